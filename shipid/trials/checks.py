"""What a record has to fulfil to be a trial: a rising clock, samples on it, angles in the unit that is stated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import median_filter

from shipid.declaration.vocabulary import shown
from shipid.foundation.numbers import brief, counted
from shipid.trials.errors import ClockError, LooksLikeDegreesError, NonFiniteError, TooShortError
from shipid.trials.filling import GAP, interpolated, usual_interval

FEWEST_SAMPLES = 10

_WINDOW = 5
"""Samples in a running median, which leaves up to two wild ones out."""

STEADY_RUDDER = np.radians(0.5)
"""Rudder movement below this is noise of the feedback, not a manoeuvre."""


def check_clock(t: np.ndarray, where: str, line: Callable[[int], int]) -> None:
    """Refuse a clock that is not strictly increasing.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time stamps [s].
    where : str
        Which record, for the message.
    line : callable
        Gives the row number to name for a sample.

    Raises
    ------
    ClockError
        With the row of the first time stamp that repeats or runs backwards, and how many do.
    """
    bad = np.flatnonzero(np.diff(t) <= 0)
    if bad.size:
        k = int(bad[0])
        what = "repeats" if t[k + 1] == t[k] else "runs backwards"
        advice = (
            "shipid check FILE --fix -o FIXED.csv sorts the rows and removes duplicates; if the logger printed too few digits, "
            "state [clock] interval in a format file."
        )
        if bad.size == len(t) - 1 and (np.diff(t) < 0).all():
            advice = "The last sample stands first: sort the rows by time, or let 'shipid check --fix' do it."
        # The second of two logs begins where the first did; rows that were exchanged have stamps of their own.
        first = k > FEWEST_SAMPLES and t[k + 1] - t[0] < 0.1 * (t[k] - t[0])
        if bad.size == 1 and t[k + 1] < t[k] and (first or np.unique(t).size < t.size):
            advice = (
                "Two logs stand in one file: cut it between these rows and read each part by itself."
                if first
                else "The clock was set back, or rows were moved: 'shipid check' says which, and 'shipid check --fix' repairs what is certain."
            )
        raise ClockError(
            f"{where}, column 't': the clock {what} between rows {line(k)} and {line(k + 1)} "
            f"({t[k]:.10g} s, then {t[k + 1]:.10g} s); {bad.size} of {len(t) - 1} steps do. {advice}"
        )


def check_stamped(columns: Mapping[str, np.ndarray], where: str, line: Callable[[int], int]) -> None:
    """Refuse samples that have no place on the clock.

    Parameters
    ----------
    columns : Mapping of str to ndarray
        The record.
    where, line
        As in `check_clock`.

    Raises
    ------
    NonFiniteError
        With the rows.
    """
    rows = np.flatnonzero(~np.isfinite(columns["t"]))
    if not rows.size:
        return
    first = ", ".join(str(line(int(k))) for k in rows[:3]) + (", ..." if len(rows) > 3 else "")
    raise NonFiniteError(
        f"{where}: {counted(len(rows), 'row has', 'rows have')} samples and no time, rows {first}, column 't'. Complete the clock or remove the rows; "
        "if the samples come at a fixed interval, state [clock] interval in a format file."
    )


def check_length(n: int, where: str) -> None:
    """Refuse a record of fewer than `FEWEST_SAMPLES` samples.

    Parameters
    ----------
    n : int
        Number of samples.
    where : str
        Which record.

    Raises
    ------
    TooShortError
    """
    if n < FEWEST_SAMPLES:
        raise TooShortError(
            f"{where} has {n} samples, and a trial needs at least {FEWEST_SAMPLES}. Check that the log is complete, "
            "or widen the window."
        )


def check_angles(columns: Mapping[str, np.ndarray], stated: Mapping[str, str], where: str) -> None:
    """Refuse angles that are said to be in radians and have the values of degrees, or the other way round.

    Parameters
    ----------
    columns : Mapping of str to ndarray
        The record in SI units, the heading as it was read, not yet unwrapped; NaN where a sample is missing.
    stated : Mapping of str to str
        The unit each column was said to have.
    where : str
        Which record.

    Raises
    ------
    LooksLikeDegreesError
    """

    def fail(name: str, finding: str) -> LooksLikeDegreesError:
        now = stated[name].lower()
        other = now.replace("rad", "deg") if "rad" in now else now.replace("deg", "rad")
        said, seems = ("radians", "degrees") if "rad" in now else ("degrees", "radians")
        return LooksLikeDegreesError(
            f"{where}, column '{name}': the unit says {said}, and the values look like {seems}: {finding}. "
            f"Write '{name} [{other}]' in the header, or unit = \"{other}\" in the format file, if they are.",
            finding,
        )

    said_radians = {name for name in columns if "rad" in stated.get(name, "").lower()}
    for name in ("delta", "delta_order"):
        if name in said_radians and (largest := float(np.nanmax(np.abs(columns[name])))) > pi / 2:
            raise fail(name, f"the rudder goes to {brief(largest, 4)} rad, beyond 90 deg")
    # 1 rad/s is a full turn in 6 s: a 3 m model reaches a fifth of it.
    if "r" in said_radians and (fast := float(np.nanquantile(np.abs(columns["r"]), 0.95, method="lower"))) > 1.0:
        raise fail("r", f"the ship turns at {brief(fast, 4)} rad/s, {shown(fast, 'r')}")
    if "psi" not in columns:
        return
    there = np.isfinite(columns["psi"])
    t, psi = columns["t"][there], columns["psi"][there]
    if t.size < 2:
        return
    step = np.diff(psi)
    if "psi" in said_radians:
        if abs(psi[0]) > 8 * pi:
            raise fail("psi", f"the heading begins at {brief(psi[0], 4)} rad")
        if np.any(np.abs(np.abs(step) - 360) < 5):
            raise fail("psi", "the heading jumps by 360")
        if (rate := float(np.quantile(np.abs(step) / np.diff(t), 0.95, method="lower"))) > 1.0:
            raise fail(
                "psi",
                f"the heading runs from {brief(psi.min(), 4)} to {brief(psi.max(), 4)} rad, up to {brief(rate, 3)} rad/s",
            )
    if "r" in columns:
        r = interpolated(columns["t"], columns["r"], t)
        said = 0.5 * (r[1:] + r[:-1]) * np.diff(t)
        smooth = (np.abs(step) < pi / 2) & np.isfinite(said)  # neither the wrap nor a hole
        if not smooth.any():
            return
        turned, said = step[smooth], said[smooth]
        # Compare spread, not sample by sample: quantised headings step while the rate is smooth.
        blocks = max(1, len(turned) // 100)
        edges = np.arange(0, len(turned), blocks)
        turned, said = np.add.reduceat(turned, edges), np.add.reduceat(said, edges)
        energy = float(said @ said)
        ratio = float(turned @ said) / energy if energy > 0 else 1.0
        agree = float(turned @ said) ** 2 > 0.5 * energy * float(turned @ turned)
        if agree and (per := _per_minute(ratio, stated.get("r", ""))) is not None:
            says, seems = per
            finding = f"the heading changes {brief(ratio, 3)} times as fast as r says"
            raise LooksLikeDegreesError(
                f"{where}, column 'r': the unit says {says}, and the values look like {seems}: {finding}. "
                f"Write 'r [{seems}]' in the header, or unit = \"{seems}\" in the format file, if they are.",
                finding,
            )
        if agree and 40 < ratio < 80:
            name = "psi" if "psi" in said_radians else "r"
            raise fail(name, f"the heading changes {ratio:.0f} times as fast as r says")
        if agree and 1 / 80 < ratio < 1 / 40:
            name = "r" if "r" in said_radians else "psi"
            raise fail(name, f"r is {1 / ratio:.0f} times the slope of the heading")


def _per_minute(ratio: float, stated: str) -> tuple[str, str] | None:
    """Return the unit that r says and the one it seems to have, where a minute and a second are taken for one another.

    A factor of 60 is told from one of 57.3 (degrees and radians) by what is nearer, and by the unit that is stated.
    """
    if not ratio > 0:
        return None  # the two go opposite ways: a sign, and no unit
    unit = stated.replace("°", "deg").replace(" ", "").lower()
    minute = unit.startswith("deg/m") and not unit.startswith("deg/ms")
    for says, seems, factor in (("deg/s", "deg/min", 1 / 60), ("deg/min", "deg/s", 60.0)):
        if unit.startswith("deg") and minute == (says == "deg/min"):
            off = abs(np.log(ratio / factor))
            if off < 0.3 and off < abs(np.log(ratio / (180 / pi if factor > 1 else pi / 180))):
                return stated, seems
    return None


def gaps(t: np.ndarray, usual: float | None = None) -> np.ndarray:
    """Return the indices of the samples after which the clock has a gap.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    usual : float, optional
        The usual interval [s], for a clock on which several signals keep their own; that of `t` by default.

    Returns
    -------
    ndarray of int
        Samples followed by an interval longer than `GAP` times the usual one.
    """
    return np.flatnonzero(np.diff(t) > GAP * (usual_interval(t) if usual is None else usual))


def turns_to_port(t: np.ndarray, delta: np.ndarray, r: np.ndarray) -> bool:
    """Whether positive rudder turns this ship to port: the sign of a in ``r' = a delta - b r + c``, by regression.

    Parameters
    ----------
    t, delta, r : ndarray, shape (n,)
        Time [s], rudder angle [rad], rate of turn [rad/s]; NaN where a sample is missing.

    Returns
    -------
    bool
        True only where the sign is beyond doubt (ten standard deviations).
    """
    delta = interpolated(t, delta)
    both = np.isfinite(delta) & np.isfinite(r)
    t, delta, r = t[both], delta[both], r[both]
    if len(t) < 2 * _WINDOW:
        return False
    # One wild sample must not decide the sign.
    delta, r = median_filter(delta, _WINDOW, mode="mirror"), median_filter(r, _WINDOW, mode="mirror")
    # In integral form, over blocks: differentiating a noisy rate of turn would drown the sign.
    count = min(400, len(t) - 1)
    at = np.unique(np.linspace(0, len(t) - 1, count + 1).astype(int))
    integral = [cumulative_trapezoid(signal, t, initial=0.0) for signal in (delta, r)]
    design = np.column_stack([*(np.diff(part[at]) for part in integral), np.diff(t[at])])
    target = np.diff(r[at])
    if len(target) < 10 or np.ptp(delta) <= STEADY_RUDDER or np.linalg.matrix_rank(design) < 3:
        return False
    solution, residual, *_ = np.linalg.lstsq(design, target, rcond=None)
    if not residual.size:
        return False
    # By the pseudo-inverse: the product of a design with itself may be singular where the design is not.
    row = np.linalg.pinv(design)[0]
    variance = residual[0] / (len(target) - 3) * float(row @ row)
    return bool(solution[0] < -10 * np.sqrt(variance))
