"""The estimate of one coefficient, as a filter, a recursion or a fit returns it."""

from __future__ import annotations

from dataclasses import dataclass

from shipid.declaration.model import Entry
from shipid.declaration.units import pretty
from shipid.estimation.standing import DETERMINED, Standing, standing_of
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import uncertain_text
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import interval_95, plain


@dataclass(frozen=True, repr=False)
class Estimate(ResultEntry):
    """One estimated coefficient.

    Attributes
    ----------
    name, unit, meaning : str
        The coefficient as declared; SI.
    value : float or None
        The estimate; None where it is not finite (a gain at the edge of course stability).
    std : float or None
        Standard deviation; None where the data give none.
    ci95 : tuple of float or None
        95 % confidence interval.
    standing : {"determined", "not distinguishable from zero", "not determined"}
        What the data say of it, by the rule of `shipid.estimation.standing`.
    why : str
        Why it is not determined; empty where it is.
    follows : bool
        Whether it is a published coefficient that follows from the estimated ones.
    prime : float or None
        Its value in the prime system (powers of L and U), or its dimensional value if it is declared without
        dimension; None where L or U is unknown.
    prime_unit : str
        Unit of `prime`.
    withheld : bool
        Whether its value is left out because the data hold nothing of it, and not because it is infinite.
    """

    name: str
    unit: str
    meaning: str
    value: float | None
    std: float | None
    ci95: tuple[float, float] | None
    standing: Standing
    why: str = ""
    follows: bool = False
    prime: float | None = None
    prime_unit: str = ""
    withheld: bool = False

    @property
    def identifiable(self) -> bool:
        """Whether the data determine it."""
        return self.standing == DETERMINED

    @property
    def lacks(self) -> str:
        """In words, why there is no value; empty where there is one."""
        if self.value is not None:
            return ""
        return "no value" if self.withheld else "runs to infinity"

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN."""
        other = "dimensional" if self.unit in ("", "1") else "normalised"
        return {
            "value": self.value,
            "unit": self.unit,
            "std": self.std,
            "interval_95": list(self.ci95) if self.ci95 else None,
            "identifiable": self.identifiable,
            "standing": self.standing,
            "why": self.why,
            "follows": self.follows,
            "meaning": self.meaning,
            other: self.prime,
            f"{other}_unit": self.prime_unit,
        }

    def __str__(self) -> str:
        value = uncertain_text(self.value, self.std)
        unit = "" if pretty(self.unit) == "1" else pretty(self.unit)
        doubt = f"   {self.standing}: {self.why}" if self.why else ""
        return f"{self.name:<12s}{value:>20s} {unit:<5s} {self.meaning}{doubt}"


def estimate_of(
    entry: Entry,
    value: float,
    std: float,
    *,
    ci95: tuple[float, float] | None = None,
    standing: tuple[Standing, str] | None = None,
    follows: bool = False,
) -> Estimate:
    """Return the estimate of a coefficient from numbers that may not be finite.

    Parameters
    ----------
    entry : Entry
        The coefficient in its model.
    value, std : float
        Estimate and standard deviation, SI.
    ci95 : tuple of float, optional
        The 95 % interval; that of a normal distribution unless it is given.
    standing : tuple of str, optional
        What the data say of it, and why; from the value and its standard deviation alone by default.
    follows : bool
        Whether it follows from the estimated coefficients.

    Returns
    -------
    Estimate
    """
    ends = tuple(plain(end) for end in ci95 or interval_95(value, std))
    return Estimate(
        entry.name,
        entry.unit,
        entry.quantity.meaning,
        plain(value),
        plain(std),
        (ends[0], ends[1]) if ends[0] is not None and ends[1] is not None else None,
        *(standing or standing_of(value, std)),
        follows,
    )
