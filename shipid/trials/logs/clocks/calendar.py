"""From the three numbers of a date to days: which is the day and which the month, decided by what decides it, or not at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.logs.clocks.settings import DATE_ORDERS
from shipid.trials.logs.clocks.stamps import Stamps

_WORDS = {order: words for words, order in DATE_ORDERS.items()}
DAY = 86400.0


@dataclass(frozen=True, eq=False)
class Dates:
    """The days of a column of dates.

    Attributes
    ----------
    days : ndarray, shape (n,)
        Days since 1 January 1970; NaN where there is none.
    notes : tuple of str
        What decided between day and month, where the date itself does not say it; that nothing did.
    possible : tuple of str
        The orders that remain possible, as a format file states them; one, where it is decided.
    agree : bool
        Whether the seconds are the same in all of them.
    """

    days: np.ndarray
    notes: tuple[str, ...]
    possible: tuple[str, ...]
    agree: bool = True


def read_dates(stamps: Stamps, order: str | None, hint: str = "") -> Dates:
    """Decide which number of a date is the day and which the month.

    Parameters
    ----------
    stamps : Stamps
        The cells; they have dates.
    order : str or None
        The order that a format file states: ``ymd``, ``dmy`` or ``mdy``.
    hint : str
        The order that the header states, as in ``Date (dd/mm/yyyy)``.

    Returns
    -------
    Dates
    """
    has = np.isfinite(stamps.date).all(axis=1)
    if order is not None:
        return Dates(_days(stamps.date, order), (), (_WORDS[order],))
    candidates = {order: _days(stamps.date, order) for order in _orders(stamps)}
    wrong = {order: int((has & np.isnan(days)).sum()) for order, days in candidates.items()}
    # One garbled cell decides nothing.
    possible = [order for order, count in wrong.items() if count == min(wrong.values())]
    if len(_orders(stamps)) == 1:
        return Dates(candidates[possible[0]], (), (_WORDS[possible[0]],))
    if len(possible) == 1:
        shown = np.flatnonzero(has & np.any([np.isnan(candidates[o]) for o in candidates if o not in possible], axis=0))
        numbers = " ".join(f"{v:02.0f}" for v in stamps.date[shown[0]]) if shown.size else ""
        return _decided(candidates, possible[0], f"the numbers {numbers} show it")
    if hint in possible:
        return _decided(candidates, hint, "the header says it")
    if stamps.points and "dmy" in possible:
        return _decided(candidates, "dmy", "points stand between the numbers")
    seconds = {o: candidates[o] * DAY + stamps.time for o in possible}
    first = next(iter(seconds.values()))
    agree = all(np.array_equal(_elapsed(first), _elapsed(other), equal_nan=True) for other in seconds.values())
    if not agree:
        smooth = [o for o in possible if _runs_on(seconds[o])]
        if len(smooth) == 1:
            return _decided(candidates, smooth[0], "the clock runs on over midnight only so")
    words = tuple(_WORDS[o] for o in possible)
    note = (
        f"The dates can be read {' or '.join(words)}, and nothing decides which is right; the seconds are the same. State layout "
        f"= '{words[0]}' or '{words[1]}' in [clock] of a format file to know the day."
    )
    return Dates(candidates[possible[0]], (note,) if agree else (), words, agree)


def _decided(candidates: dict[str, np.ndarray], order: str, why: str) -> Dates:
    return Dates(candidates[order], (f"The dates are written {_WORDS[order]}: {why}.",), (_WORDS[order],))


def _orders(stamps: Stamps) -> tuple[str, ...]:
    """The orders that the way of writing leaves open."""
    if stamps.year == 0:
        return ("ymd",)
    if stamps.month is not None:
        return ("mdy",) if stamps.month == 0 else ("dmy",) if stamps.year == 2 else ("dmy", "ymd")
    return ("dmy", "mdy") if stamps.year == 2 else ("dmy", "mdy", "ymd")


def _days(date: np.ndarray, order: str) -> np.ndarray:
    """Days since 1 January 1970; NaN where the numbers are no day of the calendar in this order."""
    year, month, day = (date[:, order.index(part)] for part in "ymd")
    year = np.where(year < 70, year + 2000, np.where(year < 100, year + 1900, year))
    whole = np.isfinite(date).all(axis=1) & (year < 2500) & (year >= 1900) & (month >= 1) & (month <= 12) & (day >= 1)
    year, month = np.where(whole, year, 1970), np.where(whole, month, 1)
    months = ((year - 1970) * 12 + month - 1).astype(int)
    first, after = (m.astype("datetime64[M]").astype("datetime64[D]").astype(int) for m in (months, months + 1))
    return np.where(whole & (day <= after - first), first + np.nan_to_num(day) - 1, np.nan)


def _elapsed(seconds: np.ndarray) -> np.ndarray:
    known = seconds[np.isfinite(seconds)]
    return seconds - (known[0] if known.size else 0.0)


def _runs_on(seconds: np.ndarray) -> bool:
    """Whether a clock rises and never by a day or more."""
    step = np.diff(seconds[np.isfinite(seconds)])
    return bool(np.all((step >= 0) & (step < DAY)))
