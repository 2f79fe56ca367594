"""Statistics over runs that are read one batch at a time: means, root mean squares, bands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.special import chdtri, gammaincinv, stdtrit

from shipid.campaign.campaign import Measure
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief, number
from shipid.foundation.result import Result
from shipid.foundation.statistics import NORMAL_95, plain

#: Different texts that are counted; with more, the rest is counted together.
_TEXTS = 200
_OTHER = "(other)"


@dataclass
class RunMoments:
    """Number, mean and sum of squared deviations of what has been added, for each place of a measure.

    Attributes
    ----------
    count, mean, squared : ndarray
        By place; a value that is not finite is missing.
    low, high : ndarray
        The smallest and the largest.
    """

    count: np.ndarray
    mean: np.ndarray
    squared: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @classmethod
    def nothing(cls, shape: tuple[int, ...]) -> RunMoments:
        """Return those of no runs.

        Parameters
        ----------
        shape : tuple of int
            Of one run.
        """
        return cls(np.zeros(shape), np.zeros(shape), np.zeros(shape), np.full(shape, np.inf), np.full(shape, -np.inf))

    def add(self, values: np.ndarray) -> None:
        """Add runs, by the pairwise update of Chan, Golub and LeVeque (1983).

        Parameters
        ----------
        values : ndarray, shape (runs, ...)
            Of a batch.
        """
        there = np.isfinite(values)
        count = there.sum(axis=0).astype(float)
        known = np.where(there, values, 0.0)
        mean = known.sum(axis=0) / np.maximum(count, 1)
        squared = np.where(there, (values - mean) ** 2, 0.0).sum(axis=0)
        total = self.count + count
        step = mean - self.mean
        weight = count / np.maximum(total, 1)
        self.squared = self.squared + squared + step**2 * self.count * weight
        self.mean = self.mean + step * weight
        self.count = total
        self.low = np.minimum(self.low, np.where(there, values, np.inf).min(axis=0))
        self.high = np.maximum(self.high, np.where(there, values, -np.inf).max(axis=0))

    @property
    def std(self) -> np.ndarray:
        """Standard deviation over runs; NaN for fewer than two."""
        return np.sqrt(np.where(self.count > 1, self.squared / np.maximum(self.count - 1, 1), np.nan))

    def band(self) -> np.ndarray:
        """Return the half width of the 95 % interval of the mean, by Student's distribution."""
        quantile = stdtrit(np.maximum(self.count - 1, 1), 0.975)
        return np.asarray(quantile * self.std / np.sqrt(np.maximum(self.count, 1)))


@dataclass
class MeasureTally:
    """The statistics of one measure, while batches are added.

    Attributes
    ----------
    measure : Measure
        What it is.
    overall, square : RunMoments
        Of a run's mean over its places, and of its mean square: runs are independent, places within one are not.
    places, place_squares : RunMoments or None
        By place, for a measure with several.
    texts : Counter
        Of a text.
    runs, missing : int
        Runs added, and those of them without a finite value.
    """

    measure: Measure
    overall: RunMoments
    square: RunMoments
    places: RunMoments | None
    place_squares: RunMoments | None
    texts: Counter[str]
    runs: int = 0
    missing: int = 0

    @classmethod
    def begin(cls, measure: Measure, first: np.ndarray) -> MeasureTally:
        """Return the tally of a measure before the first batch.

        Parameters
        ----------
        measure : Measure
            What it is.
        first : ndarray
            The first batch, for its shape.
        """
        shape = first.shape[1:]
        places, squares = (RunMoments.nothing(shape) if shape else None for _ in range(2))
        return cls(measure, RunMoments.nothing(()), RunMoments.nothing(()), places, squares, Counter())

    def add(self, rows: np.ndarray) -> None:
        """Add a batch.

        Parameters
        ----------
        rows : ndarray, shape (runs,) or (runs, k)
            Its values.
        """
        self.runs += len(rows)
        if self.measure.kind == "text":
            for text in rows:
                self.texts[str(text) if str(text) in self.texts or len(self.texts) < _TEXTS else _OTHER] += 1
            return
        flat = rows.reshape(len(rows), -1)
        there = np.isfinite(flat)
        count = np.where(there.any(axis=1), there.sum(axis=1), np.nan)
        known = np.where(there, flat, 0.0)
        self.missing += int(np.isnan(count).sum())
        self.overall.add(known.sum(axis=1) / count)
        self.square.add((known**2).sum(axis=1) / count)
        if self.places is not None and self.place_squares is not None:
            self.places.add(rows)
            self.place_squares.add(rows**2)

    def statistic(self, name: str) -> Statistic:
        """Return the statistics of what was added.

        Parameters
        ----------
        name : str
            Of the measure.
        """
        common = (name, self.measure, self.runs, self.missing)
        if self.measure.kind == "text":
            return Statistic(*common, texts=dict(self.texts.most_common()))
        step = 1.0 if self.places is None else 1.0 / max(self.places.count.size, 1)
        whole = _told(self.measure, self.overall, self.square, step)
        if self.places is None or self.place_squares is None:
            return Statistic(*common, **whole)
        whole.pop("expected_interval", None)  # the mean over scans that depend on each other has another spread
        return Statistic(*common, **whole, course=_told(self.measure, self.places, self.place_squares))


