"""Examine a trial: one examination after the other, and the diagnosis that comes of them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from shipid.parameters.catalogue import ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor import segmentation
from shipid.trials.doctor.examinations.motion import (
    clock_scale,
    course,
    heading,
    late_positions,
    over_ground,
    track,
    two_headings,
)
from shipid.trials.doctor.examinations.motion import rate_of_turn as rates
from shipid.trials.doctor.examinations.record import clock, frozen, missing, names, outliers, rows, sampling
from shipid.trials.doctor.examinations.steering import clipped, closed_loop, conduct, delay, standing
from shipid.trials.doctor.examinations.steering import rudder as steering
from shipid.trials.doctor.findings import LEAST, Diagnosis, Finding, Stretch
from shipid.trials.doctor.guesses import GuessedRecord, from_trial, guessed
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.errors import EmptyFileError, NoUnitError, TextInColumnError, UnknownColumnError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.reading import read_record
from shipid.trials.trial import Trial

#: In the order in which one fault would hide the next.
_EXAMINATIONS: tuple[Callable[[WorkingCopy], None], ...] = (
    clock.examine_clock,
    heading.examine_wrap,
    missing.examine_missing,
    two_headings.examine_two_headings,
    outliers.examine_outliers,
    sampling.examine_resampling,
    sampling.examine_resolution,
    rates.examine_label,
    rates.examine_rate,
    frozen.examine_frozen_rates,
    heading.examine_heading,
    heading.examine_heading_step,
    rates.examine_lag,
    course.examine_course,
    track.examine_track,
    late_positions.examine_late_positions,
    over_ground.examine_over_ground,
    frozen.examine_frozen,
    steering.examine_movement,
    closed_loop.examine_closed_loop,
    steering.examine_sign,
    steering.examine_order,
    standing.examine_standing_rudder,
    delay.examine_delay,
    clipped.examine_clipped,
    sampling.examine_sampling,
    sampling.examine_length,
    conduct.examine_start,
    clock_scale.examine_lone_clock,
)

#: Faults of a log that the findings or the notes about guesses speak of.
_EXAMINED = (NoUnitError, TextInColumnError, UnknownColumnError)


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
        The ship, for its length and speed; without it they are estimated from the record.
    format : str, Path or TrialFormat, optional
        A trial format file, or ``"nmea"`` for an NMEA 0183 log, as for `shipid.read_trial`.

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
    record = read_record(trial, format)
    copy, stretches = examine(guessed(record, treated=True), ship)
    handled: list[Finding] = []
    if record.format is not None and record.format.repairs:
        logged, _ = examine(guessed(record, treated=False), ship, conducted=False)
        # What is still there after the treatment is not handled; what the treatment settles is.
        left = {(f.kind, f.channel) for f in copy.findings}
        handled = [replace(f, handled=True) for f in logged.findings if (f.kind, f.channel) not in left and f.spoils]
    if record.format is not None and record.format.drop_trailing:
        copy.findings = [replace(f, handled=True) if f.kind == "trailing-empty" else f for f in copy.findings]
    return diagnose(copy, stretches, handled)


def examine(
    log: GuessedRecord, ship: ParameterSet | str | None = None, *, conducted: bool = True
) -> tuple[WorkingCopy, list[Stretch]]:
    """Examine a log.

    Parameters
    ----------
    log : GuessedRecord
        In SI units.
    ship : ParameterSet or str, optional
        The ship.
    conducted : bool
        Whether to look for manoeuvres and how they were carried out, too.

    Returns
    -------
    copy : WorkingCopy
        The findings, and a working copy with every fault put right that can be.
    stretches : list of Stretch
        The manoeuvres.

    Raises
    ------
    EmptyFileError
        If it holds no samples.
    """
    if not len(log.record):
        raise EmptyFileError(f"{log.record.where} holds no samples in this window. Choose another one.")
    copy = WorkingCopy(log.record, *_particulars(ship))
    _assumed_units(copy, log.assumed)
    names.examine_names(copy, log.names)
    names.examine_unread(copy, log.unread)
    rows.examine_marks(copy, log.marks)
    rows.examine_rows(copy)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fit through too few samples says so in its result
        for examination in _EXAMINATIONS:
            if len(copy) < 4 or copy.clockless:
                break
            try:
                examination(copy)
            except np.linalg.LinAlgError:
                # Numbers no matrix can hold: the other examinations go on, and the reader is told.
                copy.unexamined.append(examination.__name__.removeprefix("examine_").replace("_", " "))
        if not any(f.kind == "short" for f in copy.findings) and len(copy) < 30:
            sampling.examine_length(copy)
        if not conducted or copy.clockless or len(copy) < 4:
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

    Returns
    -------
    Diagnosis
    """
    findings: dict[tuple[str, str], Finding] = {}
    for f in sorted(copy.findings, key=lambda f: -f.confidence):
        if f.confidence >= LEAST:
            findings.setdefault((f.kind, f.channel), f)
    ordered = sorted(findings.values(), key=lambda f: (not f.serious, -f.confidence))
    record = copy.record
    refused = tuple(f"read_trial refuses the log: {f}" for f in record.faults if not isinstance(f, _EXAMINED))
    told = f"Not examined, for its numbers overflow: {', '.join(copy.unexamined)}."
    refused = (*refused, told) if copy.unexamined else refused
    return Diagnosis(
        record.title,
        (*ordered, *(handled or [])),
        tuple(stretches),
        (*record.notes, *refused, *copy.not_known),
        record.source.path,
        rows=len(record),
        left_out=tuple(copy.left_out),
    )


def _particulars(ship: ParameterSet | str | None) -> tuple[float | None, float | None]:
    known = ship_of(ship)
    return known.particular("L", "m"), known.particular("speed", "m/s")


def _assumed_units(p: WorkingCopy, assumed: Mapping[str, str | None]) -> None:
    for name, said in assumed.items():
        unit = p.record.stated[name]
        told = "no unit that fits" if said is None else f"the unit '{said}', which does not fit"
        # Numbers under another unit, as percent, are hardly those of the usual one.
        p.add(
            "unit", name, 0.9 if said is None else 0.8,
            f"the column says {told}; {unit} was assumed",
            "read_trial does not guess a unit and refuses the record: a wrong guess changes gains by factors of 57 or 1.94.",
            f"Write '{name} [{unit}]' in the header, or state the unit in a format file.",
            fix={"action": "assume-unit", "column": name, "unit": unit},
        )  # fmt: skip
