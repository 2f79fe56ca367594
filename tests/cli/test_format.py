"""``shipid format``: the draft of a format file, filled in and read back."""

import json
import tomllib

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.trials.logs.nmea.writing import nmea_lines

N = 40
T = np.arange(N) * 0.5
PSI = 10 + 5 * np.sin(0.2 * T)


def columns(**more):
    return pd.DataFrame(
        {
            **more,
            "Heading": PSI,
            "ROT [deg/min]": 60 * np.cos(0.2 * T),
            "Ruderwinkel": np.where(T > 5, 5.0, 0.0),
            "STW (kn)": 8.0,
        }
    )


@pytest.fixture
def drafted(call, tmp_path):
    """Write a log, draft its format file, and return both paths and the draft."""

    def draft(frame, name="log.csv", **options):
        path = tmp_path / name
        if isinstance(frame, str):
            path.write_text(frame)
        elif name.endswith(".xlsx"):
            frame.to_excel(path, index=False, **options)
        else:
            frame.to_csv(path, index=False, **options)
        fmt = tmp_path / "format.toml"
        answer = call("format", path, "-o", fmt, "--overwrite", "--json")
        assert answer.code == 0, answer.err
        return path, fmt, json.loads(answer.out)

    return draft


def test_open_units_are_refused_with_their_line_and_read_when_filled_in(drafted, call):
    path, fmt, draft = drafted(columns(**{"Zeit [s]": T}), sep=";", decimal=",")
    assert draft["columns"] == {
        "t": "Zeit [s]",
        "psi": "Heading",
        "r": "ROT [deg/min]",
        "delta": "Ruderwinkel",
        "u": "STW (kn)",
    }
    assert draft["open"] == ["psi", "delta"] and draft["unused"] == []
    assert draft["text"] == fmt.read_text()
    line = next(k for k, text in enumerate(fmt.read_text().splitlines(), start=1) if text.startswith('unit = ""'))
    answer = call("check", path, "--format", fmt)
    assert answer.code == 3 and f"[columns.psi]: 'unit' is empty in line {line}. Fill in the unit of psi" in answer.said
    fmt.write_text(fmt.read_text().replace('unit = ""', 'unit = "deg"'))
    trial = shipid.read_trial(path, format=fmt)
    np.testing.assert_allclose(trial["psi"], np.radians(PSI), rtol=1e-9)
    np.testing.assert_allclose(trial["u"], 8 * 1852 / 3600)
    assert list(trial.table) == ["t", "psi", "r", "u", "delta"]
    written = tomllib.loads(fmt.read_text())
    assert written["separator"] == "semicolon" and written["decimal"] == "comma" and written["header_lines"] == 1


@pytest.mark.parametrize("clock", ["plain", "iso", "date and time", "epoch", "comment"])
def test_a_log_that_says_everything_reads_back_to_the_same_trial(drafted, clock):
    frame = pd.DataFrame(
        {"psi [deg]": PSI, "r [deg/min]": 60 * np.cos(0.2 * T), "delta [deg]": 5.0, "my signal [kN]": T, "u [kn]": 8.0}
    )
    stamps = pd.Series(pd.Timestamp("2026-05-25 23:59:50") + pd.to_timedelta(T, unit="s"))
    if clock in ("plain", "comment"):
        frame.insert(0, "t [s]", T)
    elif clock == "iso":
        frame.insert(2, "timestamp", stamps.dt.strftime("%Y-%m-%dT%H:%M:%S.%f"))
    elif clock == "epoch":
        frame.insert(2, "time", (stamps - pd.Timestamp(0)).dt.total_seconds())
    else:
        frame.insert(0, "Time", stamps.dt.strftime("%H:%M:%S.%f"))
        frame.insert(1, "Date", stamps.dt.strftime("%d/%m/%Y"))
    path, fmt, draft = drafted("# " * (clock == "comment") + frame.to_csv(index=False))
    assert draft["open"] == []
    plain, read = shipid.read_trial(path), shipid.read_trial(path, format=fmt)
    pd.testing.assert_frame_equal(read.table, plain.table)
    assert read.source.start == plain.source.start and read.units == plain.units


def test_a_sheet_of_a_workbook(drafted, call, tmp_path):
    pytest.importorskip("openpyxl")
    path, fmt, draft = drafted(columns(**{"Time [s]": T}), "log.xlsx", sheet_name="Run 2")
    assert draft["columns"]["psi"] == "Heading" and "separator" not in draft["text"]
    named = call("format", f"{path}#Run 2")
    assert named.code == 0 and 'sheet = "Run 2"' in named.out
    fmt.write_text(named.out.replace('unit = ""', 'unit = "deg"'))
    assert shipid.read_trial(path, format=fmt).has("psi", "delta")


