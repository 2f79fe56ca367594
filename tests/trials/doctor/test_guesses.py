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
    assert [(f.kind, f.channel) for f in diagnosis.findings if f.serious] == [("name", "t,psi,r,delta"), ("unit", "t")]
    assert diagnosis.findings[0].message.endswith("t is 'time', psi is 'heading', r is 'rot', delta is 'rudder'")
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


def test_foreign_headers_are_examined_and_named(simulated, tmp_path):
    """The log of a German bridge: its rudder counts to port, and its course can be two things."""
    frame = simulated("zigzag:20/20", "none").to_frame()[["t [s]", "psi [deg]", "r [deg/s]", "delta [deg]"]]
    frame["delta [deg]"] *= -1
    frame.columns = ["t [s]", "Kurs [Grad]", "Drehgeschwindigkeit [Grad/s]", "Ruderlage [Grad]"]
    frame.to_csv(tmp_path / "log.csv", index=False)
    diagnosis = check_trial(tmp_path / "log.csv")
    found = {(f.kind, f.channel) for f in diagnosis.serious}
    assert {("name", "r,delta"), ("name", "Kurs"), ("rudder-sign", "delta")} <= found


def test_a_record_without_motion_is_no_sound_record(tmp_path):
    (tmp_path / "log.csv").write_text("t [s],oil [bar]\n" + "".join(f"{k},{5 + k % 3}\n" for k in range(60)))
    assert "no-motion" in [f.kind for f in check_trial(tmp_path / "log.csv").serious]


def test_a_course_beside_a_heading_is_nothing_to_ask(simulated, tmp_path):
    frame = simulated("zigzag:20/20", "none").to_frame()[["t [s]", "psi [deg]", "delta [deg]"]]
    frame["Kurs [deg]"] = frame["psi [deg]"]
    frame.to_csv(tmp_path / "log.csv", index=False)
    assert "name" not in check_trial(tmp_path / "log.csv").kinds
