from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

START = datetime(2026, 5, 4, 9, 0)


def summed(text: str) -> str:
    """A sentence with its checksum, counted here and not by shipid."""
    total = 0
    for character in text:
        total ^= ord(character)
    return f"${text}*{total:02X}"


def iso(seconds: float) -> str:
    return (START + timedelta(seconds=seconds)).isoformat(timespec="milliseconds") + "Z "


@pytest.fixture
def sentence():
    return summed


@pytest.fixture
def dense():
    """The function that brings a trial to the stamps of its heading."""
    return at_the_heading


def at_the_heading(trial):
    """The trial at the stamps of its heading (of another column where it has none), the others interpolated."""
    lead = next(name for name in ("psi", *trial.table.columns[1:]) if trial.has(name))
    t, rows = trial["t"], np.isfinite(trial[lead])
    table = trial.table[rows].reset_index(drop=True)
    for name in table:
        there = np.isfinite(trial[name])
        table[name] = np.interp(t[rows], t[there], trial[name][there])
    return replace(trial, table=table)


@pytest.fixture
def stamped():
    """Log text: sentences by how often a second, with ISO stamps; functions of t are filled in, and UTC 090000.00 runs."""

    def make(*wanted, seconds=20.0, stamp=iso, comment="# sea trial\n", end="\n") -> str:
        events = []
        for text, rate in wanted:
            for k in range(round(seconds * rate) + 1):
                t = k / rate
                body = text(t) if callable(text) else text
                utc = START + timedelta(seconds=t)
                events.append((t, body.replace("090000.00", f"{utc:%H%M%S}.{utc.microsecond // 10000:02d}")))
        lines = [
            stamp(t) + (body if body.startswith(("$", "!")) else summed(body))
            for t, body in sorted(events, key=lambda e: e[0])
        ]
        return comment + end.join(lines) + end

    return make


@pytest.fixture
def basic():
    """A heading that turns at half a degree a second, and a rudder that goes from 0 to 10 after 5 s."""
    return (
        (lambda t: f"HEHDT,{(350 + 0.5 * t) % 360:.1f},T", 5),
        (lambda t: f"IIRSA,{10.0 if t > 5 else 0.0:.1f},A,,V", 2),
    )


@pytest.fixture
def toml(tmp_path):
    """Write a format file and return its path."""

    def write(text: str):
        path = tmp_path / "logger.toml"
        path.write_text(text)
        return path

    return write
