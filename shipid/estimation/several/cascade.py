"""Filters in series, each at its own rate: the estimates of one are inputs of those after it.

One filter of all states carries the covariance of each with each. Where two parts are hardly correlated (the position of a
ship and her yaw), two small filters do nearly as well: n (n + 1) / 2 elements each, after Passenier (1989), sections 5.2 and
5.4. The covariance of what an earlier filter estimates is lost on the way, unless it is passed on as noise of the input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.units import to_si
from shipid.estimation.design import FilterDesign
from shipid.estimation.errors import SensorRateError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.online.online_estimate import OnlineEstimate
from shipid.estimation.records.arrangement import FilterRecord, columns_of, read_every
from shipid.estimation.records.clock import filter_time
from shipid.estimation.records.run import FilterRun
from shipid.estimation.recursion import covariance_form
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.estimation.several.cascade_run import CascadeRun
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.result import Printed
from shipid.trials.filling import GAP, usual_interval


class Cascade(Printed):
    """Kalman filters in series.

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
    designs : mapping of str to FilterDesign
        What each filter is made of.
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
        self.designs: Mapping[str, FilterDesign] = {n: f.design for n, f in filters.items()}
        self.every = {}
        for name, value in (every or {}).items():
            if name not in self.filters:
                raise UnknownNameError("filter of the cascade called", name, self.filters)
            self.every[name] = to_si(value, "s", f"interval of '{name}'")
            if not self.every[name] > 0:
                raise SensorRateError(f"'{name}' is to run every {value}: an interval must be longer than zero.")
        self.passed: dict[str, dict[str, str]] = {}
        estimated: dict[str, str] = {}
        for name, design in self.designs.items():
            self.passed[name] = {i: estimated[i] for i in design.model.inputs if i in estimated}
            estimated |= dict.fromkeys([*design.model.states, *design.parameters], name)
        for i in uncertain:
            takers = [n for n, inputs in self.passed.items() if i in inputs]
            lacking = [n for n in takers if i not in {s.name for s in self.designs[n].sources if s.place == "input"}]
            if not takers or lacking:
                what = f"'{lacking[0]}', which has no noise on it" if lacking else "no filter"
                raise UsageError(
                    f"the uncertainty of '{i}' is to be passed on to {what}. Make the filter that reads it with "
                    f"noise={{'{i}': ...}} (any level: the estimate's own replaces it), or leave it out of uncertain."
                )
        self.uncertain = tuple(uncertain)

    @property
    def covariance_elements(self) -> int:
        """Number of covariance elements carried from sample to sample."""
        levels = {n: len(f.factors) if isinstance(f, AdaptiveFilter) else 1 for n, f in self.filters.items()}
        return sum(levels[n] * covariance_form.size(d.layout.joint) for n, d in self.designs.items())

    def __repr__(self) -> str:
        lines = []
        for name, kalman in self.filters.items():
            pace = f" every {self.every[name]:g} s" if name in self.every else ""
            takes = "".join(f", {i} from {s}" for i, s in self.passed[name].items())
            lines.append(f"{name}{pace}{takes}: {kalman!r}")
        return "<cascade>\n" + "\n".join(lines)

    def filter(
        self,
        record: FilterRecord,
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
        ahead, t = filter_time(columns["t"])
        columns = {n: np.asarray(c, dtype=float)[ahead] for n, c in columns.items()} | {"t": t}
        runs: dict[str, FilterRun] = {}
        for name, kalman in self.filters.items():
            rows = np.ones(t.size, dtype=bool)
            if name in self.every:
                rows = read_every(t, rows, self.every[name], name, title)
            taken = {n: c[rows] for n, c in columns.items()}
            factors = dict((scale or {}).get(name, {}))
            for i, source in self.passed[name].items():
                known = runs[source].t
                latest = np.searchsorted(known, taken["t"], side="right") - 1
                values, spread = runs[source].quantity(i)
                # Where the earlier filter has no estimates for long, this one has no input.
                longest = GAP * usual_interval(known) if known.size > 1 else np.inf
                there = (latest >= 0) & (taken["t"] - known[latest] <= longest)
                taken[i] = np.where(there, values[latest], np.nan)
                if i in self.uncertain:
                    factors[i] = spread[latest] / _level(self.designs[name], i) * factors.get(i, 1.0)
            runs[name] = kalman.filter(taken, scale=factors)
        return CascadeRun(title, runs)

    def start(self) -> OnlineCascade:
        """Return the cascade for samples that arrive one by one."""
        return OnlineCascade(self)


def _level(design: FilterDesign, name: str) -> float:
    return next(s.level for s in design.sources if s.name == name)


class OnlineCascade:
    """A cascade that takes one sample at a time; made by `Cascade.start`.

    Parameters
    ----------
    cascade : Cascade
        What it runs.

    Attributes
    ----------
    latest : dict of str to OnlineEstimate
        The estimate of each filter at the last sample it ran at.
    """

    def __init__(self, cascade: Cascade) -> None:
        self.cascade = cascade
        self.latest: dict[str, OnlineEstimate] = {}
        self._filters = {n: k.start() for n, k in cascade.filters.items()}
        self._began: float | None = None
        self._last = 0.0
        self._counts = dict.fromkeys(cascade.every, -1)

    def update(self, sample: Mapping[str, float]) -> dict[str, OnlineEstimate]:
        """Process a sample; every filter that is due runs.

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
                    factors[i] = self.latest[source].std_of(i) / _level(cascade.designs[name], i)
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
