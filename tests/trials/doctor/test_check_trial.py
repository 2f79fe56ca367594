"""Files that read_trial refuses are explained; those nobody can read name the line that stopped the doctor."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from shipid.foundation.errors import MissingFileError
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial, diagnose, examine
from shipid.trials.doctor.guesses import GuessedRecord, from_trial
from shipid.trials.doctor.repair import NoSafeRepairError, fix_trial
from shipid.trials.logs.reading import read_trial


def rows(n=200, header="t [s],psi [deg],r [deg/s],delta [deg]"):
    t = np.arange(n) * 0.5
    psi = 10 * np.sin(t / 8)
    r = 10 / 8 * np.cos(t / 8)
    delta = 20 * np.sign(np.cos(t / 8 + 0.7))
    lines = [f"{a:.6g},{b:.8g},{c:.8g},{d:g}" for a, b, c, d in zip(t, psi, r, delta)]
    return [header, *lines]


def write(tmp_path, lines):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_text_in_a_column_is_no_empty_cell(tmp_path):
    lines = rows()
    lines[50] = "24.5,broken,0.6,20"
    found = next(f for f in check_trial(write(tmp_path, lines)).findings if f.kind == "text")
    assert found.channel == "psi" and "row 51" in found.message and "broken" in found.message
    assert found.rows == (49, 49) and found.repaired and not found.serious


def test_text_with_digits_is_a_number_nobody_knows(tmp_path):
    lines = rows()
    lines[50] = "24.5,1.002.564,0.6,20"
    found = next(f for f in check_trial(write(tmp_path, lines)).findings if f.kind == "text")
    assert found.serious and not found.repaired and "'1.002.564'" in found.message


def test_header_without_units_is_explained(tmp_path):
    diagnosis = check_trial(write(tmp_path, rows(header="time,heading,rot,rudder")))
    assert {f.channel for f in diagnosis.findings if f.kind == "unit"} >= {"t", "psi", "r", "delta"}
    [names] = [f for f in diagnosis.findings if f.kind == "name"]
    assert "psi is 'heading', r is 'rot', delta is 'rudder'" in names.message and names.serious


def test_row_too_long_names_its_line(tmp_path):
    lines = rows()
    lines[70] += ",1,2"
    with pytest.raises(e.RaggedRowError, match="line 71"):
        check_trial(write(tmp_path, lines))


def test_no_columns_names_its_line(tmp_path):
    with pytest.raises(e.TrialError, match="line 1"):
        check_trial(write(tmp_path, ["A report of the trials", "of last summer", "in words"]))


def test_no_header_names_its_line(tmp_path):
    with pytest.raises(e.HeaderError, match="line 1"):
        check_trial(write(tmp_path, rows()[1:]))


def test_no_clock_names_the_header(tmp_path):
    with pytest.raises(e.UnknownColumnError, match=r"line 1: there is no time column"):
        check_trial(write(tmp_path, rows(header="a [1],psi [deg],r [deg/s],delta [deg]")))


def test_empty_and_missing_files(tmp_path):
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(e.EmptyFileError):
        check_trial(tmp_path / "empty.csv")
    with pytest.raises(MissingFileError):
        check_trial(tmp_path / "nowhere.csv")
    with pytest.raises(e.EmptyFileError, match="window"):
        check_trial(f"{write(tmp_path, rows())}@5000:6000")


@pytest.mark.parametrize("n", [2, 5, 12])
def test_a_handful_of_samples_is_short_and_no_crash(tmp_path, n):
    assert "short" in check_trial(write(tmp_path, rows(n))).kinds


def test_a_row_without_a_time_stamp_is_a_sure_finding(tmp_path):
    lines = rows()
    lines[50] = lines[50].partition(",")[1] + lines[50].partition(",")[2]
    found = next(f for f in check_trial(write(tmp_path, lines)).findings if f.kind == "no-time")
    assert (found.channel, found.rows, found.count) == ("t", (49, 49), 1)
    assert found.serious and found.repaired and 0.95 < found.confidence < 1


def test_a_column_that_holds_nothing(tmp_path):
    lines = rows()
    lines = [lines[0] + ",u [m/s]", *(line + "," for line in lines[1:])]
    found = next(f for f in check_trial(write(tmp_path, lines)).findings if f.kind == "empty-column")
    assert found.channel == "u" and found.fix["action"] == "drop-column"


def test_stamps_that_all_stand_still(tmp_path):
    lines = rows()
    lines[1:] = ["1," + line.partition(",")[2] for line in lines[1:]]
    assert "clock-repeats" in check_trial(write(tmp_path, lines)).kinds


@pytest.mark.parametrize("seed", range(40))
def test_whatever_a_record_holds_it_is_examined(simulated, seed):
    """Columns missing, constant, noise, NaN, huge; clocks shuffled, still, with holes: a diagnosis, JSON and all."""
    rng = np.random.default_rng(seed)
    record = from_trial(simulated()).record
    n = int(rng.choice([1, 2, 3, 11, 29, 31, 70, 700]))
    kept = ["t", *(c for c in record.values if c != "t" and rng.random() < 0.7)]
    record = replace(record, values={c: record.values[c][:n].copy() for c in kept})
    for c in kept[1:]:
        values, fault = record.values[c], rng.integers(8)
        if fault < 2:
            values[:] = rng.normal(size=n) if fault else 1.7
        elif fault < 4:
            values[rng.random(n) < (0.3 if fault == 2 else 1.1)] = np.nan
        elif fault == 4:
            values *= 1e12
    t, fault = record.values["t"], rng.integers(6)
    if fault == 0:
        rng.shuffle(t)
    elif fault == 1:
        t[rng.random(n) < 0.2] = np.nan
    elif fault == 2:
        t[:] = 3.0
    diagnosis = diagnose(*examine(GuessedRecord(record)))
    assert json.loads(json.dumps(diagnosis.to_dict(), allow_nan=False))["trial"] == record.name
    assert record.name in diagnosis.text()


def test_a_clock_under_a_usual_name_without_a_unit_is_said(tmp_path):
    log = tmp_path / "log.csv"
    log.write_text("Zeit;psi [deg]\n" + "".join(f"{k};{k}\n" for k in range(20)), encoding="utf-8")
    with pytest.raises(e.NoUnitError, match="column 'Zeit' says no unit"):
        check_trial(log)


@pytest.mark.parametrize("cell", ["{:.1f}S", "{:.1f}°", "{:.0f} kn"])
def test_a_column_of_numbers_with_text_is_not_called_empty(tmp_path, cell):
    lines = rows()
    path = write(
        tmp_path, [lines[0] + ",u [m/s]", *(f"{line},{cell.format(8 + k / 90)}" for k, line in enumerate(lines[1:]))]
    )
    diagnosis = check_trial(path)
    found = next(f for f in diagnosis.findings if f.kind == "text")
    assert found.serious and found.fix is None and "empty-column" not in diagnosis.kinds
    with pytest.raises(NoSafeRepairError, match="hold text"):
        fix_trial(path, tmp_path / "fixed.csv")


def test_a_column_of_words_is_not_thrown_away(tmp_path):
    lines = rows()
    words = ("N", "NNE", "NE", "ENE")
    path = write(tmp_path, [lines[0] + ",u [m/s]", *(f"{line},{words[k % 4]}" for k, line in enumerate(lines[1:]))])
    diagnosis = check_trial(path)
    assert not any(f.repaired and f.channel == "u" for f in diagnosis.findings) and diagnosis.serious


def test_a_column_for_which_the_log_is_refused_is_told_and_left_out_by_the_repair(tmp_path, simulated):
    frame = simulated().to_frame().reset_index()
    path = tmp_path / "log.csv"
    frame.assign(mood=range(len(frame)), **{"place [ddmm.mmmm]": 5230.1}).to_csv(path, index=False)
    with pytest.raises(e.NoUnitError, match="'mood'"):
        read_trial(path)
    found = {f.channel: f for f in check_trial(path).findings if f.kind == "unit"}
    assert found["mood"].serious and "says no unit" in found["mood"].message
    assert "the unit 'ddmm.mmmm', which is none" in found["place"].message
    fixed, _ = fix_trial(path, tmp_path / "fixed.csv")
    assert not read_trial(fixed).has("mood")


def test_a_unit_that_does_not_fit_is_no_reason_to_assume_another(tmp_path):
    lines = rows()
    path = write(tmp_path, [lines[0].replace("delta [deg]", "delta [%]"), *lines[1:]])
    found = next(f for f in check_trial(path).findings if f.kind == "unit")
    assert found.channel == "delta" and "the unit '%', which does not fit" in found.message and not found.repaired
    with pytest.raises(NoSafeRepairError, match="'%'"):
        fix_trial(path, tmp_path / "fixed.csv")
