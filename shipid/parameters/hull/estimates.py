"""What a regression expects of a ship's linear derivatives, from her particulars alone: to lay beside a fit, and no part of it.

An identification takes no prior from here. `studies/hull_regressions.py` fits KVLCC2 and the Esso Osaka with these estimates as the
prior of q21, r21, q31 and r31, and predicts runs that were not fitted.

- `cross-flow` gains nothing, as its declaration already has spreads of these four from the same regression: over masses they hardly differ
  between hulls. From one 10/10 zig-zag of MARIN the tactical diameter at 35 degrees is off by 4 % as declared, by 7 % with the hull's own
  estimates, and by 12 % without any prior (rate of turn 7, 8 and 18 %); from both 20/20 by 8.2 % as declared and 8.9 %.
- `pershitz`, which declares none, gets better in one campaign and worse in three: overshoots from MARIN's 20/20 are off by 4.7 degrees in
  the place of 7.5, from her 10/10 by 7.4 in the place of 2.5, from HSVA's 20/10 by 4.1 in the place of 3.6, from the Esso Osaka's by 1.9
  in the place of 0.4. Its yaw has no drag, so that its linear coefficients stand for turns as large as those of the trials, and those of
  the regression for small motions: the prior contradicts the trials.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief, uncertain_text
from shipid.parameters.hull.regressions import PROPORTIONS, REGRESSIONS, SOURCE, ranges, scatter_of
from shipid.parameters.hull.tested_hulls import HullForm
from shipid.parameters.parameter_set import ParameterSet


@dataclass(frozen=True)
class HullEstimate:
    """A coefficient as the regression expects it.

    Attributes
    ----------
    value, std : float
        The expectation, and the scatter of single hulls about the regression; dimensionless.
    meaning : str
        What the coefficient is.
    """

    value: float
    std: float
    meaning: str

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {"value": self.value, "std": self.std, "meaning": self.meaning}


@dataclass(frozen=True)
class HullEstimates:
    """The estimates for a ship, or why there are none.

    Attributes
    ----------
    found : mapping of str to HullEstimate
        By coefficient.
    beyond : str
        Why the regression does not hold for the hull, as a sentence; empty where it does.
    missing : tuple of str
        Particulars that the regression reads and the ship does not state.
    """

    found: Mapping[str, HullEstimate] = field(default_factory=dict)
    beyond: str = ""
    missing: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, with source and range."""
        return {
            "source": SOURCE,
            "range": {n: list(span) for n, span in ranges().items()},
            "found": {n: e.to_dict() for n, e in self.found.items()},
            "beyond": self.beyond or None,
            "missing": list(self.missing),
        }

    def lines(self) -> list[str]:
        """Return them in lines of text, with source, scatter and range."""
        head = f"expected of the hull, not of trials ({SOURCE}):"
        if self.missing:
            return [f"{head} nothing, as the ship does not state {', '.join(self.missing)}"]
        if self.beyond:
            return [f"{head} nothing. {self.beyond}"]
        spans = ", ".join(f"{n} {brief(low, 2)} to {brief(high, 2)}" for n, (low, high) in ranges().items())
        lines = [f"  {n:<3}  {uncertain_text(e.value, e.std):<19}  {e.meaning}" for n, e in self.found.items()]
        return [head, *lines, f"  ± is the scatter of single hulls; the regression is used for {spans}"]


def hull_estimates(ship: ParameterSet) -> HullEstimates:
    """Return what the regression expects of a ship: nothing where she does not state a particular, or lies beyond its range.

    Parameters
    ----------
    ship : ParameterSet
        For L, B, T, and the block coefficient C_b or the volume of the displacement nabla.

    Returns
    -------
    HullEstimates
    """
    read = {n: ship.particular(n, "m") for n in ("L", "B", "T")}
    full, volume = ship.particular("C_b", "1"), ship.particular("nabla", "m^3")
    missing = [n for n, v in read.items() if v is None] + (["C_b or nabla"] if full is None and volume is None else [])
    if missing:
        return HullEstimates(missing=tuple(missing))
    length, beam, draught = (v or 0.0 for v in read.values())
    if min(length, beam, draught) <= 0:
        return HullEstimates(beyond=f"Length, beam and draught of ship {ship.name} are not all greater than zero.")
    form = HullForm(length, beam, draught, full if full is not None else (volume or 0.0) / (length * beam * draught))
    for name, (low, high) in ranges().items():
        value = PROPORTIONS[name](form)
        if not low <= value <= high:
            words = f"{name} of ship {ship.name} is {brief(value)}, and the regression is used from {brief(low)} to {brief(high)}."
            return HullEstimates(beyond=words)
    values = {n: one.estimate(form) for n, one in REGRESSIONS.items()}
    return HullEstimates(
        {n: HullEstimate(v, abs(v) * scatter_of(n), REGRESSIONS[n].meaning) for n, v in values.items()}
    )
