"""Every way a record can be wrong: the class, and that the message says where and what to do."""

import re

import numpy as np
import pandas as pd
import pytest

from shipid.foundation.errors import MissingFileError, UnknownNameError, UsageError
from shipid.trials import errors as e
from shipid.trials.fitness import check_identifiable_input
from shipid.trials.logs.reading import read_trial
from shipid.trials.trial import Trial


def refused(error, path, *words, **arguments):
    """Read, expect the error, and look for words in its one paragraph."""
    with pytest.raises(error) as caught:
        read_trial(path, **arguments)
    message = str(caught.value)
    assert "\n" not in message
    assert message.endswith((".", '".', "'."))
    for word in words:
        assert word in message, message
    assert caught.value.exit_code == 3
    return message


def test_missing_file_offers_the_nearest(log, table, tmp_path):
    log(table, "zigzag.csv")
    refused(MissingFileError, tmp_path / "zigzak.csv", "zigzak.csv", "Did you mean zigzag.csv")
    refused(MissingFileError, tmp_path / "no" / "such.csv", "such.csv", "Check the path")
    refused(MissingFileError, tmp_path / "a@b.csv", "a@b.csv")
    refused(
        MissingFileError,
        tmp_path,
        "is a folder. Name a trial in it, or several where a command takes them, as in FOLDER/*.csv.",
    )


@pytest.mark.parametrize("text", ["", "\n\n", "# only a comment\n", "t [s],psi [deg]\n"])
def test_empty_file(log, text):
    refused(e.EmptyFileError, log(text), "log.csv")


def test_no_header(log, table):
    refused(e.HeaderError, log(table.split("\n", 1)[1]), "line 1", "'t [s],psi [deg]", "format file")


def test_header_that_names_a_column_twice(log, table):
    refused(e.HeaderError, log(table.replace("r [deg/s]", "psi [deg]")), "'psi [deg]'", "twice", "Rename")
    refused(e.HeaderError, log(table.replace("r [deg/s]", "psi [rad]")), "'psi'", "twice")


def test_one_column(log, table):
    refused(e.SeparatorError, log(table.replace(",", "~").replace(" ", "")), "one column", "comma, semicolon")


def test_wrong_separator_in_the_format_file(log, table, tmp_path):
    fmt = tmp_path / "f.toml"
    fmt.write_text('separator = "tab"\nheader_lines = 1\n[columns.t]\nindex = 0\nunit = "s"\n')
    refused(e.SeparatorError, log(table), "'tab'", "one column", format=fmt)


def test_ragged_rows(log, table):
    lines = table.splitlines()
    lines[7] += ",99"
    refused(e.RaggedRowError, log("\n".join(lines)), "line 8", "5 fields")
    refused(e.RaggedRowError, log(table.replace(",delta [deg]", "")), "3 columns", "4")


def test_row_with_too_few_fields_is_a_hole(log, table):
    lines = table.splitlines()
    lines[7] = lines[7].rsplit(",", 1)[0]
    trial = read_trial(log("\n".join(lines)))
    assert np.flatnonzero(np.isnan(trial["delta"])).tolist() == [6]
    assert "delta: 1 of 20 samples are missing." in trial.source.notes


def test_no_unit(log, table):
    refused(e.NoUnitError, log(table.replace("psi [deg]", "psi")), "'psi'", "'psi [deg]' or 'psi [rad]'", "not guess")
    refused(e.NoUnitError, log(table.replace("r [deg/s]", "mood")), "'mood [unit]'")


def test_unknown_unit(log, table):
    refused(e.ColumnUnitError, log(table.replace("psi [deg]", "psi [degrez]")), "log.csv", "'degrez'", "'psi [deg]'")
    refused(e.ColumnUnitError, log(table.replace("psi [deg]", "psi [m]")), "'psi'", "rad")


def test_no_time_column(log, table):
    refused(e.NoUnitError, log(table.replace("t [s]", "time")), "column 'time' says no unit", "'time [s]'")
    refused(e.UnknownColumnError, log(table.replace("t [s]", "heave [m]")), "Name the time column")


def test_repeated_and_reversed_time(log, table):
    refused(e.ClockError, log(table.replace("\n2.0,", "\n1.5,")), "repeats", "rows 5 and 6", "format file")
    refused(e.ClockError, log(table.replace("\n2.0,", "\n1.0,")), "runs backwards", "rows 5 and 6")


