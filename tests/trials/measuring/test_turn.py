import json
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.track import drift, speed, track
from shipid.trials.trial import Trial


def circle(
    radius=300.0, speed=5.0, start=50.0, turns=1.6, side=1, course=30.0, interval=0.5, beta=0.0, rudder=35.0,
    residual=0.0, pull_out=0.0, noise=0.0, positions=True, seed=1,
):  # fmt: skip
    """Make a straight run, a circle from the order on, and perhaps a pull-out: everything in closed form."""
    rate = speed / radius
    over = start + turns * 2 * np.pi / rate
    t = np.arange(0, over + pull_out, interval)
    turned = np.where(t < over, rate * np.clip(t - start, 0, None), rate * (over - start) + residual * (t - over))
    psi = np.radians(course) + side * turned
    turning = (t >= start) & (t < over)
    north, east = speed * np.minimum(t, start), np.zeros_like(t)
    arc = rate * np.clip(np.minimum(t, over) - start, 0, None)
    north, east = north + radius * np.sin(arc), east + side * radius * (1 - np.cos(arc))
    c, s = np.cos(np.radians(course)), np.sin(np.radians(course))
    noisy = np.random.default_rng(seed).normal(0, noise, (3, len(t)))
    frame = pd.DataFrame({"t [s]": t, "psi [rad]": psi + np.radians(noisy[0])})
    if positions:
        frame["x [m]"], frame["y [m]"] = c * north - s * east + noisy[1], s * north + c * east + noisy[2]
    drifting = side * np.radians(beta) * turning
    frame["u [m/s]"], frame["v [m/s]"] = speed * np.cos(drifting), -speed * np.sin(drifting)
    frame["delta_order [deg]"] = side * rudder * turning
    return Trial.from_frame(frame, name="circle")


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("positions", [True, False])
def test_circle_in_closed_form(side, positions):
    trial = circle(side=side, positions=positions)
    found = measure(trial, length="100 m")
    assert found.kind == "turning circle"
    assert found.side == ("starboard" if side > 0 else "port")
    assert found.track == ("positions" if positions else "speeds and heading")
    # On a circle of radius R advance and transfer are R, the tactical diameter is 2 R; the kink at the order is
    # smoothed over one per cent of the turn.
    assert found.advance == pytest.approx(300, rel=0.01)
    assert found.transfer == pytest.approx(300, rel=0.01)
    assert found.tactical_diameter == pytest.approx(600, rel=0.01)
    assert found.advance_ratio == pytest.approx(found.advance / 100)
    assert found.tactical_diameter_ratio == pytest.approx(found.tactical_diameter / 100)
    # The order steps between 49.5 and 50 s.
    assert found.first_execute == pytest.approx(49.75)
    quarter = np.pi / 2 * 300 / 5
    np.testing.assert_allclose(found.times, quarter * np.arange(1, 5), rtol=0.01)
    np.testing.assert_allclose(found.speeds, 5)
    assert found.steady_rate == pytest.approx(5 / 300, rel=1e-3)
    assert found.steady_speed == pytest.approx(5)
    assert found.steady_diameter == pytest.approx(600, rel=1e-3)
    assert found.speed_loss == pytest.approx(0, abs=1e-9)
    assert found.pull_out_rate is None
    assert np.degrees(found.course) == pytest.approx(30, abs=1e-6)


def test_loss_of_speed():
    """From 5 to 3 m/s in the first 100 s of the turn: two fifths, and 2 U/r is the diameter of the steady turn."""
    frame = circle(turns=2.0).to_frame()
    t = frame["t [s]"].to_numpy()
    frame["u [m/s]"] = 5.0 - 2.0 * np.clip((t - 50) / 100, 0, 1)
    found = measure(Trial.from_frame(frame))
    assert found.approach_speed == pytest.approx(5.0, rel=1e-2)
    assert found.speed_loss == pytest.approx(0.4, abs=1e-2)
    assert found.steady_diameter == pytest.approx(2 * 3.0 / (5.0 / 300), rel=1e-3)


