"""Channels that hold a value: written only when it changes, or a slow sensor whose last value is written again in every row."""

from __future__ import annotations

import numpy as np

from shipid.trials.signals.coarse import threshold_of

#: Silences this long, of which there are so many at least, show whether a channel is written only on change.
_SILENT, _SILENCES = 5.0, 2
#: Share of the rows that repeat the one before, and of the steps at the beat, from which on a slow sensor is written again.
_REPEATED, _BEAT = 0.6, 0.9
#: The shortest beat in rows, and the shortest that may be a row longer or shorter at times.
_SHORTEST, _LOOSE = 3, 5
#: Digits a step at the beat makes at least: fewer repeat by their resolution.
_DIGITS = 8.0
#: Knots at which lines between them bend, and the share of the range that a digit is at most.
_KNOTS, _FINE = 6, 0.005


def held_on_change(t: np.ndarray, values: np.ndarray) -> np.ndarray | None:
    """Return a channel that is written only when it changes with its value held in between; None where it is no such channel.

    Such a channel never repeats a value, its steps are of a few digits or of a threshold, and it is silent where it stays: the step
    behind a long silence is no larger than one behind a short interval.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s], rising.
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing; an angle unwrapped.

    Returns
    -------
    ndarray, shape (n,), or None
        NaN before the first sample, behind the last, and in a silence behind which the value is another: a hole.
    """
    there = np.flatnonzero(np.isfinite(values))
    if not 12 <= there.size < 0.95 * t.size:
        return None
    step, apart = np.abs(np.diff(values[there])), np.diff(t[there])
    if float(np.mean(step > 0)) < 0.98:
        return None
    small = float(np.quantile(step, 0.05))
    digits = step / max(small, 1e-300)
    printed = float(np.mean(np.abs(digits - np.round(digits)) < 0.02)) > 0.95 and float(np.median(digits)) < 40
    if not printed and small < 0.3 * float(np.median(step)):
        return None
    silent = apart > _SILENT * float(np.median(apart))
    if np.count_nonzero(silent) < _SILENCES or not np.any(~silent):
        return None
    stays = step <= 1.5 * float(np.quantile(step[~silent], 0.9))
    if float(np.mean(stays[silent])) < 0.6:
        return None
    place = (np.searchsorted(there, np.arange(t.size), side="right") - 1).clip(0, there.size - 1)
    inside = (np.arange(t.size) >= there[0]) & (np.arange(t.size) <= there[-1])
    known = inside & (np.append(stays | ~silent, True)[place] | (there[place] == np.arange(t.size)))
    return np.where(known, values[there[place]], np.nan)


def repeats_of(values: np.ndarray) -> np.ndarray | None:
    """Return which samples repeat the last value of a slower sensor; None where the channel is measured in every row.

    The value changes at a regular beat of three rows or more, whatever its slope: a resolution repeats as the slope has it.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing; an angle unwrapped.

    Returns
    -------
    ndarray of bool, shape (n,), or None
        Where the value stays for longer than a beat, one sample in a beat counts as measured.
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 60:
        return None
    step = np.abs(np.diff(values[there]))
    changed = np.flatnonzero(step > 0)
    if changed.size < 12 or float(np.mean(step == 0)) < _REPEATED:
        return None
    apart, moves = np.diff(changed), step[changed]
    beat = int(np.gcd.reduce(apart))
    if beat < _SHORTEST or (np.ptp(apart) == 0 and float(np.ptp(moves)) < 1e-6 * float(moves.max())):
        # Not every beat is of the same number of rows: then the steps have to be too fine to repeat by themselves.
        beat = int(np.median(apart))
        slack = 1 if beat >= _LOOSE else 0
        if beat < _SHORTEST or float(np.mean(np.abs(apart - beat) <= slack)) < _BEAT or _few_digits(moves):
            return None
    starts = changed + 1
    begins, ends = np.append(starts[0] % beat, starts), np.append(starts, there.size)
    rows = np.arange(there.size)
    stretch = np.searchsorted(begins, rows, side="right") - 1
    since = rows - begins[stretch]
    # A value that stays is measured again at every beat, but for a last one that is cut short.
    last = np.maximum(ends - begins - beat // 2, 1)[stretch]
    fresh = (stretch >= 0) & (since % beat == 0) & (since < last)
    result = np.zeros(len(values), dtype=bool)
    result[there[~fresh]] = True
    return result


def repeats_below_threshold(values: np.ndarray) -> np.ndarray | None:
    """Return which samples repeat a value that is written again only when it has moved by more than a threshold; None of other channels.

    A value that stays for long is known to that threshold meanwhile: it counts once in the usual time between two that are written.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing; an angle unwrapped.

    Returns
    -------
    ndarray of bool, shape (n,), or None
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 60 or threshold_of(values[there]) is None:
        return None
    fresh = np.append(True, np.diff(values[there]) != 0)
    starts = np.flatnonzero(fresh)
    beat = max(2, int(np.median(np.diff(starts))))
    since = np.arange(there.size) - starts[np.cumsum(fresh) - 1]
    result = np.zeros(len(values), dtype=bool)
    result[there[since % beat != 0]] = True
    return result if result.any() else None


def _few_digits(moves: np.ndarray) -> bool:
    """Whether steps are of a few digits."""
    sizes = np.unique(np.round(moves / float(moves.max()), 9))
    digit = float(np.min(np.diff(sizes, prepend=0.0)))
    return float(np.median(moves)) < _DIGITS * digit * float(moves.max())


def between_knots(values: np.ndarray) -> np.ndarray | None:
    """Return which values lie on lines between those of a slower sensor, at a beat of three samples or more; None where none do.

    Parameters
    ----------
    values : ndarray, shape (n,)
        A column, one row a sample of an even clock.

    Returns
    -------
    ndarray of bool, shape (n,), or None
        None as well where values are missing.
    """
    bend = np.abs(np.diff(values, 2))
    if len(values) < 60 or not np.isfinite(bend).all() or not bend.any():
        return None
    apart, reach = np.diff(np.unique(values)), float(np.ptp(values))
    digit = float(apart[apart > 1e-9 * reach].min())
    if digit > _FINE * reach:
        return None
    # A bend of at least half the largest is one of the knots.
    knot = int(np.argmax(bend)) + 1
    found, index = None, np.arange(len(values))
    for beat in range(3, len(values) // _KNOTS):
        knots = index[knot % beat :: beat]
        bent = bend[knots[1:-1] - 1] > 2.01 * digit
        # Ramps that begin and end on a beat bend there by themselves; one between two beats bends at both.
        if np.count_nonzero(bent) < _KNOTS or np.count_nonzero(bent[1:] & bent[:-1]) < _KNOTS // 2:
            continue
        inner = slice(knots[0], knots[-1] + 1)
        drawn = np.interp(index[inner], knots, values[knots])
        if float(np.abs(drawn - values[inner]).max()) <= 1.01 * digit:
            found = np.zeros(len(values), dtype=bool)
            found[inner] = True
            found[knots] = False
    return found
