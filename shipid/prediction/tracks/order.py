"""What a predicted manoeuvre is ordered: a heading, a rudder angle, or a rate of turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import compass, shown
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.result import ResultEntry


@dataclass(frozen=True, repr=False)
class Order(ResultEntry):
    """A heading, a rudder angle or a rate of turn; SI.

    Attributes
    ----------
    heading : float or None
        Heading to steer in rad; the shorter way round, to starboard where both are equal.
    rudder : float or None
        Rudder angle to hold in rad.
    rate : float or None
        Rate of turn to hold in rad/s; with a heading as well, the rate of the turn to it.
    rudder_limit : float or None
        Largest rudder angle in rad; the autopilot's own where nothing is said.
    """

    heading: float | None = None
    rudder: float | None = None
    rate: float | None = None
    rudder_limit: float | None = None

    def __post_init__(self) -> None:
        given = [n for n in ("heading", "rudder", "rate") if getattr(self, n) is not None]
        if given not in (["heading"], ["rudder"], ["rate"], ["heading", "rate"]):
            raise UsageError(
                "an order is a heading, a rudder angle, a rate of turn, or a heading with the rate of the turn to it"
                + (f"; not {' with a '.join(given)}." if given else ".")
            )
        if not all(np.isfinite(getattr(self, n)) for n in given):
            raise UsageError("an order is a number with a unit, as in heading='60 deg'.")
        if self.rudder_limit is not None and not self.rudder_limit > 0:
            raise UsageError("a rudder limit is greater than zero, as in rudder_limit='10 deg'.")
        if self.heading is not None and self.rate is not None and not self.rate > 0:
            raise UsageError("the rate of a turn to a heading is greater than zero; the heading says to which side.")

    def to_dict(self) -> dict[str, Plain]:
        """Return what is ordered."""
        units = {"heading": "rad", "rudder": "rad", "rate": "rad/s", "rudder_limit": "rad"}
        ordered = {n: getattr(self, n) for n in units}
        return {n: {"value": v, "unit": units[n]} for n, v in ordered.items() if v is not None}

    def __str__(self) -> str:
        parts = []
        if self.heading is not None:
            parts.append(f"heading {compass(self.heading)} deg")
        if self.rudder is not None:
            parts.append(f"rudder {shown(self.rudder, 'delta')}")
        if self.rate is not None:
            parts.append(f"rate of turn {shown(self.rate, 'r')}")
        if self.rudder_limit is not None:
            parts.append(f"rudder limit {shown(self.rudder_limit, 'delta')}")
        return ", ".join(parts)


def read_order(
    heading: str | float | None = None,
    rudder: str | float | None = None,
    rate: str | float | None = None,
    rudder_limit: str | float | None = None,
) -> Order:
    """Return an order from angles with units, or SI numbers.

    Parameters
    ----------
    heading, rudder, rate, rudder_limit : str or float, optional
        As in `Order`.

    Returns
    -------
    Order

    Raises
    ------
    UsageError
        If the combination is none of an order's.
    UnitError
        If a unit does not fit.
    """

    def number(value: str | float | None, unit: str, what: str) -> float | None:
        return to_si(value, unit, what) if isinstance(value, str) else value

    return Order(
        number(heading, "rad", "the heading"),
        number(rudder, "rad", "the rudder angle"),
        number(rate, "rad/s", "the rate of turn"),
        number(rudder_limit, "rad", "the rudder limit"),
    )


def unwrapped(heading: float, psi: float) -> float:
    """Return a heading to steer as it continues the ship's own: the shorter way round, to starboard where both are equal.

    Parameters
    ----------
    heading : float
        In rad, any turn of it.
    psi : float
        The ship's own in rad, unwrapped.
    """
    change = (heading - psi) % (2 * np.pi)
    # Half a turn to port that is half a turn only by rounding goes to starboard.
    return float(psi + (change if change <= np.pi + 1e-9 else change - 2 * np.pi))