@given(
    radius=st.floats(50, 2000), fast=st.floats(1, 15), side=st.sampled_from([1, -1]), course=st.floats(-180, 180),
    turns=st.floats(0.8, 3),
)  # fmt: skip
@settings(max_examples=30, deadline=None)
def test_any_circle(radius, fast, side, course, turns):
    around = 2 * np.pi * radius / fast
    found = measure(
        circle(radius, fast, 0.1 * around, turns, side, course, interval=around / 1000), "turning circle"
    )  # fmt: skip
    assert found.tactical_diameter == pytest.approx(2 * radius, rel=0.01)
    assert found.advance == pytest.approx(radius, rel=0.02)
    assert found.steady_diameter == pytest.approx(2 * radius, rel=0.01)


def test_noise_on_heading_and_positions():
    found = measure(circle(noise=0.2))  # deg and m
    assert found.advance == pytest.approx(300, rel=0.02)
    assert found.tactical_diameter == pytest.approx(600, rel=0.02)
    assert found.steady_rate == pytest.approx(5 / 300, rel=0.01)


DISTANCES = ("advance", "transfer", "tactical_diameter")


@pytest.mark.parametrize("noise", [0.3, 3.0])
def test_the_uncertainty_of_a_distance_is_what_it_scatters_by(noise):
    """A diameter of a ship of 45 m under fixes of 10 m was 177 m to starboard and 196 m to port, with nothing beside it."""
    calm = measure(circle(side=-1))
    found = [measure(circle(noise=noise, side=-1, seed=k)) for k in range(2, 62)]
    for name in DISTANCES:
        errors = np.array([getattr(one, name) - getattr(calm, name) for one in found])
        stated = np.array([getattr(one, f"{name}_uncertainty") for one in found])
        # Of sixty intervals of 95 % nine in ten hold at the least, and none is twice as wide as it has to be.
        assert np.mean(np.abs(errors) <= stated) >= 0.88
        assert np.median(stated) <= 2 * 1.96 * np.std(errors) + 0.25 * 5.0
    one = found[0]
    assert f"advance                      {one.told('advance', one.advance, 'm')} m" in one.text()
    assert " ± " in one.told("transfer", one.transfer, "m") and "advance uncertainty" not in one.text()
    assert one.to_dict()["advance_uncertainty"]["value"] == one.advance_uncertainty


def test_a_reckoned_track_has_no_uncertainty_and_a_drift_has_its_own():
    """Nothing shows by how much speeds and headings are off; a drift that is taken off brings what it is uncertain by."""
    reckoned = measure(circle(noise=0.3, positions=False))
    assert reckoned.advance is not None and reckoned.advance_uncertainty is None and " ± " not in reckoned.text()
    trial = circle(noise=0.3)
    moved = trial.table.assign(x=trial.table["x"] + 0.5 * trial.table["t"])
    found = measure(Trial("drifts", moved, trial.source))
    assert found.tactical_diameter_still_water_uncertainty == pytest.approx(
        np.hypot(found.tactical_diameter_uncertainty, found.drift_uncertainty * found.times[1])
    )


@pytest.mark.parametrize("side", [1, -1])
def test_drift_and_pull_out(side):
    trial = circle(side=side, beta=15.0, pull_out=200.0, residual=np.radians(0.05))
    found = measure(trial)
    assert np.degrees(found.steady_drift) == pytest.approx(15, abs=1e-6)
    assert np.degrees(found.pull_out_rate) == pytest.approx(0.05 * side, abs=1e-3)
    short = measure(circle(side=side, pull_out=10.0))
    assert short.pull_out_rate is None


def test_what_a_short_turn_does_not_reach_is_none():
    found = measure(circle(turns=0.4))
    assert found.advance is not None and found.tactical_diameter is None
    assert found.times[1:] == (None, None, None)
    assert found.steady_rate is None and found.steady_diameter is None
    json.dumps(found.to_dict(), allow_nan=False)
    assert "not reached" in found.text() and "tactical" not in found.text()


def test_turn_without_speed_or_positions():
    frame = circle().to_frame()[["t [s]", "psi [deg]", "delta_order [deg]"]]
    found = measure(Trial.from_frame(frame))
    assert found.track == "" and found.advance is None and found.steady_speed is None
    assert found.steady_rate == pytest.approx(5 / 300, rel=1e-3)


