"""Recursive identification: parameters along a record, or from samples that arrive one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.estimation.errors import NotMeasurableError
from shipid.estimation.records.arrangement import Arrangement, FilterRecord, arrange, columns_of, loaded
from shipid.estimation.recursion.layout import total
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.aliases import Plain
from shipid.identification.recursive.design import RecursiveDesign, RecursiveSettings, design_recursion
from shipid.identification.recursive.holes import run_over_holes
from shipid.identification.recursive.online import OnlineIdentifier
from shipid.identification.recursive.result import RecursiveIdentification
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.trial import Trial


class RecursiveIdentifier:
    """One member of the family of recursive identification, for one state of a declared model.

    Parameters
    ----------
    model : Model, component class or str
        What is identified.
    ship : ParameterSet or str, optional
        Particulars, and coefficients that are known or where the search starts.
    method : str
        A key of `shipid.identification.recursive.methods.METHODS`.
    estimate : sequence of str, optional
        Parameters to estimate; by default all that are declared as estimated and enter the equation of the measured state.
    measured : mapping of str to str or None, optional
        The one measured state (or the output of a sensor that measures it), with the standard deviation of a sample:
        ``{"r": "0.02 deg/s"}``. With None the level comes from the record (`shipid.identification.recursive.noise_level`).
    noise : mapping of str to str, optional
        Random walk of the parameters, and noise that drives the measured state: per sample or per root second, as for a
        filter. Where nothing is given the declared noise holds, for the methods that use noise levels.
    initial : mapping of str to str, optional
        Standard deviations of the first estimates, with units.
    start : mapping of str to str, optional
        First estimates, with units; otherwise the ship's values, then the declared ones; of the state the first sample.
    inputs : mapping of str to str, optional
        Constant inputs with units, such as the cruising speed.
    forgetting : float
        Forgetting factor: factor on the weight of samples for each sample of age, for the methods that take one; 1 is none.
    integration, hold : str
        See `shipid.generation.step.make_step`.
    compiled : bool
        Whether to compile.

    Attributes
    ----------
    design : RecursiveDesign
        The settings, read and checked once.

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit, and for parameters that enter nonlinearly.

    Notes
    -----
    A first standard deviation is best about as large as the expected error of the first estimate. Where it is much larger, the
    extended Kalman filter sometimes diverges; least squares and MRAS do not (``studies/passenier_ch4.py`` counts both).
    """

    def __init__(
        self,
        model: Model | type[Component] | str,
        ship: ParameterSet | str | None = None,
        *,
        method: str = "combined",
        estimate: Sequence[str] | None = None,
        measured: Mapping[str, Amount | None] | None = None,
        noise: Mapping[str, Amount] | None = None,
        initial: Mapping[str, Amount] | None = None,
        start: Mapping[str, Amount] | None = None,
        inputs: Mapping[str, Amount] | None = None,
        forgetting: float = 1.0,
        integration: str = "rk4",
        hold: str = "linear",
        compiled: bool = True,
    ) -> None:
        self.design: RecursiveDesign = design_recursion(
            model,
            ship,
            RecursiveSettings(
                method=method,
                estimate=estimate,
                measured=measured,
                noise=noise,
                initial=initial,
                start=start,
                inputs=inputs,
                forgetting=forgetting,
                integration=integration,
                hold=hold,
                compiled=compiled,
            ),
        )

    def __repr__(self) -> str:
        return repr(self.design)

    @property
    def names(self) -> tuple[str, ...]:
        """The estimated parameters."""
        return self.design.names

    @property
    def output(self) -> str:
        """The measured state."""
        return self.design.output

    def identify(self, record: FilterRecord) -> RecursiveIdentification:
        """Run a whole record.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            SI columns with ``t``; NaN where a sample is missing. An input is filled between its samples; behind a hole that is
            too long for that, the measured state starts anew.

        Returns
        -------
        RecursiveIdentification

        Raises
        ------
        NotMeasurableError
            If the record lacks the measured state.
        UnstatedInputError
            If it lacks an input that declares no default.
        """
        return self.identify_all([record])[0]

    def identify_all(
        self, records: Sequence[FilterRecord], threads: int | None = None
    ) -> list[RecursiveIdentification]:
        """Run many records side by side.

        Parameters
        ----------
        records : sequence of Trial or mapping
            As for `identify`; each starts anew.
        threads : int, optional
            How many; by default one for each processor.

        Returns
        -------
        list of RecursiveIdentification
            In the order of the records.
        """
        design = self.design
        arranged = [_arranged(design, r) for r in records]
        levels = [design.level_of(a.z[a.there[:, 0], 0], a.t[a.there[:, 0]]) for a in arranged]
        starts = [
            design.carried(float(a.z[a.there[:, 0], 0][0]), a.inputs[0], level) for a, level in zip(arranged, levels)
        ]
        controls = [_controls(design, a) for a in arranged]
        constants = [design.constants(level) for level in levels]
        if any(a.holes for a in arranged):
            done = [run_over_holes(design, *each) for each in zip(starts, controls, constants, arranged, levels)]
        else:
            done = [out for _, out in design.loop.map(starts, controls, constants, threads)]
        return [
            RecursiveIdentification(design, columns_of(r)[1], a, level, out)
            for r, a, level, out in zip(records, arranged, levels, done)
        ]

    def start(self) -> OnlineIdentifier:
        """Return the recursion for samples that arrive one by one; see `shipid.identification.recursive.online`."""
        return OnlineIdentifier(self.design)

    def restore(self, path: str | Path) -> OnlineIdentifier:
        """Return an online recursion as `OnlineIdentifier.save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to another recursion.
        """
        online = OnlineIdentifier(self.design)
        online.load(path)
        return online


def _arranged(design: RecursiveDesign, record: FilterRecord) -> Arrangement:
    arranged = arrange(design.instruments, record)
    if not arranged.there.any():
        columns, name = columns_of(record)
        column = design.instruments.column_of(design.sensor, columns)
        raise NotMeasurableError(f"column '{column}' of record {name} holds no sample that is a number.")
    return arranged


def _controls(design: RecursiveDesign, arranged: Arrangement) -> np.ndarray:
    """What the recursion takes of each row, shape (rows, controls)."""
    places = design.layout.control
    control = np.zeros((arranged.t.size, total(places)))
    control[:, places["u"]] = arranged.inputs
    control[:, places["T"]] = arranged.intervals[:, None]
    control[:, places["z"]] = arranged.z
    control[:, places["there"]] = arranged.there
    return control


def identify_recursively(
    model: Model | type[Component] | str,
    trial: FilterRecord | str | Path | Sequence[FilterRecord | str | Path],
    *,
    method: str = "combined",
    ship: ParameterSet | str | None = None,
    **options: Plain,
) -> RecursiveIdentification | list[RecursiveIdentification]:
    """Identify parameters sample by sample.

    Parameters
    ----------
    model : Model, component class or str
        What is identified; one state of it, linear in the parameters.
    trial : Trial, mapping, str or Path, or a sequence of them
        Records of that state and of what its equation reads; a trial may be the file of its log.
    method : str
        ``"ekf"``, ``"rls"``, ``"series-parallel"``, ``"mras-parallel"``, ``"minimum-variance"``, ``"combined"``,
        ``"combined-heuristic"`` or ``"instrumental-variables"``.
    ship : ParameterSet or str, optional
        Particulars, and coefficients that are known or where the search starts.
    **options
        See `RecursiveIdentifier`.

    Returns
    -------
    RecursiveIdentification
        Or a list of them for a sequence of records.
    """
    identifier = RecursiveIdentifier(model, ship, method=method, **options)
    if isinstance(trial, Trial | Mapping | str | Path):
        return identifier.identify(loaded(trial))
    return identifier.identify_all([loaded(one) for one in trial])
