"""Repairs: the working copy of an examination, written as a trial with every repair in its first lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import OverwriteError
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials import checks
from shipid.trials.doctor.check_trial import examine
from shipid.trials.doctor.findings import LEAST, Finding
from shipid.trials.doctor.guesses import from_trial, guessed
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.errors import TrialError
from shipid.trials.logs.conversion import unwrapped
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.reading import read_record
from shipid.trials.logs.record import same_row
from shipid.trials.logs.writing import write_trial
from shipid.trials.source import Source
from shipid.trials.trial import Trial


class NoSafeRepairError(TrialError):
    """A finding that would spoil an identification has no repair that is safe to apply."""


#: Samples that were not measured stay missing in what is written: there is nothing to repair, and nothing is lost.
_WRITTEN_AS_THEY_ARE = ("missing", "hole")


def fix_trial(
    trial: Trial | str | Path,
    path: str | Path,
    ship: ParameterSet | str | None = None,
    format: str | Path | TrialFormat | None = None,
) -> tuple[Path, tuple[Finding, ...]]:
    """Write a trial with the repairs the doctor proposes; every repair stands in the file's first lines.

    Parameters
    ----------
    trial : Trial, str or Path
        As for `check_trial`.
    path : str or Path
        The file to write; it must not exist.
    ship : ParameterSet or str, optional
        The ship.
    format : str, Path or TrialFormat, optional
        A trial format file.

    Returns
    -------
    path : Path
        The file written.
    repaired : tuple of Finding
        What was repaired.

    Raises
    ------
    NoSafeRepairError
        If a finding that would spoil an identification has no safe repair, or `shipid.read_trial` would refuse what comes of
        the repairs; nothing is written.
    OverwriteError
        If the file exists.
    """
    path = Path(path)
    if path.exists():
        raise OverwriteError(f"'{path}' exists already, and a repair never overwrites. Choose another name.")
    log = from_trial(trial) if isinstance(trial, Trial) else guessed(read_record(trial, format), treated=True)
    copy, _ = examine(log, ship)
    record, source = log.record, log.record.source
    stuck = [f for f in copy.findings if f.serious and not f.repaired and f.kind not in _WRITTEN_AS_THEY_ARE]
    if stuck:
        told = " ".join(f"{f.kind} ({f.channel}): {f.message}. {f.repair}" for f in stuck)
        raise NoSafeRepairError(
            f"'{source.path or record.name}' is not repaired, and '{path}' is not written: no safe repair is known for "
            f"{len(stuck)} finding{'s' * (len(stuck) > 1)}. {told}"
        )
    repaired = tuple(f for f in copy.findings if f.repaired)
    remaining = [f for f in copy.findings if not f.repaired and f.confidence >= LEAST]
    table = _table(copy)
    extra = [c for c in table if c not in FIELDS]
    _check_readable(table, path)
    fixed = Trial(record.title, table, Source(path=source.path), record.ship, {c: copy.unit(c) for c in extra})
    lines = ["Simulated; repaired by shipid check --fix"] if source.simulated else ["Repaired by shipid check --fix"]
    lines[0] += f" from {Path(source.path).name if source.path else record.name}"
    lines += [f"repaired: {f.kind} ({f.channel}), {f.in_rows}: {f.message}. {f.repair}" for f in repaired]
    lines += [f"remains: {f.kind} ({f.channel}): {f.message}" for f in remaining]
    lines += [f"rows: {len(record)} read, {len(table)} written", *(f"rows: {part}" for part in copy.left_out)]
    lines += source.comment.splitlines()
    return write_trial(fixed, path, comment="\n".join(lines)), repaired


def _check_readable(table: pd.DataFrame, path: Path) -> None:
    """Refuse to write a table that `shipid.read_trial` would refuse."""
    values = {name: table[name].to_numpy() for name in table}
    try:
        checks.check_length(len(table), "the repaired record")
        checks.check_clock(values["t"], "the repaired record", same_row)
        checks.check_angles(values, {c: FIELDS[c].display for c in table if c in FIELDS}, "the repaired record")
    except TrialError as error:
        raise NoSafeRepairError(f"'{path}' is not written, because read_trial would refuse it: {error}") from None


def _table(copy: WorkingCopy) -> pd.DataFrame:
    """Return the working copy as the table of a trial: what was not measured is missing, and nothing else is."""
    values = dict(copy.values)
    for name, missing in copy.missing.items():
        if name in values:
            values[name] = np.where(missing, np.nan, values[name])
    values |= copy.sparse
    if "psi" in values:
        values["psi"] = unwrapped(values["psi"])
    extra = [c for c in values if c not in FIELDS]
    order = ["t", *(c for c in FIELDS if c in values and c != "t"), *extra]
    return pd.DataFrame({c: np.ascontiguousarray(values[c], dtype=float) for c in order})