def test_turn_that_began_before_the_record():
    with pytest.raises(e.NotAManoeuvreError, match="begins with the rudder over"):
        measure(circle().window(100, 500))
    with pytest.raises(e.NotAManoeuvreError, match="no turning circle"):
        measure(circle(turns=0.2), "turning circle")


def test_a_turn_without_a_heading_while_the_rudder_is_over_is_refused():
    """The heading is another one behind a silence, in which the rudder was over: a clock or a source that changed."""
    t = np.arange(0.0, 100.0, 0.5)
    psi = np.where(t < 49.5, 0.0, np.where(t > 70.5, 170.0, np.nan))
    columns = {"t [s]": t, "psi [deg]": psi, "delta [deg]": 20.0 * ((t >= 50) & (t <= 70)), "u [m/s]": 0 * t + 5}
    with pytest.raises(e.NotAManoeuvreError, match="no heading while the rudder is over, from"):
        measure(Trial.from_frame(columns, name="silent"), "turning circle")


def test_rudder_moved_by_three_degrees():
    frame = circle().to_frame().rename(columns={"delta_order [deg]": "delta [deg]"})
    t = frame["t [s]"].to_numpy()
    frame["delta [deg]"] = np.clip(0.5 * (t - 50), 0, 35)
    trial = Trial.from_frame(frame)
    assert measure(trial, execute="moved").first_execute == pytest.approx(56, abs=0.5)  # 3 deg at 0.5 deg/s
    assert measure(trial).first_execute == pytest.approx(50, abs=0.01)


@pytest.mark.parametrize("side", [1, -1])
def test_rudder_moved_by_three_degrees_from_what_the_helm_carries(side):
    """5 deg of weather helm, to the side of the turn, then 0.5 deg/s: 3 deg more are reached after 6 s."""
    frame = circle(side=side).to_frame().rename(columns={"delta_order [deg]": "delta [deg]"})
    t = frame["t [s]"].to_numpy()
    frame["delta [deg]"] = side * np.clip(5 + 0.5 * (t - 50), 5, 35)
    assert measure(Trial.from_frame(frame), execute="moved").first_execute == pytest.approx(56, abs=0.5)


def test_speed_drift_and_track_from_what_there_is():
    t = np.arange(20.0)
    base = {"t [s]": t, "psi [deg]": np.full(20, 90.0)}
    over_all = Trial.from_frame(pd.DataFrame(base | {"U [kn]": np.full(20, 10.0)}))
    assert speed(over_all)[0] == pytest.approx(5.1444, abs=1e-4)
    assert drift(over_all) is None
    north, east, how = track(over_all)
    assert how == "speed and heading, without drift"
    np.testing.assert_allclose(north, 0, atol=1e-9)
    assert east[-1] == pytest.approx(19 * 10 * 1852 / 3600)
    both = Trial.from_frame(pd.DataFrame(base | {"u [m/s]": np.full(20, 3.0), "v [m/s]": np.full(20, -4.0)}))
    assert speed(both)[0] == pytest.approx(5)
    assert drift(both)[0] == pytest.approx(np.arctan2(4, 3))
    north, east, _ = track(both)
    assert (north[-1], east[-1]) == pytest.approx((19 * 4, 19 * 3))  # heading east, pushed to port: north
    assert track(Trial.from_frame(pd.DataFrame(base))) is None


def test_importing_the_package_costs_nothing():
    code = "import sys, shipid.trials; assert not {'pandas', 'numpy', 'pint'} & set(sys.modules), 'eager'"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_propeller_that_stops_with_the_rudder_over_ends_the_steady_turn():
    """The ship coasts on after three quarters of the record, at a fifth of its rate; what the rudder does is the same."""
    frame = circle(turns=3.0).to_frame()
    t = frame["t [s]"].to_numpy()
    stopped = 50.0 + 0.75 * (t[-1] - 50.0)
    rate = 5 / 300
    psi = frame["psi [deg]"].to_numpy()
    frame["psi [deg]"] = np.where(t < stopped, psi, np.interp(stopped, t, psi) + np.degrees(0.2 * rate * (t - stopped)))
    frame["n [1/s]"] = np.where(t < stopped, 1.5, 0.0)
    driven = measure(Trial.from_frame(frame))
    assert driven.steady_rate == pytest.approx(rate, rel=1e-3)
    # A log without the shaft speed does not show when, but that she turns no more as she did.
    adrift = measure(Trial.from_frame(frame.drop(columns="n [1/s]")))
    assert adrift.steady_rate is None and "no steady turn" in adrift.reasons["steady_rate"]


