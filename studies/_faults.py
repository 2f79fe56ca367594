"""Faults to plant in a trial, each at three severities: what the studies and tests of the trial doctor ask it to find."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

import shipid
from shipid.declaration.component import declared_quantities
from shipid.declaration.vocabulary import FIELDS
from shipid.models.nomoto import Nomoto
from shipid.parts.planar_motion import PlanarMotion

SHIPS = (
    ("nomoto", "kvlcc2"), ("norrbin", "zeefakkel"), ("bech", "kvlcc2-7m"), ("de-keizer", "soesterberg"),
    ("pershitz", "semerdjiev"), ("davidson-schiff", "mariner"), ("van-leeuwen", "zeefakkel"), ("nomoto", "esso-osaka-3m"),
    ("de-keizer", "gunnerus"), ("nomoto-second-order", "mariner"), ("norrbin", "gunnerus"), ("pershitz", "kvlcc2"),
    ("norrbin", "kvlcc2"), ("bech", "kvlcc2"),
)  # fmt: skip
Table = dict[str, np.ndarray]


class Log:
    """A trial as a log would print it: SI values, the unit each header claims, and the severity's number."""

    def __init__(self, trial: shipid.Trial, ship: str, seed: int) -> None:
        self.values: Table = {c: trial[c].copy() for c in trial.table.columns if c in FIELDS}
        self.units = {c: FIELDS[c].display for c in self.values}
        self.ship = ship
        self.length = shipid.find_ship(ship).particular("L", "m")
        self.rng = np.random.default_rng(seed)
        self.text: tuple[str, np.ndarray] | None = None

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    def __setitem__(self, name: str, values: np.ndarray) -> None:
        self.values[name] = values

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.values["t"])

    @property
    def dt(self) -> float:
        """Median sampling interval [s]."""
        return float(np.median(np.diff(self["t"])))

    @property
    def turning(self) -> int:
        """A sample in the middle of a swing."""
        r = np.abs(self["r"])
        middle = slice(self.n // 4, 3 * self.n // 4)
        return self.n // 4 + int(np.argmax(r[middle]))

    def each(self, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Change every column in the same way."""
        self.values = {name: change(values) for name, values in self.values.items()}

    def take(self, index: np.ndarray) -> None:
        """Keep some rows, in this order."""
        self.each(lambda v: v[index])

    def frame(self) -> pd.DataFrame:
        """Return the table as it is printed, the claimed units in the headers."""
        factor = {c: shipid.trials.columns.to_inside(c, FIELDS[c].display) for c in self.values}
        table = pd.DataFrame({f"{c} [{self.units[c]}]": v / factor[c] for c, v in self.values.items()})
        if self.text is not None:
            header = f"{self.text[0]} [{self.units[self.text[0]]}]"
            table[header] = table[header].astype(object)
            table.loc[self.text[1], header] = "1.002.564"
        return table


def decimal(value: float) -> float:
    """The number 1, 2 or 5 times a power of ten at or above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(d * power for d in (1, 2, 5, 10) if d * power >= value * 0.999))


def clock_quantised(log: Log, size: float) -> None:
    t = np.arange(log["t"][0], log["t"][-1], 1.0373 * log.dt)
    log.values = {name: np.interp(t, log["t"], v) for name, v in log.values.items()}
    q = decimal(size * log.dt)
    log["t"] = np.round(t / q) * q


def clock_repeats(log: Log, size: float) -> None:
    rows = log.rng.choice(log.n, max(1, int(size * log.n)), replace=False)
    log.take(np.sort(np.concatenate([np.arange(log.n), rows])))


def clock_unsorted(log: Log, size: float) -> None:
    order = np.arange(log.n)
    for k in log.rng.choice(log.n - 2, max(1, int(size * log.n)), replace=False):
        order[[k, k + 1]] = order[[k + 1, k]]
    log.take(order if np.any(np.diff(order) < 0) else order[::-1])


def gap(log: Log, size: float) -> None:
    log.take(np.delete(np.arange(log.n), log.turning + np.arange(max(3, int(size * log.n)))))


def resampled(log: Log, size: float) -> None:
    t, keep = log["t"], np.arange(0, log.n, int(size))
    for c in ("psi", "r", "x", "y", "u", "v"):
        if c in log.values:
            log[c] = np.interp(t, t[keep], log[c][keep])


def missing(log: Log, size: float) -> None:
    log["r"][log.rng.choice(np.arange(3, log.n - 3), max(1, int(size * log.n)), replace=False)] = np.nan


def trailing_empty(log: Log, size: float) -> None:
    for c in set(log.values) - {"t"}:
        log[c][-max(1, int(size * log.n)) :] = np.nan


def outlier(log: Log, size: float) -> None:
    c = ("r", "delta", "x")[int(log.rng.integers(3))]
    d3 = np.diff(log[c], 3)
    noise = 1.4826 * np.median(np.abs(d3 - np.median(d3))) / np.sqrt(20)
    at = log.rng.choice(np.arange(10, log.n - 10), 1 + int(size > 0.1), replace=False)
    log[c][at] += (size * np.ptp(log[c]) + 10 * noise) * log.rng.choice([-1, 1])


def frozen(log: Log, size: float) -> None:
    c = ("psi", "r")[int(log.rng.integers(2))]
    width = int(size * log.n)
    window = np.lib.stride_tricks.sliding_window_view(log[c], width)
    a = int(np.argmax(np.ptp(window, axis=1)))
    log[c][a : a + width] = log[c][a]


def unit_heading(log: Log, size: float) -> None:
    if size > 1:
        log.units["psi"] = "rad"
    else:
        log["psi"] = np.radians(log["psi"])


def unit_rate(log: Log, size: float) -> None:
    log["r"] = log["r"] * {1: np.pi / 180, 2: 60.0, 3: 180 / np.pi}[int(size)]


def unit_speed(log: Log, size: float) -> None:
    factor = {1: 3.6, 2: 3600 / 1852, 3: 1852 / 3600}[int(size)]
    for c in ("u", "v"):
        if c in log.values:
            log[c] = log[c] * factor


def unit_over_ground(log: Log, size: float) -> None:
    """A speed over ground of a receiver, in metres a second, knots or kilometres an hour under a header that says another."""
    velocity = np.gradient(log["x"], log["t"]) + 1j * np.gradient(log["y"], log["t"])
    span = max(3, round(0.01 * log.n)) | 1
    smooth = np.convolve(np.pad(velocity, span // 2, mode="edge"), np.ones(span) / span, "valid")
    log["SOG"] = np.abs(smooth) * {1: 3.6, 2: 3600 / 1852, 3: 1852 / 3600}[int(size)]
    log.units["SOG"] = "m/s"


def speed_sign(log: Log, size: float) -> None:
    log["u"] = -size * log["u"]


def unit_rudder(log: Log, size: float) -> None:
    for c in ("delta", "delta_order"):
        log[c] = log[c] * {1: np.pi / 180, 2: np.pi / 180, 3: 180 / np.pi}[int(size)]


def unit_clock(log: Log, size: float) -> None:
    log["t"] = log["t"] * (1000.0 if size > 1 else 1 / 60)


def speed_scale(log: Log, size: float) -> None:
    for c in ("u", "v"):
        if c in log.values:
            log[c] = log[c] / size


def rate_scale(log: Log, size: float) -> None:
    log["r"] = log["r"] / size


def mislabelled(log: Log, size: float) -> None:
    r = log["r"]
    roll = np.gradient(np.gradient(r, log["t"]), log["t"])
    other = 0.3 * np.std(r) * roll / (np.std(roll) + 1e-30) + 0.02 * np.std(r) * log.rng.standard_normal(log.n)
    log["p"] = r
    log.units["p"] = "deg/s"
    if size < 3:
        log["r"] = other if size < 2 else 0.1 * np.std(r) * log.rng.standard_normal(log.n)
    else:
        del log.values["r"]


def rudder_sign(log: Log, size: float) -> None:
    for c in ("delta", "delta_order"):
        log[c] = -size * log[c]


def rate_sign(log: Log, size: float) -> None:
    log["r"] = -size * log["r"]


def heading_sign(log: Log, size: float) -> None:
    log["psi"] = size - log["psi"]


def with_sway(log: Log) -> None:
    """A log without sway gets one, made from its rate of turn, and positions to match."""
    if "v" not in log.values or np.ptp(log["v"]) == 0:
        log["v"] = -0.3 * (log.length or 1.0) * log["r"]
        log.units["v"] = "m/s"
        sail(log)


def sail(log: Log, flow: tuple[float, float] = (0.0, 0.0)) -> None:
    """Positions from speeds and heading, with the noise the log had."""
    t, c, s = log["t"], np.cos(log["psi"]), np.sin(log["psi"])
    for name, velocity in (
        ("x", log["u"] * c - log["v"] * s + flow[0]),
        ("y", log["u"] * s + log["v"] * c + flow[1]),
    ):
        d3 = np.diff(log[name], 3)
        noise = 1.4826 * np.median(np.abs(d3 - np.median(d3))) / np.sqrt(20)
        way = np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t))))
        log[name] = way + (noise if noise > 1e-4 * np.ptp(way) else 0.0) * log.rng.standard_normal(log.n)


