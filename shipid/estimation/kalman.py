"""The extended Kalman filter of a declared model; it needs only a list of sensors."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.levels.learn_levels import learn_levels
from shipid.estimation.levels.record_levels import RecordLevels
from shipid.estimation.online.online_filter import OnlineFilter
from shipid.estimation.records.arrangement import Arrangement, FilterRecord, arrange, columns_of, loaded
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import first_carried
from shipid.estimation.records.likelihood import Likelihood, make_likelihood
from shipid.estimation.records.observability import Observability, observability
from shipid.estimation.records.restart import restarted, run_stretches
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.smoother import Smoothed, smooth
from shipid.estimation.recursion.layout import Form
from shipid.estimation.redesign import started_at, with_levels
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import moment
from shipid.foundation.result import Printed
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.trial import Trial


class ExtendedKalmanFilter(Printed):
    """An extended Kalman filter, generated from a model with exact Jacobians.

    The state is predicted by the model's own generated step and linearised at the estimate after the last sample; sensors
    are linearised at the predicted state and taken one after the other. A model that is linear in its states runs through
    the same code, which is then the plain Kalman filter (`linear`).

    Parameters
    ----------
    model : Model, component class or str
        The ship. What a sensor shows is a state, a derived quantity, or the output of a sensor component.
    ship : ParameterSet or str, optional
        Coefficients and particulars.
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI: those of a fit.
    measured : mapping of str to str or None, optional
        Standard deviation of one sample of each sensor, with units: ``{"psi": "0.2 deg"}``; None takes what a declared
        output states. By default every declared output.
    estimated : sequence of str, optional
        Parameters that are estimated as random walks, positive ones by their logarithm; by default those that are declared
        with noise.
    noise : mapping of str to str, optional
        What drives states, inputs and estimated parameters. In the quantity's own unit it is the standard deviation of one
        sample; per root second (``"0.01 deg/s^1.5"`` on a rate of turn) a density, of an input times root second. What the
        declaration states holds where nothing is given.
    initial : mapping of str to str, optional
        Standard deviations of the first estimates, with units.
    start : mapping of str to str, optional
        First estimates of states and parameters, with units; otherwise the first samples and the ship's values.
    rates : mapping of str to str, optional
        How often a sensor is read, ``"2 s"`` or ``"0.5 Hz"``, where it is less often than the record is sampled.
    inputs : mapping of str to str, optional
        Constant inputs with units, such as the cruising speed.
    lost : mapping of str to str, optional
        Standard deviation of an input while it is missing; its last value stands in.
    ranges : mapping of str to tuple of str, optional
        Smallest and largest value a sensor can show, with units; samples outside are left out and counted.
    gate : float or None
        Samples whose innovation exceeds so many standard deviations are rejected and counted; None accepts all.
    patience : str
        After so long a sensor that keeps being rejected, and whose value changes, is accepted again.
    log : sequence of str, optional
        Which estimated parameters are positive and estimated by their logarithm; by default those whose lower bound is
        zero or more. ``()`` estimates all as they are, within their declared bounds.
    shared_noise : bool
        Whether noise of an input that a sensor shows as well is one noise for both (exact), or counted as two independent
        ones.
    model_noise : bool
        Whether states without noise get a small default noise: no model of low order is exact.
    switchable : bool
        Whether adaptation can be switched off sample by sample (`filter`, `update`). The gain is then not the optimal
        one, and the covariance takes Joseph's form.
    method, hold, substeps
        Integration of the model, see `shipid.generation.step.make_step`.
    form : {"covariance", "square-root"}
        What is carried; the square root stays positive in single precision.
    compiled, single : bool
        Whether to compile, and whether to compute in single precision.

    Attributes
    ----------
    design : FilterDesign
        The settings, read and checked once.
    settings : FilterSettings
        As they were given.

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit.

    Notes
    -----
    Gelb (1974), sections 4.2 and 6.1; sequential updates: Bierman (1977), chapter II.
    """

    def __init__(
        self,
        model: Model | type[Component] | str,
        ship: ParameterSet | str | None = None,
        *,
        values: Mapping[str, float] | None = None,
        measured: Mapping[str, Amount | None] | None = None,
        estimated: Sequence[str] | None = None,
        noise: Mapping[str, Amount] | None = None,
        initial: Mapping[str, Amount] | None = None,
        start: Mapping[str, Amount] | None = None,
        rates: Mapping[str, Amount] | None = None,
        inputs: Mapping[str, Amount] | None = None,
        lost: Mapping[str, Amount] | None = None,
        ranges: Mapping[str, tuple[Amount, Amount]] | None = None,
        gate: float | None = 5.0,
        patience: Amount = "10 s",
        log: Sequence[str] | None = None,
        shared_noise: bool = True,
        model_noise: bool = True,
        switchable: bool = False,
        method: str = "rk4",
        hold: str = "linear",
        substeps: int = 1,
        form: Form = "covariance",
        compiled: bool = True,
        single: bool = False,
    ) -> None:
        self.settings = FilterSettings(
            values=values,
            measured=measured,
            estimated=estimated,
            noise=noise,
            initial=initial,
            start=start,
            rates=rates,
            inputs=inputs,
            lost=lost,
            ranges=ranges,
            gate=gate,
            patience=patience,
            log=log,
            shared_noise=shared_noise,
            model_noise=model_noise,
            switchable=switchable,
            method=method,
            hold=hold,
            substeps=substeps,
            form=form,
            compiled=compiled,
            single=single,
        )
        self.design: FilterDesign = design_filter(model, ship, self.settings)

    def __repr__(self) -> str:
        return repr(self.design)

    @property
    def model(self) -> Model:
        """The ship with the estimated parameters among its states."""
        return self.design.model

    @property
    def parameters(self) -> Mapping[str, str]:
        """The state of each estimated parameter: its own name, or ``log_NAME`` where its logarithm is estimated."""
        return self.design.parameters

    @property
    def measured(self) -> tuple[str, ...]:
        """The measured quantities, in the order of the sensors."""
        return self.design.measured

    @property
    def linear(self) -> bool:
        """Whether neither Jacobian depends on the estimate: then this is the plain Kalman filter, and exact."""
        return self.design.linear

    def filter(
        self,
        record: FilterRecord | str | Path,
        *,
        adapt: np.ndarray | bool = True,
        scale: Mapping[str, np.ndarray | float] | None = None,
    ) -> FilterRun:
        """Filter a whole record.

        Parameters
        ----------
        record : Trial, mapping of str to ndarray, str or Path
            SI columns with ``t``, or a trial's file; NaN where a sample is missing. An input is filled between its samples; behind a hole that is
            too long for that, what it drives starts anew.
        adapt : bool or ndarray of bool, shape (samples,)
            Where parameters adapt (needs ``switchable=True``).
        scale : mapping of str to float or ndarray, optional
            Factors on the noise of states and inputs, for every sample.

        Returns
        -------
        FilterRun

        Raises
        ------
        FilterDivergedError
            If the estimate diverges.
        NotMeasurableError
            If the record lacks a sensor.
        UnstatedInputError
            If it lacks an input that declares no default.
        """
        design, record = self.design, loaded(record)
        arranged = arrange(design.instruments, record)
        control = controls_of(design, arranged, adapt, scale)
        start = first_carried(design, record, arranged)
        _, out, starts = run_stretches(
            design.loop(full=True),
            start,
            control,
            design.constants,
            arranged,
            lambda carried, hole: restarted(design, arranged, carried, hole),
        )
        check_finite(design, arranged, out, record.name if isinstance(record, Trial) else None)
        return FilterRun(design, columns_of(record)[1], arranged, control, starts, out)

    def smooth(self, run: FilterRun) -> Smoothed:
        """Return the estimate at each sample from all samples of a filtered record.

        Parameters
        ----------
        run : FilterRun
            What this filter made of the record.

        Raises
        ------
        UsageError
            If the run is of another filter, or of several.
        """
        self._check_own(run)
        return smooth(run)

    def observability(self, run: FilterRun) -> Observability:
        """Return which directions of the state a filtered record does not show.

        Parameters
        ----------
        run : FilterRun
            What this filter made of the record.

        Raises
        ------
        UsageError
            If the run is of another filter.
        """
        self._check_own(run)
        return observability(run)

    def _check_own(self, run: FilterRun) -> None:
        if not isinstance(run, FilterRun):
            raise UsageError(f"this takes what filter(record) returned, a FilterRun, and not a {type(run).__name__}.")
        if run.design is not self.design and run.design.fingerprint != self.design.fingerprint:
            raise UsageError(f"the run of record {run.record} is of another filter, {run.design!r}; use that filter.")

    def likelihood(self, record: FilterRecord, unknowns: Sequence[str], *, filled: bool = False) -> Likelihood:
        """Return the likelihood of a record as a function of unknowns, with its exact gradient.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            What was measured.
        unknowns : sequence of str
            Coefficients by name, ``noise:NAME`` and ``sensor:NAME`` (logarithms of levels), ``x0:STATE``, ``bias:INPUT``.
        filled : bool
            Whether the inputs of the record are known to be whole.
        """
        return make_likelihood(self.design, record, unknowns, filled=filled)

    def learn_levels(self, record: FilterRecord, kept: Sequence[str] = ()) -> RecordLevels:
        """Return the noise levels under which a record is most probable, and what it says of the coefficients.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            What is filtered.
        kept : sequence of str
            ``sensor:NAME`` and ``noise:NAME`` that stay as they are.

        Returns
        -------
        RecordLevels
            For `with_levels`.
        """
        return learn_levels(self.design, self.settings, record, kept)

    def with_levels(self, levels: RecordLevels) -> ExtendedKalmanFilter:
        """Return the same filter with other noise levels, and with the biases of its inputs taken out.

        Parameters
        ----------
        levels : RecordLevels
            Of every sensor and of all that drives the states.
        """
        other = copy.copy(self)
        other.design = with_levels(self.design, levels.sensors, levels.noise, levels.biases)
        return other

    def started_at(self, starts: Mapping[str, tuple[float, float]]) -> ExtendedKalmanFilter:
        """Return the same filter with other first estimates of parameters.

        Parameters
        ----------
        starts : mapping of str to tuple of float
            First value and standard deviation by estimated parameter, SI.
        """
        other = copy.copy(self)
        other.design = started_at(self.design, starts)
        return other

    def start(self, lag: Amount | None = None) -> OnlineFilter:
        """Return the filter for samples that arrive one by one.

        Parameters
        ----------
        lag : str, optional
            Fixed lag, ``"10 s"``: estimates so long ago are smoothed with the samples since.

        Returns
        -------
        OnlineFilter
            With ``update(sample)``; see `shipid.estimation.online.online_filter`.
        """
        return OnlineFilter(self.design, None if lag is None else to_si(lag, "s", "the lag"))

    def restore(self, path: str | Path) -> OnlineFilter:
        """Return an online filter as `OnlineFilter.save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to a filter of another model, with other sensors or noise.
        """
        online = OnlineFilter(self.design)
        online.load(path)
        return online


def check_finite(design: FilterDesign, arranged: Arrangement, out: np.ndarray, trial: str | None = None) -> None:
    """Raise an error if the estimates diverged.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    arranged : Arrangement
        The record.
    out : ndarray, shape (rows, outputs)
        What the step returned of each row.
    trial : str, optional
        The record's name.

    Raises
    ------
    FilterDivergedError
        If an estimate or a variance is not finite.
    """
    good = np.isfinite(out[:, : design.layout.full["var"].stop]).all(axis=1)
    if not good.all():
        whose = "" if trial is None else f"trial '{trial}': "
        raise FilterDivergedError(
            f"{whose}the filter of model {design.base.name} diverges {moment(arranged.t[np.argmin(good)])} s into the record. Start "
            "closer to the true state (start, initial), put more noise on the states, or estimate fewer parameters."
        )
