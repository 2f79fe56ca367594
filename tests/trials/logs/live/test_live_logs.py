"""A log read line by line gives what the whole log gives."""

import datetime as dt
import struct

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.live.lines import lines_of
from shipid.trials.logs.live.reader import LiveLog
from shipid.trials.logs.nmea.writing import nmea_lines
from shipid.trials.logs.reading import read_trial
from shipid.trials.trial import Trial

N = 60
SECONDS = np.arange(N) * 0.5
STAMPS = pd.Series(pd.Timestamp("2026-05-04 23:59:50") + pd.to_timedelta(SECONDS, unit="s"))
EPOCH = (STAMPS - pd.Timestamp(0)).dt.total_seconds()


def frame(**columns):
    psi = np.round(10 + 5 * np.sin(0.2 * SECONDS), 4)
    r = np.round(60 * np.cos(0.2 * SECONDS), 4)
    return pd.DataFrame(
        {**columns, "psi [deg]": psi, "r [deg/min]": r, "delta [deg]": np.where(SECONDS < 5, 0.0, 5.25)}
    )


def live(text, fmt=None):
    """The samples of a log, and what was told."""
    told = []
    log = LiveLog(text.splitlines(keepends=True), "log", fmt, told.append)
    return [sample.values for sample in log], told


def same_as_the_record(text, path, fmt=None, atol=1e-9):
    path.write_text(text)
    trial = read_trial(path, fmt)
    samples, told = live(text, fmt)
    found = pd.DataFrame(samples)
    assert len(found) == len(trial) and set(found) == set(trial.table)
    for name in trial.table:
        np.testing.assert_allclose(found[name], trial[name], atol=atol, err_msg=name)
    return trial, told


@pytest.mark.parametrize(
    "columns",
    [
        {"t [s]": SECONDS},
        {"t [min]": SECONDS / 60},
        {"t [cs]": SECONDS * 100},
        {"timestamp": STAMPS.dt.strftime("%Y-%m-%dT%H:%M:%S.%f")},
        {"UTC": STAMPS.dt.strftime("%Y-%m-%d %H:%M:%S.%fZ")},
        {"Date": STAMPS.dt.strftime("%d/%m/%Y"), "Time": STAMPS.dt.strftime("%H:%M:%S.%f")},
        {"Zeit": STAMPS.dt.strftime("%H:%M:%S.%f")},
        {"time": STAMPS.dt.strftime("%I:%M:%S %p")},
        {"timestamp": EPOCH},
        {"timestamp": (EPOCH * 1e3).astype("int64")},
        {"time": EPOCH / 86400 + 25569},
        {"tow": (EPOCH - 315964800) % 604800},
    ],
)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_tables(tmp_path, columns, separator):
    text = frame(**columns).to_csv(index=False, sep=separator)
    same_as_the_record(text, tmp_path / "log.csv", atol=2e-5)
    same_as_the_record("# head\n\n" + text, tmp_path / "log.csv", atol=2e-5)


@pytest.mark.parametrize("decimal", [".", ","])
def test_a_clock_in_several_columns(tmp_path, decimal):
    parts = {
        name: getattr(STAMPS.dt, name.lower()).astype(int) for name in ("Year", "Month", "Day", "Hour", "Minute")
    } | {"Second": STAMPS.dt.second + STAMPS.dt.microsecond / 1e6}
    text = frame(**parts).to_csv(index=False, sep=";", decimal=decimal)
    trial, told = same_as_the_record(text, tmp_path / "log.csv")
    assert trial.source.start is not None
    assert any("t = 0" in line or "midnight" in line for line in told) or trial["t"][-1] == SECONDS[-1]


