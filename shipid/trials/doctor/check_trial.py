"""The examination: which look follows which, and the diagnosis that comes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor import segmentation
from shipid.trials.doctor.examinations import clock, conduct, heading, sampling
from shipid.trials.doctor.examinations import rate_of_turn as rates
from shipid.trials.doctor.examinations import rudder as steering
from shipid.trials.doctor.examinations import samples as values
from shipid.trials.doctor.examinations import track as course
from shipid.trials.doctor.findings import Diagnosis, Finding, Stretch
from shipid.trials.doctor.record import Record, from_trial, has_repairs, read_record
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.format import TrialFormat, read_format
from shipid.trials.trial import Trial

#: In the order in which one fault would hide the next.
_EXAMINATIONS: tuple[Callable[[WorkingCopy], None], ...] = (
    values.examine_holes,
    clock.examine_clock,
    heading.examine_wrap,
    sampling.examine_resampling,
    sampling.examine_resolution,
    rates.examine_label,
    rates.examine_rate,
    values.examine_outliers,
    values.examine_frozen_rates,
    heading.examine_heading,
    rates.examine_lag,
    course.examine_track,
    values.examine_frozen,
    steering.examine_rudder,
    steering.examine_order,
    sampling.examine_sampling,
    sampling.examine_length,
    conduct.examine_start,
)


def check_trial(
    trial: Trial | str | Path,
    ship: ParameterSet | str | None = None,
    format: str | Path | TrialFormat | None = None,
) -> Diagnosis:
    """Examine a trial: what is wrong with it, what that does to an identification, what repairs it.

    A file is read leniently: records that `read_trial` refuses are explained. With a format file that repairs
    something, the record is examined as logged and as the format file leaves it; what the format file puts right is
    listed as handled.

    Parameters
    ----------
    trial : Trial, str or Path
        A trial, or a file (``FILE@A:B`` is a window of it).
    ship : ParameterSet or str, optional
        The ship, for its length and speed; without it they are judged from the record.
    format : str, Path or TrialFormat, optional
        A trial format file.

    Returns
    -------
    Diagnosis
        Findings and manoeuvres.

    Raises
    ------
    TrialError
        If the file cannot be read at all; the message names the line that stopped it.
    """
    if isinstance(trial, Trial):
        return diagnose(*examine(from_trial(trial), ship))
    fmt = format if isinstance(format, TrialFormat) or format is None else read_format(format)
    copy, stretches = examine(read_record(trial, fmt, treated=True), ship)
    handled: list[Finding] = []
    if has_repairs(fmt):
        logged, _ = examine(read_record(trial, fmt, treated=False), ship, conducted=False)
        # What is still there after the treatment is not handled; what the treatment settles is.
        left = {(f.kind, f.channel) for f in copy.findings}
        handled = [replace(f, handled=True) for f in logged.findings if (f.kind, f.channel) not in left and f.spoils]
    return diagnose(copy, stretches, handled)


def examine(
    record: Record, ship: ParameterSet | str | None = None, *, conducted: bool = True
) -> tuple[WorkingCopy, list[Stretch]]:
    """Examine a record.

    Parameters
    ----------
    record : Record
        As read.
    ship : ParameterSet or str, optional
        The ship.
    conducted : bool
        Whether to look for manoeuvres and how they were sailed, too.

    Returns
    -------
    copy : WorkingCopy
        The findings, and a working copy with every fault put right that can be.
    stretches : list of Stretch
        The manoeuvres.
    """
    if not len(record.values["t"]):
        raise EmptyFileError(f"'{record.path or record.name}' holds no samples in this window. Choose another one.")
    copy = WorkingCopy(record, *_particulars(ship))
    _no_unit(copy)
    with np.errstate(all="ignore"):
        for examination in _EXAMINATIONS:
            if len(copy) < 4:
                break
            examination(copy)
        if not any(f.kind == "short" for f in copy.findings) and len(copy) < 30:
            sampling.examine_length(copy)
        if not conducted:
            return copy, []
        stretches = segmentation.find_manoeuvres(copy)
        conduct.examine_neutral(copy, stretches)
    return copy, stretches


def diagnose(copy: WorkingCopy, stretches: list[Stretch], handled: list[Finding] | None = None) -> Diagnosis:
    """Put findings and manoeuvres together, each finding once.

    Parameters
    ----------
    copy : WorkingCopy
        The record, examined.
    stretches : list of Stretch
        Its manoeuvres.
    handled : list of Finding, optional
        What the format file has put right.
    """
    findings: dict[tuple[str, str], Finding] = {}
    for f in sorted(copy.findings, key=lambda f: -f.confidence):
        findings.setdefault((f.kind, f.channel), f)
    ordered = sorted(findings.values(), key=lambda f: (not f.serious, -f.confidence))
    return Diagnosis(
        copy.record.name, (*ordered, *(handled or [])), tuple(stretches), tuple(copy.record.notes),
        copy.record.path,
    )  # fmt: skip


def _particulars(ship: ParameterSet | str | None) -> tuple[float | None, float | None]:
    if ship is None:
        return None, None
    if isinstance(ship, str):
        from shipid.parameters.catalogue import find_ship

        ship = find_ship(ship)
    return ship.particular("L", "m"), ship.particular("speed", "m/s")


def _no_unit(p: WorkingCopy) -> None:
    for name in p.record.no_unit:
        p.add(
            "unit", name, 0.9, f"the column says no unit that fits; {p.record.stated[name]} was assumed",
            "shipid does not guess, and refuses the record: a wrong guess changes gains by factors of 57 or 1.94.",
            f"Write '{name} [{p.record.stated[name]}]' in the header, or state the unit in a format file.",
            fix={"action": "assume-unit", "column": name, "unit": p.record.stated[name]},
        )  # fmt: skip
