"""The working copy of a log, which every examination may put right, and what was found so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.aliases import Plain
from shipid.trials import columns
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.findings import CERTAIN, MOST_SPANS, Finding, LeftOut
from shipid.trials.filling import GAP
from shipid.trials.logs.record import LenientRecord


@dataclass
class WorkingCopy:
    """A record under examination.

    Attributes
    ----------
    record : LenientRecord
        As logged, in SI units.
    length, cruise : float or None
        Ship length [m] and cruising speed [m/s], where the ship is known.
    values : dict of str to ndarray
        The working copy; repairs are applied to it, so that one fault does not hide the next. From `bridge` on every channel
        has a number at every stamp: a missing sample is interpolated in time, for comparisons that integrate.
    missing : dict of str to ndarray of bool
        Which of these numbers were not measured.
    rows : ndarray of int, shape (n,)
        The sample of the record that each sample of the working copy comes from.
    findings : list of Finding
        So far.
    left_out : list of LeftOut
        Rows that are not part of the working copy.
    sparse : dict of str to ndarray
        Channels of so few samples that nothing can be said about them; a repair writes them as they were.
    clockless : bool
        Whether no time is known at all, so that nothing can be said about rates.
    unexamined : list of str
        Examinations that the numbers of the record did not allow.
    not_known : list of str
        What nothing in the record can tell, in sentences.
    """

    record: LenientRecord
    length: float | None = None
    cruise: float | None = None
    values: dict[str, np.ndarray] = field(default_factory=dict)
    missing: dict[str, np.ndarray] = field(default_factory=dict)
    rows: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    findings: list[Finding] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    sparse: dict[str, np.ndarray] = field(default_factory=dict)
    clockless: bool = False
    unexamined: list[str] = field(default_factory=list)
    not_known: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.values = {name: values.copy() for name, values in self.record.values.items()}
        self.rows = np.arange(len(self.values["t"]))

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    def __setitem__(self, name: str, values: np.ndarray) -> None:
        self.values[name] = values

    def __len__(self) -> int:
        return len(self.rows)

    def has(self, *names: str) -> bool:
        """Return whether the record has all these columns.

        Parameters
        ----------
        *names : str
            Canonical names.
        """
        return all(name in self.values for name in names)

    def unit(self, name: str) -> str:
        """Return the unit a column has inside a trial.

        Parameters
        ----------
        name : str
            The column.
        """
        return FIELDS[name].unit if name in FIELDS else columns.inside_unit(name, self.record.stated[name])

    @property
    def t(self) -> np.ndarray:
        """Time [s] of the working copy."""
        return self.values["t"]

    @property
    def sampling(self) -> float:
        """Median sampling interval of the clock [s]."""
        return _usual_interval(self.t) or 1.0

    @property
    def rudder(self) -> str | None:
        """The column that says where the rudder is, or was ordered."""
        return next((c for c in ("delta", "delta_order") if c in self.values), None)

    @property
    def speed(self) -> np.ndarray | None:
        """Speed of the ship [m/s], shape (n,), of the columns that say it; None where none does."""
        if self.has("U"):
            return self["U"]
        if self.has("u"):
            return np.hypot(self["u"], self["v"]) if self.has("v") else self["u"]
        return None

    def own(self, name: str) -> np.ndarray:
        """Return the indices of the samples that a channel itself has.

        Parameters
        ----------
        name : str
            The column.

        Returns
        -------
        ndarray of int, shape (m,)
        """
        missing = self.missing.get(name)
        return np.arange(len(self)) if missing is None else np.flatnonzero(~missing)

    def measured(self, name: str) -> np.ndarray:
        """Return the samples of a channel on its own clock.

        Parameters
        ----------
        name : str
            The column.

        Returns
        -------
        ndarray, shape (m,)
        """
        samples: np.ndarray = self.values[name][self.own(name)]
        return samples

    def interval(self, name: str) -> float:
        """Return the usual interval between the samples of a channel [s].

        Parameters
        ----------
        name : str
            The column.
        """
        return _usual_interval(self.t[self.own(name)]) or self.sampling

    def noise(self, name: str) -> float:
        """Return the standard deviation of the white noise of a channel, on its own clock.

        Parameters
        ----------
        name : str
            The column.
        """
        return robust.noise(self.measured(name))

    def blind(self, *names: str) -> np.ndarray:
        """Return where any of some channels is unknown: inside a hole, before its first and behind its last sample.

        Parameters
        ----------
        *names : str
            Columns; what is not in the record is not asked for.

        Returns
        -------
        ndarray of bool, shape (n,)
            An interval up to `GAP` usual ones of the channel is no hole.
        """
        result = np.zeros(len(self), dtype=bool)
        for name in names:
            if name not in self.missing or not self.missing[name].any():
                continue
            index = self.own(name)
            times, longest = self.t[index], GAP * self.interval(name)
            result[: index[0]] = True
            result[index[-1] + 1 :] = True
            for k in np.flatnonzero(np.diff(times) > longest):
                result[index[k] + 1 : index[k + 1]] = True
        return result

    def bridge(self) -> None:
        """Give every channel a number at every stamp, interpolated in time where its own sample is missing."""
        for name in list(self.values):
            if name != "t":
                self.void(name, ~np.isfinite(self.values[name]))

    def void(self, name: str, mask: np.ndarray) -> None:
        """Count samples of a channel as missing.

        Parameters
        ----------
        name : str
            The column.
        mask : ndarray of bool, shape (n,)
            The samples.
        """
        missing = mask | self.missing[name] if name in self.missing else mask.copy()
        self.missing[name] = missing
        if missing.any() and not missing.all():
            there = ~missing
            self.values[name] = np.where(
                missing, np.interp(self.t, self.t[there], self.values[name][there]), self.values[name]
            )

    def shift(self, name: str, late: float) -> None:
        """Move a channel to the time at which it was measured.

        Parameters
        ----------
        name : str
            The column.
        late : float
            How late its samples are stamped [s]; negative where they are early.
        """
        t, missing = self.t, self.missing.get(name, np.zeros(len(self), dtype=bool))
        at = t + late
        outside = (at < t[0]) | (at > t[-1])
        self.values[name] = np.interp(at, t, self.values[name])
        self.missing[name] = outside | (np.interp(at, t, missing.astype(float)) > 0.5)

    def exchange(self, one: str, other: str) -> None:
        """Exchange the names of two columns; a name that is not there is given.

        Parameters
        ----------
        one, other : str
            The names; `one` is there.
        """
        for table in (self.values, self.missing):
            first, second = table.pop(one, None), table.pop(other, None)
            if first is not None:
                table[other] = first
            if second is not None:
                table[one] = second

    def keep(self, mask: np.ndarray, why: str = "") -> None:
        """Keep some samples of the working copy, or put them in another order.

        Parameters
        ----------
        mask : ndarray
            Mask or indices.
        why : str
            Why the others are left out, for the reader.
        """
        before = len(self)
        self.values = {name: values[mask] for name, values in self.values.items()}
        self.missing = {name: values[mask] for name, values in self.missing.items()}
        self.sparse = {name: values[mask] for name, values in self.sparse.items()}
        self.rows = self.rows[mask]
        if len(self) < before:
            self.left_out.append(LeftOut(before - len(self), why))

    def found(self, kind: str) -> bool:
        """Return whether a kind was found with some confidence.

        Parameters
        ----------
        kind : str
            The kind.
        """
        return any(f.kind == kind and f.confidence >= 0.5 for f in self.findings)

    def add(
        self,
        kind: str,
        channel: str,
        confidence: float,
        message: str,
        effect: str,
        repair: str,
        *,
        at: np.ndarray | None = None,
        fix: Mapping[str, Plain] | None = None,
        spoils: bool = True,
    ) -> bool:
        """Note a finding.

        Parameters
        ----------
        kind, channel, confidence, message, effect, repair, fix, spoils
            See `Finding`.
        at : ndarray of int, optional
            The samples of the working copy that are concerned; all by default.

        Returns
        -------
        bool
            Whether the repair is certain enough to apply it to the working copy.
        """
        confidence = float(confidence) if np.isfinite(confidence) else 0.0
        index = np.arange(len(self)) if at is None or not len(at) else np.unique(np.asarray(at))
        rows = self.rows[index]
        first, last = int(rows.min()), int(rows.max())
        if fix is not None and not all(np.isfinite(v) for v in fix.values() if isinstance(v, float)):
            fix = None
        self.findings.append(
            Finding(
                kind,
                channel,
                (first, last),
                (self._when(first), self._when(last)),
                len(index),
                confidence,
                effect,
                repair,
                message,
                fix,
                bool(spoils),
                spans=self._spans(rows),
            )
        )
        return fix is not None and confidence >= CERTAIN

    def _when(self, row: int) -> float:
        """Stamp of a row of the record [s]; the number of the row where it has none."""
        stamp = float(self.record.values["t"][row])
        return stamp if np.isfinite(stamp) else float(row)

    def _spans(self, rows: np.ndarray) -> tuple[tuple[float, float], ...]:
        """Spans of time of the rows concerned, joined over the smallest breaks where they are many."""
        rows = np.sort(rows)
        breaks = np.flatnonzero(np.diff(rows) > 1)
        if len(breaks) >= MOST_SPANS:
            widest = np.argsort(np.diff(rows)[breaks])[-(MOST_SPANS - 1) :]
            breaks = np.sort(breaks[widest])
        first, last = rows[np.r_[0, breaks + 1]], rows[np.r_[breaks, len(rows) - 1]]
        ends = [sorted((self._when(int(a)), self._when(int(b)))) for a, b in zip(first, last)]
        return tuple((a, b) for a, b in ends)


def _usual_interval(times: np.ndarray) -> float:
    """Median interval; that of the steps forward where a clock jumps and repeats, and zero where there are none [s]."""
    steps = np.diff(times)
    forward = steps[steps > 0]
    if not forward.size:
        return 0.0
    return max(float(np.median(steps)), 0.0) or float(np.median(forward))
