"""Rows that are no samples are left out with a word: repeated headers, and what stands below the last sample."""

import numpy as np
import pytest

from shipid.trials.errors import TextInColumnError
from shipid.trials.logs.reading import read_trial


def notes(trial):
    return [str(note) for note in trial.source.notes]


def test_a_header_at_the_head_of_every_page(log, table):
    head, *rows = table.splitlines()
    trial = read_trial(log("\n".join([head, *rows[:8], head, *rows[8:15], head, *rows[15:]]) + "\n"))
    assert len(trial) == 20
    assert trial["t"][-1] == 9.5
    assert "2 lines repeat the header, the first is line 10: no samples, and left out." in notes(trial)


def test_units_below_a_repeated_header(log):
    head = "Time;psi;delta\ns;deg;deg\n"
    rows = [f"{k};{10 + k};5\n" for k in range(20)]
    trial = read_trial(log(head + "".join(rows[:9]) + head + "".join(rows[9:])))
    assert len(trial) == 20
    assert any("2 lines repeat the header" in note for note in notes(trial))


@pytest.mark.parametrize(
    "below",
    ["mean,12,0.6,3\nmax,15,0.6,5\n", "\nRemarks: wind 5 m/s\nEnd of file\n", "Mittelwert,1,2,3\n,,,\nend,,,\n"],
)
def test_what_stands_below_the_last_sample(log, table, below):
    trial = read_trial(log(table + below))
    assert len(trial) == 20
    assert np.degrees(trial["psi"][-1]) == pytest.approx(15.7)
    assert sum("a word in place of a time" in note for note in notes(trial)) == 1


def test_a_word_among_the_samples_is_still_told(log, table):
    """What stands between samples may be one."""
    rows = table.splitlines()
    with pytest.raises(TextInColumnError, match="'restart' is not a number"):
        read_trial(log("\n".join([*rows[:9], "restart,,,", *rows[9:]]) + "\n"))
    with pytest.raises(TextInColumnError, match="'no' is not a number"):  # the time is there
        read_trial(log(table + "10.0,no,0.6,5\n"))


def test_stamps_at_the_end_stay(log):
    stamps = [f"2026-05-04T09:00:{k:02d}Z" for k in range(20)]
    trial = read_trial(log("time,psi [deg]\n" + "".join(f"{s},{k}\n" for k, s in enumerate(stamps)) + "Ende,\n"))
    assert len(trial) == 20
    assert trial["t"][-1] == 19
