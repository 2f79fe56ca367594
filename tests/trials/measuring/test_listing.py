import numpy as np
import pandas as pd
import pytest

from shipid.foundation.errors import UsageError
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.listing import manoeuvres_in
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


@pytest.fixture
def day(sailed):
    """A zig-zag 20/20 to starboard, a straight run, and a zig-zag 10/10 to port, in one log."""
    parts = [sailed(), sailed(switch=10.0, rudder=10.0, side=-1, duration=200.0)]
    t, psi, delta, begin = [], [], [], 0.0
    for part in parts:
        seconds, heading, angle = (column[::50] for column in part[:3])
        t += [begin + seconds, begin + seconds[-1] + 0.5 * np.arange(1, 401)]
        # Amidships and straight on for 200 s.
        psi += [heading, np.full(400, 350.0)]
        delta += [angle, np.zeros(400)]
        begin = float(t[-1][-1]) + 0.5
    columns = {"t [s]": np.concatenate(t), "psi [deg]": np.concatenate(psi), "delta [deg]": np.concatenate(delta)}
    return Trial.from_frame(pd.DataFrame(columns), name="day"), parts


def test_manoeuvres_are_listed_with_the_command(day):
    trial, _ = day
    listed = manoeuvres_in(trial, check_trial(trial))
    assert [m.kind for m in listed] == ["zig-zag", "zig-zag"] and [m.number for m in listed] == [1, 2]
    with pytest.raises(e.SeveralManoeuvresError) as refused:
        measure(trial)
    text = str(refused.value)
    assert isinstance(refused.value, UsageError)
    assert "1: zig-zag 20/20, first to starboard" in text and "2: zig-zag 10/10, first to port" in text
    assert "--manoeuvre 1" in text
    with pytest.raises(e.SeveralManoeuvresError, match="no manoeuvre 3"):
        measure(trial, manoeuvre=3)
    with pytest.raises(e.SeveralManoeuvresError, match="several"):
        measure(trial, "zig-zag")


def test_each_is_measured(day):
    trial, parts = day
    for number, part in enumerate(parts, start=1):
        found = measure(trial, manoeuvre=number)
        known = np.degrees(found.leading_overshoots)
        assert len(known) >= 3
        # The last swing of each ends in the straight run, which the model did not sail.
        np.testing.assert_allclose(known[:3], part[5][:3], atol=0.05)
    assert found.nominal == "10/10" and found.first_side == "port"


def test_a_turn_and_a_pull_out_are_one(campaign):
    trial = campaign("gunnerus", "RVG_ManeuveringTests_part1.csv")
    listed = manoeuvres_in(trial, check_trial(trial))
    zigzags = [m for m in listed if m.kind == "zig-zag"]
    for start in (1625.0, 1961.5, 2696.5):
        assert any(abs(m.start - start) < 5 for m in zigzags)
    assert sum(m.kind == "turning circle" for m in listed) == 4
    with pytest.raises(e.SeveralManoeuvresError):
        measure(trial)
    number = next(m.number for m in listed if abs(m.start - 1961.5) < 5)
    assert measure(trial, manoeuvre=number).nominal == "10/20"


def test_one_manoeuvre_in_a_long_log_is_measured_in_its_window(sailed):
    """An hour of straight running after it: nine tenths of the samples have no rudder."""
    t, psi, delta, *_, overshoots = sailed()
    seconds = np.arange(0, 3840, 0.5)
    columns = {
        "t [s]": seconds, "psi [deg]": np.interp(seconds, t, psi, right=350.0),
        "delta [deg]": np.interp(seconds, t, delta, right=0.0),
    }  # fmt: skip
    found = measure(Trial.from_frame(pd.DataFrame(columns)))
    np.testing.assert_allclose(np.degrees(found.leading_overshoots[:3]), overshoots[:3], atol=0.05)


def test_a_zigzag_of_slow_gear_that_turns_far_on_is_no_circle(sailed):
    """35/20 at 0.7 deg/s: the ship turns through 236 deg from one extreme to the other."""
    t, psi, delta, *_, overshoots = sailed(switch=20.0, rudder=35.0, rudder_rate=0.7, duration=600.0)
    columns = {"t [s]": t[::50], "psi [deg]": psi[::50], "delta [deg]": delta[::50]}
    trial = Trial.from_frame(pd.DataFrame(columns))
    found = measure(trial)
    assert found.title == "zig-zag 35/20"
    # The first plate is reversed on its way, at 25 deg.
    assert found.first_side == "starboard"
    np.testing.assert_allclose(np.degrees(found.leading_overshoots[:4]), overshoots[:4], atol=0.3)
    assert [m.kind for m in check_trial(trial).manoeuvres if m.kind in ("turn", "zigzag")] == ["zigzag"]
    assert measure(trial.window(0.0, 500.0)).title == "zig-zag 35/20"


def test_a_gear_so_slow_that_no_plate_is_reached_at_once_is_no_circle(sailed):
    """35/35 at 0.3 deg/s: the first plate is reversed at 19 deg, the second just as it is reached."""
    t, psi, delta, *_, overshoots = sailed(switch=35.0, rudder=35.0, rudder_rate=0.3, duration=900.0)
    trial = Trial.from_frame(pd.DataFrame({"t [s]": t[::100], "psi [deg]": psi[::100], "delta [deg]": delta[::100]}))
    assert [m.kind for m in check_trial(trial).manoeuvres if m.kind in ("turn", "zigzag")] == ["zigzag"]
    np.testing.assert_allclose(np.degrees(measure(trial).leading_overshoots[:2]), overshoots[:2], atol=1.0)


def test_rough_course_keeping_after_a_zigzag_is_no_part_of_it(sailed):
    """From 262 s on the rudder is put over to either side at other headings: the whole was no zig-zag for it, or one of six reversals."""
    t, psi, delta, _, orders, _ = sailed(duration=262.0)
    after = np.arange(262.5, 340.0, 0.5) - 262.0
    rudder = np.interp(after % 36, [0, 6, 12, 24, 30, 36], [20, 20, -20, -20, 20, 20])
    heading = 350.0 + (psi[-1] - 350.0) * np.exp(-after / 20) * np.cos(after / 18 * np.pi)
    columns = {
        "t [s]": np.append(t[::50], 262.0 + after), "psi [deg]": np.append(psi[::50], heading), "delta [deg]": np.append(delta[::50], rudder),
    }  # fmt: skip
    assert measure(Trial.from_frame(pd.DataFrame(columns))).executes == pytest.approx(orders[1:5], abs=0.1)
