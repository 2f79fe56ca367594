"""Repairs: the working copy of an examination, written as a trial with every repair in its first lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import OverwriteError
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor.check_trial import examine
from shipid.trials.doctor.findings import Finding
from shipid.trials.doctor.record import from_trial, read_record
from shipid.trials.errors import TrialError
from shipid.trials.logs.format import TrialFormat, read_format
from shipid.trials.logs.writing import write_trial
from shipid.trials.source import Source
from shipid.trials.trial import Trial


class NoSafeRepairError(TrialError):
    """A finding that would spoil an identification has no repair that is safe to apply."""


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
        If a finding that would spoil an identification has no safe repair; nothing is written.
    OverwriteError
        If the file exists.
    """
    path = Path(path)
    if path.exists():
        raise OverwriteError(f"'{path}' exists already, and a repair never overwrites. Choose another name.")
    fmt = format if isinstance(format, TrialFormat) or format is None else read_format(format)
    record = from_trial(trial) if isinstance(trial, Trial) else read_record(trial, fmt, treated=True)
    patient, _ = examine(record, ship)
    stuck = [f for f in patient.findings if f.serious and f.fix is None]
    if stuck:
        told = " ".join(f"{f.kind} ({f.channel}): {f.message}. {f.repair}" for f in stuck)
        raise NoSafeRepairError(
            f"'{record.path or record.name}' is not repaired, and '{path}' is not written: no safe repair is known for "
            f"{len(stuck)} finding{'s' * (len(stuck) > 1)}. {told}"
        )
    repaired = tuple(f for f in patient.findings if f.fix is not None)
    remaining = [f for f in patient.findings if f.fix is None]
    if "psi" in patient.values:
        patient["psi"] = np.unwrap(patient["psi"])
    order = ["t", *(c for c in FIELDS if c in patient.values and c != "t")]
    order += [c for c in patient.values if c not in order]
    table = pd.DataFrame({c: np.ascontiguousarray(patient[c], dtype=float) for c in order})
    units = {c: record.extra[c] for c in order if c not in FIELDS}
    fixed = Trial(record.name, table, Source(path=record.path), record.ship, units)
    lines = ["Simulated; repaired by shipid check --fix"] if record.simulated else ["Repaired by shipid check --fix"]
    lines[0] += f" from {Path(record.path).name if record.path else record.name}"
    lines += [
        f"repaired: {f.kind} ({f.channel}), rows {f.rows[0]}-{f.rows[1]}: {f.message}. {f.repair}" for f in repaired
    ]
    lines += [f"remains: {f.kind} ({f.channel}): {f.message}" for f in remaining]
    lines += record.comment.splitlines()
    return write_trial(fixed, path, comment="\n".join(lines)), repaired
