"""What a table [trial] states of a trial."""

from __future__ import annotations

import pytest

import shipid
from shipid.trials.conditions import Conditions, different_loadings
from shipid.trials.errors import FormatFileError
from shipid.trials.logs.format import read_format

COLUMNS = """
[columns.t]
index = 0
unit = "s"
[columns.psi]
index = 1
unit = "deg"
"""


def stated(tmp_path, text):
    path = tmp_path / "logger.toml"
    path.write_text(COLUMNS + "[trial]\n" + text, encoding="utf-8")
    return read_format(path).conditions


def test_numbers_are_si_inside_and_shown_with_their_units(tmp_path):
    found = stated(
        tmp_path, 'displacement = "12000 t"\nwind_from = "270 deg"\ncurrent_speed = "2 kn"\ndate = 2026-05-04\n'
    )
    assert found.number("displacement") == pytest.approx(12e6)
    assert found.shown("displacement") == "12000 t" and found.shown("wind_from") == "270 deg"
    assert found.shown("current_speed") == "2 kn" and found.shown("date") == "2026-05-04"
    assert found.shown("who") is None
    assert found.to_dict()["displacement"] == {"value": pytest.approx(12000), "unit": "t"}


def test_the_trial_carries_them(tmp_path):
    stated(tmp_path, 'who = "Trial party"\n')
    log = tmp_path / "log.csv"
    log.write_text("time,heading\n" + "".join(f"{k},{k % 5}\n" for k in range(30)), encoding="utf-8")
    trial = shipid.read_trial(log, format=tmp_path / "logger.toml")
    assert trial.source.to_dict()["conditions"] == {"who": "Trial party"}


@pytest.mark.parametrize(
    ("name", "draught"), [("ballast.csv", 5), ("laden.csv", 7), ("laden.csv@end", 8), ("other.csv", 6)]
)
def test_one_format_file_describes_logs_at_several_loadings(tmp_path, name, draught):
    stated(
        tmp_path,
        'draught_aft = "6 m"\nwho = "Trial party"\n[trials."ballast.csv"]\ndraught_aft = "5 m"\n[trials.laden]\n'
        'draught_aft = "7 m"\n[trials."laden@end"]\ndraught_aft = "8 m"\n[windows]\nend = [10, 20]\n',
    )
    log = tmp_path / name.split("@")[0]
    log.write_text("time,heading\n" + "".join(f"{k},{k % 5}\n" for k in range(30)), encoding="utf-8")
    trial = shipid.read_trial(tmp_path / name, format=tmp_path / "logger.toml")
    assert trial.source.conditions.loading == {"draught": draught}
    assert trial.source.conditions.shown("who") == "Trial party"


def test_conditions_of_a_name_that_no_log_has_are_told(tmp_path):
    """A name that is misspelt would be silent otherwise, and the trial as light as all the others."""
    stated(tmp_path, 'draught_aft = "6 m"\n[trials.balast]\ndraught_aft = "5 m"\n[trials.laden]\ndraught_aft = "7 m"\n')
    for name in ("ballast.csv", "laden.csv"):
        rows = "".join(f"{k},{k % 5}\n" for k in range(30))
        (tmp_path / name).write_text(f"time,heading\n{rows}", encoding="utf-8")
    said = {
        n: shipid.read_trial(tmp_path / n, format=tmp_path / "logger.toml").source.notes
        for n in ("ballast.csv", "laden.csv")
    }
    warned = next(str(note) for note in said["ballast.csv"] if "'balast'" in str(note))
    assert warned.startswith("WARNING")
    assert "Did you mean ballast" in warned
    assert "'laden'" not in warned  # the log is there
    assert not any("WARNING" in str(note) for note in said["laden.csv"])  # it has an entry of its own


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('draft = "8 m"', "no entry 'draft'"),
        ("depth = 40", "unit"),
        ('depth = "-4 m"', "greater than zero"),
        ('depth = "nan m"', "number"),
    ],
)
def test_what_cannot_be_meant_is_refused(tmp_path, text, words):
    with pytest.raises(FormatFileError, match=words):
        stated(tmp_path, text)


def test_trials_of_different_loadings_are_told_apart() -> None:
    laden = Conditions({"displacement": 610e3, "condition": "laden", "draught_aft": 3.0})
    also = Conditions({"displacement": 605e3, "condition": "Laden", "draught_aft": 3.05})
    ballast = Conditions({"displacement": 520e3, "condition": "ballast"})
    assert different_loadings({"a": laden, "b": also, "c": Conditions()}) is None
    words = different_loadings({"a": laden, "b": also, "c": ballast})
    assert words == "loading condition laden (a), Laden (b), ballast (c); displacement 610 t (a), 605 t (b), 520 t (c)"
