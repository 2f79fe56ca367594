"""Samples as they arrive: one line in, one line of estimates out."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from shipid.cli.delivery import json_text
from shipid.cli.messages import say

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.foundation.aliases import Plain
    from shipid.parameters.parameter_set import ParameterSet

#: How often a file that has come to its end is looked at again, in s.
_LOOK_AGAIN = 0.05


def lines_of(source: str, wait: float) -> Iterator[str]:
    """Read lines as they are written.

    Parameters
    ----------
    source : str
        A file, or ``-`` for standard input, which ends when it is closed.
    wait : float
        Seconds without a new line after which a file is taken to have ended.

    Yields
    ------
    str
        A line.

    Raises
    ------
    MissingFileError
        If there is no such file.
    """
    from shipid.foundation.errors import MissingFileError

    if source == "-":
        yield from sys.stdin
        return
    path = Path(source)
    if not path.is_file():
        raise MissingFileError(f"there is no file {source} to follow.")
    with path.open(encoding="utf-8", errors="replace") as stream:
        quiet, part = 0.0, ""
        while quiet < wait:
            line = stream.readline()
            if line.endswith("\n"):
                yield part + line
                quiet, part = 0.0, ""
                continue
            # A line that is still being written is finished by what comes next.
            part += line
            time.sleep(_LOOK_AGAIN)
            quiet = 0.0 if line else quiet + _LOOK_AGAIN
        if part.strip():
            yield part


def follow(
    source: str,
    model: Model,
    ship: ParameterSet | None,
    measured: Mapping[str, str] | None,
    settings: Mapping[str, Plain],
    wait: str,
    as_json: bool,
) -> None:
    """Filter samples as they arrive, and print an estimate for each.

    Parameters
    ----------
    source : str
        A file, or ``-``.
    model : Model
        The model.
    ship, measured, settings
        See `shipid.estimation.kalman.ExtendedKalmanFilter`.
    wait : str
        See `lines_of`, with its unit.
    as_json : bool
        Whether an estimate is a line of JSON instead of a line of a table.

    Raises
    ------
    EmptyFileError
        If nothing comes before the source ends.
    """
    from shipid.declaration.units import to_si
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.settings.defaults import standard_sensors
    from shipid.generation.reduction import reduced
    from shipid.trials.errors import EmptyFileError

    lines = lines_of(source, to_si(wait, "s", "the wait"))
    header = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), None)
    if header is None:
        raise EmptyFileError(f"{source} holds no header. Write one with units first: 't [s], psi [deg], delta [deg]'.")
    separator = next((s for s in (",", ";", "\t") if s in header), ",")
    columns = _columns(header, separator, source)
    sensors = standard_sensors(model, tuple(n for n, _ in columns)) if measured is None else measured
    kalman = ExtendedKalmanFilter(reduced(model, tuple(sensors)), ship, measured=sensors, **settings)
    online = kalman.start()
    names = [s for s in kalman.model.states if s not in kalman.parameters.values()] + list(kalman.parameters)
    heads = [f"{p}{n} [{kalman.model[n].unit}]" for n in names for p in ("", "std_")]
    header_line = ",".join(["t [s]", *heads, "rejected"])
    for number, line in enumerate(lines, start=2):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        sample = _sample(line, separator, columns, source, number)
        if sample is None:
            continue
        estimate = online.update(sample)
        if estimate.refused:
            say(f"{source}, line {number}: refused, {estimate.refused}.")
            continue
        if as_json:
            click.echo(json_text(estimate.to_dict(), indent=None))
        else:
            # With the first estimate: a record that cannot be filtered prints nothing.
            if header_line:
                click.echo(header_line)
                header_line = ""
            cells = [f"{v:.9g}" for n in names for v in (estimate[n], estimate.std_of(n))]
            click.echo(",".join([f"{estimate.t:.9g}", *cells, " ".join(estimate.rejected)]))
        sys.stdout.flush()


def _columns(header: str, separator: str, source: str) -> list[tuple[str, float]]:
    """Names and factors to SI of a header line."""
    from shipid.trials.columns import no_unit, split_header, to_inside

    found = []
    for text in header.strip().split(separator):
        name, unit = split_header(text)
        if unit is None:
            raise no_unit(name, f"{source}, header: ")
        found.append((name, to_inside(name, unit, f"{source}, header: ")))
    return found


def _sample(
    line: str, separator: str, columns: list[tuple[str, float]], source: str, number: int
) -> dict[str, float] | None:
    """One sample, SI; a cell that is empty or no number is missing. None for a line that cannot be a sample."""
    cells = line.strip().split(separator)
    if len(cells) != len(columns):
        say(f"{source}, line {number}: {len(cells)} fields where the header has {len(columns)}; left out.")
        return None
    sample = {}
    for cell, (name, factor) in zip(cells, columns):
        try:
            sample[name] = float(cell) * factor
        except ValueError:
            sample[name] = math.nan
    if not math.isfinite(sample.get("t", math.nan)):
        say(f"{source}, line {number}: no time 't'; left out.")
        return None
    return sample
