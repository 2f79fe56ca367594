"""A table of ways in which logs are sound or spoiled, as ships and yards hand them over: each a function that changes a log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from _loggers import LAYOUTS, Log


def rounded(name: str, step: float) -> Callable[[Log], None]:
    """A column in steps."""

    def change(log: Log) -> None:
        if name in log.values:
            log[name] = np.round(log[name] / step) * step

    return change


def sea(rms: float, period: float, grain: float) -> Callable[[Log], None]:
    """The heading yaws in waves, and is written with a grain."""

    def change(log: Log) -> None:
        if "r" in log.values:
            del log.values["r"]
        phase = np.cumsum(2 * np.pi / period * (1 + 0.2 * log.rng.standard_normal(len(log.t)))) * log.interval
        log["psi"] += rms * 1.4 * np.sin(phase) * (1 + 0.4 * np.sin(0.13 * phase))
        rounded("psi", grain)(log)

    return change


def shifted(names: str, share: float) -> Callable[[Log], None]:
    """Columns late by so many paces."""
    return lambda log: log.late(names, share * log.pace)


def late_by(names: str, seconds: float) -> Callable[[Log], None]:
    """Columns late by so many seconds."""
    return lambda log: log.late(names, seconds)


def scaled(names: str, factor: float, added: float = 0.0) -> Callable[[Log], None]:
    """Columns in another unit, of another sign, or with an offset."""

    def change(log: Log) -> None:
        for c in names.split():
            if c in log.values:
                log[c] = factor * log[c] + added

    return change


def put(name: str, value: float, share: float) -> Callable[[Log], None]:
    """A number instead of some samples, also about the first peak."""

    def change(log: Log) -> None:
        at = log.rng.random(len(log.t)) < share
        log[name][at | (np.abs(log.t - log.peak) < 0.6 * log.interval)] = value

    return change


def held(name: str, paces: float, where: str, drawn: bool | None = False) -> Callable[[Log], None]:
    """A column that stands, is empty (None) or is drawn as a line, about the first peak or from the second execute on."""

    def change(log: Log) -> None:
        middle = log.peak if where == "peak" else float(log.executes[1 if len(log.executes) > 2 else 0])
        lost = np.flatnonzero(log.between(middle - 0.5 * paces * log.pace, middle + 0.5 * paces * log.pace))
        for c in name.split():
            if c in log.values:
                a, b = log[c][lost[0] - 1], log[c][min(lost[-1] + 1, len(log.t) - 1)]
                log[c][lost] = np.nan if drawn is None else np.linspace(a, b, len(lost) + 2)[1:-1] if drawn else a

    return change


def every(names: str, seconds: float, how: str) -> Callable[[Log], None]:
    """A slow column: held, drawn as lines, or empty between its samples."""

    def change(log: Log) -> None:
        step = max(2, round(seconds / log.interval))
        for c in names.split():
            if c in log.values:
                own = np.arange(len(log.t)) // step * step
                if how == "held":
                    log[c] = log[c][own]
                elif how == "drawn":
                    log[c] = np.interp(log.t, log.t[::step], log[c][::step])
                else:
                    log[c][own != np.arange(len(log.t))] = np.nan

    return change


def filtered(name: str, lag: float) -> Callable[[Log], None]:
    """A column behind a filter of the first order, its time constant in s."""

    def change(log: Log) -> None:
        share, last = 1 - np.exp(-log.interval / lag), float(log[name][0])
        for k, now in enumerate(log[name]):
            last += share * (float(now) - last)
            log[name][k] = last

    return change


def on_change(name: str, threshold: float) -> Callable[[Log], None]:
    """A column that is written again only when it has moved."""

    def change(log: Log) -> None:
        last = float(log[name][0])
        for k, now in enumerate(log[name]):
            last = float(now) if abs(now - last) > threshold else last
            log[name][k] = last

    return change


def helm(degrees: float, period: float, keep: float) -> Callable[[Log], None]:
    """Steered in waves before the execute: the rudder goes to and fro, faster than the ship answers."""

    def change(log: Log) -> None:
        before = log.t < log.executes[0] - keep * log.pace
        swing = degrees * np.sin(2 * np.pi * log.t / period) * before
        log["delta"] += swing
        if "delta_order" in log.values:
            log["delta_order"] += swing

    return change


def rows_lost(log: Log) -> None:
    """Rows are lost, and the clock goes on as if they were not."""
    kept = ~log.between(log.executes[0] + 3 * log.pace, log.executes[0] + 6 * log.pace)
    t = log.t[: kept.sum()]
    log.values = {c: v[kept] for c, v in log.values.items()} | {"t": t}


def take(log: Log, kept: np.ndarray) -> None:
    """Keep some rows."""
    log.values = {c: v[kept] for c, v in log.values.items()}


def clock(log: Log, how: str) -> None:
    """Another clock."""
    t = log.t
    if how == "set":
        log["t"] = t + 40.0 * (t > log.executes[0] + 5 * log.pace)
    elif how == "minutes":
        log["t"] = t / 60
    elif how == "ms":
        log["t"] = 1000 * t
    elif how == "whole seconds":
        log["t"] = np.floor(t)
    elif how == "jitter":
        log["t"] = t + 0.4 * log.interval * log.rng.uniform(-1, 1, len(t))
    elif how == "midnight":
        seconds = (86300 + t) % 86400
        log.texts["t"] = [
            f"{int(s // 3600):02d}:{int(s // 60 % 60):02d}:{s % 60:04.1f}" for s in np.round(seconds, 1) % 86400
        ]
        log.names["t"], log.units["t"] = "time", ""


def exchanged(one: str, two: str) -> Callable[[Log], None]:
    """Two columns under each other's header."""

    def change(log: Log) -> None:
        if one in log.values and two in log.values:
            log[one], log[two] = log[two], log[one]

    return change