def test_what_is_left_to_decide_is_a_comment(drafted):
    frame = columns(
        **{"t [s]": T, "Kurs [deg]": PSI, "Speed [kn]": 8.0, "HDG_deg": PSI, "Engine RPM": 90.0, "note": "calm"}
    )
    _, _, draft = drafted(frame)
    assert {"Speed [kn]", "Engine RPM", "note"} <= set(draft["unused"]) and "SOG" not in draft["columns"]
    text = draft["text"]
    assert "# 'Speed' can be u or SOG" in text and '# column = "Speed"' in text and '# unit = "kn"' in text
    assert "# 'Engine RPM' is not always of the shaft" in text
    assert draft["columns"]["psi"] == "HDG_deg" or draft["columns"]["psi"] == "Heading"
    assert "would be psi again" in text
    assert tomllib.loads(text)


def test_a_log_without_names_or_a_clock(drafted):
    rows = "\n".join(f"{10 + 0.1 * k:.4f}\t{0.6 - 0.01 * k:.4f}\t{5.5}" for k in range(N))
    path, fmt, draft = drafted("Zig-zag\n20/20\n\n" + rows + "\n", "log.dat")
    assert draft["columns"] == {} and draft["open"] == ["t"]
    assert "# index = 2" in draft["text"] and "# interval = '0.1 s'" in draft["text"]
    fmt.write_text(draft["text"] + "[clock]\ninterval = '0.5 s'\n[columns.psi]\nindex = 0\nunit = 'deg'\n")
    np.testing.assert_allclose(np.degrees(shipid.read_trial(path, format=fmt)["psi"]), 10 + 0.1 * np.arange(N))
    _, _, draft = drafted(columns(time=T))
    assert draft["columns"]["t"] == "time" and draft["open"][0] == "t"


def test_dates_that_nothing_decides_and_strange_names(drafted):
    frame = columns(Date="04/05/2026", Time=[f"10:00:{k:02d}" for k in range(N)])
    frame['a "b"\\ [m]'] = 1.0
    _, _, draft = drafted(frame)
    assert 'date = "Date"' in draft["text"] and "day first or month first" in draft["text"]
    assert tomllib.loads(draft["text"])["columns"]['a "b"\\']["unit"] == "m"


def test_refusals(refused, call, tmp_path):
    refused(3, ["format", tmp_path / "none.csv"], "there is no file")
    trial = shipid.Trial.from_frame(pd.DataFrame({"t [s]": T, "psi [deg]": PSI, "delta [deg]": 5.0}))
    path = tmp_path / "log.nmea"
    path.write_text("\r\n".join(nmea_lines(trial)) + "\r\n")
    refused(3, ["format", path], "is an NMEA log, which needs no format file")
    (tmp_path / "log.csv").write_text("t [s],psi [deg]\n0,1\n1,2\n")
    (tmp_path / "f.toml").write_text("mine")
    refused(2, ["format", tmp_path / "log.csv", "-o", tmp_path / "f.toml"], "exists already")
    assert (tmp_path / "f.toml").read_text() == "mine"


def test_what_has_to_be_decided_is_said(call, tmp_path):
    rows = "".join(f"{k},{10 + k},0\n" for k in range(20))
    (tmp_path / "log.csv").write_text(f"Zeit [s],Kurs [Grad],Ruderwinkel [Grad]\n{rows}")
    answer = call("format", tmp_path / "log.csv", "-o", tmp_path / "log.toml")
    assert "Decide what Kurs is." in answer.said


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("Gyro1.Heading [deg]", "psi"), ("Rudder1.Command [deg]", "delta_order"), ("GPS/SOG [kn]", "SOG"),
        ("AIS.Heading [deg]", None), ("Target 1: Heading [deg]", None),
    ],
)  # fmt: skip
def test_names_that_are_paths(drafted, name, field):
    """Of another ship or device it is not said whose they are: somebody decides."""
    frame = columns(**{"time [s]": T}).drop(columns=["Heading"])
    frame[name] = PSI
    draft = drafted(frame)[2]
    assert draft["columns"].get(field) == (name if field else None)
    assert (name.partition(" [")[0] in draft["undecided"]) == (field is None)