def test_row_numbers_count_comments_and_blank_lines(log, table):
    lines = table.splitlines()
    text = "\n".join(["# one", *lines[:3], "", "# two", *lines[3:]]).replace("\n2.0,", "\n1.5,")
    number = 1 + text.split("\n1.5,")[0].count("\n") + 1
    refused(e.ClockError, log(text), f"rows {number} and {number + 1}")


@pytest.mark.parametrize("hole", ["", "nan", "inf", "-inf"])
def test_hole_in_the_record(log, table, hole):
    trial = read_trial(log(table.replace("2.0,11.2000", f"2.0,{hole}")))
    assert len(trial) == 20 and np.flatnonzero(np.isnan(trial["psi"])).tolist() == [4]
    assert "psi: 1 of 20 samples are missing." in trial.source.notes
    assert trial.to_dict()["columns"]["psi"][4] is None
    assert "1 missing" in trial.text()


def test_empty_rows_are_counted(log, table):
    trial = read_trial(log(table + ",,,\n,,,\n"))
    assert len(trial) == 20 and "2 rows without any number were left out of 22." in trial.source.notes


def test_samples_without_a_time(log, table):
    text = table.replace("\n2.0,", "\n,").replace("\n3.0,", "\nnan,")
    refused(e.NonFiniteError, log(text), "2 rows have samples and no time", "rows 6, 8", "[clock] interval")


def test_columns_without_a_sample(log, table):
    rows = [row.split(",") for row in table.splitlines()]
    silent = [rows[0], *([row[0], "", "", ""] for row in rows[1:])]
    refused(e.EmptyFileError, log("\n".join(",".join(row) for row in silent)), "no sample in any column but the clock")
    half = [rows[0], *([row[0], row[1], "", row[3]] for row in rows[1:])]
    trial = read_trial(log("\n".join(",".join(row) for row in half)))
    assert not trial.has("r") and "r holds no sample and was left out." in trial.source.notes


def test_text_in_a_numeric_column(log, table):
    refused(e.TextInColumnError, log(table.replace("2.0,11.2000", "2.0,eleven")), "line 6", "'psi [deg]'", "'eleven'")
    refused(e.TextInColumnError, log(table.replace(",", ";").replace("11.2000", "11,2")), "line 6", "decimal comma")


@pytest.mark.parametrize(
    ("header", "value", "word"),
    [("delta [rad]", "20", "beyond 90 deg"), ("r [rad/s]", "3", "turns at 3 rad/s")],
)
def test_degrees_given_as_radians(log, header, value, word):
    rows = "".join(f"{k},{0.01 * k},{value}\n" for k in range(20))
    refused(e.LooksLikeDegreesError, log(f"t [s],psi [rad],{header}\n" + rows), word, "deg")


@pytest.mark.parametrize(
    ("psi", "word"),
    [
        (np.full(60, 200.0), "begins at 200"),
        (np.mod(10 - 0.5 * np.arange(60), 360), "jumps by 360"),
        (20 * np.sin(np.arange(60) / 5), "runs from"),
    ],
)
def test_heading_in_degrees_given_as_radians(psi, word):
    frame = pd.DataFrame({"t [s]": np.arange(60.0), "psi [rad]": psi})
    with pytest.raises(e.LooksLikeDegreesError, match=re.escape(word)):
        Trial.from_frame(frame)


@pytest.mark.parametrize(("psi_unit", "r_unit"), [("rad", "rad/s"), ("deg", "deg/s")])
@pytest.mark.parametrize("wrong", ["psi", "r"])
def test_heading_and_rate_that_differ_by_57(psi_unit, r_unit, wrong):
    t = np.arange(200) * 0.5
    scale = 1 if psi_unit == "rad" else 57.3
    psi, r = 0.3 * scale * np.sin(t / 20), 0.015 * scale * np.cos(t / 20)
    if wrong == "psi":
        psi = psi * (57.3 if psi_unit == "rad" else 1 / 57.3)
    else:
        r = r * (57.3 if psi_unit == "rad" else 1 / 57.3)
    frame = pd.DataFrame({"t [s]": t, f"psi [{psi_unit}]": psi, f"r [{r_unit}]": r})
    with pytest.raises(e.LooksLikeDegreesError, match=r"look like (degrees|radians)"):
        Trial.from_frame(frame)


def test_radians_that_are_radians_pass():
    t = np.arange(2000) * 0.5
    frame = pd.DataFrame({"t [s]": t, "psi [rad]": 0.05 * t, "r [rad/s]": 0.05, "delta [rad]": 0.6})
    assert len(Trial.from_frame(frame)) == 2000  # eight circles: 50 rad


