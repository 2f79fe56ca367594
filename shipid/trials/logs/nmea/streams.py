"""Several devices behind one talker: their sentences are told apart, and a sentence that was sent twice counts once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter

from shipid.foundation.numbers import brief, counted
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.nmea.log import NmeaLog, Origin, Records

FEWEST = 20
"""Fewer sentences do not show whether they come from one device."""
_ALTERNATING = 0.8
"""So many steps have to lead from one device to the other."""
_STRICTLY = 0.95
"""So many jumps between devices of different rates have to be there and back, and of one size."""
_MOST = 4
"""More devices do not share a talker."""
_APART = 4.0
"""Devices are told apart where they differ by this many times what the values of one of them scatter by."""

#: Sentences by what tells two devices apart: the fields, and the least difference (m, deg, knots).
TELLING: dict[str, tuple[tuple[str, ...], float]] = {
    **dict.fromkeys(("GGA", "RMC", "GLL"), (("lat", "lon"), 1.0)),
    **dict.fromkeys(("HDT", "THS", "HDG", "HDM"), (("heading",), 0.3)),
    **dict.fromkeys(("VHW", "VBW"), (("u",), 0.3)),
    "RSA": (("starboard",), 1.0),
}


def separated(log: NmeaLog, times: np.ndarray) -> NmeaLog:
    """Return the log with the streams of devices that share a talker kept apart, ``GPGGA#1`` and ``GPGGA#2``.

    Parameters
    ----------
    log : NmeaLog
        The log.
    times : ndarray, shape (n,)
        Time of every sentence [s], NaN where it is not known.

    Returns
    -------
    NmeaLog
        With a note for each talker that stands for two devices, and for each sentence that came twice.
    """
    records: dict[Origin, Records] = {}
    notes = list(log.notes)
    for origin, found in log.records.items():
        once, twice = _once(found)
        if twice:
            notes.append(
                f"{counted(twice, f'sentence {origin.name} repeats', f'sentences {origin.name} repeat')} the one before with its UTC: they count once."
            )
        labels, apart = devices_of(origin.kind, once, times)
        if labels is None:
            records[origin] = once
            continue
        parts = [part_of(origin, k) for k in range(int(labels.max()) + 1)]
        for k, part in enumerate(parts):
            records[part] = once.keep(labels == k)
        names = ", ".join(part.name for part in parts)
        notes.append(
            f"WARNING: {origin.name} comes from {len(parts)} devices that share a talker, {apart} apart. They are kept apart as "
            f"{names}; [nmea.sources] of a format file says which one is taken, as in '{parts[1].name}'."
        )
    return replace(log, records=records, notes=notes)


def _once(records: Records) -> tuple[Records, int]:
    """Leave out a sentence that says the same as the one before, UTC included: a multiplexer sent it twice."""
    if "utc" not in records.fields or len(records.order) < 2:
        return records, 0
    utc = records.column("utc")
    same = np.all(
        (records.values[1:] == records.values[:-1]) | np.isnan(records.values[1:] + records.values[:-1]), axis=1
    )
    repeats = np.append(False, same & np.isfinite(utc[1:]) & (utc[1:] == utc[:-1]))
    return records.keep(~repeats), int(repeats.sum())


def part_of(origin: Origin, device: int) -> Origin:
    """Return the origin of one of several devices that share a talker.

    Parameters
    ----------
    origin : Origin
        What they share.
    device : int
        Counted from 0.
    """
    return origin._replace(stream=f"{origin.stream}{device + 1}")


def devices_of(kind: str, records: Records, times: np.ndarray) -> tuple[np.ndarray | None, str]:
    """Tell apart the devices that send one kind of sentence under one talker.

    Parameters
    ----------
    kind : str
        The sentence, ``GGA``.
    records : Records
        All of them in the order they came.
    times : ndarray, shape (n,)
        Time of every sentence of the log [s], NaN where it is not known.

    Returns
    -------
    labels : ndarray of int, shape (k,), or None
        The device of each of the records, counted from 0; None where there is one, or they cannot be told apart.
    apart : str
        How far they are apart, in words.
    """
    if kind not in TELLING:
        return None, ""
    fields, least = TELLING[kind]
    values = np.column_stack([records.column(name) for name in fields])
    t = times[records.order]
    valid = np.isfinite(values).all(axis=1) & np.isfinite(t)
    if valid.sum() < FEWEST:
        return None, ""
    t, values, unit = t[valid], values[valid], {"u": "knots", "heading": "deg", "starboard": "deg"}.get(fields[0], "m")
    if fields[0] == "lat":
        lat, lon = np.radians(values.T)
        values = np.column_stack(to_local(lat, lon, (float(lat[0]), float(lon[0]))))
    elif fields[0] == "heading":
        values = np.unwrap(values, period=360, axis=0)
    step = _steps(t, values)
    found = _alternating(t, values, step, least, may_meet=fields[0] == "starboard")
    if found is None:
        found = _beside(t, step, least)
    if found is None and "utc" in records.fields:
        found = _within_an_epoch(records.column("utc")[valid])
    if found is None:
        return None, ""
    size = np.linalg.norm(step, axis=1)
    labels = np.zeros(len(valid), dtype=int)
    labels[valid] = found
    return labels, f"{brief(float(np.median(size[np.diff(found) != 0])), 2)} {unit}"


def _steps(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """From each value to the next, less what the ship's motion makes of it; shape (n - 1, k)."""
    span = np.maximum(t[2:] - t[:-2], 1e-3)
    # Two sentences later the same device speaks again, if there are two.
    slope = median_filter((values[2:] - values[:-2]) / span[:, None], size=(5, 1), mode="nearest")
    slope = np.vstack((slope[:1], slope))
    return np.asarray(np.diff(values, axis=0) - slope * np.diff(t)[:, None])


