"""Where summer time ends or begins, a log runs on: from a file and line by line, NMEA and tables, with its zone stated or not."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials.logs.format import read_format
from shipid.trials.logs.live.reader import LiveLog
from shipid.trials.logs.nmea.sentences.lines import checksum
from shipid.trials.logs.reading import read_trial

SECONDS = np.arange(40.0)
#: The first stamp, UTC, half a minute before the change.
CHANGES = {"ends": "2026-10-25 00:59:40", "begins": "2026-03-29 00:59:40"}


def wall(change):
    moments = pd.Timestamp(CHANGES[change], tz="UTC") + pd.to_timedelta(SECONDS, unit="s")
    return moments.tz_convert("Europe/Oslo").tz_localize(None)


def table(change):
    rows = [f"{m:%Y-%m-%d %H:%M:%S},{5 * np.sin(0.2 * s):.3f},0" for m, s in zip(wall(change), SECONDS)]
    return "time,psi [deg],delta [deg]\n" + "\n".join(rows) + "\n"


def nmea(change):
    lines = []
    for moment, s in zip(wall(change), SECONDS):
        for text in (f"HEHDT,{10 + 5 * np.sin(0.2 * s):.2f},T", "IIRSA,0.0,A,,V"):
            lines += [f"{moment:%Y-%m-%dT%H:%M:%S} ${text}*{checksum(text)}"]
    return "\n".join(lines) + "\n"


def live(text, fmt=None):
    told = []
    return [s.values["t"] for s in LiveLog(text.splitlines(keepends=True), "log", fmt, told.append)], told


@pytest.mark.parametrize("zone", [None, "Europe/Oslo"])
@pytest.mark.parametrize("change", CHANGES)
def test_a_table(change, zone, tmp_path):
    fmt = None
    if zone:
        path = tmp_path / "zone.toml"
        path.write_text(
            "[columns.t]\ncolumn = 'time'\n[columns.psi]\ncolumn = 'psi'\nunit = 'deg'\n[columns.delta]\n"
            f"column = 'delta'\nunit = 'deg'\n[clock]\nzone = '{zone}'\n"
        )
        fmt = read_format(path)
    (tmp_path / "log.csv").write_text(table(change))
    whole = read_trial(tmp_path / "log.csv", fmt)
    np.testing.assert_allclose(whole["t"], SECONDS)
    times, told = live(table(change), fmt)
    np.testing.assert_allclose(times, SECONDS)
    assert zone or any("summer time" in words for words in told)


@pytest.mark.parametrize("change", CHANGES)
def test_stamps_before_sentences(change, tmp_path):
    (tmp_path / "log.nmea").write_text(nmea(change))
    whole = read_trial(tmp_path / "log.nmea")
    assert whole["t"][-1] == pytest.approx(39, abs=1) and np.diff(whole["t"]).max() < 2
    assert any(f"summer time {change}" in note for note in whole.source.notes)
    times, told = live(nmea(change))
    assert times[-1] == pytest.approx(39, abs=1) and np.diff(times).min() > 0 and np.diff(times).max() < 2
    assert any(f"summer time {change}" in words for words in told)


@pytest.mark.parametrize("dated_first", [True, False])
def test_utc_with_and_without_a_date_is_one_clock(dated_first):
    """GGA says the time of day, ZDA and RMC its date too: over midnight, whichever of them comes first."""
    lines = []
    for second in range(86390, 86410):
        day, moment = divmod(second, 86400)
        clock = f"{moment // 3600:02d}{moment // 60 % 60:02d}{moment % 60:02d}"
        fix = [
            f"GNGGA,{clock}.00,6327.0,N,01025.2,E,1,10,0.9,5.0,M,40.0,M,,",
            f"GNZDA,{clock}.00,{4 + day:02d},05,2026,00,00",
        ]
        spoken = (*(fix[::-1] if dated_first else fix), f"INHDT,{second - 86390}.0,T", "AGRSA,0.0,A,,V")
        lines += [f"${text}*{checksum(text)}\n" for text in spoken]
    found, told = live("".join(lines))
    assert found == pytest.approx(list(range(20)))
    assert not any("refused" in line for line in told)
