"""Filters in a row, each at its own rate: what one estimates is an input of those after it.

One filter for everything carries the covariance of everything with everything. Where one part hardly tells another anything
(the position of a ship says little of her yaw), two small filters do nearly as well: n (n + 1) / 2 elements each, after
Passenier (1989), sections 5.2 and 5.4. What an earlier filter knows of the error of its estimate is lost on the way, unless
it is passed on as noise of the input.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.declaration.units import to_si
from shipid.estimation.errors import SensorRateError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.arrangement import read_every
from shipid.estimation.records.clock import own_time
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.vectors import columns_of
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.estimation.online.online_filter import OnlineEstimate


class Cascade:
    """Filters in a row.

    Parameters
    ----------
    filters : mapping of str to ExtendedKalmanFilter or AdaptiveFilter
        In the order they run. An input of one that an earlier one estimates, as a state or a parameter, is that estimate;
        all others come from the record.
    every : mapping of str to str, optional
        Interval at which a filter runs, ``{"position": "2 s"}``; the others run at every sample.
    uncertain : sequence of str
        Inputs whose standard deviation, as the earlier filter has it, is the noise of the input in the later one. The error
        of an estimate lasts longer than a sample, and is counted as if it were new every time.

    Attributes
    ----------
    plain : mapping of str to ExtendedKalmanFilter
        The filters; of an adaptive one, the filter it is made of.
    passed : mapping of str to mapping of str to str
        For each filter, by input: the earlier filter it comes from.

    Raises
    ------
    UsageError
        If there is no filter, or an uncertain input is passed to no filter that has noise on it.
    UnknownNameError
        If an interval is given for a filter that is not there.
    """

    def __init__(
        self,
        filters: Mapping[str, ExtendedKalmanFilter | AdaptiveFilter],
        *,
        every: Mapping[str, str] | None = None,
        uncertain: Sequence[str] = (),
    ) -> None:
        if not filters:
            raise UsageError('a cascade needs at least one filter, as in Cascade({"yaw": yaw, "position": position}).')
        self.filters = dict(filters)
        self.plain = {n: f.kalman if isinstance(f, AdaptiveFilter) else f for n, f in filters.items()}
        self.every = {}
        for name, value in (every or {}).items():
            if name not in self.filters:
                raise UnknownNameError("filter of the cascade called", name, self.filters)
            self.every[name] = to_si(value, "s", f"interval of '{name}'")
            if not self.every[name] > 0:
                raise SensorRateError(f"'{name}' is to run every {value}: an interval is longer than zero.")
        self.passed: dict[str, dict[str, str]] = {}
        estimated: dict[str, str] = {}
        for name, kalman in self.plain.items():
            self.passed[name] = {i: estimated[i] for i in kalman.model.inputs if i in estimated}
            estimated |= dict.fromkeys([*kalman.model.states, *kalman.parameters], name)
        for i in uncertain:
            takers = [n for n, inputs in self.passed.items() if i in inputs]
            lacking = [n for n in takers if i not in {s.name for s in self.plain[n].sources if s.place == "input"}]
            if not takers or lacking:
                what = f"'{lacking[0]}', which has no noise on it" if lacking else "no filter"
                raise UsageError(
                    f"the uncertainty of '{i}' is to be passed on to {what}. Make the filter that reads it with "
                    f"noise={{'{i}': ...}} (any level: the estimate's own replaces it), or leave it out of uncertain."
                )
        self.uncertain = tuple(uncertain)

    @property
    def covariance_elements(self) -> int:
        """How many elements of covariances it carries from sample to sample."""
        levels = {n: len(f.factors) if isinstance(f, AdaptiveFilter) else 1 for n, f in self.filters.items()}
        return sum(levels[n] * k.layout.joint * (k.layout.joint + 1) // 2 for n, k in self.plain.items())

    def __repr__(self) -> str:
        lines = []
        for name, kalman in self.filters.items():
            pace = f" every {self.every[name]:g} s" if name in self.every else ""
            takes = "".join(f", {i} from {s}" for i, s in self.passed[name].items())
            lines.append(f"{name}{pace}{takes}: {kalman!r}")
        return "<cascade>\n" + "\n".join(lines)

    def filter(
        self,
        record: Trial | Mapping[str, np.ndarray],
        *,
        scale: Mapping[str, Mapping[str, np.ndarray | float]] | None = None,
    ) -> CascadeRun:
        """Filter a whole record.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            As for one filter.
        scale : mapping of str to mapping, optional
            By filter: factors on its noise, see `ExtendedKalmanFilter.filter`; arrays count the samples it runs at.

        Returns
        -------
        CascadeRun

        Raises
        ------
        SensorRateError
            If a filter is to run more often than the record is sampled.
        """
        columns, title = columns_of(record)
        ahead, t = own_time(columns["t"])
        columns = {n: np.asarray(c, dtype=float)[ahead] for n, c in columns.items()} | {"t": t}
        runs: dict[str, FilterRun] = {}
        for name, kalman in self.filters.items():
            rows = slice(None)
            if name in self.every:
                rows = read_every(t, np.ones(t.size, dtype=bool), self.every[name], name, title)  # type: ignore[assignment]
            taken = {n: c[rows] for n, c in columns.items()}
            factors = dict((scale or {}).get(name, {}))
            for i, source in self.passed[name].items():
                latest = np.searchsorted(runs[source].t, taken["t"], side="right") - 1
                values, spread = runs[source].quantity(i)
                taken[i] = values[latest]
                if i in self.uncertain:
                    factors[i] = spread[latest] / _level(self.plain[name], i) * factors.get(i, 1.0)
            runs[name] = kalman.filter(taken, scale=factors)
        return CascadeRun(self, title, runs)

    def start(self) -> OnlineCascade:
        """Return the cascade for samples that arrive one by one."""
        return OnlineCascade(self)


def _level(kalman: ExtendedKalmanFilter, name: str) -> float:
    return next(s.level for s in kalman.sources if s.name == name)


@dataclass(frozen=True, eq=False, repr=False)
class CascadeRun:
    """A record and what the filters of a cascade made of it.

    Attributes
    ----------
    cascade : Cascade
        Which filters.
    record : str
        Name of the record.
    runs : mapping of str to FilterRun
        By filter, each at its own samples.
    """

    cascade: Cascade
    record: str
    runs: Mapping[str, FilterRun]

    def __getitem__(self, name: str) -> FilterRun:
        """Return what one filter made of the record."""
        if name not in self.runs:
            raise UnknownNameError("filter of the cascade called", name, self.runs)
        return self.runs[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.runs)

    def to_frame(self) -> Any:
        """Return a pandas table at the samples of the first filter; estimates of the others stand until the next."""
        import pandas as pd

        frames = [run.to_frame() for run in self.runs.values()]
        whole = frames[0]
        for other in frames[1:]:
            new = other[["t [s]", *(c for c in other.columns if c not in whole.columns)]]
            whole = pd.merge_asof(whole, new, on="t [s]")
        return whole

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain values, free of NaN."""
        return {"record": self.record, "filters": {n: run.to_dict() for n, run in self.runs.items()}}

    def __repr__(self) -> str:
        return "\n".join(f"{n}: {run!r}" for n, run in self.runs.items())


