"""The multiple-model filter: declared models, a Markov chain between them, and one generated cycle for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.declaration.units import to_si
from shipid.estimation.design import FilterDesign, FilterSettings
from shipid.estimation.errors import FilterDivergedError, ModeError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.multiple.cycle.cycle import CycleSettings, Merging
from shipid.estimation.multiple.cycle.maps import ModeMaps, make_maps
from shipid.estimation.multiple.design import MultipleModelDesign, read_moves
from shipid.estimation.multiple.first_state import FirstState
from shipid.estimation.multiple.modes import ModeLike, check_modes, design_modes
from shipid.estimation.multiple.multiple_run import MultipleModelRun
from shipid.estimation.multiple.multiple_runs import MultipleModelRuns, filter_runs
from shipid.estimation.multiple.online import OnlineMultipleModel
from shipid.estimation.multiple.record import MultipleRecord, arrange_for_modes
from shipid.estimation.multiple.structures import Structure
from shipid.estimation.multiple.transition import read_probabilities, read_transition
from shipid.estimation.records.arrangement import FilterRecord, columns_of, loaded
from shipid.estimation.records.restart import run_stretches
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.numbers import moment
from shipid.foundation.result import Printed


class InteractingMultipleModel(Printed):
    """A filter for a system that follows one of several models at a time, generated with exact Jacobians.

    Parameters
    ----------
    models : mapping of str to Mode or Model
        The modes by name: a model each, or a `shipid.estimation.multiple.modes.Mode` with settings of its own. They read the same
        sensors. The combined estimate has the states of the first.
    transition : sequence of sequence of float
        Transition probabilities from each mode (row) to each (column), in the order of the modes.
    measured : mapping of str to str or None
        Standard deviation of one sample of each sensor, with units.
    per : str, optional
        The interval the transition probabilities hold for, as in ``"3 s"``: longer and shorter intervals take the power of the
        matrix. By default they hold from one sample to the next.
    probabilities : sequence of float, optional
        Of the modes before the first sample; equal by default.
    values, noise, initial, start, inputs, lost : mapping, optional
        As for `shipid.ExtendedKalmanFilter`; each holds for all modes that have the quantity.
    structure : Displaced or AdaptiveGrid, optional
        How a parameter of the modes moves (`shipid.estimation.multiple.structures`).
    merging : {"interacting", "pseudo-bayesian"}
        Whether each mode starts a scan from a mixture of its own, or all from the combined estimate (GPB1).
    fading : float
        Factor on the covariance before each prediction, 1 or more.
    led : mapping of str to str, optional
        States that all modes take from one of them after each scan: ``{"V_U": "straight"}``.
    maps : mapping, optional
        For modes with different states, by pair ``(from, to)``: what the states that `from` does not have are, a quantity of `from` by
        name, or a value and its standard deviation.
    correlated : bool
        Whether the errors of a scan's sensors are correlated, as of a polar radar in x and y; covariances come with the samples.
    model_noise : bool
        Whether states without noise get a small default noise, where the ship's scale is known.
    method, hold, substeps
        Integration of the models, see `shipid.generation.step.make_step`.
    compiled : bool
        Whether to compile.

    Attributes
    ----------
    design : MultipleModelDesign
        The settings, read and checked once.

    Raises
    ------
    UnknownNameError
        If a setting names what no mode has.
    ModeError
        If modes do not fit each other, or their bounds overlap.
    ShipidError
        For names, units and levels that do not fit.

    Notes
    -----
    Blom and Bar-Shalom (1988); Bar-Shalom, Li and Kirubarajan (2001), section 11.6.
    """

    def __init__(
        self,
        models: Mapping[str, ModeLike],
        transition: Sequence[Sequence[float]] | np.ndarray,
        *,
        measured: Mapping[str, Amount | None],
        per: Amount | None = None,
        probabilities: Sequence[float] | None = None,
        values: Mapping[str, float] | None = None,
        noise: Mapping[str, Amount] | None = None,
        initial: Mapping[str, Amount] | None = None,
        start: Mapping[str, Amount] | None = None,
        inputs: Mapping[str, Amount] | None = None,
        lost: Mapping[str, Amount] | None = None,
        structure: Structure = None,
        merging: Merging = "interacting",
        fading: float = 1.0,
        led: Mapping[str, str] | None = None,
        maps: ModeMaps | None = None,
        correlated: bool = False,
        model_noise: bool = True,
        method: str = "rk4",
        hold: str = "linear",
        substeps: int = 1,
        compiled: bool = True,
    ) -> None:
        common = FilterSettings(
            values=values,
            measured=measured,
            noise=noise,
            initial=initial,
            start=start,
            inputs=inputs,
            lost=lost,
            model_noise=model_noise,
            method=method,
            hold=hold,
            substeps=substeps,
            compiled=compiled,
        )
        modes = design_modes(models, common)
        names = tuple(modes)
        if merging not in ("interacting", "pseudo-bayesian"):
            raise UnknownNameError("merging", merging, ("interacting", "pseudo-bayesian"))
        if not fading >= 1:
            raise ModeError(f"a fading of {fading:g} shrinks the covariance before each prediction; give 1 or more.")
        interval = _interval(per)
        numbers = {n: j for j, n in enumerate(names)}
        settings = CycleSettings(
            {(numbers[a], numbers[b]): m for (a, b), m in make_maps(modes, maps or {}).items()},
            merging,
            float(fading),
            {s: numbers[leader] for s, leader in _leaders(led or {}, modes).items()},
            read_moves(structure, modes),
            correlated,
        )
        matrix = read_transition(transition, names)
        self.design = MultipleModelDesign(
            modes, matrix, interval, read_probabilities(probabilities, names), settings, compiled
        )

    @classmethod
    def of_filters(
        cls,
        filters: Mapping[str, ExtendedKalmanFilter],
        transition: Sequence[Sequence[float]] | np.ndarray,
        *,
        per: Amount | None = None,
        probabilities: Sequence[float] | None = None,
    ) -> InteractingMultipleModel:
        """Return the multiple-model filter over Kalman filters as they are, with their sensors and noise.

        Parameters
        ----------
        filters : mapping of str to ExtendedKalmanFilter
            The modes, made with ``gate=None`` and ``shared_noise=False``, with equal sensors and states.
        transition, per, probabilities
            See the class.

        Raises
        ------
        ModeError
            If the filters do not fit each other.
        TransitionError
            If the transition probabilities do not fit the modes.
        """
        modes = {n: f.design for n, f in filters.items()}
        check_modes(modes)
        made = cls.__new__(cls)
        names = tuple(modes)
        maps = {(names.index(a), names.index(b)): m for (a, b), m in make_maps(modes, {}).items()}
        made.design = MultipleModelDesign(
            modes,
            read_transition(transition, names),
            _interval(per),
            read_probabilities(probabilities, names),
            CycleSettings(maps, "interacting", 1.0, {}, None, False),
            all(d.compiled for d in modes.values()),
        )
        return made

    def __repr__(self) -> str:
        return repr(self.design)

    @property
    def modes(self) -> tuple[str, ...]:
        """Names of the modes, in order."""
        return self.design.names

    @property
    def states(self) -> tuple[str, ...]:
        """States of the combined estimate: those of the first mode."""
        return self.design.states

    @property
    def measured(self) -> tuple[str, ...]:
        """The measured quantities, in the order of the sensors."""
        return self.design.measured

    def filter(
        self,
        record: FilterRecord | str | Path,
        *,
        covariances: np.ndarray | None = None,
        first: FirstState | None = None,
    ) -> MultipleModelRun:
        """Filter a whole record.

        Parameters
        ----------
        record : Trial, mapping of str to ndarray, str or Path
            SI columns with ``t``, or a trial's file; NaN where a sample is missing.
        covariances : ndarray, shape (samples, sensors, sensors) or (sensors, sensors), optional
            Covariance of the sensors' errors, SI, in the order of the sensors, in place of the standard deviations given.
        first : FirstState, optional
            What is known before the first sample; otherwise the first samples, and the settings.

        Returns
        -------
        MultipleModelRun

        Raises
        ------
        FilterDivergedError
            If the estimate diverges.
        ShipidError
            If the covariances do not fit, or the record lacks a sensor or an input.
        """
        record = loaded(record)
        arranged = arrange_for_modes(self.design, record, covariances, first)
        out = run_cycles(self.design, arranged)
        return self._run(columns_of(record)[1], arranged, out)

    def filter_runs(
        self,
        record: Mapping[str, np.ndarray],
        *,
        covariances: np.ndarray | None = None,
        first: FirstState | None = None,
        threads: int | None = None,
    ) -> MultipleModelRuns:
        """Filter many runs of one experiment, side by side on several threads where the code is compiled.

        Parameters
        ----------
        record : mapping of str to ndarray, shape (runs, samples) or (samples,)
            SI columns; the times ``t`` and the inputs are those of all runs, shape (samples,).
        covariances : ndarray, shape (runs, samples, sensors, sensors), optional
            As for `filter`; one without the first axes holds for all.
        first : FirstState, optional
            As for `filter`; its mean may have one row for each run.
        threads : int, optional
            How many; by default one for each processor.

        Returns
        -------
        MultipleModelRuns

        Raises
        ------
        FilterDivergedError
            If an estimate diverges.
        ShipidError
            See `filter`.
        """
        return filter_runs(self.design, record, covariances, first, threads)

    def _run(self, name: str, record: MultipleRecord, out: np.ndarray) -> MultipleModelRun:
        good = np.isfinite(out[:, : self.design.layout.brief["ll"].stop]).all(axis=1)
        if not good.all():
            raise FilterDivergedError(
                f"{self.design!r} diverges {moment(record.arranged.t[np.argmin(good)])} s into record {name}. Start closer to the true "
                "state (start, initial, first), or put more noise on the states."
            )
        return MultipleModelRun(self.design, name, record.arranged, record.control, out)

    def start(self, first: FirstState | None = None) -> OnlineMultipleModel:
        """Return the filter for samples that arrive one by one.

        Parameters
        ----------
        first : FirstState, optional
            What is known before the first sample.

        Returns
        -------
        OnlineMultipleModel
            With ``update(sample)`` and ``predict(t)``.
        """
        return OnlineMultipleModel(self.design, first)


def run_cycles(design: MultipleModelDesign, record: MultipleRecord) -> np.ndarray:
    """Run the cycle over an arranged record, anew behind each hole of an input; return its outputs, shape (rows, outputs).

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    record : MultipleRecord
        The record.

    Returns
    -------
    ndarray
    """
    following = iter(record.starts[1:])
    _, out, _ = run_stretches(
        design.loop(),
        record.starts[0],
        record.control,
        design.constants,
        record.arranged,
        lambda _, __: next(following),
    )
    return out


def _interval(per: Amount | None) -> float | None:
    interval = None if per is None else to_si(per, "s", "the interval of the transition probabilities")
    if interval is not None and not interval > 0:
        raise ModeError(f"the transition probabilities hold for {per}: an interval must be longer than zero.")
    return interval


def _leaders(led: Mapping[str, str], modes: Mapping[str, FilterDesign]) -> dict[str, str]:
    for name, leader in led.items():
        if leader not in modes:
            raise UnknownNameError(f"mode that leads '{name}' called", leader, modes)
        for mode, design in modes.items():
            if name not in design.model.states:
                raise ModeError(f"'{name}' is led by mode '{leader}', and mode '{mode}' has no such state.")
    return dict(led)
