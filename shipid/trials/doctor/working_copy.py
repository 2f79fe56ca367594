"""The working copy of a log, which every examination may put right, and what was found so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.aliases import Plain
from shipid.trials import columns
from shipid.trials.doctor.findings import Finding
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
        The working copy; repairs are applied to it, so that one fault does not hide the next.
    rows : ndarray of int, shape (n,)
        The sample of the record that each sample of the working copy comes from.
    findings : list of Finding
        So far.
    """

    record: LenientRecord
    length: float | None = None
    cruise: float | None = None
    values: dict[str, np.ndarray] = field(default_factory=dict)
    rows: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    findings: list[Finding] = field(default_factory=list)

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
        """Median sampling interval [s]."""
        return float(np.median(np.diff(self.t))) if len(self) > 1 else 1.0

    @property
    def rudder(self) -> str | None:
        """The column that says where the rudder is, or was ordered."""
        return next((c for c in ("delta", "delta_order") if c in self.values), None)

    def keep(self, mask: np.ndarray) -> None:
        """Keep some samples of the working copy, or put them in another order.

        Parameters
        ----------
        mask : ndarray
            Mask or indices.
        """
        self.values = {name: values[mask] for name, values in self.values.items()}
        self.rows = self.rows[mask]

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
    ) -> None:
        """Note a finding.

        Parameters
        ----------
        kind, channel, confidence, message, effect, repair, fix, spoils
            See `Finding`.
        at : ndarray of int, optional
            The samples of the working copy that are concerned; all by default.
        """
        index = np.arange(len(self)) if at is None or not len(at) else np.asarray(at)
        rows = self.rows[index]
        first, last = int(rows.min()), int(rows.max())
        clock = self.record.values["t"]
        seconds = (
            float(clock[first]) if np.isfinite(clock[first]) else float(first),
            float(clock[last]) if np.isfinite(clock[last]) else float(last),
        )
        self.findings.append(
            Finding(
                kind,
                channel,
                (first, last),
                seconds,
                len(index),
                float(confidence),
                effect,
                repair,
                message,
                fix,
                spoils,
            )
        )