def header(name: str, called: str, unit: str, factor: float = 1.0) -> Callable[[Log], None]:
    """A column under another header, in its unit."""

    def change(log: Log) -> None:
        if name in log.values:
            log.names[name], log.units[name] = called, unit
            log[name] = factor * log[name]

    return change


def drifting(name: str, whole: float) -> Callable[[Log], None]:
    """A drift, linear over the record."""
    return lambda log: log.__setitem__(name, log[name] + whole * np.linspace(0, 1, len(log.t)))


def step_at(name: str, size: float) -> Callable[[Log], None]:
    """A column is set to another value, between the second execute and the peak."""

    def change(log: Log) -> None:
        when = 0.5 * (log.peak + log.executes[1 if len(log.executes) > 2 else 0])
        log[name] += size * (log.t > when)

    return change


def clipped(name: str, share: float) -> Callable[[Log], None]:
    """A sensor at the end of its range."""

    def change(log: Log) -> None:
        end = share * float(np.abs(log[name] - log[name][0]).max())
        log[name] = np.clip(log[name], log[name][0] - end, log[name][0] + end)

    return change


def nothing(log: Log) -> None:
    """A sound log."""


def both(*changes: Callable[[Log], None]) -> Callable[[Log], None]:
    """One after the other."""

    def change(log: Log) -> None:
        for one in changes:
            one(log)

    return change


@dataclass(frozen=True)
class Kind:
    """A way in which a log is sound or spoiled.

    Attributes
    ----------
    change : callable
        What spoils it.
    sound : bool
        Whether nothing serious is to be said.
    only : str
        The manoeuvre that it bears on: "zigzag", "turn", or "" for both.
    met : dict
        Current, wind and waves of the simulation.
    angles : tuple of float
        Of the manoeuvre, in degrees; empty for those of the table.
    layout : tuple of str
        Columns; empty for any of `LAYOUTS`.
    ship : str
        The ship, where only one has what it takes.
    """

    change: Callable[[Log], None] = nothing
    sound: bool = False
    only: str = ""
    met: dict[str, object] = field(default_factory=dict)
    angles: tuple[float, ...] = ()
    layout: tuple[str, ...] = ()
    ship: str = ""


