"""The result of evaluating a model against IMO MSC.137(76): quantities beside their limits, to both sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import brief, fixed, number, quantity
from shipid.foundation.result import DrawnResult, Result, ResultEntry

if TYPE_CHECKING:
    import pandas as pd

WORDING = "evaluated against MSC.137(76) 5.3"
#: What the standard asks for and no model here can show.
NOT_COVERED = (
    "stopping, MSC.137(76) 5.3.4: a track of at most 15 L under full astern; the models have no reversing engine",
)
Band = tuple[float, float] | None


def first_overshoot_limit(unit_time: float) -> float:
    """Return the limit of the first overshoot of a 10/10 zig-zag in degrees, MSC.137(76) 5.3.3.1.

    Parameters
    ----------
    unit_time : float
        L/V in s.
    """
    return float(np.clip(5 + 0.5 * unit_time, 10.0, 20.0))


def second_overshoot_limit(unit_time: float) -> float:
    """Return the limit of the second overshoot of a 10/10 zig-zag in degrees, MSC.137(76) 5.3.3.2.

    Parameters
    ----------
    unit_time : float
        L/V in s.
    """
    return float(np.clip(17.5 + 0.75 * unit_time, 25.0, 40.0))


def loop_width_limit(unit_time: float) -> float:
    """Return a limit of the width of the spiral's loop in degrees.

    It is no criterion of MSC.137(76): 0 below L/V 9 s, then L/V/3 - 3, and 12 from 45 s on. The limit is ascribed to the ABS Guide
    for Vessel Maneuverability (March 2006). The guide exists, but its section was not at hand: the limit is not verified, and what
    prints it says so.

    Parameters
    ----------
    unit_time : float
        L/V in s.
    """
    return float(np.clip(unit_time / 3 - 3, 0.0, 12.0))


#: Water so many draughts deep is shallow to the standard (MSC/Circ.1053, 2.2).
DEEP = 4.0
#: Why a quantity with a value to both sides is not decided.
OPEN = "the limit lies inside the 95 % band"
#: Why a value has no band although there are draws.
NO_BAND = "no band: more than one draw in twenty does not reach it"
#: Digits behind the point, by the unit of a quantity: a log shows a tenth of a degree, and lengths are told to a hundredth.
_DECIMALS = {"deg": 1, "L": 2}


@dataclass(frozen=True, repr=False)
class CriterionSide(ResultEntry):
    """One quantity to one side.

    Attributes
    ----------
    value : float or None
        In the unit of its row; None where it was not reached.
    band95 : tuple of float or None
        95 % band from the uncertainty of the parameters; None where that is unknown.
    words : str
        Why there is no value.
    """

    value: float | None
    band95: Band
    words: str = ""


@dataclass(frozen=True, repr=False)
class Criterion(Result):
    """One quantity beside its limit.

    Attributes
    ----------
    key, meaning, unit : str
        Name, meaning and unit of the quantity.
    limit : float or None
        None where the standard has no limit.
    limit_text : str
        The limit as the standard writes it.
    starboard, port : CriterionSide
        With the first execute to either side.
    extrapolated : bool
        Whether the manoeuvre has more rudder than the trials that the coefficients come from.
    """

    key: str
    meaning: str
    unit: str
    limit: float | None
    limit_text: str
    starboard: CriterionSide
    port: CriterionSide
    extrapolated: bool = False

    @property
    def verdict(self) -> str:
        """The verdict in words: of an extrapolated value it says so."""
        if self.limit is None:
            return "no limit"
        said = {True: "within", False: "beyond", None: "not decided"}[self.within]
        return f"{said}, extrapolated" if self.extrapolated and self.within is not None else said

    def cell(self, side: CriterionSide) -> str:
        """Return the value to a side with its band, without the unit; why there is none where it has none.

        Parameters
        ----------
        side : CriterionSide
            One of the two.
        """
        if side.value is None:
            return side.words.partition(":")[0]
        return decimals(side.value, self.unit, side.band95)

    @property
    def within(self) -> bool | None:
        """Whether both sides are within the limit; None where there is none, a side was not reached, or it lies inside a band."""
        values = [side.value for side in (self.starboard, self.port) if side.value is not None]
        if self.limit is None or len(values) < 2:
            return None
        limit, bands = self.limit, [side.band95 for side in (self.starboard, self.port)]
        if any(value > limit and (band is None or band[0] > limit) for value, band in zip(values, bands)):
            return False
        return None if self.open else True

    @property
    def open(self) -> bool:
        """Whether the limit lies inside the 95 % band of a side: what is known of the ship does not decide it."""
        ends = [side.band95 for side in (self.starboard, self.port) if side.band95 is not None]
        return self.limit is not None and any(low <= self.limit <= high for low, high in ends)


@dataclass(frozen=True, repr=False)
class Criteria(DrawnResult):
    """A model evaluated against the standard.

    Attributes
    ----------
    model, ship : str
        Their names.
    length, speed, rudder : float
        L in m, V in m/s, rudder angle of the turning circle in rad.
    rows : tuple of Criterion
        The quantities.
    spiral : mapping or None
        ``stable``; ``half_width`` and ``loop_width`` of the loop with their bands, ``loop_height``; the ``limit`` of the width, whether
        it is ``within`` it and the ``words`` why that is not decided; None where the model has no spiral.
    notes : tuple of str
        Notes for the reader.
    """

    model: str
    ship: str
    length: float
    speed: float
    rudder: float
    rows: tuple[Criterion, ...]
    spiral: Mapping[str, Plain] | None
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values; None where something was not reached."""
        return {
            "standard": WORDING,
            "model": self.model,
            "ship": self.ship,
            "length": quantity(self.length, "m"),
            "speed": quantity(self.speed, "m/s"),
            "unit_time": quantity(self.length / self.speed, "s"),
            "rudder": quantity(round(to_display(self.rudder, "delta"), 6), "deg"),
            "criteria": {
                row.key: {
                    "meaning": row.meaning,
                    "unit": row.unit,
                    "limit": row.limit,
                    "limit_text": row.limit_text,
                    "within": row.within,
                    "extrapolated": row.extrapolated,
                    **{
                        name: _plain(side, row.unit)
                        for name, side in (("starboard", row.starboard), ("port", row.port))
                    },
                }
                for row in self.rows
            },
            "spiral": None if self.spiral is None else dict(self.spiral),
            "not_covered": list(NOT_COVERED),
            "warnings": plain_notices(self.notes),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return one row a quantity and side as a pandas table."""
        import pandas as pd

        rows = [
            {"quantity": row.key, "side": name, "value": side.value, "interval_95": side.band95}
            | {"unit": row.unit, "limit": row.limit, "words": side.words}
            for row in self.rows
            for name, side in (("starboard", row.starboard), ("port", row.port))
        ]
        return pd.DataFrame(rows).set_index(["quantity", "side"])

    def text(self) -> str:
        """Return the result in lines of text."""
        head = f"{self.model} of {self.ship}, {WORDING}: L {self.length:g} m, V {brief(self.speed)} m/s"
        lines = [
            f"{head}, L/V {brief(self.length / self.speed)} s",
            f"  {'':42s} {'starboard':>22s} {'port':>22s}   limit",
        ]
        for row in self.rows:
            cells = " ".join(f"{_short(row.cell(side)):>22s}" for side in (row.starboard, row.port))
            verdict = "" if row.limit is None else row.verdict.replace("beyond", "BEYOND")
            verdict += f": {OPEN}" if row.within is None and row.open else ""
            lines.append(
                f"  {row.meaning + f' [{row.unit}]':42s} {cells}   {row.limit_text or 'none':24s} {verdict}".rstrip()
            )
        lines.append("  spiral: " + spiral_words(self.spiral).replace(", beyond", ", BEYOND"))
        lines += [f"  not covered: {what}" for what in NOT_COVERED]
        return "\n".join([*lines, *(f"  {n}" for n in self.notes)])


def _plain(side: CriterionSide, unit: str) -> dict[str, Plain]:
    ends = None if side.band95 is None else list(side.band95)
    return {"value": side.value, "unit": unit, "interval_95": ends, "words": side.words}


def spiral_words(spiral: Mapping[str, Plain] | None) -> str:
    """Return what a spiral shows, in words: whether the ship is stable, her loop with its band, and its width beside the limit.

    Parameters
    ----------
    spiral : mapping or None
        See `Criteria`.
    """
    if spiral is None:
        return "not found, since no single rudder angle holds each rate of turn: the turn depends on the heading, or the rudder has a dead band"
    band, height = spiral["loop_width"]["interval_95"], spiral["loop_height"]["value"]
    words = "stable on a straight course" if spiral["stable"] else "unstable on a straight course"
    if spiral["loop_width"]["value"] == 0:
        words += ", no loop"
        if spiral["stable"] and (band is None or band[1] == 0):
            return words + (f"; {spiral['words']}" if spiral["words"] else "")
    else:
        words += f"; half width of the loop {decimals(spiral['half_width']['value'], 'deg')} deg"
        words += "" if height is None else f", height {number(height, 3)} deg/s"
    words += f"; width {decimals(spiral['loop_width']['value'], 'deg', band)} deg, {spiral['limit_text']}"
    if spiral["within"] is None and spiral["words"]:
        return f"{words}, not decided: {spiral['words']}"
    beside = f"; {spiral['words']}" if spiral["words"] else ""
    verdict = {True: ", within", False: ", beyond", None: ""}[spiral["within"]]
    return f"{words}{beside}{verdict}"


def decimals(value: float, unit: str, band: Sequence[float] | None = None) -> str:
    """Return a value of a criterion with the digits it is told in everywhere, and its band where it has one; an ASCII minus sign.

    Parameters
    ----------
    value : float
        In its unit.
    unit : str
        The unit, L or deg.
    band : sequence of float, optional
        Its ends. A narrow one has up to two decimals more, so that it is seen.
    """
    places = _DECIMALS[unit]
    if band is None:
        return fixed(value, places).replace("−", "-")
    if band[0] != band[1]:
        places = next((k for k in (places, places + 1) if fixed(band[0], k) != fixed(band[1], k)), places + 2)
    return f"{fixed(value, places)} ({fixed(band[0], places)} to {fixed(band[1], places)})".replace("−", "-")


def _short(cell: str) -> str:
    """A cell as wide as a column of the terminal."""
    return cell.removesuffix(" by this model")[:22] or "not reached"
