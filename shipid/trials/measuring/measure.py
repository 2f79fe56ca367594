"""Measure a manoeuvre: find out what it is, and put its numbers in the terms of ITTC and IMO."""

from __future__ import annotations

from math import pi

import numpy as np

from shipid.declaration import units
from shipid.foundation.errors import UnknownNameError
from shipid.trials.errors import NotAManoeuvreError, UnknownColumnError
from shipid.trials.measuring.executes import convention
from shipid.trials.measuring.measures import Measures
from shipid.trials.measuring.turn import measure_turn, turning_plate
from shipid.trials.measuring.zigzag import measure_zigzag
from shipid.trials.signals.plates import Plate, plates, regular
from shipid.trials.trial import Trial

KINDS = ("zig-zag", "turning circle")


def measure(
    trial: Trial, kind: str | None = None, *, execute: str | None = None, length: str | float | None = None
) -> Measures:
    """Measure a zig-zag or a turning circle.

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading ``psi`` and rudder ``delta`` (or ``delta_order``).
    kind : {"zig-zag", "turning circle"}, optional
        What it is; found out from rudder and heading by default.
    execute : {"moved", "order"}, optional
        How the execute is read (`shipid.trials.measuring.executes`): the rudder has left its plate by 15 % (in a turn: 3 deg
        from midships), or the order. By default the order where it is recorded, else "moved".
    length : str, optional
        Ship length with its unit, as in "320 m", for the ratios to it.

    Returns
    -------
    Measures
        A `ZigZag` or a `TurningCircle`; None stands for what the manoeuvre did not reach.

    Raises
    ------
    NotAManoeuvreError
        If the record is neither.
    UnknownNameError
        If there is no such kind.
    UnknownColumnError
        If heading or rudder is missing.
    UnitError
        If the length has no unit.
    """
    metres = None if length is None else units.to_si(length, "m", "the ship length")
    if kind is not None and kind not in KINDS:
        raise UnknownNameError("kind of manoeuvre", kind, KINDS)
    if not trial.has("psi"):
        raise UnknownColumnError(f"trial '{trial.name}' has no heading 'psi', and a manoeuvre is measured by it.")
    kind = kind or detect(trial)
    return measure_turn(trial, execute, metres) if kind == KINDS[1] else measure_zigzag(trial, execute, metres)


def detect(trial: Trial) -> str:
    """Find out whether a trial is a zig-zag or a turning circle.

    Parameters
    ----------
    trial : Trial
        With heading and rudder.

    Returns
    -------
    str
        One of `KINDS`.

    Raises
    ------
    NotAManoeuvreError
        If it is neither.
    """
    _, rudder = convention(trial, None)
    found = plates(rudder)
    psi = trial["psi"]
    turning = turning_plate(trial, rudder)
    if turning is not None and turning.side * (psi[turning.last - 1] - psi[turning.first]) > pi:
        return KINDS[1]
    held = regular(found)
    if len(held) >= 2 and _reversed_by_heading(trial, held):
        return KINDS[0]
    if turning is not None:
        return KINDS[1]
    raise NotAManoeuvreError(
        f"trial '{trial.name}' is neither a zig-zag nor a turning circle: the rudder does not go from one held angle to "
        "the opposite one at two regular headings, and the heading does not change by 90 deg on one rudder angle. "
        "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
    )


def _reversed_by_heading(trial: Trial, held: list[Plate]) -> bool:
    """Whether the rudder is reversed at two headings in turn, as in a zig-zag, and not at any heading by a clock."""
    psi = trial["psi"]
    at = np.array([psi[min(plate.last, len(psi) - 1)] for plate in held[:-1]]) * held[0].side
    out, back = at[0::2], at[1::2]
    if not back.size:
        return True
    apart = float(np.median(out) - np.median(back))
    spread = max(float(np.ptp(out)), float(np.ptp(back)))
    return apart > 0 and spread < 0.6 * apart
