"""Bad records: exit code 3, and the paragraph says which file, which rows, what to do."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shipid
from shipid import read_trial

FORMAT = """
separator = "comma"
header_lines = 1
[columns.t]
column = "t"
unit = "s"
[columns.psi]
column = "psi"
unit = "deg"
[columns.delta]
column = "delta"
unit = "deg"
[windows.middle]
span = [50, 150]
"""


@pytest.mark.parametrize("hole", ["", "nan", "inf", "-inf", "1e300"])
def test_sample_that_is_no_number(call, changed, column, fitted, hole):
    """It is missing, and the fit says how many are there."""
    log = changed(column("psi", lambda value, k: hole if k == 100 else value))
    answer = call("identify", log, *fitted)
    assert answer.code == 0 and "samples there: psi " in answer.said_out and " of " in answer.said_out


def test_column_of_marks_for_missing_values(call, changed, column):
    """It holds no sample: it is left out, and the record says so."""
    log = changed(column("r", lambda *_: "9.97e36"))
    assert "r holds no sample and was left out" in str(read_trial(log))


def test_repeated_and_unsorted_samples(refused, changed, fitted):
    twice = changed(lambda rows: [*rows[:50], rows[49], *rows[50:]])
    refused(3, ["identify", twice, *fitted], "repeats between rows 51 and 52", "removes duplicates")
    swapped = changed(lambda rows: [*rows[:50], rows[51], rows[50], *rows[52:]])
    refused(3, ["identify", swapped, *fitted], "runs backwards between rows 52 and 53", "sorts the rows")


def test_gap_in_the_clock(call, changed, zigzag, fitted):
    """What the rudder did in it is not known: the stretches on either side have initial states of their own."""
    gap = changed(lambda rows: [*rows[:300], *rows[500:]], name="gap.csv")
    answer = call("identify", gap, *fitted)
    assert answer.code == 0 and "fitted to gap@0:59.8, gap@100:279" in answer.out
    assert "Holes in delta split the record; 2 stretches are used" in answer.said_out
    answer = call("identify", zigzag, *fitted, "--validate", gap)
    assert answer.code == 0 and "predicted  gap@100:279" in answer.out


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", ("is empty (0 bytes)",)),
        (b"t [s],psi [deg],delta [deg]\n", ("holds no samples",)),
        (
            bytes(np.random.default_rng(0).integers(0, 256, 5000, dtype=np.uint8)),
            ("log.csv", "is a binary file of a kind that is not known. Export"),
        ),
        (b"PK\x03\x04" + bytes(2000), ("log.csv", "is a zip archive that cannot be opened")),
    ],
)
def test_file_that_is_no_table(refused, tmp_path, fitted, content, words):
    log = tmp_path / "log.csv"
    log.write_bytes(content)
    refused(3, ["identify", log, *fitted], *words)
    refused(3, ["measure", log], *words)


def test_file_that_is_not_there(refused, zigzag, fitted):
    missing = zigzag.with_name("zigzak.csv")
    refused(3, ["identify", missing, *fitted], "zigzak.csv", "Did you mean zigzag.csv?")
    refused(3, ["identify", zigzag, *fitted, "--validate", missing], "zigzak.csv")
    refused(3, ["identify", zigzag, *fitted, "--validate", zigzag.parent], "is a folder")


def test_wrong_separator(refused, changed, fitted):
    log = changed(lambda rows: [r.replace(",", "~") for r in rows], lambda header: header.replace(",", "~"))
    refused(3, ["identify", log, *fitted], "only one column", "comma, semicolon, tab")


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("psi [degree_x]", ("'degree_x' is not a unit", "psi [deg]")),
        ("psi [m]", ("'psi'", "does not fit")),
        ("psi", ("'psi' says no unit", "psi [deg]")),
        ("psi [rad]", ("the unit says radians, and the values look like degrees", "psi [deg]")),
    ],
)
def test_unit(refused, changed, fitted, header, words):
    refused(3, ["identify", changed(header=lambda h: h.replace("psi [deg]", header)), *fitted], *words)


def test_heading_of_350_radians(refused, changed, column, fitted):
    log = changed(column("psi", lambda *_: "350"), lambda h: h.replace("psi [deg]", "psi [rad]"))
    refused(3, ["identify", log, *fitted], "'psi'", "350 rad", "psi [deg]")


def test_missing_columns(refused, changed, fitted):
    refused(3, ["identify", changed(header=lambda h: h.replace("t [s]", "heave [m]")), *fitted], "time column")
    unsteered = changed(header=lambda h: h.replace(",delta [deg]", ",trim [deg]"))
    refused(3, ["identify", unsteered, *fitted], "'delta'", "nothing to identify")
    blind = changed(header=lambda h: h.replace("psi [", "roll [").replace("r [deg", "roll_rate [deg"))
    refused(3, ["identify", blind, *fitted], "no trial measures what model nomoto predicts", "roll")
    refused(3, ["identify", blind, *fitted, "--signals", "r"], "the signal 'r'", "roll_rate")


def test_rudder_that_does_not_move(refused, changed, column, fitted):
    still = changed(column("delta", lambda *_: "5.0"))
    refused(3, ["identify", still, *fitted], "'delta'", "stays at 5 deg", "cannot be identified")


@pytest.mark.parametrize("name", ["psi", "r"])
def test_sensor_that_stands_still(refused, changed, column, fitted, name):
    stuck = changed(column(name, lambda *_: "10.0"))
    refused(3, ["identify", stuck, *fitted], "log", f"'{name}'", "Check the sensor")


def test_trial_that_is_too_short(refused, changed, fitted):
    refused(3, ["identify", changed(lambda rows: rows[:5]), *fitted], "5 samples", "at least 10")
    # 16 s, in which the rudder moves, of a ship with a time constant of 31 s
    refused(3, ["identify", changed(lambda rows: rows[:80]), *fitted], "15.8 s", "time constant is 31")


def test_nothing_to_measure(refused, changed, column):
    still = changed(lambda rows: column("delta_order", lambda *_: "0")(column("delta", lambda *_: "0")(rows[:30])))
    refused(3, ["measure", still], "neither a zig-zag nor a turning circle", "FILE@start:end")


def test_rudder_counted_to_port_is_pointed_out(call, changed, column, fitted):
    log = changed(column("delta", lambda value, _: str(-float(value))))
    answer = call("identify", log, *fitted)
    assert "WARNING: positive rudder turns this ship to port" in answer.said
    assert "Traceback" not in answer.err


def broken(old: str, new: str) -> str:
    assert old in FORMAT
    return FORMAT.replace(old, new)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (broken("separator", "seperator"), ("'seperator'", "Did you mean separator")),
        (broken('unit = "deg"', 'unti = "deg"'), ("[columns.psi]", "'unti'", "Did you mean unit")),
        (broken('"deg"', '"blorp"'), ("'blorp' is not a unit",)),
        (broken('column = "psi"', 'column = "heading"'), ("no column 'heading'", "for psi")),
        (broken("[50, 150]", "[150, 50]"), ("[windows]: 'middle'", "start before end")),
        (broken("[50, 150]", "50"), ("'middle' has to be [start, end]",)),
        (broken("header_lines = 1", 'header_lines = "x"'), ("header_lines",)),
        ("[[", ("is not valid TOML",)),
        ("", ("names no columns",)),
        ("columns = 3\n", ("'columns' is 3",)),
    ],
)
def test_format_file(refused, changed, tmp_path, fitted, text, words):
    form = tmp_path / "form.toml"
    form.write_text(text)
    refused(3, ["identify", changed(), *fitted, "--format", form], "form", *words)


def test_format_file_that_is_not_there(refused, zigzag, fitted, tmp_path):
    refused(3, ["identify", zigzag, *fitted, "--format", tmp_path / "none.toml"], "none.toml")


@pytest.mark.parametrize("name", ["kvlcc2-marin", "kvlcc2-hsva", "esso-osaka", "gunnerus"])
def test_format_of_another_campaign(refused, zigzag, fitted, name):
    form = Path(__file__).parents[2] / "studies" / "formats" / f"{name}.toml"
    refused(3, ["identify", zigzag, *fitted, "--format", form], "zigzag.csv")


def test_windows_of_a_format_file(call, refused, changed, tmp_path, fitted):
    form = tmp_path / "form.toml"
    form.write_text(FORMAT)
    log = changed(name="log.csv")
    refused(3, ["identify", f"{log}@muddle", *fitted, "--format", form], "'muddle'", "Did you mean middle?")
    answer = call("identify", f"{log}@middle", *fitted, "--format", form, "--json")
    assert answer.code == 0
    assert list(json.loads(answer.out)["fit"]) == ["log@50:150"]


def test_a_ship_that_reverses_is_refused_by_every_command(refused, tmp_path):
    """The second half of the record goes astern, and the models that are scaled with the speed hold for a ship that goes ahead."""
    ship = ("--ship", "soesterberg")
    ahead = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", sampling="1 s")
    table = ahead.table.assign(u=ahead["u"] * np.linspace(1.0, -0.5, len(ahead)))
    good, bad = tmp_path / "ahead.csv", tmp_path / "reverses.csv"
    shipid.write_trial(ahead, good)
    shipid.write_trial(replace(ahead, table=table), bad)
    said = ("reverses", "goes astern from", "model", "holds for a ship that goes ahead")
    refused(3, ["identify", bad, "--model", "de-keizer", *ship], *said)
    refused(3, ["identify", bad, "--model", "de-keizer", *ship, "--for", "filter"], *said)
    refused(3, ["identify", good, "--model", "de-keizer", *ship, "--starts", "1", "--validate", bad], *said)
    refused(3, ["filter", bad, "--model", "de-keizer", *ship], *said)
    refused(3, ["filter", bad, "--model", "yaw-filter", *ship], *said)