@pytest.mark.parametrize("early", [0.0, 2.0, 5.0])
def test_an_order_stamped_early_gives_both_advances(early):
    frame = circle().to_frame()
    t = frame["t [s]"].to_numpy()
    frame["delta [deg]"] = np.clip(2.5 * (t - 49.75), 0.0, 35.0)
    frame["delta_order [deg]"] = np.interp(t + early, t, frame["delta_order [deg]"])
    trial = Trial.from_frame(frame)
    found = measure(trial)
    told = [n for n in found.notes if n.kind == "order-early"]
    if not early:
        assert not told
        return
    assert found.advance == pytest.approx(300 + 5 * early, rel=0.01)
    assert len(told) == 1 and told[0].serious and "counted from there: advance 30" in told[0]
    assert "order-early" in check_trial(trial).kinds
    alone = measure(Trial.from_frame(frame.drop(columns="delta [deg]")))
    assert any("stamps that are early would not show" in note for note in alone.notes)


def test_a_turn_out_of_a_turn_has_no_course():
    """The second half of a Williamson turn: the ship turns to the other side as fast when the rudder is put over."""
    frame = circle(turns=0.8).to_frame()
    t = frame["t [s]"].to_numpy()
    before = t < 50
    frame["psi [rad]"] = frame.pop("psi [deg]") * np.pi / 180 - np.where(before, np.radians(1.0) * (t - 50), 0.0)
    found = measure(Trial.from_frame(frame), "turning circle", length="100 m")
    assert found.advance is None and found.advance_ratio is None and found.course is None
    assert (
        "it was on no course" in found.reasons["advance"]
        and found.reasons["advance_still_water"] == found.reasons["advance"]
    )
    assert found.times[0] is not None


@pytest.mark.parametrize(
    ("gain", "said"),
    [(0.02, "the speed rose by 0.4 m/s in the 20 s before"), (-0.02, "the speed fell by"), (0.001, "")],
)
def test_a_turn_from_no_steady_speed_is_told(gain, said):
    """A ship that gathers speed goes a tenth farther than from a steady approach."""
    t = np.arange(0.0, 200.0, 0.5)
    speed, psi = 8.0 + gain * t, 0.04 * np.clip(t - 20.0, 0.0, None)
    frame = pd.DataFrame({
        "t [s]": t, "psi [deg]": np.degrees(psi), "u [m/s]": speed, "delta [deg]": np.clip(3.0 * (t - 20.0), 0.0, 35.0),
        "x [m]": np.cumsum(speed * np.cos(psi)) * 0.5, "y [m]": np.cumsum(speed * np.sin(psi)) * 0.5,
    })  # fmt: skip
    told = [str(note) for note in measure(Trial.from_frame(frame)).notes if "steady approach speed" in str(note)]
    assert told[0].startswith(said) if said else not told


@pytest.mark.parametrize("early", [0.0, 3.0, -3.0])
def test_a_rudder_on_another_clock_than_the_heading_gives_both_advances(early):
    t = np.arange(0.0, 220.0, 1.0)
    rudder = np.clip(3.0 * (t - 40.0), 0.0, 35.0)
    r = np.zeros_like(t)
    for k in range(1, len(t)):
        r[k] = r[k - 1] + (0.08 * rudder[k - 1] - r[k - 1]) / 12.0
    psi = np.cumsum(r)
    north, east = np.cumsum(8.0 * np.cos(np.radians(psi))), np.cumsum(8.0 * np.sin(np.radians(psi)))
    columns = {
        "t [s]": t,
        "psi [deg]": psi,
        "x [m]": north,
        "y [m]": east,
        "delta [deg]": np.interp(t + early, t, rudder),
    }
    found = measure(Trial.from_frame(pd.DataFrame(columns), name="turn"))
    told = [n for n in found.notes if n.kind == "latency"]
    assert len(told) == (early != 0)
    if early:
        true = found.advance - 8.0 * early
        assert told[0].serious
        stated = float(told[0].split("counted from where it acts: advance ")[1].split(" m")[0])
        assert stated == pytest.approx(true, rel=0.015)


