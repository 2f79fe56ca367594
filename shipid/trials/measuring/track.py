"""Track and speed of a trial: from positions where they are recorded, else from speeds and heading."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.integrate import cumulative_trapezoid

from shipid.foundation.numbers import brief, moment
from shipid.trials.measuring.faults import Faults
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.trial import Trial

_JUMP = 0.02
"""Positions that jump by this share of a distance leave it unknown."""

_DRIVES = 0.5
"""Below this share of the revolutions at the execute the propeller no longer drives the ship as it did."""


def speed(trial: Trial) -> np.ndarray | None:
    """Return the speed over all [m/s], shape (n,), or None where the trial has no speed.

    Parameters
    ----------
    trial : Trial
        With ``u`` and ``v``, ``U``, or ``u`` alone; else with ``SOG``, in which the current is.
    """
    if trial.has("u", "v"):
        return np.asarray(np.hypot(trial["u"], trial["v"]))
    if trial.has("U"):
        return trial["U"]
    if trial.has("u"):
        return np.asarray(np.abs(trial["u"]))
    return trial["SOG"] if trial.has("SOG") else None


def only_over_ground(trial: Trial) -> bool:
    """Return whether the only speed of a trial is that over the ground.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    return trial.has("SOG") and not (trial.has("U") or trial.has("u"))


def over_ground_notes(trial: Trial) -> tuple[str, ...]:
    """Return what has to be known of the speeds of a manoeuvre, where they are over the ground.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    return ("the speeds are over the ground (SOG): the current is in them",) if only_over_ground(trial) else ()


def drift(trial: Trial) -> np.ndarray | None:
    """Return the drift angle [rad], shape (n,), positive when the flow comes from port, or None.

    Parameters
    ----------
    trial : Trial
        With ``beta``, or ``u`` and ``v``.
    """
    if trial.has("beta"):
        return trial["beta"]
    return np.arctan2(-trial["v"], trial["u"]) if trial.has("u", "v") else None


def track(trial: Trial) -> tuple[np.ndarray, np.ndarray, str] | None:
    """Return north and east [m], shape (n,), and where they come from; None where nothing gives them.

    Parameters
    ----------
    trial : Trial
        With ``x`` and ``y``; or ``psi`` and a speed, with drift where it is known.
    """
    if trial.has("x", "y"):
        return trial["x"], trial["y"], "positions"
    moving = None if only_over_ground(trial) else speed(trial)
    if moving is None or not trial.has("psi"):
        return None
    sideways = drift(trial)
    along = trial["psi"] - (0.0 if sideways is None else sideways)
    if not np.isfinite(moving).any() or not np.isfinite(along).any():
        return None
    t = trial["t"]
    moving, along = (np.interp(t, t[np.isfinite(y)], y[np.isfinite(y)]) for y in (moving, along))
    north = cumulative_trapezoid(moving * np.cos(along), t, initial=0.0)
    east = cumulative_trapezoid(moving * np.sin(along), t, initial=0.0)
    return north, east, "speeds and heading" if sideways is not None else "speed and heading, without drift"


def speed_channel(trial: Trial, wrong: Mapping[str, np.ndarray] | None = None) -> Channel | None:
    """Return the speed over all by its own samples [m/s], or None where the trial has no speed.

    Parameters
    ----------
    trial : Trial
        As for `speed`.
    wrong : Mapping of str to ndarray of bool, shape (samples,), optional
        Samples that count as missing, by column.
    """
    other = "U" if trial.has("U") else "SOG" if only_over_ground(trial) else "u"
    names = ("u", "v") if trial.has("u", "v") else (other,)
    values = speed(trial)
    if values is None or not np.isfinite(values).any():
        return None
    out = np.zeros(len(trial), dtype=bool)
    for name in names:
        out |= (wrong or {}).get(name, False)
    table = trial.table[["t"]].assign(u=values)
    found = channel_of(Trial(trial.name, table, trial.source), "u", out)
    return found if len(found.t) > 1 else None


def distance_between(moving: Channel, start: float, end: float) -> float:
    """Return the distance sailed between two moments [m], the speed interpolated at both.

    Parameters
    ----------
    moving : Channel
        Speed over all [m/s].
    start, end : float
        The moments [s].
    """
    inside = (moving.t > start) & (moving.t < end)
    t = np.concatenate(([start], moving.t[inside], [end]))
    return float(np.trapezoid(np.interp(t, moving.t, moving.y), t))


def track_channels(trial: Trial, wrong: Mapping[str, np.ndarray]) -> tuple[Channel, Channel, str] | None:
    """Return north and east by their own samples [m], and where they come from; None where nothing gives them.

    Parameters
    ----------
    trial : Trial
        As for `track`.
    wrong : Mapping of str to ndarray of bool, shape (samples,)
        Samples that count as missing, by column.
    """
    path = track(trial)
    if path is None:
        return None
    if path[2] == "positions":
        x, y = (channel_of(trial, name, wrong.get(name)) for name in ("x", "y"))
        return (x, y, path[2]) if min(len(x.t), len(y.t)) > 1 else None
    moving, psi = speed_channel(trial, wrong), channel_of(trial, "psi", wrong.get("psi"))
    if moving is None:
        return None
    # Dead reckoning: after a hole in speed or heading the position is not known any more.
    lost = min((a for a, _ in (*moving.holes, *psi.holes)), default=None)
    holes = () if lost is None else ((lost, float(trial["t"][-1])),)
    t = trial["t"]
    return Channel("x", t, path[0], holes, trial.sampling), Channel("y", t, path[1], holes, trial.sampling), path[2]


def turning_width(interval: float, lasts: float) -> float:
    """Return half the time over which the heading and the positions of a turn are averaged, in s.

    Parameters
    ----------
    interval : float
        Usual interval of the samples, s.
    lasts : float
        How long the rudder is over, s.
    """
    return max(5 * interval, 0.01 * lasts)


def smooth_track(trial: Trial, moments: np.ndarray, half: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return north and east [m] at given moments, smoothed as the distances of a turn are; None where nothing gives them.

    Parameters
    ----------
    trial : Trial
        As for `track`.
    moments : ndarray, shape (m,)
        The moments [s].
    half : float
        Half the time over which positions are averaged [s].

    Returns
    -------
    tuple of ndarray, shape (m,), or None
        NaN in a hole of the record.
    """
    channels = track_channels(trial, {})
    if channels is None:
        return None
    return _at(channels[0], moments, half), _at(channels[1], moments, half)


