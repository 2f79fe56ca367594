"""The prime system: length L and speed U, and what they make of coefficients that are declared in it."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

from shipid.declaration.model import Entry
from shipid.declaration.units import pretty, unit
from shipid.foundation.errors import UnitError


@functools.cache
def prime_exponents(text: str) -> tuple[float, float]:
    """Return (a, b) such that ``L**a * (L/U)**b`` has the unit: the prime system of a coefficient.

    Parameters
    ----------
    text : str
        The unit.

    Raises
    ------
    UnitError
        If the unit is not made of lengths and times.
    """
    dimensions = dict(unit(text).dimensionality)
    length, time = float(dimensions.pop("[length]", 0)), float(dimensions.pop("[time]", 0))
    if dimensions:
        raise UnitError(f"{pretty(text)} is not made of lengths and times, so L and U do not scale it.")
    return length, time


@dataclass(frozen=True)
class Scale:
    """Length and speed of a ship; either may be unknown.

    Attributes
    ----------
    length : float or None
        L in m.
    speed : float or None
        U in m/s.
    """

    length: float | None
    speed: float | None

    @property
    def known(self) -> bool:
        """Whether both are known and greater than zero."""
        return bool(self.length and self.speed and self.length > 0 and self.speed > 0)

    @property
    def unit_time(self) -> float:
        """L/U in s, the time in which the ship sails its length; NaN where it is not known."""
        return self.length / self.speed if self.known and self.length and self.speed else math.nan

    def factor(self, text: str) -> float:
        """Return what one unit of the prime system is in a unit of lengths and times: 1/s gives U/L.

        Parameters
        ----------
        text : str
            The unit.

        Returns
        -------
        float
            NaN where the unit needs a scale that is not known.

        Raises
        ------
        UnitError
            If the unit is not made of lengths and times.
        """
        a, b = prime_exponents(text)
        if a == 0 and b == 0:
            return 1.0
        if not self.known or self.length is None:
            return math.nan
        return float(self.length**a * self.unit_time**b)

    def factor_of(self, entry: Entry) -> float:
        """Return the factor from the declared start and bounds of a coefficient to SI: 1 unless it is declared in the prime system.

        Parameters
        ----------
        entry : Entry
            The coefficient in its model.

        Returns
        -------
        float
            NaN where the scale is needed and not known.
        """
        return self.factor(entry.unit) if entry.quantity.prime else 1.0

    def start_of(self, entry: Entry) -> float | None:
        """Return the declared start of a coefficient in SI; None where it declares none, or the scale is needed and not known.

        Parameters
        ----------
        entry : Entry
            The coefficient in its model.
        """
        declared = entry.number("start")
        factor = self.factor_of(entry)
        return None if declared is None or math.isnan(factor) else declared * factor

    def bounds_of(self, entry: Entry) -> tuple[float, float]:
        """Return the declared bounds of a coefficient in SI; infinite where it declares none.

        Parameters
        ----------
        entry : Entry
            The coefficient in its model.

        Returns
        -------
        low, high : float
            A bound of zero needs no scale; another one whose scale is not known is infinite.
        """
        factor = self.factor_of(entry)

        def scaled(bound: float | None, absent: float) -> float:
            if bound is None:
                return absent
            if bound == 0:
                return 0.0
            return absent if math.isnan(factor) else bound * factor

        return scaled(entry.number("low"), -math.inf), scaled(entry.number("high"), math.inf)
