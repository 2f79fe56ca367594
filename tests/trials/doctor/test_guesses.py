"""Text, Parquet and NMEA 0183: the doctor examines whatever the reader reads."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.doctor.check_trial import check_trial


def test_an_nmea_log_is_examined(simulated, tmp_path):
    from shipid.trials.logs.nmea.writing import write_nmea

    trial = simulated("zigzag:20/20", "none")
    path = write_nmea(trial, tmp_path / "log.nmea")
    diagnosis = check_trial(path, format="nmea")
    assert diagnosis.serious == ()
    assert [m.kind for m in diagnosis.manoeuvres if m.kind == "zigzag"] == ["zigzag"]
    assert any(note == "NMEA 0183." for note in diagnosis.notes)


def test_the_rudder_of_an_nmea_log_that_counts_the_other_way(simulated, tmp_path):
    from shipid.trials.logs.nmea.writing import write_nmea

    log = write_nmea(simulated("zigzag:20/20", "none"), tmp_path / "log.nmea")
    (tmp_path / "format.toml").write_text("[nmea.rudder]\nsign = -1\n")
    assert "rudder-sign" in check_trial(log, format=tmp_path / "format.toml").kinds


def test_a_rate_in_another_unit_than_it_is_said_to_be_in(simulated, tmp_path):
    from shipid.trials.logs.nmea.writing import write_nmea

    log = write_nmea(simulated("zigzag:20/20", "none"), tmp_path / "log.nmea")
    (tmp_path / "format.toml").write_text("[nmea.rate]\nunit = 'rad/s'\n")
    diagnosis = check_trial(log, format=tmp_path / "format.toml")
    assert any(f.kind == "unit" and f.channel == "r" for f in diagnosis.findings)


def test_headers_of_a_parquet_file_are_guessed(simulated, tmp_path):
    pytest.importorskip("pyarrow")
    trial = simulated("zigzag:20/20", "none")
    frame = trial.to_frame()[["t [s]", "psi [deg]", "r [deg/s]", "delta [deg]"]]
    frame.columns = ["time", "heading [deg]", "rot [deg/s]", "rudder [deg]"]
    frame.to_parquet(tmp_path / "log.parquet")
    diagnosis = check_trial(tmp_path / "log.parquet")
    assert [(f.kind, f.channel) for f in diagnosis.findings if f.serious] == [("unit", "t")]
    assert diagnosis.notes == (
        "Columns guessed from their headers: t is 'time', psi is 'heading', r is 'rot', delta is 'rudder'.",
    )
    assert [m.kind for m in diagnosis.manoeuvres if m.kind == "zigzag"] == ["zigzag"]


def test_text_in_a_parquet_file_is_named(simulated, tmp_path):
    pytest.importorskip("pyarrow")
    frame = simulated("zigzag:20/20", "none").to_frame()[["t [s]", "psi [deg]", "r [deg/s]", "delta [deg]"]]
    printed = frame["r [deg/s]"].map("{:.9g}".format)
    printed[40] = "broken"
    frame["r [deg/s]"] = printed
    frame.to_parquet(tmp_path / "log.parquet")
    found = next(f for f in check_trial(tmp_path / "log.parquet").findings if f.kind == "text")
    assert found.channel == "r" and found.rows == (40, 40)
    assert "'broken'" in found.message and np.isclose(found.confidence, 0.99)