def earth_fixed(log: Log, size: float) -> None:
    with_sway(log)
    c, s = np.cos(log["psi"]), np.sin(log["psi"])
    log["u"], log["v"] = log["u"] * c - log["v"] * s, log["u"] * s + log["v"] * c


def heading_wrap(log: Log, size: float) -> None:
    middle = np.quantile(log["psi"], 0.5 + 0.1 * (size - 2))
    log["psi"] = middle + np.mod(log["psi"] - middle, 2 * np.pi)


def heading_interpolated(log: Log, size: float) -> None:
    middle = np.median(log["psi"])
    psi = np.mod(log["psi"] - middle, 2 * np.pi)
    jumps = np.flatnonzero(np.abs(np.diff(psi)) > np.pi)
    if "r" in log.values:  # not where noise crosses north to and fro
        jumps = jumps[np.concatenate(([True], np.diff(jumps) > 4 * size + 4))][:8]
    for k in jumps:
        a, b = max(k - int(size) // 2, 0), min(k + 1 + (int(size) + 1) // 2, log.n - 1)
        if abs(psi[b] - psi[a]) > np.pi:
            psi[a : b + 1] = np.linspace(psi[a], psi[b], b - a + 1)
    log["psi"] = middle + psi


def heading_glitch(log: Log, size: float) -> None:
    d3 = np.diff(log["psi"], 3)
    noise = 1.4826 * np.median(np.abs(d3)) / np.sqrt(20)
    for k in log.rng.choice(np.arange(20, log.n - 20), 1 + int(size), replace=False):
        log["psi"][k : k + 2] += np.radians(size) + 6 * noise


def order_not_feedback(log: Log, size: float) -> None:
    log["delta"] = log["delta_order"].copy()
    if size < 3:
        del log.values["delta_order"]
    if size < 2:
        log["delta"] = np.convolve(log["delta"], [0.25, 0.75], "same")


def accelerating(log: Log, size: float) -> None:
    rise = 0.2 * np.ptp(log["t"])
    ramp = 1 - (1 - size) * np.clip(1 - (log["t"] - log["t"][0]) / rise, 0, 1)
    log["u"] = log["u"] * ramp
    if "v" in log.values:
        log["v"] = log["v"] * ramp
        sail(log)
    else:
        log["v"] = np.zeros(log.n)
        sail(log)
        del log.values["v"]


def bias_rudder(log: Log, size: float) -> None:
    for c in ("delta", "delta_order"):
        log[c] = log[c] + size * np.quantile(np.abs(log["delta"]), 0.9)


def bias_rate(log: Log, size: float) -> None:
    log["r"] = log["r"] + size * np.quantile(np.abs(log["r"]), 0.9)


def track_inconsistent(log: Log, size: float) -> None:
    speed = size * float(np.quantile(log["u"], 0.9)) * (log["t"] - log["t"][0])
    log["x"], log["y"] = log["x"] + 0.6 * speed, log["y"] - 0.8 * speed


def position_jump(log: Log, size: float) -> None:
    jump = size * (float(np.quantile(log["u"], 0.9)) * log.dt) + 8 * np.median(np.abs(np.diff(log["x"], 2)))
    log["y"] = log["y"] + jump * (np.arange(log.n) > log.n // 2)


def short(log: Log, size: float) -> None:
    over = np.flatnonzero(np.abs(log["delta"]) > 0.5 * np.quantile(np.abs(log["delta"]), 0.99))
    sides = np.sign(log["delta"][over])
    turns = over[1:][np.diff(sides) != 0]
    first = int(turns[0]) if len(turns) else min(log.n - 1, over[0] + log.n // 20)
    log.take(np.arange(max(12, int(over[0] + size * (first - over[0])))))


def no_rudder_movement(log: Log, size: float) -> None:
    for c in ("delta", "delta_order"):
        log[c] = np.full(log.n, np.radians(size - 1)) + np.radians(0.02 * size) * log.rng.standard_normal(log.n)


def coarse_sampling(log: Log, size: float) -> None:
    unit = (log.length or 1.0) / float(np.quantile(log["u"], 0.9))
    log.take(np.arange(0, log.n, max(1, round(size * unit / log.dt))))


def quantised(log: Log, size: float) -> None:
    d3 = np.diff(log["psi"], 3)
    q = size * np.ptp(log["psi"]) + 10 * size * 100 * np.median(np.abs(d3)) / np.sqrt(20) * 0.6
    log["psi"] = np.round(log["psi"] / q) * q


def latency_rate(log: Log, size: float) -> None:
    log["r"] = np.interp(log["t"] - size * log.dt, log["t"], log["r"])


def latency_rudder(log: Log, size: float) -> None:
    over = np.flatnonzero(np.abs(log["delta"]) > 0.5 * np.quantile(np.abs(log["delta"]), 0.99))
    turns = over[1:][np.diff(np.sign(log["delta"][over])) != 0]
    late = size * float(np.median(np.diff(log["t"][turns])))
    for c in ("delta", "delta_order"):
        log[c] = np.interp(log["t"] - late, log["t"], log[c])


def text_cells(log: Log, size: float) -> None:
    """Numbers written with two points: decimal sign and thousands."""
    column = log["x" if "x" in log.values else "psi"]
    log.text = ("x" if "x" in log.values else "psi", log.rng.choice(log.n, max(1, int(size * log.n)), replace=False))
    column[log.text[1]] = np.nan


def sentinel(log: Log, size: float) -> None:
    log["psi"][log.rng.choice(log.n, max(1, int(size * log.n)), replace=False)] = np.radians(-9999.0)


def hole(log: Log, size: float) -> None:
    width = max(6, int(size * log.n))
    log["psi"][log.turning : log.turning + width] = np.nan


def track_direction(log: Log, size: float) -> None:
    place = log["x"] + 1j * log["y"]
    if size > 2:  # the names of x and y are exchanged
        log["x"], log["y"] = place.imag, place.real
    else:
        turned = place * np.exp(1j * np.radians({1: 20.0, 2: 60.0}[int(size)]))
        log["x"], log["y"] = turned.real, turned.imag


def speed_stands(log: Log, size: float) -> None:
    scale = float(np.quantile(log["u"], 0.9))
    for c in ("u", "v"):
        if c in log.values:
            log[c] = 0.03 / size * scale * log.rng.standard_normal(log.n)


def rudder_early(log: Log, size: float) -> None:
    over = np.flatnonzero(np.abs(log["delta"]) > 0.5 * np.quantile(np.abs(log["delta"]), 0.99))
    turns = over[1:][np.diff(np.sign(log["delta"][over])) != 0]
    early = size * float(np.median(np.diff(log["t"][turns])))
    for c in ("delta", "delta_order"):
        log[c] = np.interp(log["t"] + early, log["t"], log[c])


def closed_loop(log: Log, size: float) -> None:
    """An autopilot steers a first-order ship in gusts, over the time of the log and at its interval."""
    n, dt, tau = log.n, log.dt, 12 * log.dt
    gust = np.zeros(n)
    psi, r, delta = (np.zeros(n) for _ in range(3))
    push = size * 0.004 * log.rng.standard_normal(n)
    for k in range(1, n):
        gust[k] = 0.9 * gust[k - 1] + push[k]
        delta[k] = np.clip(-(psi[k - 1] + 8 * dt * r[k - 1]), -0.6, 0.6)
        r[k] = r[k - 1] + dt * ((0.08 / dt * delta[k - 1] - r[k - 1]) / tau + gust[k] / (dt * tau))
        psi[k] = psi[k - 1] + dt * r[k]
    kept = {"t": log["t"], "psi": psi, "r": r, "delta": delta, "delta_order": delta.copy()}
    log.values = {c: kept[c] for c in log.values if c in kept} | {"delta_order": kept["delta_order"]}


def frozen_rudder(log: Log, size: float) -> None:
    """The rudder repeats a value while it is put over; its order is not logged."""
    log.values.pop("delta_order", None)
    k, width = int(np.argmax(np.abs(np.diff(log["delta"])))), max(10, int(size * log.n))
    # It stands from shortly before the largest step of the rudder on, until the ramp is over.
    a = max(k - width // 3, 1)
    log["delta"][a : a + width] = log["delta"][a]


def clock_set(log: Log, size: float) -> None:
    log["t"][log.turning :] += size * log.dt


def clock_jitter(log: Log, size: float) -> None:
    log["t"] = log["t"] + size * log.dt * log.rng.uniform(-1, 1, log.n)


def written_on_change(log: Log, size: float) -> None:
    """The heading is written again only when it has moved by more than a threshold."""
    threshold, last = size * float(np.ptp(log["psi"])), float(log["psi"][0])
    for k, now in enumerate(log["psi"]):
        last = float(now) if abs(now - last) > threshold else last
        log["psi"][k] = last


def unit_positions(log: Log, size: float) -> None:
    metres = {1: 0.3048, 2: 1000.0, 3: 1852.0}[int(size)]
    log["x"], log["y"] = log["x"] / metres, log["y"] / metres


def order_early(log: Log, size: float) -> None:
    log["delta_order"] = np.interp(log["t"] + size * max(1.5, 2.5 * log.dt), log["t"], log["delta_order"])


Plant = tuple[Callable[[Log, float], None], tuple[float, float, float], str, str]
#: Row: what plants it, mild, clear and gross, the kind asked for, and what it needs ("zigzag", "stamps": little noise, or "v": a sway).
FAULTS: dict[str, Plant] = {
    "clock-quantised": (clock_quantised, (0.4, 1.5, 5.0), "clock-quantised", ""),
    "clock-repeats": (clock_repeats, (0.001, 0.01, 0.1), "clock-repeats", ""),
    "clock-unsorted": (clock_unsorted, (0.001, 0.01, 0.1), "clock-unsorted", ""),
    "gap": (gap, (0.003, 0.03, 0.15), "gap", ""),
    "resampled": (resampled, (2, 4, 8), "resampled", ""),
    "missing samples": (missing, (0.001, 0.01, 0.1), "missing", ""),
    "text": (text_cells, (0.002, 0.02, 0.3), "text", ""),
    "sentinel": (sentinel, (0.001, 0.01, 0.05), "sentinel", ""),
    "hole": (hole, (0.01, 0.05, 0.2), "hole", ""),
    "trailing-empty": (trailing_empty, (0.001, 0.02, 0.2), "trailing-empty", ""),
    "outlier": (outlier, (0.03, 0.3, 2.0), "outlier", ""),
    "frozen": (frozen, (0.02, 0.06, 0.15), "frozen", ""),
    "frozen rudder": (frozen_rudder, (0.03, 0.06, 0.1), "frozen", "zigzag"),
    "clock-set": (clock_set, (5, 60, 3600), "clock-set", ""),
    "clock-jitter": (clock_jitter, (0.1, 0.3, 0.45), "clock-jitter", "stamps"),
    "written-on-change": (written_on_change, (0.005, 0.02, 0.06), "written-on-change", "zigzag"),
    "unit of the positions": (unit_positions, (1, 2, 3), "unit", "positions"),
    "order-early": (order_early, (1.2, 2, 4), "order-early", "zigzag"),
    "unit of the heading": (unit_heading, (1, 2, 3), "unit", ""),
    "unit of the rate": (unit_rate, (1, 2, 3), "unit", ""),
    "unit of the speed": (unit_speed, (1, 2, 3), "unit", "positions"),
    "unit of the SOG": (unit_over_ground, (1, 2, 3), "unit", "positions"),
    "speed-sign": (speed_sign, (1, 1, 1), "speed-sign", "positions"),
    "unit of the rudder": (unit_rudder, (1, 2, 3), "unit", ""),
    "unit of the clock": (unit_clock, (1, 2, 3), "unit", ""),
    "speed-scale": (speed_scale, (1.020372, 1.1, 1.3), "speed-scale", "positions"),
    "rate-scale": (rate_scale, (1.05, 1.15, 1.5), "rate-scale", ""),
    "mislabelled": (mislabelled, (1, 2, 3), "mislabelled", ""),
    "rudder-sign": (rudder_sign, (1, 1, 1), "rudder-sign", "steered"),
    "rate-sign": (rate_sign, (1, 1, 1), "rate-sign", ""),
    "earth-fixed-velocity": (earth_fixed, (1, 1, 1), "earth-fixed-velocity", "positions"),
    "heading-wrap": (heading_wrap, (1, 2, 3), "heading-wrap", ""),
    "heading-interpolated": (heading_interpolated, (1, 2, 3), "heading-interpolated", ""),
    "heading-glitch": (heading_glitch, (1.0, 3.0, 10.0), "heading-glitch", ""),
    "order-not-feedback": (order_not_feedback, (1, 2, 3), "order-not-feedback", "order"),
    "accelerating": (accelerating, (0.8, 0.5, 0.05), "accelerating", "positions"),
    "bias of the rudder": (bias_rudder, (0.05, 0.15, 0.4), "bias", "zigzag"),
    "bias of the rate": (bias_rate, (0.02, 0.1, 0.5), "bias", ""),
    "asymmetric": (lambda log, size: None, (0.1, 0.3, 0.6), "asymmetric", "lopsided"),
    "track-inconsistent": (track_inconsistent, (0.03, 0.1, 0.25), "track-inconsistent", "turn"),
    "position-jump": (position_jump, (4, 20, 100), "position-jump", "positions"),
    "short": (short, (1.3, 0.9, 0.4), "short", "zigzag"),
    "no-rudder-movement": (no_rudder_movement, (1, 2, 3), "no-rudder-movement", ""),
    "coarse-sampling": (coarse_sampling, (0.25, 0.5, 1.0), "coarse-sampling", ""),
    "quantised": (quantised, (0.005, 0.02, 0.06), "quantised", ""),
    "latency of the rate": (latency_rate, (1, 4, 12), "latency", ""),
    "track-direction": (track_direction, (1, 2, 3), "track-direction", "positions"),
    "speed-stands": (speed_stands, (1, 2, 3), "speed-stands", "positions"),
    "early rudder": (rudder_early, (0.03, 0.1, 0.2), "latency", "zigzag"),
    "closed-loop": (closed_loop, (0.5, 2.0, 5.0), "closed-loop", "steered"),
    "latency of the rudder": (latency_rudder, (0.02, 0.08, 0.2), "latency", "zigzag"),
}  # fmt: skip


def noise_for(ship: str, level: str) -> dict[str, float] | str:
    """Sensor noise: none, that of the standard sensors, or instruments fit for the size of the ship."""
    if level != "fitting":
        return level
    found = shipid.find_ship(ship)
    length, speed = found.particular("L", "m") or 1.0, found.particular("speed", "m/s") or 1.0
    u = 0.01 * speed
    return {"psi": 0.0017, "r": 0.02 * 0.3 * speed / length, "u": u, "v": u, "x": 0.01 * length, "y": 0.01 * length}


def lopsided(ship: str, share: float, noise: dict[str, float] | str, seed: int) -> shipid.Trial:
    """A zig-zag of a ship that turns more willingly to starboard."""

    class Lopsided(Nomoto):
        """Nomoto's ship with two gains."""

        @declared_quantities(Nomoto)["r"].rate
        def yaw(self):
            """A gain for either side."""
            gain = self.K * (1 + 0.5 * share * np.tanh(self.delta / 0.02))
            return (gain * self.delta - self.r) / self.tau

    model = shipid.join("nomoto", Lopsided, PlanarMotion)
    known = shipid.find_ship(ship)
    unit = (known.particular("L", "m") or 1.0) / (known.particular("speed", "m/s") or 1.0)
    gains = {"K": f"{0.9 / unit} 1/s", "tau": f"{1.2 * unit} s"}
    return shipid.simulate(model, ship, "zigzag:20/20", noise=noise, seed=seed, values=gains)