@dataclass(frozen=True, repr=False)
class Statistic(Result):
    """The statistics of one measure over the runs.

    Attributes
    ----------
    name : str
        Of the measure.
    measure : Measure
        What it is.
    runs, missing : int
        Runs, and those of them without a value.
    mean, std, low, high : float or None
        Over runs; of a run's mean where the measure has several places.
    mean_interval : tuple of float or None
        95 % interval of the mean; of the share of an event by Wilson (1927), of the mean of a count by Garwood (1936) and Fay and
        Feuer (1997), see `count_interval`.
    rmse : float or None
        Root mean square of an error.
    rmse_interval : tuple of float or None
        Its 95 % interval.
    expected_interval : tuple of float or None
        Where the mean of a consistent normalised squared error lies in 95 % of campaigns of this size.
    course : mapping or None
        The same by place, as arrays, for a measure with several.
    texts : mapping of str to int
        How often each text came.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"expected_interval": "1"}

    name: str
    measure: Measure
    runs: int
    missing: int
    mean: float | None = None
    std: float | None = None
    low: float | None = None
    high: float | None = None
    mean_interval: tuple[float, float] | None = None
    rmse: float | None = None
    rmse_interval: tuple[float, float] | None = None
    expected_interval: tuple[float, float] | None = None
    course: dict[str, Plain] | None = None
    texts: dict[str, int] | None = None

    @property
    def unit(self) -> str:
        """Unit of the numbers."""
        return self.measure.unit

    def told(self, factor: float = 1.0) -> tuple[str, str, str]:
        """Return standard deviation, smallest and largest value as they are printed: whole numbers without decimals.

        Parameters
        ----------
        factor : float
            Of the unit shown.
        """
        std, low, high = (None if v is None else v * factor for v in (self.std, self.low, self.high))
        return number(std, 2), brief(low), brief(high)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN."""
        unit = self.measure.unit
        told: dict[str, Plain] = {
            "kind": self.measure.kind, "meaning": self.measure.meaning, "runs": self.runs, "missing": self.missing,
        }  # fmt: skip
        if self.texts is not None:
            return told | {"counts": self.texts}
        told["mean"] = {
            "value": plain(self.mean), "std": plain(self.std), "unit": unit, "interval_95": _ends(self.mean_interval),
        }  # fmt: skip
        told["range"] = {"low": plain(self.low), "high": plain(self.high), "unit": unit}
        if self.measure.kind == "error":
            told["rmse"] = {"value": plain(self.rmse), "unit": unit, "interval_95": _ends(self.rmse_interval)}
        if self.measure.kind == "nees":
            told["degrees"] = self.measure.degrees
            told["expected_interval_95"] = _ends(self.expected_interval)
        if self.course is not None:
            told["course"] = {
                "unit": unit,
            } | {
                name: [_ends(pair) for pair in np.transpose(value)]
                if isinstance(value, tuple)
                else [plain(float(v)) for v in np.atleast_1d(value)]
                for name, value in self.course.items()
                if value is not None
            }
        return told


