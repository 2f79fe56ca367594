"""Trials given as they are, by their files, one or several; anything else is refused in words."""

from __future__ import annotations

from pathlib import Path

import pytest

import shipid
from shipid.foundation.errors import UsageError
from shipid.trials.logs.reading import trials_of

LOG = Path(__file__).resolve().parents[3] / "studies" / "trials" / "container-20-20.csv"


def test_one_trial_or_several_in_memory_or_as_files():
    trial = shipid.read_trial(LOG)
    assert trials_of(trial) == [trial] and trials_of((trial, trial)) == [trial, trial]
    for given in (LOG, str(LOG), [LOG], [trial, f"{LOG}@0:300"]):
        assert [t.name.partition("@")[0] for t in trials_of(given)] == [trial.name] * (
            len(given) if isinstance(given, list) else 1
        )
    assert trials_of(()) == []
    assert shipid.measure(LOG).to_dict() == shipid.measure(trial).to_dict()


@pytest.mark.parametrize("given", [3, {"t": 1}, [None], trials_of])
def test_what_is_no_trial_is_refused(given):
    with pytest.raises(UsageError, match=r"a trial is a shipid.Trial or the path of a log"):
        trials_of(given)


def test_a_table_of_pandas_is_told_how_it_becomes_a_trial():
    with pytest.raises(
        UsageError, match=r"this is a DataFrame. A table of pandas becomes one by shipid.Trial.from_frame"
    ):
        trials_of(shipid.read_trial(LOG).to_frame())


def test_a_filter_says_what_it_takes():
    ekf = shipid.ExtendedKalmanFilter("nomoto", "soesterberg", measured={"psi": "0.2 deg"})
    trial = shipid.read_trial(LOG)
    assert (ekf.filter(LOG).std == ekf.filter(trial).std).all()
    with pytest.raises(UsageError, match=r"this is a DataFrame"):
        ekf.filter(trial.to_frame())
    for verb in (ekf.smooth, ekf.observability):
        with pytest.raises(UsageError, match=r"what filter.record. returned, a FilterRun, and not a Trial"):
            verb(trial)


def test_a_report_has_the_name_of_a_page(tmp_path):
    with pytest.raises(UsageError, match=r"end in .html or .pdf, and not as 'trial.docx'"):
        shipid.write_report(shipid.read_trial(LOG), tmp_path / "trial.docx")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["trial.xlsx", "trial.csv.gz", "trial.nmea", "trial.MAT"])
def test_a_table_is_not_written_under_the_name_of_another_kind_of_file(tmp_path, name):
    with pytest.raises(UsageError, match="a trial is written as CSV or Parquet"):
        shipid.write_trial(shipid.read_trial(LOG), tmp_path / name)
    assert list(tmp_path.iterdir()) == []