def _alternating(
    t: np.ndarray, values: np.ndarray, step: np.ndarray, least: float, may_meet: bool
) -> np.ndarray | None:
    """Labels of two devices that take turns: the values jump there and back. A turn may be missed."""
    size = np.linalg.norm(step, axis=1)
    typical = float(np.median(size))
    if typical < least:
        return None
    over = size > 0.5 * typical
    # Two rudders may say the same for a while, and go on taking turns: one was missed only where they are apart before and behind.
    apart = np.concatenate((over[:1], over[:-1])) & np.concatenate((over[1:], over[-1:]))
    labels = np.append(0, np.cumsum(over | ~apart if may_meet else over) % 2)
    back = np.sum(step[1:] * step[:-1], axis=1) < 0
    if over.mean() < _ALTERNATING or back.mean() < _ALTERNATING:
        return None
    scatter = [_scatter(t[labels == k], values[labels == k]) for k in (0, 1)]
    return labels if typical > _APART * max(scatter) else None


def _beside(t: np.ndarray, step: np.ndarray, least: float) -> np.ndarray | None:
    """Labels of two devices of different rates: the slower one speaks between two sentences of the other, which keeps its beat."""
    size = np.linalg.norm(step, axis=1)
    small, large = float(np.median(size)), float(np.quantile(size, 0.95))
    for _ in range(20):  # two groups of sizes
        over = size > (small + large) / 2
        if not over.any() or over.all():
            return None
        small, large = float(size[~over].mean()), float(size[over].mean())
    if large < least or large < _APART * float(np.median(size[~over])):
        return None
    jumps = step[over]
    along = jumps @ (jumps[0] / np.linalg.norm(jumps[0]))
    there = along > 0
    alike = np.linalg.norm(jumps - np.where(there, 1, -1)[:, None] * jumps[there].mean(axis=0), axis=1) < 0.5 * large
    if len(jumps) < FEWEST or np.mean(there[1:] != there[:-1]) < _STRICTLY or alike.mean() < _STRICTLY:
        return None
    last = np.append(-1, np.maximum.accumulate(np.where(over, np.cumsum(over) - 1, -1)))
    labels = np.where(last >= 0, there[np.maximum(last, 0)], not there[0]).astype(int)
    if labels.mean() > 0.5:
        labels = 1 - labels
    # A glitch stands in the place of a sample; another device speaks besides, at a beat of its own.
    beats = [np.diff(t[labels == k]) for k in (0, 1)]
    even = [float(np.mean(np.abs(beat - np.median(beat)) <= 0.3 * np.median(beat))) for beat in beats]
    return labels if min(even) >= _ALTERNATING else None


def _scatter(t: np.ndarray, values: np.ndarray) -> float:
    """Median distance of a value from the line through its neighbours."""
    if len(t) < 5:
        return np.inf
    share = ((t[1:-1] - t[:-2]) / np.maximum(t[2:] - t[:-2], 1e-3))[:, None]
    between = values[:-2] + share * (values[2:] - values[:-2])
    return float(np.median(np.linalg.norm(values[1:-1] - between, axis=1)))


def _within_an_epoch(utc: np.ndarray) -> np.ndarray | None:
    """Labels by the order within a UTC: one receiver has one position at a time."""
    fresh = np.append(True, np.diff(utc) != 0)
    first = np.flatnonzero(fresh)
    rank = np.arange(len(utc)) - first[np.cumsum(fresh) - 1]
    count = np.diff(np.append(first, len(utc)))
    most = int(np.median(count))
    if not 2 <= most <= _MOST or count.size < FEWEST // 2 or (count >= 2).mean() < _ALTERNATING:
        return None
    return np.asarray(np.minimum(rank, most - 1))