def _ends(pair: Plain) -> list[float | None] | None:
    return None if pair is None else [plain(float(e)) for e in pair]


def _told(measure: Measure, of: RunMoments, square: RunMoments, step: float = 1.0) -> dict[str, Plain]:
    """The statistics of a kind of measure: arrays by place, or numbers; one event more adds `step` to the value of a run."""
    half = of.band()
    known = of.count > 0
    mean = np.where(known, of.mean, np.nan)
    found: dict[str, Plain] = {
        "mean": mean,
        "std": of.std,
        "low": np.where(known, of.low, np.nan),
        "high": np.where(known, of.high, np.nan),
        "mean_interval": (mean - half, mean + half),
    }
    if measure.kind == "probability":
        found["mean_interval"] = (np.maximum(mean - half, 0.0), np.minimum(mean + half, 1.0))
    if measure.kind == "event":
        found["mean_interval"] = _wilson(mean, of.count)
    if measure.kind == "count":
        found["mean_interval"] = count_interval(mean, of.std, of.count, step)
    if measure.kind == "error":
        spread = square.band()
        found["rmse"] = np.sqrt(np.where(known, square.mean, np.nan))
        found["rmse_interval"] = (
            np.sqrt(np.maximum(square.mean - spread, 0.0)), np.sqrt(square.mean + spread),
        )  # fmt: skip
    if measure.kind == "nees":
        # The sum over N independent runs has N times the degrees of freedom; within a run the scans are not independent.
        freedom = measure.degrees * np.maximum(of.count, 1)
        found["expected_interval"] = tuple(chdtri(freedom, p) / np.maximum(of.count, 1) for p in (0.975, 0.025))
    if mean.ndim:
        return found
    return {
        name: tuple(float(v) for v in value) if isinstance(value, tuple) else float(value)
        for name, value in found.items()
    }


def count_interval(
    mean: np.ndarray, std: np.ndarray, runs: np.ndarray, step: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the 95 % interval of the mean of a count: never below zero, and above it where no run has an event.

    The gamma interval of Fay and Feuer (1997, Statistics in Medicine 16, 791-801) with equal weights. Where events come
    independently (Poisson) it is the exact one of Garwood (1936, Biometrika 28, 437-442). Events that come in clusters have a larger
    variance than mean: the weight is then their ratio as measured, widened as Student's distribution asks of so few runs. A
    smaller variance does not narrow it: few runs may look calm by chance. Where no run has an event nothing shows whether they come
    in clusters, and the interval is that of independent ones.

    Parameters
    ----------
    mean, std : ndarray
        Over runs, events a run.
    runs : ndarray
        Runs with a value.
    step : float
        What one event more adds to the value of a run: less than 1 where that is a mean over places.

    Returns
    -------
    tuple of ndarray
        Its ends; NaN for fewer than two runs, which do not show how the counts scatter.
    """
    wide = (stdtrit(np.maximum(runs - 1, 1), 0.975) / NORMAL_95) ** 2
    scattered = np.where(mean > 0, wide * std**2 / np.where(mean > 0, mean, 1.0), 0.0)
    weight = np.maximum(scattered, step) / np.maximum(runs, 1)
    events = mean / weight
    low = np.where(events > 0, gammaincinv(np.where(events > 0, events, 1.0), 0.025), 0.0)
    known = runs > 1
    return np.where(known, weight * low, np.nan), np.where(known, weight * gammaincinv(events + 1, 0.975), np.nan)


def _wilson(share: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    z = NORMAL_95**2 / np.maximum(count, 1)
    middle = (share + z / 2) / (1 + z)
    half = np.sqrt(z * share * (1 - share) + z**2 / 4) / (1 + z)
    return np.maximum(middle - half, 0.0), np.minimum(middle + half, 1.0)