def _at(channel: Channel, moments: np.ndarray, half: float) -> np.ndarray:
    """A coordinate at given moments; what is reckoned from speed and heading is smooth as it is."""
    found = np.interp(moments, channel.t, _calmed(channel, half), left=np.nan, right=np.nan)
    begin, end = np.array(channel.holes).reshape(-1, 2).T[:, :, None]
    return np.where(((moments > begin) & (moments < end)).any(axis=0), np.nan, found)


def _calmed(channel: Channel, half: float) -> np.ndarray:
    """A coordinate at its own samples, averaged over so much time before and behind each."""
    # What lies on the other side of a hole is far away: each stretch is averaged by itself.
    behind = np.searchsorted(channel.t, [end for _, end in channel.holes])
    wide = max(half, 2.5 * channel.interval)
    stretches = zip(np.split(channel.t, behind), np.split(channel.y, behind))
    return np.concatenate([series.local_values(t, y, wide) for t, y in stretches])


def jumped(channel: Channel, start: float, end: float) -> float:
    """Return how far a position has jumped in a span of time, beyond how it moved just before and behind it, in m.

    Parameters
    ----------
    channel : Channel
        A coordinate, m.
    start, end : float
        The span, s.
    """
    t, y = channel.t, channel.y
    a, b = int(np.searchsorted(t, start)), int(np.searchsorted(t, end)) + 1
    if not 1 <= a < b < len(t) - 1:
        return 0.0
    return float(y[b] - y[a] - 0.5 * (b - a) * (y[a] - y[a - 1] + y[b + 1] - y[b]))


