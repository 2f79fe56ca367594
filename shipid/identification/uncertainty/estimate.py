"""One estimated coefficient: value, uncertainty, and whether the trials determine it."""

from __future__ import annotations

from dataclasses import dataclass

from shipid.foundation.aliases import Plain


@dataclass(frozen=True)
class Estimate:
    """One estimated coefficient.

    Attributes
    ----------
    name, unit, meaning : str
        The coefficient as declared; SI.
    value : float or None
        The estimate; None where it runs to infinity (a gain at the edge of course stability).
    std : float or None
        Standard deviation; None where the data give none.
    ci95 : tuple of float or None
        95 % confidence interval.
    identifiable : bool
        Whether the trials determine it.
    why : str
        If not, why not.
    follows : bool
        Whether it is a published coefficient that follows from the fitted ones.
    prime : float or None
        Its value in the prime system (powers of L and U), or its dimensional value if it is declared without
        dimension; None where L or U is unknown.
    prime_unit : str
        Unit of `prime`.
    """

    name: str
    unit: str
    meaning: str
    value: float | None
    std: float | None
    ci95: tuple[float, float] | None
    identifiable: bool
    why: str = ""
    follows: bool = False
    prime: float | None = None
    prime_unit: str = ""

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN."""
        return {
            "value": self.value,
            "unit": self.unit,
            "std": self.std,
            "ci95": list(self.ci95) if self.ci95 else None,
            "identifiable": self.identifiable,
            "why": self.why,
            "follows": self.follows,
            "meaning": self.meaning,
            "normalised" if self.unit not in ("", "1") else "dimensional": self.prime,
            "normalised_unit" if self.unit not in ("", "1") else "dimensional_unit": self.prime_unit,
        }
