"""The speed before the manoeuvre (U0, in the models ``cruise``): one number a trial, found by one rule."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from shipid.foundation.numbers import brief, moment
from shipid.trials.errors import NotAheadError

#: A rudder this far from its first position has been put over: more than a helmsman needs to keep a course in calm water.
PUT_OVER = np.deg2rad(3.0)
#: Below this share of the usual speed of the record, a ship is still gathering speed.
GATHERING = 0.9
#: Samples that are averaged at least, where neither the length of the ship nor an approach says how many.
_LEAST = 10
#: Share of L/U for which a ship keeps her speed behind an execute: with the rudder hard over she loses 1 % in it, and 5 % in L/U.
_KEEPS = 0.25
#: Where the forward speed and the rudder are looked for, in this order.
_SPEEDS, _RUDDERS = ("u", "U"), ("delta", "delta_order")
#: A record by columns.
Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class SpeedBefore:
    """The speed before the manoeuvre.

    Attributes
    ----------
    value : float
        In m/s.
    std : float
        Standard error of that mean by the noise from sample to sample, in m/s.
    samples : int
        How many were averaged.
    source : {"approach", "first samples", "usual speed"}
        Where it comes from: the samples before the first execute; those of the first quarter of L/U, where the record begins
        with the execute; the median of the record, where the ship is still gathering speed.
    """

    value: float
    std: float
    samples: int
    source: Literal["approach", "first samples", "usual speed"]


def check_ahead(speed: float | None, record: str, model: str) -> None:
    """Check that a ship goes ahead before the manoeuvre, for a model in which the speed stands.

    Parameters
    ----------
    speed : float or None
        The speed before the manoeuvre in m/s; None where it is not known.
    record, model : str
        The names of trial and model, for the message.

    Raises
    ------
    NotAheadError
        If the ship goes astern or lies still.
    """
    if speed is not None and not speed > 0:
        does = "goes astern" if speed < 0 else "lies still"
        raise NotAheadError(
            f"trial {record}: the ship {does} before the manoeuvre ({brief(speed)} m/s), and model {model} holds for a ship that "
            "goes ahead. Take a window in which it does, or correct the sign of the speed in the format of the trial."
        )


def check_way(columns: Columns, record: str, model: str) -> None:
    """Check that a ship does not go astern in the course of a record, for a model that is scaled with the forward speed.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (N,)
        The record, SI. Samples of the forward speed ``u`` that noise alone makes negative are passed over: ten in a row are not.
    record, model : str
        The names of trial and model, for the message.

    Raises
    ------
    NotAheadError
        If it does, with the time.
    """
    if (first := astern_from(columns)) is not None:
        t = columns["t"][np.isfinite(columns["u"])]
        since = f"from {moment(first)} s on" if first > t[0] else "before the manoeuvre"
        before = f" (FILE@{moment(float(t[0]))}:{moment(first)} for the part before)" if first > t[0] else ""
        raise NotAheadError(
            f"trial {record}: the ship goes astern {since}, and model {model} holds for a ship that goes ahead. Take "
            f"a window in which it does{before}, or correct the sign of the speed "
            "in the format of the trial."
        )


def astern_from(columns: Columns) -> float | None:
    """Return the time in s from which a record shows the ship going astern, see `check_way`; None where it does not.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (N,)
        The record, SI.
    """
    if "u" not in columns:
        return None
    there = np.isfinite(columns["u"])
    t, astern = columns["t"][there], columns["u"][there] < 0
    runs = np.convolve(astern, np.ones(_LEAST), mode="valid") if astern.size >= _LEAST else np.zeros(0)
    return float(t[np.argmax(runs >= _LEAST - 0.5)]) if (runs >= _LEAST - 0.5).any() else None


def recorded_speed(columns: Columns) -> np.ndarray | None:
    """Return the recorded forward speed in m/s, shape (N,); the speed over all where there is no other.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (N,)
        The record, SI.

    Returns
    -------
    ndarray or None
        None where the record holds no sample of a speed; NaN where one is missing.
    """
    return _first_of(columns, _SPEEDS)


def speed_before_in(columns: Columns, unit_time: float | None = None) -> SpeedBefore | None:
    """Return the speed before the manoeuvre of a record, by the rule of `speed_before`.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (N,)
        The record, SI: times ``t``, a speed, and the rudder angle or the order where it has one.
    unit_time : float, optional
        L/U in s.

    Returns
    -------
    SpeedBefore or None
        None where no sample of a speed is there.
    """
    speed = recorded_speed(columns)
    return None if speed is None else speed_before(columns["t"], speed, _first_of(columns, _RUDDERS), unit_time)


def _first_of(columns: Columns, names: tuple[str, ...]) -> np.ndarray | None:
    found = (np.asarray(columns[n], dtype=float) for n in names if n in columns)
    return next((column for column in found if np.isfinite(column).any()), None)


def speed_before(
    t: np.ndarray, speed: np.ndarray, rudder: np.ndarray | None = None, unit_time: float | None = None
) -> SpeedBefore | None:
    """Return the speed before the manoeuvre: the mean measured forward speed from the start to the first execute.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times in s.
    speed : ndarray, shape (N,)
        Measured forward speed in m/s; NaN where a sample is missing.
    rudder : ndarray, shape (N,), optional
        Rudder angle in rad. The first execute is where it leaves its first position by more than `PUT_OVER`.
    unit_time : float, optional
        L/U in s. A record that begins with the execute is averaged over the first quarter of L/U, in which she keeps her speed.

    Returns
    -------
    SpeedBefore or None
        None where no sample of the speed is there.
    """
    there = np.isfinite(speed)
    if not there.any():
        return None
    first = kept = _LEAST
    if unit_time is not None and np.isfinite(unit_time):
        first, kept = (max(1, int(np.searchsorted(t, t[0] + s * unit_time))) for s in (1.0, _KEEPS))
    first = min(first, t.size)
    execute = 0
    if rudder is not None and np.isfinite(rudder).any():
        # Its first position: of the samples that are there, where the rudder keeps a slower clock than the rows.
        lain = np.median(rudder[np.isfinite(rudder)][: min(first, _LEAST)])
        over = np.abs(rudder - lain) > PUT_OVER
        execute = int(np.argmax(over)) if over.any() else 0
    approach = execute > first // 2
    taken = speed[: execute if approach else max(execute, kept)]
    taken = taken[np.isfinite(taken)]
    usual = float(np.median(speed[there]))
    # Where the speed was not recorded yet, the first sample comes from the manoeuvre, which may have taken some of it.
    lost = 0.0 if taken.size else float(abs(speed[there][0] - usual))
    if not taken.size:
        taken = speed[there][:1]
    value = float(np.mean(taken))
    if value < GATHERING * usual:
        return SpeedBefore(usual, 0.0, int(there.sum()), "usual speed")
    # The noise from sample to sample, not the drift of the speed itself.
    series = taken if taken.size > 2 else speed[there]
    noise = float(np.std(np.diff(series)) / np.sqrt(2)) if series.size > 2 else 0.0
    std = float(np.hypot(noise / np.sqrt(taken.size), lost))
    return SpeedBefore(value, std, int(taken.size), "approach" if approach else "first samples")