@pytest.mark.parametrize("wrong", ["feet", "exchanged"])
def test_positions_that_are_not_where_the_ship_goes_give_no_distances(wrong):
    frame = circle(noise=0.05).to_frame()
    frame["r [deg/s]"] = np.degrees(np.gradient(np.radians(frame["psi [deg]"]), frame["t [s]"]))
    if wrong == "feet":
        frame[["x [m]", "y [m]"]] /= 0.3048
    else:
        frame[["x [m]", "y [m]"]] = frame[["y [m]", "x [m]"]].to_numpy()
    found = measure(Trial.from_frame(frame, name="turn"))
    assert found.advance is None and found.tactical_diameter is None and found.drift_speed is None
    assert ("feet" if wrong == "feet" else "exchanged") in found.reasons["advance"]


def test_an_order_known_to_some_seconds_and_a_track_without_drift_are_told():
    frame = circle(interval=5.0, positions=False).to_frame().drop(columns="v [m/s]")
    frame["delta [deg]"] = frame.pop("delta_order [deg]")
    notes = measure(Trial.from_frame(frame)).notes
    assert any("the order is known to 2.5 s only: the advance lies within 12.5 m" in note for note in notes)
    assert any("as if the ship did not drift in the turn" in note for note in notes)


@pytest.mark.parametrize(("wrong", "said"), [("leap", "jump by 20 m"), ("stand", "frozen")])
def test_positions_alone_that_leap_or_stand_give_no_distances(wrong, said):
    frame = circle(noise=0.05, start=120.0, interval=1.0).to_frame().drop(columns=["u [m/s]", "v [m/s]"])
    t, x, y = (frame[c].to_numpy() for c in ("t [s]", "x [m]", "y [m]"))
    if wrong == "leap":
        frame["y [m]"] = y + 20.0 * (t > 180)
    else:
        stands = (t > 200) & (t < 220)
        frame["x [m]"], frame["y [m]"] = np.where(stands, x[t > 200][0], x), np.where(stands, y[t > 200][0], y)
    found = measure(Trial.from_frame(frame, name="turn"))
    assert found.advance is None and found.transfer is None and said in found.reasons["advance"]


def test_a_track_to_the_other_side_gives_no_distances():
    """Of a ship that loses two thirds of her speed, positions alone do not tell the doctor that they are exchanged."""
    t = np.arange(0.0, 1400.0, 1.0)
    after = np.clip(t - 120, 0, None)
    psi = np.radians(40 + 0.3 * (after - 40 * (1 - np.exp(-after / 40))))
    speed = 2.6 + 5.4 * np.exp(-after / 150)
    north, east = np.cumsum(speed * np.cos(psi)), np.cumsum(speed * np.sin(psi))
    frame = {"t [s]": t, "psi [rad]": psi, "delta [deg]": 35.0 * (t > 120), "x [m]": east, "y [m]": north}
    found = measure(Trial.from_frame(frame, name="turn"))
    assert found.advance is None and found.drift_speed is None and "to the other side" in found.reasons["transfer"]


@pytest.mark.parametrize("share", [0.3, 0.8])
def test_a_ship_that_ends_its_turn_far_more_slowly_is_in_no_steady_turn(share):
    """The wind straightens a model up on 35 deg of rudder: its steady diameter was four tactical diameters."""
    t = np.arange(0.0, 1200.0, 0.5)
    rate = np.where(t < 50, 0.0, np.where(t < 380, 1 / 60, share / 60))
    psi = 0.5 * np.cumsum(rate)
    frame = {"t [s]": t, "psi [rad]": psi, "u [m/s]": np.full(t.size, 5.0), "v [m/s]": 0.0 * t}
    found = measure(Trial.from_frame(pd.DataFrame(frame | {"delta_order [deg]": 35.0 * (t >= 50)}), name="circle"))
    known = share > 0.5
    assert (
        (found.steady_rate is not None)
        == (found.steady_diameter is not None)
        == (found.speed_loss is not None)
        == known
    )
    assert found.tactical_diameter == pytest.approx(600, rel=0.02)
    if known:
        assert found.steady_diameter == pytest.approx(600 / share, rel=0.02)
    else:
        assert "less than half of the 0.9" in found.reasons["steady_rate"]