def test_milliseconds_beside_a_time(tmp_path):
    columns = {"time": STAMPS.dt.strftime("%H:%M:%S"), "ms": (STAMPS.dt.microsecond // 1000).astype(int)}
    trial, _ = same_as_the_record(frame(**columns).to_csv(index=False), tmp_path / "log.csv")
    assert trial["t"][1] == 0.5


@pytest.mark.parametrize("letters", ["SP", ("STBD", "PORT")])
def test_angles_with_letters_for_their_sides(tmp_path, letters):
    cells = [f"{abs(k - 20) / 2:.1f} {letters[k < 20]}".strip() if k != 20 else "0.0" for k in range(N)]
    made = frame(**{"t [s]": SECONDS}).assign(**{"delta [deg]": cells})
    if letters == "SP":  # S alone is south as well: the first P tells
        made.loc[0, "delta [deg]"] = "3.0 P"
    trial, told = same_as_the_record(made.to_csv(index=False), tmp_path / "log.csv")
    assert trial["delta"][-1] == pytest.approx(np.radians(19.5))
    assert trial["delta"][5] == pytest.approx(np.radians(-7.5))
    assert any("sign" in line for line in told)


def test_degrees_and_minutes(tmp_path):
    lat, lon = 48 + SECONDS * 2e-5, 9 + SECONDS * 3e-5
    made = frame(**{"t [s]": SECONDS}).assign(
        lat=[f"{int(v)}°{v % 1 * 60:.5f}'N" for v in lat], lon=[f"{int(v):03d}°{v % 1 * 60:.5f}'W" for v in lon]
    )
    trial, _ = same_as_the_record(made.to_csv(index=False), tmp_path / "log.csv", atol=1e-4)
    assert trial["x"][-1] > 50
    assert trial["y"][-1] < -50


def test_a_letter_that_leaves_the_side_open_is_told():
    samples, told = live("t [s],delta [deg]\n0,1.0 S\n1,2.0 S\n2,3.0 P\n3,4.0 S\n4,5.0\n5,0.0\n")
    np.testing.assert_allclose(
        np.degrees([s["delta"] for s in samples]), [np.nan, np.nan, -3, 4, np.nan, 0], atol=1e-12
    )
    assert sum("delta is no number there" in line for line in told) == 3


@pytest.mark.parametrize("comma", [False, True])
def test_units_in_the_cells(tmp_path, comma):
    table = frame(**{"t [s]": SECONDS})
    cells = pd.DataFrame({h.split()[0]: [f"{v:.4f} {h[h.index('[') + 1 : -1]}" for v in table[h]] for h in table})
    text = cells.to_csv(index=False, sep=";")
    trial, _ = same_as_the_record(text.replace(".", ",") if comma else text, tmp_path / "log.csv")
    np.testing.assert_allclose(trial["delta"], np.deg2rad(table["delta [deg]"]), atol=1e-6)


def test_a_clock_that_counts_from_midnight_and_names_that_end_in_a_unit(tmp_path):
    table = frame(t_s=(86390 + SECONDS) % 86400).rename(columns={"psi [deg]": "psi_deg", "delta [deg]": "delta_deg"})
    _, told = same_as_the_record(table.to_csv(index=False), tmp_path / "log.csv", atol=1e-6)
    assert sum("The clock passes midnight" in text for text in told) == 1


def test_dates_of_fourteen_digits(tmp_path):
    text = frame(Time=STAMPS.dt.strftime("%Y%m%d%H%M%S"))[::2].to_csv(index=False)
    same_as_the_record(text, tmp_path / "log.csv", atol=1e-6)


def test_decimal_commas(tmp_path):
    same_as_the_record(frame(**{"t [s]": SECONDS}).to_csv(index=False, sep=";", decimal=","), tmp_path / "log.csv")


def test_headers_and_numbers_as_people_write_them(tmp_path):
    rows = "".join(f'{0.5 * k},"1,0{k:02d}.25",{k}\n' for k in range(N))
    same_as_the_record("t,x,delta\ns,m,deg\n" + rows, tmp_path / "log.csv")
    rows = "".join(f"{0.5 * k}D+00 {k}.5D-01 {k}\n" for k in range(N))
    same_as_the_record("t[s] psi[deg] delta[deg]\n" + rows, tmp_path / "log.dat")
    same_as_the_record("# t[s] psi[deg] delta[deg]\n" + rows, tmp_path / "log.dat")


@pytest.mark.parametrize("names", [("lat [deg]", "lon [deg]"), ("Latitude", "Longitude")])
def test_positions_in_degrees_and_columns_of_text(tmp_path, names):
    table = frame(**{"t [s]": SECONDS, names[0]: 59.9 + 1e-5 * SECONDS, names[1]: 10.6 - 1e-5 * SECONDS})
    same_as_the_record(table.assign(note="calm").to_csv(index=False), tmp_path / "log.csv", atol=1e-6)


@pytest.mark.parametrize(
    "clock, cells, text",
    [
        ("[columns.t]\ncolumn = 'when'\nunit = 's'", SECONDS, ""),
        ("[columns.t]\ncolumn = 'when'", STAMPS.dt.strftime("%d.%m.%Y %H:%M:%S.%f"), "[clock]\nzone = 'Europe/Oslo'"),
        ("[columns.t]\nindex = 0", STAMPS.dt.strftime("%Hh%M %S.%f"), "[clock]\nlayout = '%Hh%M %S.%f'"),
        ("[columns.t]\nindex = 0", EPOCH / 86400 + 25569, "[clock]\nlayout = 'excel'"),
        ("", SECONDS, "[clock]\ninterval = '0.5 s'"),
    ],
)  # fmt: skip
def test_format_files(tmp_path, clock, cells, text):
    fmt = tmp_path / "format.toml"
    fmt.write_text(
        f"header_lines = 2\n{clock}\n[columns.psi]\ncolumn = 'HDG'\nunit = 'deg'\n[columns.delta]\nindex = 2\nunit = 'deg'\n"
        f"sign = -1\n[columns.r]\nindex = 3\nunit = 'deg/min'\nscale = 2.0\n{text}\n"
    )
    table = pd.DataFrame({"when": cells, "HDG": SECONDS, "RUD": 5.0, "ROT": 30.0})
    same_as_the_record("a title\n" + table.to_csv(index=False), tmp_path / "log.csv", fmt, atol=2e-5)


def test_frames_of_a_format_file(tmp_path):
    fmt = tmp_path / "format.toml"
    fmt.write_text(
        "header_lines = 1\n[columns.t]\nindex = 0\nunit = 's'\n[columns.psi]\nindex = 1\nunit = 'deg'\n"
        "[columns.u]\nindex = 2\nunit = 'm/s'\nframe = 'earth'\n[columns.v]\nindex = 3\nunit = 'm/s'\nframe = 'earth'\n"
        "[columns.wind_direction]\nindex = 4\nunit = 'deg'\nframe = 'from'\n"
    )
    table = pd.DataFrame({"t": SECONDS, "a": SECONDS, "b": 3.0, "c": 4.0, "d": 200.0})
    same_as_the_record(table.to_csv(index=False), tmp_path / "log.csv", fmt)


def test_nmea(tmp_path):
    trial = Trial.from_frame(
        frame(**{"t [s]": SECONDS}).assign(**{"x [m]": 3 * SECONDS, "y [m]": SECONDS, "u [m/s]": 3.0, "v [m/s]": 0.0})
    )
    start = dt.datetime(2026, 5, 4, 23, 59, 50)
    lines = list(nmea_lines(trial))
    assert start.year == 2026 and len(lines) > N
    text = "\r\n".join(lines) + "\r\n"
    (tmp_path / "log.nmea").write_text(text)
    record = read_trial(tmp_path / "log.nmea", "nmea")
    samples, told = live(text)
    found = pd.DataFrame(samples)
    assert {"psi", "r", "delta", "x", "y"} <= set(found)
    at = np.searchsorted(found["t"], record["t"][5])
    for name in ("psi", "r", "delta"):
        shown = found[name].dropna().to_numpy()
        np.testing.assert_allclose([shown.min(), shown.max()], [trial[name].min(), trial[name].max()], atol=2e-3)
    assert 0 < at < len(found)
    assert any("psi is of" in words for words in told) and any("t = 0 is" in words for words in told)


@pytest.mark.parametrize("head", ["Time,Port,Sentence\n", "Logger 3.1\nport COM1\n", ""])
def test_sentences_in_the_columns_of_a_table(tmp_path, head):
    rows = [f'2026-05-04T09:00:{k // 2:02d}.{k % 2 * 5}00,COM1,"$HEHDT,{10 + k / 10:.1f},T"\n' for k in range(40)]
    text = head + "".join(rows)
    trial, _ = same_as_the_record(text, tmp_path / "log.csv")
    assert trial["psi"][-1] == pytest.approx(np.radians(13.9))


def test_nmea_that_is_broken():
    lines = [
        "10:00:00 $HEHDT,10.0,T",
        "10:00:00 $HEHDT,10",
        "rubbish",
        "10:00:01 $HEHDT,11.0,T*00",
        "10:00:01 $HEHDT,12.0,T",
        "",
    ]
    samples, told = live("\n".join(lines))
    assert [round(np.degrees(s["psi"])) for s in samples] == [10, 12]
    assert any("line 3: no whole sentence" in words for words in told)
    assert any("line 4: wrong checksum" in words for words in told)
    with pytest.raises(e.EmptyFileError, match="before a sentence said its time"):
        live("$HEHDT,10.0,T\n")


def n2k(t, pgn, layout, *values, source=27):
    """A message in canboat's text form."""
    data = struct.pack(layout, *values)
    stamp = (dt.datetime(2026, 5, 4, 9) + dt.timedelta(seconds=t)).isoformat(timespec="milliseconds")
    return f"{stamp}Z,3,{pgn},{source},255,{len(data)},{','.join(f'{b:02x}' for b in data)}"


def a_turn(reference=0xFC):
    """Heading, rate, rudder and its order, course over the ground, speed: a ship that turns by 1 deg/s through north."""
    lines = []
    for k in range(40):
        t, angle = float(k), round(np.radians((350 + k) % 360) * 1e4)
        lines += [
            n2k(t, 127250, "<BHhhB", 0, angle, 0x7FFF, 0x7FFF, reference),
            n2k(t + 0.2, 127251, "<BiBH", 0, round(np.radians(1.0) / 3.125e-8), 0xFF, 0xFFFF),
            n2k(t + 0.4, 127245, "<BBhhH", 0, 0xF8, round(np.radians(10) * 1e4), round(np.radians(8) * 1e4), 0xFFFF),
            n2k(t + 0.6, 128259, "<BHHBH", 0, 450, 0xFFFF, 0, 0xFFFF),
            n2k(t + 0.8, 129026, "<BBHHH", 0, 0xFC, angle, 400, 0xFFFF),
        ]
    return lines


def test_nmea_2000_followed_gives_what_the_whole_log_gives(tmp_path):
    text = "\n".join(["# format=FAST", *a_turn()]) + "\n"
    (tmp_path / "log.raw").write_text(text)
    record = read_trial(tmp_path / "log.raw")
    samples, told = live(text)
    found = pd.DataFrame(samples)
    assert set(found) == set(record.table) == {"t", "psi", "r", "delta", "delta_order", "u", "SOG", "COG"}
    for name in record.table.columns[1:]:
        shown, wanted = (v[np.isfinite(v)] for v in (found[name].to_numpy(), record[name]))
        turn = 2 * np.pi if name in ("psi", "COG") else np.inf
        off = shown - wanted
        np.testing.assert_allclose(off - (np.round(off / turn) * turn if turn < 7 else 0), 0, atol=1e-9, err_msg=name)
    assert any("psi is of 127250#27" in words for words in told)


def test_a_magnetic_heading_of_nmea_2000_is_told_and_corrected_where_the_variation_is_sent():
    samples, told = live("\n".join(a_turn(reference=0xFD)))
    assert np.degrees(samples[0]["psi"]) == pytest.approx(350, abs=0.01)
    assert sum("psi is the magnetic heading" in words for words in told) == 1
    variation = n2k(0.0, 127258, "<BBHhH", 0, 0xFF, 0xFFFF, round(np.radians(-4) * 1e4), 0xFFFF)
    samples, told = live("\n".join([variation, *a_turn(reference=0xFD)[1:]]))
    assert np.degrees(next(s["psi"] for s in samples if "psi" in s)) == pytest.approx(347, abs=0.01)
    assert not any("magnetic" in words for words in told)


def test_a_broken_message_is_told_and_left_out():
    lines = a_turn()[:4]
    samples, told = live("\n".join([*lines[:2], lines[2][:40], "rubbish", lines[3]]))
    assert [set(s) for s in samples] == [{"t", "psi"}, {"t", "r"}, {"t", "u"}]
    assert [words for words in told if "no whole message" in words] == [
        "log, line 3: no whole message; left out.",
        "log, line 4: no whole message; left out.",
    ]


def test_what_is_told_and_left_out():
    rows = [
        "t [s],psi [deg],delta [deg]",
        "0,1,2",
        "1,1,2",
        "1,1,2",
        "2,1",
        "x,1,2",
        "3,north,2",
        "4,inf,1e31",
        "5,,2",
        "6,1,2",
    ]
    samples, told = live("\n".join(rows))
    assert [s["t"] for s in samples] == [0, 1, 3, 4, 5, 6]
    assert [k for k, s in enumerate(samples) if np.isnan(s["psi"])] == [2, 3, 4]
    assert np.isnan(samples[3]["delta"])
    assert [words.partition(": ")[0] for words in told] == [f"log, line {k}" for k in (4, 5, 6, 7, 8, 8)]


def test_midnight_and_the_end_of_summer_time_are_told():
    text = frame(time=STAMPS.dt.strftime("%H:%M:%S.%f")).to_csv(index=False)
    assert any("line 22: The clock passes midnight" in words for words in live(text)[1])
    moments = pd.Series(pd.date_range("2026-10-25 00:59:50Z", periods=N, freq="500ms"))
    wall = moments.dt.tz_convert("Europe/Oslo").dt.strftime("%Y-%m-%d %H:%M:%S.%f")
    samples, told = live(frame(time=wall).to_csv(index=False))
    np.testing.assert_allclose([s["t"] for s in samples], SECONDS)
    assert any("summer time ends" in words for words in told)


@pytest.mark.parametrize(
    "text, error, words",
    [
        ("", e.EmptyFileError, "log holds no header"),
        ("t [s],psi\n0,1\n1,1\n", e.NoUnitError, "log, line 1, column 'psi' says no unit"),
        ("time,psi [deg]\n0,1\n1,1\n2,1\n", e.NoUnitError, "column 'time' says no unit"),
        ("t [kg],psi [deg]\n0,1\n1,1\n2,1\n", e.ColumnUnitError, "kg"),
        ("t [s],psi [m]\n0,1\n1,1\n2,1\n", e.ColumnUnitError, "psi"),
        ("t [s]\n0\n1\n", e.SeparatorError, "'log', line"),
    ],
)
def test_headers_that_cannot_be_read(text, error, words):
    with pytest.raises(error, match=words):
        live(text)


@pytest.mark.parametrize("encoding, mark", [("utf-8", b"\xef\xbb\xbf"), ("utf-16", b""), ("cp1252", b"")])
def test_encodings(tmp_path, encoding, mark):
    text = frame(**{"t [s]": SECONDS}).rename(columns={"psi [deg]": "psi [°]"}).to_csv(index=False)
    path = tmp_path / "log.csv"
    path.write_bytes(mark + text.encode(encoding))
    samples = [s.values for s in LiveLog(lines_of(str(path), 0.01), "log", None, print)]
    assert len(samples) == N and samples[0]["psi"] == pytest.approx(np.radians(10))


def test_what_is_no_text(tmp_path):
    for head, what in (
        (b"PAR1", "a Parquet file"),
        (b"\x1f\x8b", "compressed by gzip"),
        (b"PK\x03\x04", "a zip archive"),
    ):
        path = tmp_path / "log"
        path.write_bytes(head + bytes(range(256)))
        with pytest.raises(e.NotALiveLogError, match=what):
            list(lines_of(str(path), 0.01))
    path.write_text("x" * 1_000_001)
    with pytest.raises(e.NotALiveLogError, match="has no end"):
        list(lines_of(str(path), 0.01))


WIND = {
    "wind_speed_relative [m/s]": 6 + np.sin(0.3 * SECONDS),
    "wind_direction_relative [deg]": 100 + 20 * SECONDS % 200,
}


@pytest.mark.parametrize(
    "columns",
    [
        {"U [m/s]": 8 + 0.1 * SECONDS, "beta [deg]": 5 * np.sin(0.1 * SECONDS)},
        {"u [m/s]": 8 + 0.1 * SECONDS, "beta [deg]": 5 * np.sin(0.1 * SECONDS)},
        {"u [m/s]": 8 + 0.1 * SECONDS, **WIND},
        {"U [m/s]": 8 + 0.1 * SECONDS, "beta [deg]": 5 * np.sin(0.1 * SECONDS), **WIND},
        {"SOG [m/s]": 8 + 0.1 * SECONDS, "COG [deg]": 10 + 5 * np.sin(0.2 * SECONDS), **WIND},
        {"u [m/s]": 8 + 0.1 * SECONDS, "wind_speed [m/s]": 3 + 0 * SECONDS, "wind_direction [deg]": 40.0, **WIND},
    ],
    ids=["U, beta", "u, beta", "u, wind", "U, beta, wind", "SOG, COG, wind", "true wind recorded"],
)
def test_what_follows_from_other_columns_is_worked_out(columns, tmp_path):
    text = frame(**{"t [s]": SECONDS}, **columns).to_csv(index=False)
    path = tmp_path / "log.csv"
    path.write_text(text)
    trial, (samples, told) = read_trial(path), live(text)
    found = pd.DataFrame(samples)
    assert set(found) == set(trial.table)
    for name in trial.table:
        turns = 2 * np.pi if name.startswith("wind_direction") else np.inf
        off = np.abs(found[name] - trial[name])
        np.testing.assert_allclose(np.minimum(off % turns, turns - off % turns) if turns < 9 else off, 0, atol=1e-9)
    worked_out = [line for line in told if "worked out" in line]
    assert len(worked_out) == sum("worked out" in note for note in trial.source.notes)


def test_a_relative_wind_is_turned_by_the_last_heading(tmp_path):
    """The heading comes every second sample; without one for ten seconds there is no true wind."""
    psi = np.where(SECONDS % 1, np.nan, 90.0)
    psi[SECONDS > 10] = np.nan
    table = frame(**{"t [s]": SECONDS}).assign(**{"psi [deg]": psi, "u [m/s]": 5.0, **WIND})
    samples, _ = live(table.to_csv(index=False))
    there = np.array(["wind_speed" in s for s in samples])
    np.testing.assert_array_equal(there, SECONDS <= 20)


def test_the_wind_of_sentences(tmp_path):
    """The true wind of MWV,R is that of the whole log; MWV,T is turned by the heading."""
    table = pd.DataFrame({"t": SECONDS, "psi": 0.3, "u": 5.0, "v": 0.0, "delta": 0.0})
    table = table.assign(wind_speed_relative=7.0, wind_direction_relative=2.5)
    text = "\r\n".join(nmea_lines(Trial("log", table))) + "\r\n"
    (tmp_path / "log.nmea").write_text(text)
    whole = read_trial(tmp_path / "log.nmea")
    samples, _ = live(text)
    last = {k: v for s in samples for k, v in s.items()}
    assert last["wind_speed"] == pytest.approx(np.nanmedian(whole["wind_speed"]), abs=0.05)
    assert np.cos(last["wind_direction"] - np.nanmedian(whole["wind_direction"])) == pytest.approx(1, abs=1e-3)
    body = "WIMWV,90.0,T,10.0,N,A"
    check = f"{np.bitwise_xor.reduce(np.frombuffer(body.encode(), np.uint8)):02X}"
    true = [
        line.replace(line[line.index("$WIMWV") :], f"${body}*{check}") if "$WIMWV" in line else line
        for line in text.splitlines()
    ]
    last = {k: v for s in live("\r\n".join(true))[0] for k, v in s.items()}
    assert last["wind_speed"] == pytest.approx(10 * 1852 / 3600)
    assert np.cos(last["wind_direction"] - (np.pi * 1.5 + 0.3)) == pytest.approx(1, abs=1e-4)
