"""Measure every manoeuvre of the logs of a trial day, and put the numbers beside their limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from shipid.criteria.measured.form import FormEntry, form_of
from shipid.criteria.measured.measured_criteria import MeasuredCriterion, measured_criteria
from shipid.criteria.measured.sheet import NotMeasured, SheetManoeuvre, TrialSheet
from shipid.declaration.units import to_si
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import given
from shipid.parameters.catalogue import ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.conditions import Conditions
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import Diagnosis
from shipid.trials.errors import TrialError
from shipid.trials.logs.reading import read_trial
from shipid.trials.measuring.faults import faults_of
from shipid.trials.measuring.listing import chosen, manoeuvres_in
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.spiral import is_spiral
from shipid.trials.trial import Trial

#: What the standard asks of the conditions (MSC.137(76) 5.2), said beside the verdicts.
SCOPE = (
    "MSC.137(76) applies to ships of 100 m and longer, in deep, unrestricted water, calm surroundings, at full load on even keel, at "
    "90 % or more of the speed at 85 % of the engine's output; whether these held is not in a log. Stopping (5.3.4) is not measured."
)
_SHORT = 100.0
#: No ship turns in a tactical diameter outside this range, in her lengths: the length, or the unit of the positions, is another.
_DIAMETERS = (0.8, 20.0)


def trial_sheet(
    trials: Trial | str | Path | Sequence[Trial | str | Path],
    *,
    length: str | float | None = None,
    ship: ParameterSet | str | Path | None = None,
    conditions: Conditions | None = None,
    reader: Callable[[str], Trial] = read_trial,
    tell: Callable[[str], object] = lambda _: None,
) -> TrialSheet:
    """Measure every manoeuvre of some logs: the sheet of a trial day, without a model.

    Parameters
    ----------
    trials : Trial, str, Path or sequence of them
        Trials, or files that are read as `shipid.read_trial` does.
    length : str or float, optional
        Ship length with its unit, as in "320 m", or in m; by default that of the conditions, or of the ship.
    ship : ParameterSet, str or Path, optional
        Her particulars.
    conditions : Conditions, optional
        What is stated of the day; it goes before what the format file of a log states.
    reader : callable, optional
        Reads a trial of its name.
    tell : callable, optional
        Told what is being done.

    Returns
    -------
    TrialSheet
        A log that cannot be read or measured costs the others nothing: it is among `not_measured`.

    Raises
    ------
    UsageError
        If there is no trial, or the length is none.
    UnitError
        If the length is a text without a unit.
    TrialError, MissingFileError
        Of reading or measuring, if there is only one log and it has no numbers.
    """
    given = [trials] if isinstance(trials, (Trial, str, Path)) else list(trials)
    if not given:
        raise UsageError("a trial sheet needs a trial.")
    known = None if ship is None else ship_of(ship)
    stated = to_si(length, "m", "the ship length") if isinstance(length, str) else length
    if stated is not None and not stated > 0:
        raise UsageError(f"a ship length of {stated:g} m has no ratios to it: give one greater than zero.")
    sailed: list[tuple[Trial, Diagnosis]] = []
    lost: list[NotMeasured] = []
    failures: list[Exception] = []
    for one in given:
        tell(f"reading {one.name if isinstance(one, Trial) else one}")
        try:
            trial = one if isinstance(one, Trial) else reader(str(one))
            sailed.append((trial, check_trial(trial)))
        except (TrialError, OSError) as error:
            failures.append(error)
            lost.append(NotMeasured(one.name if isinstance(one, Trial) else str(one), str(error)))
    unread = len(lost)
    whole = _conditions(conditions, [trial for trial, _ in sailed], known)
    stated = stated or whole.number("length")
    manoeuvres: list[SheetManoeuvre] = []
    for trial, diagnosis in sailed:
        tell(f"measuring {trial.name}")
        _measure_all(trial, diagnosis, stated, manoeuvres, lost, failures)
    if not manoeuvres and len(given) == 1 and failures:
        raise failures[0]
    largest = whole.number("largest_rudder")
    rows = tuple(row for m in manoeuvres for row in measured_criteria(m.number, m.measures, stated, largest))
    record = whole.with_defaults({"length": stated})
    form = form_of(record, stated, [m.measures for m in manoeuvres])
    warnings = _simulated([trial for trial, _ in sailed]) + _doubts(manoeuvres)
    warnings += _warnings(stated, rows, lost, unread > 0 or not manoeuvres) + _unmet(form, rows)
    return TrialSheet(record, stated, tuple(manoeuvres), rows, tuple(lost), tuple(warnings), form)


def _measure_all(
    trial: Trial,
    diagnosis: Diagnosis,
    length: float | None,
    manoeuvres: list[SheetManoeuvre],
    lost: list[NotMeasured],
    failures: list[Exception],
) -> None:
    """Measure the manoeuvres of one log, each on its own: one that fails costs the others nothing."""
    try:
        several = () if is_spiral(trial, faults_of(trial, diagnosis)) else manoeuvres_in(trial, diagnosis)
    except TrialError:
        several = ()
    numbers: Sequence[int | None] = [m.number for m in several] if len(several) > 1 else [None]
    for which in numbers:
        try:
            found = measure(
                trial, length=None if length is None else f"{length!r} m", manoeuvre=which, diagnosis=diagnosis
            )
            part = trial if found.kind in ("spiral", "pull-out") else chosen(trial, several, which, None)
        except TrialError as error:
            failures.append(error)
            name = trial.name if which is None else f"{trial.name}, {several[which - 1]}"
            lost.append(NotMeasured(name, str(error)))
        else:
            manoeuvres.append(SheetManoeuvre(len(manoeuvres) + 1, found, part))


def _conditions(given: Conditions | None, trials: Sequence[Trial], ship: ParameterSet | None) -> Conditions:
    """What is stated, by the caller before the logs; entries on which the logs differ are left blank."""
    own: dict[str, str | float | None] = {}
    for trial in trials:
        for name, value in trial.source.conditions.values.items():
            own[name] = value if own.get(name, value) == value else None
    whole = (given or Conditions()).with_defaults(own)
    starts = {trial.source.start for trial in trials}
    begin = starts.pop() if len(starts) == 1 else None
    whole = whole.with_defaults({"date": begin and begin.replace("T", " ")})
    if ship is None:
        return whole
    return whole.with_defaults(
        {
            "ship": ship.name,
            "length": ship.particular("L", "m"),
            "breadth": ship.particular("B", "m"),
            "largest_rudder": ship.particular("delta_max", "rad"),
        }
    )


def _unmet(form: Sequence[FormEntry], rows: Sequence[MeasuredCriterion]) -> list[Notice]:
    """What is stated of the surroundings that is not what the standard asks."""
    if not rows:
        return []
    said = [
        f"{e.label} {given(float(f'{e.value:.2g}'))} ({e.asked})"
        for e in form
        if e.met is False and e.value is not None
    ]
    words = f"The surroundings were not those of the standard: {'; '.join(said)}. Its limits do not hold there."
    return [Notice(words, "surroundings")] if said else []


def _simulated(trials: Sequence[Trial]) -> list[Notice]:
    names = [t.name for t in trials if t.source.simulated]
    return [Notice(f"Simulated, not measured: {', '.join(names)}.", "simulated")] if names else []


def _doubts(manoeuvres: Sequence[SheetManoeuvre]) -> list[Notice]:
    """What the doctor is sure of that misleads the numbers of a manoeuvre."""
    told = [(m, note) for m in manoeuvres for note in m.measures.notes if isinstance(note, Notice) and note.serious]
    return [note.about(f"manoeuvre {m.number}, {m.record.name}") for m, note in told]


def _warnings(
    length: float | None, rows: Sequence[MeasuredCriterion], lost: Sequence[NotMeasured], serious: bool
) -> list[Notice]:
    said = []
    if lost:
        what = "One log or manoeuvre has" if len(lost) == 1 else f"{len(lost)} logs or manoeuvres have"
        said.append(Notice(f"{what} no numbers; the reasons are listed.", "not-measured", serious=serious))
    if rows:
        said.append(Notice(SCOPE, "scope"))
        if length is None:
            words = "The ship length is not stated: without it there are no ratios to it and no limits by L/V. Give --length."
            said.append(Notice(words, "length-unknown"))
        elif any(
            r.value is not None and not _DIAMETERS[0] < r.value < _DIAMETERS[1]
            for r in rows
            if r.key == "tactical_diameter"
        ):
            words = (
                f"With a length of {length:g} m a tactical diameter is outside {_DIAMETERS[0]:g} to {_DIAMETERS[1]:g} L, which is no ship's: "
                "check the length, and whether log and length are both of the ship or both of the model."
            )
            said.append(Notice(words, "length-doubtful", serious=True))
        elif length < _SHORT:
            words = f"This ship is {length:g} m long: the limits are shown for comparison only."
            said.append(Notice(words, "scope"))
    return said