class TurnTrack:
    """The track along and across the initial course, from the execute on.

    Parameters
    ----------
    x, y : Channel
        Positions, north and east [m].
    course : float
        Initial course [rad].
    side : int
        1 for a turn to starboard, -1 for one to port.
    when : float
        Time of the execute [s].
    calm : float
        Half the time over which positions are averaged [s].
    faults : Faults
        What the doctor found.
    """

    def __init__(
        self, x: Channel, y: Channel, course: float, side: int, when: float, calm: float, faults: Faults
    ) -> None:
        self.x, self.y, self.side, self.when, self.calm, self.faults = x, y, side, when, calm, faults
        self.c, self.s = np.cos(course), np.sin(course)

    def moved(self, at: float, drift: tuple[float, float] = (0.0, 0.0)) -> tuple[float, float]:
        """Return the distance along and across the course between the execute and a moment [m].

        Parameters
        ----------
        at : float
            The moment [s].
        drift : tuple of float
            Velocity north and east that is taken off [m/s].
        """
        shift = []
        for channel in (self.x, self.y):
            half = max(self.calm, 2.5 * channel.interval)
            shift.append(
                series.value_at(channel.t, channel.y, at, half) - series.value_at(channel.t, channel.y, self.when, half)
            )
        north, east = shift
        north, east = north - drift[0] * (at - self.when), east - drift[1] * (at - self.when)
        return self.c * north + self.s * east, self.side * (self.c * east - self.s * north)

    def scatter(self) -> float:
        """Return the standard deviation of a coordinate that is averaged as those of the distances are [m].

        An average over twice the time has about half of its variance, and is part of the same samples: what lies between the two has the
        other half. It holds noise that lasts for a few samples, but none that lasts as long as the turn, as that of a satellite
        receiver may.
        """
        squares = []
        for channel in (self.x, self.y):
            half = max(self.calm, 2.5 * channel.interval)
            apart = np.abs(_calmed(channel, half) - _calmed(channel, 2 * half))[channel.t >= self.when - 4 * half]
            squares.append((1.4826 * float(np.median(apart))) ** 2 if apart.size else 0.0)
        return float(np.sqrt(2 * np.mean(squares)))

    def speed(self, quarters: list[float | None]) -> float:
        """Return the mean speed over the ground of the first 90 deg, as the crow flies [m/s].

        Parameters
        ----------
        quarters : list of float or None
            When the heading has changed by 90, 180 deg and so on [s].
        """
        if quarters[0] is None:
            return 0.0
        return float(np.hypot(*self.moved(quarters[0]))) / (quarters[0] - self.when)

    def missing(self, at: float) -> str | None:
        """Return why the track is not known at a moment, or at the execute; None where it is.

        Parameters
        ----------
        at : float
            The moment [s].
        """
        for channel in (self.x, self.y):
            for when in (self.when, at):
                if (hole := channel.hole(when)) is not None:
                    return self.faults.hole(channel.name, hole)
        return self.faults.step(self.when, at) or self.jump(at)

    def jump(self, at: float) -> str | None:
        """Return that the positions have jumped on the way there, in words; None where they have not, or there and back.

        Parameters
        ----------
        at : float
            The moment at the end of the way [s].
        """
        spans = self.faults.jumps(self.when, at)
        north, east = (sum(jumped(channel, *span) for span in spans) for channel in (self.x, self.y))
        size = float(np.hypot(north, east))
        if size <= _JUMP * float(np.hypot(*self.moved(at))):
            return None
        return f"the positions jump by {brief(size, 3)} m at {moment(spans[0][0])} s"

    def distances(self, quarters: list[float | None], reasons: dict[str, str]) -> dict[str, float | None]:
        """Return advance, transfer and tactical diameter over the ground [m].

        Parameters
        ----------
        quarters : list of float or None
            When the heading has changed by 90, 180 deg and so on [s].
        reasons : dict of str to str
            Why one is not known; written to.
        """
        result: dict[str, float | None] = {"advance": None, "transfer": None, "tactical_diameter": None}
        for k, names in ((0, ("advance", "transfer")), (1, ("tactical_diameter",))):
            quarter = quarters[k]
            why = reasons.get(f"times[{k + 1}]")
            if quarter is not None:
                why = self.missing(quarter)
            for name in names:
                if why is not None:
                    reasons[name] = why
                elif quarter is not None:
                    along, across = self.moved(quarter)
                    result[name] = along if name == "advance" else across
        return result


def driven_until(trial: Trial, when: float) -> float:
    """Return when the propeller no longer drives the ship as at the execute, infinite where the log does not show it [s].

    A record is often stopped by the propeller first, with the rudder still over: what the ship does then is no steady turn.

    Parameters
    ----------
    trial : Trial
        The trial.
    when : float
        The execute [s].
    """
    if not trial.has("n"):
        return float("inf")
    t, n = trial["t"], trial["n"]
    before = n[(t <= when) & np.isfinite(n)]
    usual = float(np.median(before[-50:])) if before.size else 0.0
    stopped = np.flatnonzero((t > when) & (n * np.sign(usual) < _DRIVES * abs(usual)))
    return float(t[stopped[0]]) if stopped.size else float("inf")
