import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


def pull_out(side=1, residual=0.1, after=200.0, lag=15.0, interval=0.5):
    """1 deg/s at 20 deg of rudder for 100 s, then amidships: the rate falls to the residual with a time constant."""
    t = np.arange(0, 100 + after, interval)
    rate = np.where(t < 100, 1.0, residual + (1.0 - residual) * np.exp(-np.clip(t - 100, 0, None) / lag))
    heading = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * interval)))
    delta = np.where(t < 100, 20.0, 0.0)
    frame = pd.DataFrame({"t [s]": t, "psi [deg]": side * heading, "delta [deg]": side * delta})
    return Trial.from_frame(frame, name="pulled")


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("residual", [0.0, 0.1])
def test_residual_rate(side, residual):
    found = measure(pull_out(side, residual), "pull-out")
    assert found.title == f"pull-out from {'starboard' if side > 0 else 'port'}"
    assert np.degrees(found.turning_rate) == pytest.approx(side, abs=1e-6)
    assert np.degrees(found.residual_rate) == pytest.approx(side * residual, abs=1e-3)
    assert found.first_execute == pytest.approx(99.5) and found.notes == ()


def test_a_rate_that_has_not_settled():
    found = measure(pull_out(after=40.0, lag=30.0), "pull-out")
    assert any("had not settled" in note for note in found.notes)


def test_a_record_without_one(logged):
    with pytest.raises(e.NotAManoeuvreError, match="no pull-out"):
        measure(logged(0.5)[0], "pull-out")
    with pytest.raises(e.NotAManoeuvreError, match="no pull-out"):
        measure(pull_out().window(0, 90), "pull-out")


def test_a_gap_at_the_end():
    trial = pull_out()
    frame = trial.to_frame()
    frame.loc[(trial["t"] > 250) & (trial["t"] < 295), "psi [deg]"] = np.nan
    found = measure(Trial.from_frame(frame), "pull-out")
    assert found.residual_rate is None and "gap" in found.reasons["residual_rate"]
