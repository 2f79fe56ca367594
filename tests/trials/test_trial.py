import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import MissingFileError, OverwriteError
from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.writing import write_trial
from shipid.trials.trial import Trial


@pytest.fixture
def trial(log, table):
    return read_trial(log(table))


def make(psi, interval=0.5, unit="deg"):
    psi = np.asarray(psi, dtype=float)
    frame = pd.DataFrame({"t [s]": interval * np.arange(len(psi)), f"psi [{unit}]": psi, "x [m]": psi * 3})
    return Trial.from_frame(frame, name="made")


headings = st.lists(st.floats(-150, 150), min_size=10, max_size=60)


def test_access(trial):
    assert trial.has("psi", "r") and not trial.has("psi", "u")
    assert len(trial) == 20
    assert trial.sampling == 0.5
    assert trial.duration == 9.5
    assert isinstance(trial["psi"], np.ndarray)


def test_trial_is_frozen(trial):
    with pytest.raises(AttributeError):
        trial.name = "other"
    with pytest.raises(ValueError, match="read-only"):
        trial["psi"][0] = 1.0


def test_repr_says_what_a_reader_wants(trial):
    text = trial.text()
    for word in ("log", "20 samples", "0 to 9.5 s", "psi", "deg/s", "15.7 deg"):
        assert word in text


@settings(deadline=None)
@given(headings, st.integers(0, 60), st.integers(0, 60))
def test_window_keeps_clock_and_values(psi, a, b):
    trial = make(psi)
    a, b = sorted((a % len(trial), b % len(trial)))
    if b - a < 1:
        return
    window = trial.window(0.5 * a, 0.5 * b)
    np.testing.assert_array_equal(window["t"], 0.5 * np.arange(a, b + 1))
    np.testing.assert_array_equal(window["psi"], trial["psi"][a : b + 1])
    assert window.name == f"made@{0.5 * a:g}:{0.5 * b:g}"


def test_window_of_a_window_is_named_after_the_file(trial):
    assert trial.window(1, 8).window(2, 6).name == "log@2:6"
    with pytest.raises(e.WindowError, match="1 to 8 s"):
        trial.window(1, 8).window(0, 6)


@settings(deadline=None)
@given(headings, st.sampled_from(["deg", "rad"]))
def test_frame_round_trip(psi, unit):
    trial = make(psi)
    frame = trial.to_frame({"psi": unit})
    if unit == "rad" and np.quantile(np.abs(np.diff(trial["psi"])), 0.95) > 0.4:
        return  # faster than ships turn: radians like these are refused
    assert list(frame.columns) == ["t [s]", "x [m]", f"psi [{unit}]"]
    back = Trial.from_frame(frame, name="back")
    np.testing.assert_allclose(back["psi"], trial["psi"], atol=1e-12)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(headings)
def test_file_round_trip(tmp_path, psi):
    trial = make(psi)
    path = write_trial(trial, tmp_path / "out.csv", overwrite=True)
    back = read_trial(path)
    assert path.read_text().startswith("t [s],x [m],psi [deg]\n")
    for name in ("t", "x", "psi"):
        # Shortest decimals read back exactly; the way through degrees rounds twice.
        np.testing.assert_allclose(back[name], trial[name], rtol=1e-14, atol=1e-15)


def test_units_of_a_frame(trial):
    assert "psi [rad]" in trial.to_frame("SI")
    np.testing.assert_array_equal(trial.to_frame("SI")["psi [rad]"], trial["psi"])
    assert trial.to_frame({"t": "min"})["t [min]"].iloc[-1] == pytest.approx(9.5 / 60)
    with pytest.raises(e.UnknownColumnError, match="Did you mean psi"):
        trial.to_frame({"psy": "deg"})
    with pytest.raises(e.ColumnUnitError, match="psi"):
        trial.to_frame({"psi": "m"})
    with pytest.raises(e.ColumnUnitError, match="'SI'"):
        trial.to_frame("deg")


def test_other_columns_survive(log, table, tmp_path):
    header, *rows = table.splitlines()
    trial = read_trial(log("\n".join([header + ",power [kW],ratio [1]", *(row + ",36,0.7" for row in rows)])))
    back = read_trial(write_trial(trial, tmp_path / "out.csv"))
    np.testing.assert_allclose(back["power"], 36e3)
    np.testing.assert_allclose(back["ratio"], 0.7)
    assert trial.to_frame({"power": "kW"})["power [kW]"][0] == pytest.approx(36)


def test_to_dict_is_plain(trial):
    content = json.loads(json.dumps(trial.to_dict(), allow_nan=False))
    assert content["units"]["psi"] == "rad"
    np.testing.assert_array_equal(content["columns"]["psi"], trial["psi"])
    assert content["source"]["sha256"] == trial.source.sha256


class TestWriting:
    def test_nothing_is_overwritten_unasked(self, trial, tmp_path):
        path = tmp_path / "out.csv"
        path.write_text("precious")
        with pytest.raises(OverwriteError, match="exists already"):
            write_trial(trial, path)
        assert path.read_text() == "precious"
        write_trial(trial, path, overwrite=True)
        assert len(read_trial(path)) == 20

    def test_comment_lines_come_first(self, trial, tmp_path):
        path = write_trial(trial, tmp_path / "out.csv", comment="simulated\nby hand")
        assert path.read_text().startswith("# simulated\n# by hand\nt [s],psi [deg],r [deg/s],delta [deg]\n")
        back = read_trial(path)
        assert back.source.simulated
        again = read_trial(write_trial(back, tmp_path / "again.csv"))
        assert again.source.comment == "simulated\nby hand"

    def test_interrupted_writing_leaves_nothing(self, trial, tmp_path, monkeypatch):
        def interrupted(*_, **__):
            raise KeyboardInterrupt

        monkeypatch.setattr(pd.DataFrame, "to_csv", interrupted)
        with pytest.raises(KeyboardInterrupt):
            write_trial(trial, tmp_path / "out.csv")
        assert not any(path.name.startswith((".out", "out")) for path in tmp_path.iterdir())

    def test_no_such_folder(self, trial, tmp_path):
        with pytest.raises(MissingFileError, match="no folder"):
            write_trial(trial, tmp_path / "no" / "out.csv")
        with pytest.raises(MissingFileError, match="is a folder"):
            write_trial(trial, tmp_path)


def test_a_clock_that_counts_from_long_ago_is_told_to_the_second():
    """2.592e+06 s was no place in a log."""
    t = 2_592_000.25 + np.arange(60.0)
    trial = Trial.from_frame(
        pd.DataFrame({"t [s]": t, "psi [deg]": np.linspace(0, 5, 60), "delta [deg]": np.zeros(60)})
    )
    assert "2592000.25 to 2592059.25 s" in str(trial)
    with pytest.raises(e.WindowError, match=r"window 5:10 s reaches outside.*2592000\.25 to 2592059\.25 s"):
        trial.window(5.0, 10.0)
