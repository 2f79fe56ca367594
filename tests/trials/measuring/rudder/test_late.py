"""Orders that are stamped early, and gear that answers late: which it is, the record does not tell, so both values are given."""

import numpy as np
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.early_rudder import order_answered
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


@pytest.fixture
def early(logged):
    """A zig-zag whose order is stamped early, with the rudder angle beside it or without."""

    def log(seconds, *columns, noise=0.0, **settings):
        trial, _, overshoots = logged(0.5, noise=noise, order=True, rudder=True, **settings)
        frame = trial.to_frame()
        rows = np.minimum(np.arange(len(frame)) + round(2 * seconds), len(frame) - 1)
        frame["delta_order [deg]"] = frame["delta_order [deg]"].to_numpy()[rows]
        frame["r [deg/s]"] = np.degrees(np.gradient(trial["psi"], trial["t"]))
        return Trial.from_frame(frame.drop(columns=list(columns))), overshoots

    return log


@pytest.mark.parametrize("alone", [(), ("delta [deg]",)])
@pytest.mark.parametrize("settings", [{}, {"rudder_rate": 1.5, "lag": 20.0, "gain": 0.06, "duration": 400.0}])
def test_an_order_that_is_stamped_early_gives_both_values(early, alone, settings):
    trial, overshoots = early(2.0, *alone, **settings)
    found = measure(trial)
    many = len(found.overshoots_set_out)
    np.testing.assert_allclose(np.degrees(found.overshoots_set_out), overshoots[:many], atol=0.8)
    away = np.abs(np.degrees(found.overshoots) - overshoots[:many])
    assert np.all(away > 1.0) and np.all(away <= np.degrees(found.overshoot_uncertainties))
    assert found.nominal == "20/20"
    [told] = [n for n in found.notes if n.kind == "order-early"]
    assert told.serious and "which is not known" in told
    assert "set out [deg]" in found.text()
    assert "order-early" in {f.kind for f in check_trial(trial).serious}


@pytest.mark.parametrize("alone", [(), ("delta [deg]",)])
def test_gear_that_starts_within_a_second_is_believed(early, alone):
    trial, overshoots = early(1.0, *alone)
    found = measure(trial)
    np.testing.assert_allclose(np.degrees(found.overshoots_set_out), overshoots[: len(found.overshoots)], atol=0.8)
    assert max(found.overshoot_uncertainties) < np.radians(0.5)
    [told] = [n for n in found.notes if n.kind == "order-early"]
    assert not told.serious and "as a steering gear may" in told


def test_a_right_order_is_measured_by_and_what_its_stamps_may_hide_is_said(early):
    trial, overshoots = early(0.0, "delta [deg]")
    found = measure(trial)
    assert found.overshoots_set_out is None and "set out [deg]" not in found.text()
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.5)
    [told] = [n for n in found.notes if n.kind == "order-alone"]
    assert "s early would not show" in told
    assert "order-early" not in {f.kind for f in check_trial(trial).findings}
    assert measure(early(0.0)[0]).overshoots_set_out is None


def test_an_order_in_ramps_that_comes_before_its_copy(logged):
    trial, *_ = logged(0.5)
    frame = trial.to_frame()
    t = frame["t [s]"].to_numpy()
    frame["delta_order [deg]"] = np.interp(t + 4.0, t, frame["delta [deg]"])
    [found] = [f for f in check_trial(Trial.from_frame(frame)).findings if f.kind == "order-early"]
    assert "the rudder sets out 4" in found.message


def test_an_order_of_a_handful_of_samples_tells_nothing_of_the_gear(logged):
    frame = logged(0.5, order=True)[0].to_frame()
    order = np.full(len(frame), np.nan)
    order[[40, 200, 330, 400]] = 20.0, 20.0, -20.0, -20.0
    trial = Trial.from_frame(frame.assign(**{"delta_order [deg]": order}))
    assert order_answered(trial, "delta_order") is None
