"""Measured values beside the limits of IMO MSC.137(76) 5.3, with what keeps a measurement from being compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from shipid.criteria.criteria import first_overshoot_limit, second_overshoot_limit
from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.trials.measuring.results.measures import Measures
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.results.zigzag import ZigZag

#: What a measured value is beside its limit.
Verdict = Literal["within", "beyond", "not decided", "no limit"]
#: The standard turns with this rudder angle or the largest there is; with less than the second a circle is another manoeuvre [deg].
_ASKED, _FULL = 35.0, 33.0


@dataclass(frozen=True, repr=False)
class MeasuredCriterion(Result):
    """One measured quantity beside its limit.

    Attributes
    ----------
    key, meaning, unit : str
        Name, meaning and unit of the quantity.
    manoeuvre : int
        Number of the manoeuvre on the sheet.
    value : float or None
        In `unit`; None where it was not reached or is not known.
    uncertainty : float or None
        Half of its 95 % interval; None where it is not known.
    limit : float or None
        None where the standard has none, or what it depends on is not known.
    limit_text : str
        The limit in words.
    verdict : {"within", "beyond", "not decided", "no limit"}
        ``"not decided"`` where the value or the limit is not known, where the limit lies inside the 95 % interval of the value,
        and where the manoeuvre is not the one of the standard.
    words : str
        Why it is not decided, or what has to be known beside the value.
    """

    key: str
    meaning: str
    unit: str
    manoeuvre: int
    value: float | None
    uncertainty: float | None
    limit: float | None
    limit_text: str
    verdict: Verdict
    words: str = ""

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        ends = (
            None
            if self.value is None or self.uncertainty is None
            else [self.value - self.uncertainty, self.value + self.uncertainty]
        )
        return {
            "quantity": self.key,
            "meaning": self.meaning,
            "manoeuvre": self.manoeuvre,
            "measured": {"value": self.value, "unit": self.unit, "interval_95": ends},
            "limit": {"value": self.limit, "unit": self.unit},
            "limit_text": self.limit_text,
            "verdict": self.verdict,
            "words": self.words,
        }


def measured_criteria(
    number: int, measures: Measures, length: float | None, largest: float | None = None
) -> Iterator[MeasuredCriterion]:
    """Yield the quantities of a manoeuvre for which MSC.137(76) 5.3 has a limit.

    Parameters
    ----------
    number : int
        Of the manoeuvre on the sheet.
    measures : Measures
        What it measures.
    length : float or None
        Ship length in m.
    largest : float or None
        Largest rudder angle of the ship in rad, where it is known.

    Yields
    ------
    MeasuredCriterion
    """
    if isinstance(measures, TurningCircle):
        yield from _turn(number, measures, length, largest)
    elif isinstance(measures, ZigZag) and measures.nominal in ("10/10", "20/20"):
        yield from _zigzag(number, measures, length)


def _turn(
    number: int, circle: TurningCircle, length: float | None, largest: float | None
) -> Iterator[MeasuredCriterion]:
    rudder = None if circle.rudder is None else abs(to_display(circle.rudder, "delta"))
    full = _FULL if largest is None else min(_FULL, _FULL / _ASKED * float(to_display(largest, "delta")))
    other = ""
    if rudder is not None and rudder < full:
        other = f"the standard turns with {_ASKED:g} deg of rudder or the largest permitted; this circle has {brief(rudder)} deg"
        if largest is None:
            other += ". If that is the largest, state largest_rudder in [trial], or name the ship"
    for name, limit in (("advance", 4.5), ("transfer", None), ("tactical_diameter", 5.0)):
        still = getattr(circle, f"{name}_still_water")
        value = getattr(circle, name) if still is None else still
        off = getattr(circle, f"{name}_uncertainty" if still is None else f"{name}_still_water_uncertainty")
        beside = "" if still is None else "the drift of the circle is taken off"
        if circle.track.startswith("speed"):
            beside = f"the track is from {circle.track}"
        yield _criterion(
            name,
            name.replace("_", " "),
            "L",
            number,
            None if value is None or length is None else value / length,
            None if off is None or length is None else off / length,
            limit,
            "none" if limit is None else f"{limit:g} L",
            "the ship length is not stated" if length is None else circle.reason(name) or "not reached",
            other if limit is not None else "",
            beside,
        )


def _zigzag(number: int, zigzag: ZigZag, length: float | None) -> Iterator[MeasuredCriterion]:
    speed = zigzag.approach_speed
    time = length / speed if length and speed else None
    unknown = "the ship length is not stated" if length is None else "the approach speed is not known"
    ten = zigzag.nominal == "10/10"
    if ten:
        ability, off = zigzag.initial_turning_ability, zigzag.initial_turning_ability_uncertainty
        yield _criterion(
            "initial_turning",
            "initial turning, 10 deg by 10 deg",
            "L",
            number,
            None if ability is None or length is None else ability / length,
            None if off is None or length is None else off / length,
            2.5,
            "2.5 L",
            "the ship length is not stated"
            if length is None
            else zigzag.reason("initial_turning_ability") or "the track is not known",
        )
    rules = (first_overshoot_limit, second_overshoot_limit) if ten else (None,)
    for k, rule in enumerate(rules):
        overshoot = _entry(zigzag.overshoots, k)
        margin = _entry(zigzag.overshoot_uncertainties, k)
        limit = 25.0 if rule is None else None if time is None else rule(time)
        text = (
            "25 deg"
            if rule is None
            else "by L/V: not known"
            if time is None
            else f"{brief(limit)} deg at L/V {brief(time)} s"
        )
        why = zigzag.reasons.get(f"overshoots[{k + 1}]", "not reached")
        yield _criterion(
            f"{'first' if k == 0 else 'second'}_overshoot_{10 if ten else 20}",
            f"{zigzag.nominal} {'first' if k == 0 else 'second'} overshoot",
            "deg",
            number,
            None if overshoot is None else float(to_display(overshoot, "psi")),
            None if margin is None else float(to_display(margin, "psi")),
            limit,
            text,
            why,
            f"{unknown}, and the limit depends on L/V" if limit is None else "",
        )


def _entry(values: tuple[float | None, ...] | None, k: int) -> float | None:
    return values[k] if values is not None and k < len(values) else None


def _criterion(
    key: str,
    meaning: str,
    unit: str,
    number: int,
    value: float | None,
    uncertainty: float | None,
    limit: float | None,
    limit_text: str,
    why: str,
    undecided: str = "",
    beside: str = "",
) -> MeasuredCriterion:
    """The verdict: only a value that is known, of the manoeuvre of the standard, and clear of its limit, has one."""
    verdict: Verdict
    words = beside
    if value is None:
        verdict, words = "not decided", why
    elif limit_text == "none":
        verdict = "no limit"
    elif undecided or limit is None:
        verdict, words = "not decided", undecided
    elif uncertainty is not None and abs(value - limit) <= uncertainty:
        verdict, words = "not decided", "the limit lies within the 95 % uncertainty of the value"
    else:
        verdict = "within" if value <= limit else "beyond"
    return MeasuredCriterion(key, meaning, unit, number, value, uncertainty, limit, limit_text, verdict, words)
