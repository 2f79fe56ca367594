"""Signals of MATLAB that each have a clock of their own."""

import numpy as np
import pytest
from scipy.io import savemat

from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial

FORMAT = """
[columns.t]
column = "t"
unit = "s"
[columns.psi]
column = "heading"
unit = "deg"
[columns.delta]
column = "rudder"
unit = "deg"
"""
FAST, SLOW = np.arange(0, 30, 0.2), np.arange(0, 30, 0.5)


def heading(t):
    return 40 + np.sin(t / 5)


def rudder(t):
    return np.where(t > 10, 20.0, 0.0)


@pytest.fixture
def log(tmp_path):
    def write(content, fmt=FORMAT):
        savemat(tmp_path / "log.mat", content)
        (tmp_path / "log.toml").write_text(fmt)
        return read_trial(tmp_path / "log.mat", tmp_path / "log.toml")

    return write


def timeseries(t, values):
    return {"Time": t[:, None], "Data": values[:, None], "Name": "x", "Length": 3.0}


def simulink(t, values):
    return {"time": t, "signals": {"values": values[:, None], "label": ""}}


@pytest.mark.parametrize("one", [timeseries, simulink])
@pytest.mark.parametrize("inside", [False, True])
def test_every_signal_keeps_its_samples(log, one, inside):
    content = {"heading": one(FAST, heading(FAST)), "rudder": one(SLOW, rudder(SLOW))}
    trial = log({"log": content} if inside else content)
    both = np.unique(np.round(np.concatenate([FAST, SLOW]), 6))
    np.testing.assert_allclose(trial["t"], both, atol=1e-9)
    for name, t, values in (("psi", FAST, heading(FAST)), ("delta", SLOW, rudder(SLOW))):
        there = np.isfinite(trial[name])
        np.testing.assert_allclose(trial["t"][there], t, atol=1e-9)
        np.testing.assert_allclose(np.degrees(trial[name][there]), values)


def test_signals_of_one_clock_under_simulink(log):
    signals = np.array(
        [{"values": heading(FAST)[:, None], "label": "heading"}, {"values": rudder(FAST)[:, None], "label": "rudder"}]
    )
    trial = log({"out": {"time": FAST, "signals": signals}})
    np.testing.assert_allclose(np.degrees(trial["psi"]), heading(FAST))
    np.testing.assert_allclose(np.degrees(trial["delta"]), rudder(FAST))


def test_a_clock_each_and_another_name(log):
    """Structs of a clock and one named array; a position has two columns."""
    content = {
        "gyro": {"t": FAST, "heading": heading(FAST)}, "helm": {"t": SLOW, "rudder": rudder(SLOW)},
        "gps": {"time": SLOW, "data": np.column_stack([SLOW, 2 * SLOW])},
    }  # fmt: skip
    trial = log(
        content, FORMAT + '[columns.x]\ncolumn = "gps_1"\nunit = "m"\n[columns.y]\ncolumn = "gps_2"\nunit = "m"\n'
    )
    there = np.isfinite(trial["x"])
    np.testing.assert_allclose(trial["x"][there], SLOW)
    np.testing.assert_allclose(trial["y"][there], 2 * SLOW)


def test_runs_are_not_joined(log):
    """Two structs with a heading each are two runs, and so are signals of different times."""
    run = {"t": FAST, "heading": heading(FAST), "rudder": rudder(FAST)}
    with pytest.raises(e.ChoiceError, match="'run1', 'run2'"):
        log({"run1": run, "run2": run})
    with pytest.raises(e.ChoiceError):
        log({"a": {"t": FAST, "heading": heading(FAST)}, "b": {"t": FAST, "heading": heading(FAST)}})
    with pytest.raises(e.ChoiceError):
        log({"heading": timeseries(FAST, FAST), "rudder": timeseries(FAST + 100, FAST)})