ALONE = ("psi", "delta", "x", "y")
SWAY = ("psi", "r", "delta", "x", "y", "u", "v")
KINDS: dict[str, Kind] = {
    "as logged": Kind(sound=True),
    "heading of 0.1 deg": Kind(rounded("psi", 0.1), sound=True),
    "heading of 0.5 deg": Kind(rounded("psi", 0.5), sound=True),
    "heading of 1 deg": Kind(rounded("psi", 1.0), sound=True),
    "waves, heading of 0.1 deg": Kind(sea(0.2, 8, 0.1), sound=True),
    "waves, heading of 1 deg": Kind(sea(0.4, 7, 1.0), sound=True),
    "swell, heading of 0.5 deg": Kind(sea(0.4, 12, 0.5), sound=True),
    "wind, heading of 0.1 deg": Kind(rounded("psi", 0.1), sound=True, met={"wind": "4 m/s from 100 deg"}, ship="soesterberg", layout=ALONE),
    "wind, heading of 1 deg": Kind(rounded("psi", 1.0), sound=True, met={"wind": "4 m/s from 300 deg"}, ship="soesterberg", layout=ALONE),
    "rudder of 1 deg": Kind(rounded("delta", 1.0), sound=True),
    "heading and rudder only": Kind(sound=True, only="zigzag", layout=("psi", "delta")),
    "positions every 1 s, held": Kind(every("x y", 1.0, "held"), sound=True),
    "positions every 1 s, empty between": Kind(every("x y", 1.0, "empty"), sound=True),
    "heading from 0 to 360 deg": Kind(lambda log: scaled("psi", 1.0)(log) or log.__setitem__("psi", log["psi"] % 360), sound=True),
    "semicolons and decimal commas": Kind(lambda log: (setattr(log, "separator", ";"), setattr(log, "decimal", ","))[0], sound=True),
    "clock over midnight": Kind(lambda log: clock(log, "midnight"), sound=True),
    "heading off by 4 deg": Kind(scaled("psi", 1.0, 4.0), sound=True, layout=("psi", "delta")[:2], only="zigzag"),
    "ordered about until the order": Kind(helm(5.0, 9.0, 0.0), only="zigzag", angles=(20, 20), layout=LAYOUTS[0]),
    "speed in knots": Kind(header("u", "STW", "kn", 1.943844), sound=True),
    "German header": Kind(both(header("psi", "Kurs", "Grad"), header("delta", "Ruderlage", "Grad"))),
    "heavy swell, heading of 0.5 deg": Kind(sea(1.2, 12, 0.5)),
    "heading to the other side": Kind(scaled("psi", -1.0)),
    "heading in rad, called deg": Kind(scaled("psi", np.pi / 180)),
    "heading 5 % large": Kind(scaled("psi", 1.05)),
    "heading late by 2 s": Kind(late_by("psi", 2.0)),
    "heading early by 2 s": Kind(late_by("psi", -2.0)),
    "heading and rate late by 3 s": Kind(late_by("psi r", 3.0)),
    "heading behind a filter": Kind(filtered("psi", 2.0)),
    "heading stands at the peak": Kind(held("psi", 3, "peak")),
    "heading empty at the peak": Kind(held("psi", 3, "peak", None)),
    "heading drawn across the peak": Kind(held("psi", 3, "peak", True)),
    "heading at the end of its range": Kind(clipped("psi", 0.85), only="zigzag"),
    "heading written by 1 deg": Kind(on_change("psi", 1.0)),
    "heading written by 3 deg": Kind(on_change("psi", 3.0)),
    "heading every 5 s, held": Kind(every("psi", 5.0, "held")),
    "heading every 5 s, drawn": Kind(every("psi", 5.0, "drawn")),
    "heading 0 where lost": Kind(put("psi", 0.0, 0.02)),
    "heading -999 where lost": Kind(put("psi", -999.0, 0.02)),
    "heading off by 6 deg, now and then": Kind(lambda log: put("psi", float(log["psi"].max()) + 6, 0.01)(log)),
    "gyro drifts by 5 deg": Kind(drifting("psi", 5.0)),
    "gyro drifts by 5 deg, alone": Kind(drifting("psi", 5.0), layout=("psi", "delta"), only="zigzag"),
    "gyro set by 3 deg": Kind(step_at("psi", 3.0)),
    "rudder to the other side": Kind(scaled("delta delta_order", -1.0)),
    "rudder in rad, called deg": Kind(scaled("delta delta_order", np.pi / 180)),
    "rudder off by 3 deg": Kind(scaled("delta", 1.0, 3.0)),
    "rudder 20 % large": Kind(scaled("delta", 1.2)),
    "rudder late by 3 s": Kind(late_by("delta", 3.0)),
    "rudder early by 3 s": Kind(late_by("delta", -3.0)),
    "rudder and order late by 3 s": Kind(late_by("delta delta_order", 3.0)),
    "order late by 3 s": Kind(late_by("delta_order", 3.0), layout=LAYOUTS[0]),
    "order early by 3 s": Kind(late_by("delta_order", -3.0), layout=LAYOUTS[0]),
    "order and rudder exchanged": Kind(exchanged("delta", "delta_order"), layout=LAYOUTS[0]),
    "rudder every 5 s, held": Kind(every("delta", 5.0, "held"), layout=LAYOUTS[1]),
    "rudder every 5 s, drawn": Kind(every("delta", 5.0, "drawn"), layout=LAYOUTS[1]),
    "rudder stands at the execute": Kind(held("delta", 4, "execute"), layout=LAYOUTS[1]),
    "rudder empty at the execute": Kind(held("delta", 4, "execute", None), layout=LAYOUTS[1]),
    "rudder drawn across the execute": Kind(held("delta", 6, "execute", True), layout=LAYOUTS[1]),
    "rudder at the end of its range": Kind(clipped("delta", 0.7)),
    "rudder in steps of 5 deg": Kind(rounded("delta", 5.0)),
    "rudder behind a filter": Kind(filtered("delta", 1.5), layout=LAYOUTS[1]),
    "rudder 0 where lost": Kind(put("delta", 0.0, 0.02)),
    "steered in waves before": Kind(helm(3.0, 9.0, 1.0), sound=True),
    "steered in waves until the order": Kind(helm(4.0, 9.0, 0.0), layout=LAYOUTS[1]),
    "clock in min, called s": Kind(lambda log: clock(log, "minutes")),
    "clock in ms, called s": Kind(lambda log: clock(log, "ms")),
    "clock set by 40 s": Kind(lambda log: clock(log, "set")),
    "clock in whole s": Kind(lambda log: clock(log, "whole seconds")),
    "clock with jitter": Kind(lambda log: clock(log, "jitter")),
    "rows lost, clock goes on": Kind(rows_lost),
    "rows lost": Kind(lambda log: take(log, ~log.between(log.peak - log.pace, log.peak + 2 * log.pace))),
    "begins in the manoeuvre": Kind(lambda log: take(log, log.t > log.executes[0] + 2 * log.pace)),
    "begins on the ramp": Kind(lambda log: take(log, log.t > log.executes[0] + log.interval)),
    "ends before the peak": Kind(lambda log: take(log, log.t < log.peak - 1.0)),
    "rows in disorder": Kind(lambda log: take(log, np.argsort(np.arange(len(log.t)) + 3 * (log.rng.random(len(log.t)) < 0.05), kind="stable"))),
    "rows twice": Kind(lambda log: take(log, np.sort(np.r_[np.arange(len(log.t)), log.rng.integers(0, len(log.t), len(log.t) // 20)]))),
    "heading and rudder exchanged": Kind(exchanged("psi", "delta")),
    "rate under the heading": Kind(exchanged("psi", "r"), layout=LAYOUTS[0]),
    "positions late by 3 s": Kind(late_by("x y", 3.0), only="turn", layout=SWAY),
    "positions late by a pace": Kind(shifted("x y", 1.0), only="turn", layout=SWAY),
    "positions early by a pace": Kind(shifted("x y", -1.0), only="turn", layout=SWAY),
    "positions exchanged": Kind(exchanged("x", "y"), only="turn"),
    "positions in ft, called m": Kind(scaled("x y", 3.28084), only="turn", layout=LAYOUTS[1]),
    "positions leap by 40 m": Kind(step_at("y", 40.0), only="turn"),
    "positions stand": Kind(held("x y", 3, "peak"), only="turn"),
    "positions every 10 s, held": Kind(every("x y", 10.0, "held"), only="turn"),
    "positions 0 where lost": Kind(both(put("x", 0.0, 0.02), put("y", 0.0, 0.02)), only="turn"),
    "current": Kind(sound=True, only="turn", met={"current": "0.8 m/s to 100 deg"}, angles=(35, 540)),
    "current, a turn of 200 deg": Kind(only="turn", met={"current": "0.8 m/s to 100 deg"}, angles=(35, 200)),
    "current, a turn of 200 deg, no speed": Kind(only="turn", met={"current": "0.8 m/s to 100 deg"}, angles=(35, 200), layout=ALONE),
    "current, SOG as u": Kind(lambda log: sog(log), only="turn", met={"current": "0.8 m/s to 100 deg"}, layout=LAYOUTS[1]),
    "turn of 200 deg": Kind(sound=True, only="turn", angles=(35, 200)),
    "speed in knots, called m/s": Kind(scaled("u", 1.943844)),
    "speed in nds": Kind(header("u", "u", "nds", 1.943844), layout=LAYOUTS[1]),
    "two reversals": Kind(lambda log: take(log, log.t < log.executes[3] - log.interval), sound=True, only="zigzag"),
    "one reversal": Kind(lambda log: take(log, log.t < log.executes[2] - log.interval), sound=True, only="zigzag"),
}  # fmt: skip


def sog(log: Log) -> None:
    """The speed over the ground under the header of that through the water."""
    log["u"] = np.hypot(np.gradient(log.run["x"], log.run["t"]), np.gradient(log.run["y"], log.run["t"]))[
        np.searchsorted(log.run["t"], log.t)
    ]
