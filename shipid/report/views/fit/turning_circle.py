"""A turning circle measured in a trial, beside the one that the model predicts with the recorded rudder."""

from __future__ import annotations

from shipid.declaration.units import pretty
from shipid.foundation.numbers import fixed, number
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predicted_manoeuvre import PredictedManoeuvre
from shipid.report.page import Row

_SHOWN = ("advance", "transfer", "tactical_diameter", "steady_diameter", "steady_rate", "steady_speed")


def turn_rows(
    comparison: Comparison, speed: bool, length: float | None, manoeuvre: PredictedManoeuvre | None
) -> tuple[str, list[Row]]:
    """Return what the turning circle is called, and a row for each of its quantities; nothing for another manoeuvre.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    speed : bool
        Whether the model predicts the speed.
    length : float or None
        Ship length in m, for ratios.
    manoeuvre : PredictedManoeuvre or None
        The manoeuvre with its bands.
    """
    measured, predicted_circle = comparison.measures.circle, comparison.predicted_circle
    if measured is None:
        return "", []
    found = {n: (v, u, m) for n, v, u, m in measured.quantities()}
    foreseen = {n: v for n, v, _, _ in predicted_circle.quantities()} if predicted_circle is not None else {}
    rows: list[Row] = []
    for name in (n for base in _SHOWN for n in (base, f"{base}_ratio")):
        if name == "steady_speed" and not speed:
            continue  # the model reads the speed from the record, so it predicts none
        value, unit, meaning = found.get(name, (None, "", ""))
        predicted = _predicted(name, manoeuvre, length, foreseen.get(name))
        if value is None and predicted is None:
            continue
        words = name.removesuffix("_ratio").replace("_", " ").capitalize()
        rows.append(
            {
                "label": words + (" in ship lengths" if name.endswith("_ratio") else ""),
                "meaning": meaning,
                "unit": pretty(unit),
                "measured": _reached(value),
                "predicted": _reached(predicted),
                "difference": _percent(value, predicted),
                "band": _band(name, manoeuvre, length),
            }
        )
    return measured.title, rows


def _predicted(
    name: str, manoeuvre: PredictedManoeuvre | None, length: float | None, whole: float | None
) -> float | None:
    """The prediction that the band is about: of a trial kept apart from the order on, not from the beginning of the record."""
    base = name.removesuffix("_ratio")
    found = manoeuvre.turn.get(base) if manoeuvre else None
    if found is None or found.predicted is None:
        return whole
    return found.predicted / length if base != name and length else found.predicted


def _band(name: str, manoeuvre: PredictedManoeuvre | None, length: float | None) -> str:
    """The band of one quantity, in ship lengths where its name says so."""
    base = name.removesuffix("_ratio")
    found = manoeuvre.turn.get(base) if manoeuvre else None
    if found is None or found.band95 is None:
        return ""
    low, high = (b / length if name.endswith("_ratio") and length else b for b in found.band95)
    return f"{number(low, 3)} to {number(high, 3)}"


def _reached(value: float | None) -> str:
    return "not reached" if value is None else number(value, 3)


def _percent(value: float | None, predicted: float | None) -> str:
    return "" if not value or predicted is None else fixed(100 * (predicted - value) / abs(value), 0, sign=True) + " %"