class OnlineCascade:
    """A cascade that takes one sample at a time; made by `Cascade.start`.

    Parameters
    ----------
    cascade : Cascade
        What it runs.

    Attributes
    ----------
    latest : dict of str to OnlineEstimate
        What each filter made of the last sample it ran at.
    """

    def __init__(self, cascade: Cascade) -> None:
        self.cascade = cascade
        self.latest: dict[str, OnlineEstimate] = {}
        self._filters = {n: k.start() for n, k in cascade.filters.items()}
        self._began: float | None = None
        self._last = 0.0
        self._counts = dict.fromkeys(cascade.every, -1)

    def update(self, sample: Mapping[str, float]) -> dict[str, OnlineEstimate]:
        """Take in a sample; every filter whose turn it is runs.

        Parameters
        ----------
        sample : mapping of str to float
            ``t`` in s and, SI, what there is of sensors and inputs.

        Returns
        -------
        dict of str to OnlineEstimate
            Of those that ran.
        """
        cascade, ran = self.cascade, {}
        t = float(sample.get("t", np.nan))
        for name, online in self._filters.items():
            if not self._due(name, t):
                continue
            taken, factors = dict(sample), {}
            for i, source in cascade.passed[name].items():
                taken[i] = self.latest[source][i]
                if i in cascade.uncertain:
                    factors[i] = self.latest[source].std_of(i) / _level(cascade.plain[name], i)
            self.latest[name] = ran[name] = online.update(taken, scale=factors)
        if np.isfinite(t) and (self._began is None or t > self._last):
            self._began, self._last = (t if self._began is None else self._began), t
        return ran

    def _due(self, name: str, t: float) -> bool:
        """Whether a filter runs at a sample; the first of each interval, with half a sample of slack as in a record."""
        seconds = self.cascade.every.get(name)
        if seconds is None or not np.isfinite(t):
            return True
        if self._began is None:
            number = 0
        elif t <= self._last:
            return False
        else:
            number = int((t - self._began + 0.5 * (t - self._last)) // seconds)
        if number <= self._counts[name]:
            return False
        self._counts[name] = number
        return True
