"""Measure a manoeuvre: find out what it is, and put its numbers in the terms of ITTC and IMO."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np

from shipid.declaration import units
from shipid.foundation.errors import UnknownNameError
from shipid.trials.doctor.findings import CERTAIN, Diagnosis
from shipid.trials.errors import ClockError, NotAManoeuvreError, UnknownColumnError
from shipid.trials.logs.reading import trials_of
from shipid.trials.measuring.faults import Faults, faults_of
from shipid.trials.measuring.instead import instead_of_manoeuvre, propeller_words
from shipid.trials.measuring.listing import chosen, manoeuvres_in
from shipid.trials.measuring.pull_out import measure_pull_out
from shipid.trials.measuring.results.measures import Measures
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.measuring.rudder.ends import without_keeping
from shipid.trials.measuring.rudder.executes import leaves
from shipid.trials.measuring.rudder.steering import Steering, check_rudder, rate_of, steering_of
from shipid.trials.measuring.spiral import is_spiral, measure_spiral
from shipid.trials.measuring.turn import measure_turn, turning_plate
from shipid.trials.measuring.zigzags.measure_zigzag import measure_zigzag
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.signals.plates import Plate, plates, regular
from shipid.trials.signals.ship_length import length_notice
from shipid.trials.trial import Trial

_MEASURE: dict[str, Callable[[Trial, str | None, float | None, Faults], Measures]] = {
    "zig-zag": measure_zigzag,
    "turning circle": measure_turn,
    "spiral": measure_spiral,
    "pull-out": measure_pull_out,
}
KINDS = tuple(_MEASURE)
_WIDEST = 2 * np.radians(60.0)
"""The two headings at which the rudder of a zig-zag is reversed are this far apart at the most."""


def measure(
    trial: Trial | str | Path,
    kind: str | None = None,
    *,
    execute: str | None = None,
    length: str | float | None = None,
    manoeuvre: int | None = None,
    diagnosis: Diagnosis | None = None,
) -> Measures:
    """Measure a zig-zag, a turning circle, a spiral or a pull-out.

    The doctor is asked what bears on the numbers: what lies in a gap or where a sensor stood still is not known, and the
    result says why.

    Parameters
    ----------
    trial : Trial, str or Path
        The trial, a window of it, or its file, with heading ``psi`` and rudder ``delta`` (or ``delta_order``).
    kind : {"zig-zag", "turning circle", "spiral", "pull-out"}, optional
        What it is; found out from rudder and heading by default.
    execute : {"order", "moved"}, optional
        How the execute is read (`shipid.trials.measuring.rudder.executes`): the order, read back from the ramp of the rudder where
        it is not logged, by default; or the rudder has left its plate by 15 % (in a turn: 3 deg from midships).
    length : str, optional
        Ship length with its unit, as in "320 m", for the ratios to it.
    manoeuvre : int, optional
        Which manoeuvre of a record that holds several, from 1 (`shipid.trials.measuring.listing.manoeuvres_in`).
    diagnosis : Diagnosis, optional
        What the doctor says of the trial, where it was asked already.

    Returns
    -------
    Measures
        A `ZigZag`, a `TurningCircle`, a `MeasuredSpiral` or a `PullOut`. None stands for what the manoeuvre did not reach and for
        what is not known; `reasons` says why.

    Raises
    ------
    NotAManoeuvreError
        If the record is none of them; the message says what it is instead.
    SeveralManoeuvresError
        If it holds several and none is chosen; the message lists them.
    ClockError
        If the doctor is certain that the clock is in another unit.
    UnknownNameError
        If there is no such kind.
    UnknownColumnError
        If heading or rudder is missing.
    UnitError
        If the length has no unit.
    """
    [trial] = trials_of(trial)
    metres = None if length is None else units.to_si(length, "m", "the ship length")
    if kind is not None and kind not in KINDS:
        raise UnknownNameError("kind of manoeuvre", kind, KINDS)
    if not trial.has("psi"):
        raise UnknownColumnError(f"trial '{trial.name}' has no heading 'psi', and a manoeuvre is measured by it.")
    check_rudder(trial, execute)
    faults = faults_of(trial, diagnosis)
    _check_clock(trial, faults)
    if manoeuvre is None and kind in (None, "spiral") and is_spiral(trial, faults):
        return replace(measure_spiral(trial, execute, metres, faults), record=trial)
    part = trial
    if manoeuvre is not None or kind not in ("spiral", "pull-out"):
        part = chosen(trial, manoeuvres_in(trial, faults.diagnosis), manoeuvre, kind)
    if part is not trial:
        faults = faults_of(part, faults.diagnosis)
    _check_heading(part, faults)
    measured = _MEASURE[kind or _detected(part, faults)](part, execute, metres, faults)
    if kind is None and isinstance(measured, ZigZag) and measured.doubt:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no zig-zag: {measured.doubt}. {propeller_words(trial)} Choose the window of the manoeuvre "
            "(FILE@start:end), or state its kind.".replace("  ", " ")
        )
    doubt = length_notice(part, metres)
    return replace(measured, record=part, notes=(*measured.notes, *([] if doubt is None else [doubt])))


def detect(trial: Trial, diagnosis: Diagnosis | None = None) -> str:
    """Find out whether a trial is a zig-zag, a turning circle, a spiral or a pull-out.

    Parameters
    ----------
    trial : Trial
        With heading and rudder.
    diagnosis : Diagnosis, optional
        What the doctor says of it, where it was asked already.

    Returns
    -------
    str
        One of `KINDS`.

    Raises
    ------
    NotAManoeuvreError
        If it is none of them.
    """
    faults = faults_of(trial, diagnosis)
    _check_heading(trial, faults)
    return "spiral" if is_spiral(trial, faults) else _detected(trial, faults)


def _check_clock(trial: Trial, faults: Faults) -> None:
    """Refuse a trial whose clock is in another unit than it says: every time and rate would be, and windows would miss it."""
    found = next((f for f in faults.diagnosis.serious if f.kind == "unit" and f.channel == "t"), None)
    if found is not None and found.confidence >= CERTAIN and not found.handled:
        raise ClockError(
            f"trial '{trial.name}': {found.message}. Write the unit of the clock in the header, as in 't [ms]' or 't [min]', or in a "
            "format file; 'shipid check --fix' repairs what is certain."
        )


def _check_heading(trial: Trial, faults: Faults) -> None:
    """Refuse a trial of whose heading the doctor leaves nothing."""
    if len(channel_of(trial, "psi", faults.wrong.get("psi")).t) < 2:
        kinds = ", ".join(sorted({kind for _, _, kind in faults.why.get("psi", ())}))
        why = f" ({kinds})" if kinds else ""
        raise NotAManoeuvreError(
            f"trial '{trial.name}' has fewer than two samples of the heading that can be right{why}, and a manoeuvre is measured by it."
        )


def _detected(trial: Trial, faults: Faults) -> str:
    steering = steering_of(trial, None, wrong=faults.wrong.get("delta"))
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    turning = turning_plate(steering, psi)
    held = regular(plates(steering.channel.y))
    held = without_keeping(rate_of(steering, held), psi, held) if held else held
    if turning is not None and turning.side * float(np.diff(_heading(steering, psi, turning))[0]) > pi:
        return "zig-zag" if _ordered_by_heading(steering, psi, held) else "turning circle"
    if len(held) >= 2 and _reversed_by_heading(steering, psi, held):
        return "zig-zag"
    if turning is not None:
        return "turning circle"
    raise NotAManoeuvreError(
        f"trial '{trial.name}' is neither a zig-zag nor a turning circle: the rudder does not go from one held angle to "
        "the opposite one at two regular headings, and the heading does not change by 90 deg on one rudder angle. "
        f"{instead_of_manoeuvre(trial, steering, psi)} {_doctor_says(faults, steering.channel.name)}"
        "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
    )


def _doctor_says(faults: Faults, rudder: str) -> str:
    """What the doctor is sure of that may hide a manoeuvre, in words."""
    said = [note for note in faults.notes(("psi", rudder)) if note.serious]
    return f"The doctor finds {'; '.join(map(str, said))}. " if said else ""


def _heading(steering: Steering, psi: Channel, plate: Plate) -> np.ndarray:
    """Heading at both ends of a plate [rad]."""
    return np.asarray(np.interp([steering.channel.t[plate.first], steering.after(plate)], psi.t, psi.y))


def _ordered_by_heading(steering: Steering, psi: Channel, held: list[Plate]) -> bool:
    """Whether the rudder is ordered over at two headings in turn, as in a zig-zag of slow gear: the ship turns far on meanwhile."""
    if len(held) < 3:
        return False
    known = rate_of(steering, held)
    at = np.interp([leaves(known, plate).time for plate in held[:-1]], psi.t, psi.y) * held[0].side
    apart = float(np.median(at[0::2]) - np.median(at[1::2]))
    middle = 0.5 * float(np.median(at[0::2]) + np.median(at[1::2]))
    # Two reversals alone are as far on either side of the course.
    centred = len(at) > 2 or abs(middle - held[0].side * float(psi.y[0])) < 0.2 * apart
    return 0 < apart < _WIDEST and centred and max(float(np.ptp(at[0::2])), float(np.ptp(at[1::2]))) < 0.3 * apart


def _reversed_by_heading(steering: Steering, psi: Channel, held: list[Plate]) -> bool:
    """Whether the rudder is reversed at two headings in turn, as in a zig-zag, and not at any heading by a clock."""
    at = np.array([_heading(steering, psi, plate)[1] for plate in held[:-1]]) * held[0].side
    out, back = at[0::2], at[1::2]
    if not back.size:
        return True
    apart = float(np.median(out) - np.median(back))
    spread = max(float(np.ptp(out)), float(np.ptp(back)))
    return apart > 0 and spread < 0.6 * apart