def test_too_short(log, table):
    refused(e.TooShortError, log("\n".join(table.splitlines()[:9])), "8 samples", "at least 10")


@pytest.mark.parametrize(
    ("window", "words"),
    [
        ("100:200", ("100:200", "0 to 9.5 s")),
        ("-5:5", ("outside",)),
        ("6:2", ("backwards",)),
        ("2:2.1", ("fewer than two",)),
        ("zigzag", ("start:end",)),
        ((3, 300), ("outside",)),
    ],
)
def test_window_outside_the_record(log, table, window, words):
    refused(e.WindowError, log(table), *words, window=window)


def test_window_given_twice(log, table):
    refused(e.WindowError, f"{log(table)}@2:6", "one of the two", window="2:6")


def test_gap_in_the_clock(log, table):
    text = "\n".join(line for k, line in enumerate(table.splitlines()) if not 8 <= k <= 13)
    trial = read_trial(log(text))
    assert any("has 1 gap," in note for note in trial.source.notes)


def test_rudder_that_does_not_move(log, table):
    trial = read_trial(log(table))
    check_identifiable_input(trial)
    with pytest.raises(e.NoRudderMovementError, match=r"'delta'.*stays at 5 deg"):
        check_identifiable_input(trial.window(4, 9))
    with pytest.raises(e.UnknownColumnError, match="delta_order"):
        check_identifiable_input(trial, "delta_order")


def test_a_rudder_of_which_no_sample_is_known(log, table):
    trial = read_trial(log(table))
    hole = Trial("hole", trial.table.assign(delta=np.nan), trial.source)
    with pytest.raises(
        e.NoRudderMovementError, match=r"trial 'hole', column 'delta': each of its .* samples is missing"
    ):
        check_identifiable_input(hole)


def test_asking_for_a_column_that_is_not_there(log, table):
    with pytest.raises(e.UnknownColumnError, match="Did you mean psi"):
        read_trial(log(table))["psy"]


def test_from_frame_names_rows_and_columns():
    t = np.arange(12.0)
    frame = pd.DataFrame({"t [s]": t, "psi [deg]": ["1"] * 11 + ["north"]})
    with pytest.raises(e.TextInColumnError, match="row 11, column 'psi': 'north'"):
        Trial.from_frame(frame)
    with pytest.raises(e.TextInColumnError, match="'when': it holds dates or times, and is not the clock"):
        Trial.from_frame(pd.DataFrame({"t [s]": t, "when [s]": pd.to_timedelta(t, unit="s")}))
    with pytest.raises(e.TextInColumnError, match="'psi': it holds complex numbers"):
        Trial.from_frame(pd.DataFrame({"t [s]": t, "psi [deg]": t + 1j}))
    with pytest.raises(UnknownNameError, match="'psy'"):
        Trial.from_frame(pd.DataFrame({"t [s]": t}), units={"psy": "deg"})
    with pytest.raises(e.TooShortError):
        Trial.from_frame(pd.DataFrame({"t [s]": []}, dtype=float))


def test_positive_rudder_that_turns_to_port_is_noted():
    t = np.arange(0, 400, 0.5)
    delta = 10 * np.sign(np.sin(t / 20))
    r = np.zeros_like(t)
    for k in range(len(t) - 1):
        r[k + 1] = r[k] + 0.5 * (-0.1 * delta[k] - r[k]) / 10
    frame = pd.DataFrame({"t [s]": t, "r [deg/s]": r, "delta [deg]": delta})
    assert any(n.startswith("WARNING: positive rudder turns") for n in Trial.from_frame(frame).source.notes)
    frame["delta [deg]"] *= -1
    assert not any("WARNING" in n for n in Trial.from_frame(frame).source.notes)


def test_from_frame_takes_columns_by_name_and_says_what_is_no_table():
    t = np.arange(20.0)
    trial = Trial.from_frame({"t [s]": t, "psi [deg]": t, "delta [deg]": 0 * t})
    assert trial["psi"] == pytest.approx(np.deg2rad(t))
    with pytest.raises(UsageError, match=r"'log' is made of a pandas\.DataFrame.* this is a str\. shipid\.read_trial"):
        Trial.from_frame("log.csv", name="log")
    with pytest.raises(UsageError, match="'trial' is no table: all arrays must be of the same length"):
        Trial.from_frame({"t [s]": t, "psi [deg]": t[1:]})
