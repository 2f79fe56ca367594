"""Logs of simulated trials as loggers write them: columns, clock, noise, and what the run they were made of measures."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

import shipid
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre

SHIPS = (("de-keizer", "soesterberg"), ("norrbin", "zeefakkel"), ("pershitz", "kvlcc2"))
#: Intervals of the loggers in s, of these ships.
INTERVALS = {"soesterberg": (0.2, 0.5, 1.0), "zeefakkel": (0.1, 0.2, 0.5), "kvlcc2": (0.5, 1.0)}
#: Columns of the logs: everything, what a voyage recorder has, and what a helmsman's log has.
LAYOUTS = (
    ("psi", "r", "delta", "delta_order", "x", "y", "u"), ("psi", "delta", "x", "y", "u"), ("psi", "r", "delta", "x", "y"),
)  # fmt: skip
UNITS = {
    "t": "s", "psi": "deg", "r": "deg/s", "delta": "deg", "delta_order": "deg", "x": "m", "y": "m", "u": "m/s", "v": "m/s",
}  # fmt: skip
NOISE = {"psi": 0.03, "r": 0.01, "delta": 0.05, "x": 0.3, "y": 0.3, "u": 0.02, "v": 0.02}
_STEP = 0.1


@lru_cache(maxsize=60)
def sailed(model: str, ship: str, kind: str, angles: tuple[float, ...], **met: object) -> dict[str, np.ndarray]:
    """Sail a manoeuvre in steps of 0.1 s: its columns in the units of the logs, without noise.

    Parameters
    ----------
    model, ship : str
        Names.
    kind : {"zigzag", "turn"}
        What is sailed.
    angles : tuple of float
        Rudder and heading in degrees.
    **met
        Current, wind or waves, as `shipid.simulate` takes them.
    """
    manoeuvre = Manoeuvre(kind, tuple(np.radians(angles)), approach=3.0)
    trial = shipid.simulate(shipid.find_model(model), ship, manoeuvre, sampling=f"{_STEP} s", heading="40 deg", **met)
    turned = {"psi", "r", "delta", "delta_order"}
    return {c: np.degrees(trial[c]) if c in turned else trial[c] for c in UNITS if trial.has(c)}


def truth(run: dict[str, np.ndarray]) -> dict[str, float]:
    """What the un-spoiled run measures: overshoots in deg, distances in m, times in s.

    Parameters
    ----------
    run : dict of str to ndarray
        A run of `sailed`.
    """
    t, psi, order = run["t"], run["psi"], run["delta_order"]
    at = np.flatnonzero(np.diff(order)) + 1
    side = np.sign(order[at[0]])
    if np.any(order * side < 0):
        found = {"initial_turning_time": float(t[at[1]] - t[at[0]])}
        for k in range(1, min(len(at) - 1, 4)):
            way = side * (-1) ** (k - 1)
            found[f"overshoots[{k}]"] = float((way * psi[at[k] : at[k + 1] + 1]).max() - way * psi[at[k]])
        return found
    turned, course = side * (psi - psi[at[0]]), np.radians(psi[at[0]])
    quarter, half = (int(np.argmax(turned >= q)) for q in (90, 180))
    north, east = run["x"] - run["x"][at[0]], run["y"] - run["y"][at[0]]
    across = side * (np.cos(course) * east - np.sin(course) * north)
    along = np.cos(course) * north + np.sin(course) * east
    return {
        "advance": float(along[quarter]), "transfer": float(across[quarter]), "tactical_diameter": float(across[half]),
        "times[1]": float(t[quarter] - t[at[0]]),
    }  # fmt: skip


@dataclass
class Log:
    """A run as a logger writes it, to be spoiled.

    Attributes
    ----------
    run : dict of str to ndarray
        The run, every 0.1 s.
    interval : float
        Of the logger in s.
    layout : tuple of str
        Columns.
    rng : Generator
        Of the noise and of what is spoiled.
    values : dict of str to ndarray
        What is written, in the units of the headers.
    units : dict of str to str
        What the headers claim; empty for none.
    names : dict of str to str
        Other names of columns.
    separator, decimal : str
        Of the file.
    texts : dict of str to list of str
        Columns written as they stand here.
    """

    run: dict[str, np.ndarray]
    interval: float
    layout: tuple[str, ...]
    rng: np.random.Generator
    values: dict[str, np.ndarray] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=lambda: dict(UNITS))
    names: dict[str, str] = field(default_factory=dict)
    separator: str = ","
    decimal: str = "."
    texts: dict[str, list[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        step = round(self.interval / _STEP)
        # The clock of the logger begins somewhere between.
        first = int(self.rng.integers(step))
        self.values = {c: self.run[c][first::step].copy() for c in ("t", *self.layout) if c in self.run}
        for c, deviation in NOISE.items():
            if c in self.values:
                self.values[c] += deviation * self.rng.standard_normal(len(self.t))

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    def __setitem__(self, name: str, values: np.ndarray) -> None:
        self.values[name] = values

    @property
    def t(self) -> np.ndarray:
        """Time in s."""
        return self.values["t"]

    @property
    def executes(self) -> np.ndarray:
        """When the rudder is ordered, in s."""
        return self.run["t"][np.flatnonzero(np.diff(self.run["delta_order"])) + 1]

    @property
    def pace(self) -> float:
        """A tenth of the time from the first execute to the second; in a turn, to 90 deg. In s."""
        turned = np.abs(self.run["psi"] - self.run["psi"][0])
        return 0.1 * float(min(self.executes[1], self.run["t"][np.argmax(turned > 90) or -1]) - self.executes[0])

    @property
    def peak(self) -> float:
        """When the heading turns back first, or has changed by 90 deg, in s."""
        turned = np.abs(self.run["psi"] - self.run["psi"][0])
        until = np.searchsorted(self.run["t"], self.executes[min(2, len(self.executes) - 1)])
        return float(
            self.run["t"][np.argmax(turned > 90)] if turned.max() > 90 else self.run["t"][np.argmax(turned[:until])]
        )

    def late(self, names: str, seconds: float) -> None:
        """Shift columns in time."""
        for c in names.split():
            if c in self.values:
                self[c] = np.interp(self.t - seconds, self.t, self[c])

    def between(self, start: float, end: float) -> np.ndarray:
        """Samples between two times."""
        return (self.t >= start) & (self.t <= end)

    def text(self) -> str:
        """The log as a file holds it."""
        heads = {c: self.names.get(c, c) + (f" [{self.units[c]}]" if self.units[c] else "") for c in self.values}
        cells = {
            c: self.texts.get(c) or ["" if np.isnan(v) else f"{v:.{2 if c in 'xy' else 3}f}".replace(".", self.decimal) for v in column]
            for c, column in self.values.items()
        }  # fmt: skip
        return "\n".join([self.separator.join(heads.values()), *map(self.separator.join, zip(*cells.values()))]) + "\n"
