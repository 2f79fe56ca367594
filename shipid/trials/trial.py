"""A trial: a table in SI units, and where it came from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from shipid.declaration import units as border
from shipid.declaration.vocabulary import FIELDS, display_unit
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError, nearest
from shipid.foundation.numbers import brief, moment
from shipid.foundation.result import DrawnResult
from shipid.trials import columns
from shipid.trials.errors import ColumnUnitError, UnknownColumnError, WindowError
from shipid.trials.filling import usual_interval
from shipid.trials.logs.frames import record_of_frame
from shipid.trials.logs.strict import sound_table
from shipid.trials.source import Source


@dataclass(frozen=True, eq=False, repr=False)
class Trial(DrawnResult):
    """A trial record, SI inside.

    Attributes
    ----------
    name : str
        The file's stem; a window adds ``@A:B``.
    table : pandas.DataFrame
        Column ``t`` (s, strictly increasing) and further float64 columns by canonical name, in the units of
        `shipid.trials.FIELDS`; heading unwrapped. NaN where a sample is missing: signals keep their own clocks.
    source : Source
        Where it came from and what was done to it.
    ship : str or None
        Name of the ship's parameter set, where the record says it.
    units : Mapping of str to str
        Units inside of the columns that are not in the vocabulary.
    """

    name: str
    table: pd.DataFrame
    source: Source = field(default_factory=Source)
    ship: str | None = None
    units: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_frame(
        cls,
        frame: pd.DataFrame | Mapping[str, ArrayLike],
        *,
        name: str = "trial",
        units: Mapping[str, str] | None = None,
        ship: str | None = None,
        source: Source | None = None,
    ) -> Trial:
        """Make a trial of a pandas table.

        Parameters
        ----------
        frame : pandas.DataFrame, or mapping of str to array_like, shape (samples,)
            One row a sample. Columns say their unit in the header (``psi [deg]``) or in `units`.
        name : str
            The trial's name.
        units : Mapping of str to str, optional
            Units by column name, for headers that say none.
        ship : str, optional
            Name of the ship's parameter set.
        source : Source, optional
            Where the table came from.

        Returns
        -------
        Trial

        Raises
        ------
        TrialError
            If a unit is missing or does not fit, or the record is not a sound one (`shipid.trials.checks`).
        UsageError
            If it is no table.
        """
        if isinstance(frame, Mapping):
            try:
                frame = pd.DataFrame(dict(frame))
            except ValueError as error:
                raise UsageError(f"trial '{name}' is no table: {str(error)[:1].lower()}{str(error)[1:]}.") from None
        if not isinstance(frame, pd.DataFrame):
            raise UsageError(
                f"trial '{name}' is made of a pandas.DataFrame, or of columns by name; this is a {type(frame).__name__}. "
                "shipid.read_trial reads a file."
            )
        sound = sound_table(record_of_frame(frame, name, units or {}, source))
        return cls(name, sound.table, sound.source, ship, sound.units)

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.table:
            raise UnknownColumnError(f"trial '{self.name}' has no column '{name}'. {nearest(name, self.table.columns)}")
        return np.asarray(self.table[name].to_numpy())

    def __contains__(self, name: object) -> bool:
        return name in self.table

    def __len__(self) -> int:
        return len(self.table)

    def text(self) -> str:
        """Return the result in lines of text."""
        t = self["t"]
        lines = [
            f"Trial '{self.name}'" + (f", ship {self.ship}" if self.ship else ""),
            f"  {len(self)} samples, {moment(t[0])} to {moment(t[-1])} s, every {brief(self.sampling, 4)} s",
        ]
        for column in self.table.columns[1:]:
            shown = display_unit(column, self.unit(column))
            values = self[column] / self._factor(column, shown)
            there = values[np.isfinite(values)]
            missing = f", {len(values) - len(there)} missing" if len(there) < len(values) else ""
            extent = (
                f"{there.min():11.4g} to {brief(there.max(), 4)} {border.pretty(shown)}"
                if len(there)
                else f"{'none':>11s}"
            )
            lines.append(f"  {column:<12s} {extent}{missing}")
        lines += [f"  note: {note}" for note in self.source.notes]
        return "\n".join(lines)

    def has(self, *names: str) -> bool:
        """Return whether the trial has all these columns.

        Parameters
        ----------
        *names : str
            Canonical names.
        """
        return all(name in self.table for name in names)

    @property
    def sampling(self) -> float:
        """Median sampling interval [s]: of the signal that is sampled most often, where they keep their own clocks."""
        t = self["t"]
        own = [usual_interval(t, self[name]) for name in self.table.columns if name != "t"]
        return float(np.nanmin([usual_interval(t), *own] if np.isnan(own).all() else own))

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        t = self["t"]
        return float(t[-1] - t[0])

    def unit(self, name: str) -> str:
        """Return the unit a column has inside the trial.

        Parameters
        ----------
        name : str
            A column of this trial.
        """
        self[name]
        return FIELDS[name].unit if name in FIELDS else self.units[name]

    def window(self, start: float | None, end: float | None) -> Trial:
        """Return a stretch of the trial; the clock keeps running as it was.

        Parameters
        ----------
        start, end : float or None
            Seconds of the trial's own clock, both ends included; None is the record's own end.

        Returns
        -------
        Trial
            Named ``stem@start:end``.

        Raises
        ------
        WindowError
            If the window lies outside the record, is empty, or runs backwards.
        """
        t = self["t"]
        a = float(t[0]) if start is None else float(start)
        b = float(t[-1]) if end is None else float(end)
        span = f"The record '{self.name}' runs from {moment(t[0])} to {moment(t[-1])} s."
        if not a < b:
            # As it was typed, where it is no number.
            first, last = (moment(x) if np.isfinite(x) else f"{x:g}" for x in (a, b))
            raise WindowError(
                f"the window {first}:{last} is empty or runs backwards. {span} Write start:end in seconds."
            )
        over = max(t[0] - a, b - t[-1])
        if over > 0 and (len(self) < 2 or over > 0.5 * self.sampling):
            raise WindowError(
                f"the window {moment(a)}:{moment(b)} s reaches outside the record. {span} Choose a window inside it."
            )
        tiny = 1e-9 * max(1.0, abs(a), abs(b))
        first, last = np.searchsorted(t, [a - tiny, b + tiny])
        if last - first < 2:
            raise WindowError(f"the window {moment(a)}:{moment(b)} s holds fewer than two samples. {span} Widen it.")
        stem = self.name.rpartition("@")[0] if _is_window(self.name) else self.name
        table = self.table.iloc[first:last].reset_index(drop=True)
        return replace(self, name=f"{stem}@{a:.10g}:{b:.10g}", table=table)

    def to_frame(self, units: Mapping[str, str] | str | None = None) -> pd.DataFrame:
        """Return the table with units in the headers, such as ``psi [deg]``.

        Parameters
        ----------
        units : Mapping of str to str, or "SI", optional
            Units by column name; columns not named get the unit a reader expects (deg, rpm). ``"SI"`` keeps
            everything as it is inside.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        UnknownColumnError
            If `units` names a column that is not there.
        ColumnUnitError
            If a unit does not fit its column.
        """
        chosen = {} if units is None or isinstance(units, str) else dict(units)
        if isinstance(units, str) and units != "SI":
            raise ColumnUnitError(f"units is '{units}'. Write 'SI', or a unit for each column as in {{'psi': 'deg'}}.")
        for name in chosen:
            self[name]
        result = {}
        for name in self.table.columns:
            inside = self.unit(name)
            shown = chosen.get(name, inside if units == "SI" else display_unit(name, inside))
            result[columns.header(name, shown)] = self[name] / self._factor(name, shown)
        return pd.DataFrame(result)

    def to_dict(self) -> dict[str, Plain]:
        """Return name, ship, source, units and the columns as plain lists (JSON-able: None where a sample is missing)."""
        return {
            "name": self.name,
            "ship": self.ship,
            "source": self.source.to_dict(),
            "units": {name: self.unit(name) for name in self.table.columns},
            "columns": {name: _plain(self[name]) for name in self.table.columns},
        }

    def _factor(self, name: str, shown: str) -> float:
        if name in FIELDS:
            return columns.to_inside(name, shown)
        return border.factor(columns.spelt(shown), self.units[name], f"column '{name}'")


def _plain(values: np.ndarray) -> list[float | None]:
    """Return samples as JSON can hold them: None where one is missing."""
    result: list[float | None] = np.where(np.isfinite(values), values, np.array(None)).tolist()
    return result


def _is_window(name: str) -> bool:
    """Whether the name ends in ``@A:B``, so that a window of a window is named after the file alone."""
    stem, at, window = name.rpartition("@")
    first, colon, second = window.partition(":")
    try:
        return bool(at and stem and colon and (float(first), float(second)))
    except ValueError:
        return False
