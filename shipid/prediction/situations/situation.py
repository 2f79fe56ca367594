"""What is known of a ship when a prediction begins: its state and surroundings, with their covariance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.units import pretty, to_si
from shipid.declaration.vocabulary import FIELDS, compass, display_unit, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief, fixed, last_place, moment
from shipid.foundation.result import Result, table

if TYPE_CHECKING:
    import pandas as pd

#: Decimals a value is rounded to before it is shown.
_DECIMALS = 9


@dataclass(frozen=True, eq=False)
class PastErrors:
    """By how much the bands of past predictions were too narrow, against the distance; made by `shipid.prediction.situations.past`.

    Attributes
    ----------
    s_star : ndarray, shape (K,)
        Distances in ship lengths.
    track, heading : ndarray, shape (K,)
        Factors of the standard deviations across the track and of the heading, 1 at least.
    count : int
        How many predictions they come from.
    lost : int
        How many of these ran away or could not be made where the ship sailed on.
    """

    s_star: np.ndarray = field(repr=False)
    track: np.ndarray = field(repr=False)
    heading: np.ndarray = field(repr=False)
    count: int
    lost: int = 0

    def at(self, s_star: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the factors of track and heading; beyond the farthest distance seen they are those there.

        Parameters
        ----------
        s_star : ndarray
            Distances in ship lengths.
        """
        if not self.s_star.size:
            return np.ones_like(s_star), np.ones_like(s_star)
        return np.interp(s_star, self.s_star, self.track), np.interp(s_star, self.s_star, self.heading)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, free of NaN."""
        return {
            "predictions": self.count,
            "lost": self.lost,
            "ship_lengths": self.s_star.tolist(),
            "track_factors": self.track.tolist(),
            "heading_factors": self.heading.tolist(),
        }


@dataclass(frozen=True, eq=False, repr=False)
class Situation(Result):
    """A ship at one moment; SI.

    Attributes
    ----------
    values : mapping of str to float
        States, inputs (current, wind) and coefficients by name. ``psi`` and ``u`` are needed; ``x`` and ``y`` are zero and ``r``,
        ``v`` and ``delta`` those of a straight course where nothing is said.
    uncertain : tuple of str
        Names along `covariance`.
    covariance : ndarray, shape (uncertain, uncertain)
        Of what is uncertain.
    noise : mapping of str to float
        Density of the noise that drives a quantity while the ship sails on, per root second.
    t : float
        In s, on the clock of its source.
    past : PastErrors or None
        How far off earlier predictions of this ship were, which widens the band; None where nothing is known of that.
    current_std : float or None
        Standard deviation of each component of the estimated current in m/s, with the errors of model and log that are read as a
        current (`shipid.prediction.situations.fix_errors`); None where none is estimated. The covariance is that of the filter:
        a track that continues with the same errors is not as far off as they are large.
    structural : mapping of str to float
        The part of `noise` by which a model of low order is not the ship.
    """

    values: Mapping[str, float]
    uncertain: tuple[str, ...] = ()
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    noise: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    t: float = 0.0
    past: PastErrors | None = None
    current_std: float | None = None
    structural: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        for name in ("psi", "u"):
            if name not in self.values:
                raise UsageError(f"a prediction begins from a heading and a speed, and nothing says '{name}'.")
        wrong = [n for n, v in self.values.items() if not np.isfinite(v)]
        if wrong:
            raise UsageError(f"a prediction begins from numbers, and '{wrong[0]}' is none.")
        if not self.values["u"] > 0:
            raise UsageError(
                f"a prediction runs along the distance sailed ahead, and at u = {brief(self.values['u'])} m/s the ship makes none."
            )
        if abs(self.values.get("v", 0.0)) > self.values["u"]:
            raise UsageError(
                f"a prediction runs along the distance sailed ahead, and at v = {brief(self.values['v'])} m/s beside u = "
                f"{brief(self.values['u'])} m/s the ship drifts by more than 45 degrees: state the speed ahead as u; of a trial, check "
                "that it is this ship's."
            )
        count = len(self.uncertain)
        if self.covariance.shape != (count, count) or not np.isfinite(self.covariance).all():
            raise UsageError(f"the covariance of {count} uncertain quantities has {count} rows and columns of numbers.")

    @property
    def current(self) -> tuple[float, float]:
        """Current to the north and to the east in m/s; zero where nothing is said."""
        return self.values.get("current_north", 0.0), self.values.get("current_east", 0.0)

    @property
    def ground_velocity(self) -> tuple[float, float]:
        """Velocity over the ground to the north and to the east in m/s: Passenier (1989), eq. (2.71)-(2.72)."""
        u, v, psi = self.values["u"], self.values.get("v", 0.0), self.values["psi"]
        north, east = self.current
        return float(u * np.cos(psi) - v * np.sin(psi) + north), float(u * np.sin(psi) + v * np.cos(psi) + east)

    def std_of(self, name: str) -> float:
        """Return the standard deviation of a quantity, SI; zero where it is taken as known.

        Parameters
        ----------
        name : str
            A key of `values`.
        """
        if name not in self.uncertain:
            return 0.0
        i = self.uncertain.index(name)
        return float(np.sqrt(max(self.covariance[i, i], 0.0)))

    def told_std(self, name: str) -> float:
        """Return the standard deviation that is told beside a quantity: of a current with the errors of model and log.

        Parameters
        ----------
        name : str
            A key of `values`.
        """
        if name in ("current_north", "current_east") and self.current_std is not None:
            return self.current_std
        return self.std_of(name)

    def told(self, name: str) -> tuple[str, str, str]:
        """Return a value, its standard deviation and its unit, as a terminal and a page print them.

        Parameters
        ----------
        name : str
            A key of `values`.

        Returns
        -------
        tuple of str
            The value to the second digit of its standard deviation, a heading in compass degrees; no standard deviation where the
            value is taken as known.
        """
        inside, value = _unit(name), self.values[name]
        std = float(to_display(self.told_std(name), name, inside))
        place = None if std <= 0 else max(0, last_place(std))
        unit = display_unit(name, inside)
        if name == "psi":
            said = compass(value) if place is None else compass(value, place)
        else:
            # Rounded first: of a current to the east, the sine leaves a rest to the north.
            shown = round(float(to_display(value, name, inside)), _DECIMALS)
            said = brief(shown, 4) if place is None else fixed(shown, place).replace("−", "-")
        return said, "" if place is None else fixed(std, place), "" if unit == "1" else pretty(unit)

    def told_in_words(self, name: str) -> str:
        """Return a value with its standard deviation and unit in one piece: ``"8.341 ± 0.042 m/s"``.

        Parameters
        ----------
        name : str
            A key of `values`.
        """
        value, std, unit = self.told(name)
        return f"{value}{f' ± {std}' if std else ''} {unit}".rstrip()

    def with_structure(self, growth: float) -> Situation:
        """Return the situation with a larger error of the model.

        Parameters
        ----------
        growth : float
            How many times as large as in `structural`.
        """
        more = {n: float(np.sqrt(self.noise[n] ** 2 + (growth**2 - 1) * d**2)) for n, d in self.structural.items()}
        return replace(
            self, noise={**self.noise, **more}, structural={n: growth * d for n, d in self.structural.items()}
        )

    def to_frame(self) -> pd.DataFrame:
        """Return the values with their standard deviations as a pandas table, SI."""
        rows = ({"name": n, "value": v, "std": self.told_std(n), "unit": _unit(n)} for n, v in self.values.items())
        return table(rows, "name")

    def text(self) -> str:
        """Return the situation in lines of text."""
        lines = [f"  {n:<16s} {self.told_in_words(n)}" for n in self.values]
        return "\n".join([f"situation at {moment(self.t)} s", *lines])


def situation_of(known: Situation | Mapping[str, str | float]) -> Situation:
    """Return a situation from itself or from values by name.

    Parameters
    ----------
    known : Situation or mapping of str to str or float
        What is known of the ship; values with a unit or in SI.

    Returns
    -------
    Situation

    Raises
    ------
    UsageError
        If it is neither, or a value is no number.
    UnitError
        If a unit does not fit.
    """
    if isinstance(known, Situation):
        return known
    if not isinstance(known, Mapping) or not all(isinstance(v, (str, int, float, np.number)) for v in known.values()):
        raise UsageError(
            "a prediction begins from a Situation, or from values by name: {'psi': '30 deg', 'u': '8 m/s'}."
        )
    return Situation({n: to_si(v, _unit(n), f"'{n}'") if isinstance(v, str) else float(v) for n, v in known.items()})


def _unit(name: str) -> str:
    return FIELDS[name].unit if name in FIELDS else ""
