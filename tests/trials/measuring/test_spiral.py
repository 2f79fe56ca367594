import json
import re

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.measuring.measure import detect, measure
from shipid.trials.trial import Trial

STAIRS = [15, 10, 5, 2.5, 1.25, 0, -1.25, -2.5, -5, -10, -15, -10, -5, -2.5, -1.25, 0, 1.25, 2.5, 5, 10, 15]


def sail(rudder, interval=0.5, a=0.02, b1=0.02, b3=0.05, noise=0.0):
    """A ship with r' = a delta - b1 r - b3 r^3 (deg, deg/s, 1/s), sailed with this rudder in sub-steps."""
    psi, rates, rate = [0.0], [0.0], 0.0
    fine = interval / 5
    for angle in rudder[1:]:
        heading = psi[-1]
        for _ in range(5):
            rate += fine * (a * angle - b1 * rate - b3 * rate**3)
            heading += fine * rate
        psi.append(heading)
        rates.append(rate)
    scatter = np.random.default_rng(4).normal(0, noise, len(psi)) if noise else 0.0
    frame = {"t [s]": interval * np.arange(len(psi)), "psi [deg]": np.array(psi) + scatter, "delta [deg]": rudder}
    return Trial.from_frame(pd.DataFrame(frame), name="spiral")


def direct(hold=400.0, interval=0.5, **ship):
    stairs = np.repeat([0.0, *STAIRS], round(hold / interval))
    return sail(stairs, interval, **ship)


def steady(angle, a=0.02, b1=0.02, b3=0.05):
    """Real steady rates of turn at a rudder angle."""
    roots = np.roots([b3, 0.0, b1, -a * angle])
    return np.sort(roots[np.abs(roots.imag) < 1e-9].real)


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_stable_ship_has_no_loop(noise):
    trial = direct(noise=noise)
    assert detect(trial) == "spiral"
    found = measure(trial)
    assert found.title == "direct spiral" and found.kind == "spiral"
    np.testing.assert_allclose(np.degrees(found.rudders[-21:]), STAIRS, atol=1e-6)
    np.testing.assert_allclose(np.degrees(found.rates[-21:]), [steady(d)[0] for d in STAIRS], atol=2e-3)
    assert np.degrees(found.loop_height) == pytest.approx(0, abs=3e-3)
    assert np.degrees(found.loop_width) == pytest.approx(0, abs=1e-2)
    # At midships the slope is a/b1, less what the cube makes of the stages at 1.25 deg.
    assert found.slope == pytest.approx(steady(1.25)[0] / 1.25, rel=0.01)


def test_unstable_ship_has_a_loop_of_the_height_of_its_steady_rates():
    """At midships r = sqrt(0.08/0.05) = 1.265 deg/s to either side; it jumps where d = 2 b1 r/(3 a), r^2 = -b1/(3 b3)."""
    found = measure(direct(hold=400.0, b1=-0.08))
    at_rest = steady(0.0, b1=-0.08)
    assert 2 * 0.08 / (3 * 0.02) * np.sqrt(0.08 / 0.15) == pytest.approx(1.947, abs=1e-3)
    assert np.degrees(found.loop_height) == pytest.approx(at_rest[2] - at_rest[0], rel=1e-3)
    # The stages bracket the jump: it lies between 1.25 and 2.5 deg on either side.
    assert 2.5 <= np.degrees(found.loop_width) <= 5.0
    assert found.slope is None
    assert any("the loop is 2.5 deg to 5 deg wide" in note for note in found.notes)


def test_stages_held_longer_near_midships_are_still_those_of_the_rudder():
    """All begin at whole hundreds of seconds: that is no sensor that is read every 100 s, nor a rate that is held."""
    held = np.concatenate([np.full(600 if abs(angle) <= 5 else 200, float(angle)) for angle in [0.0, *STAIRS]])
    found = measure(sail(held))
    assert found.title == "direct spiral"
    assert found.loop_height == pytest.approx(0.0, abs=1e-3)


def test_reversed_spiral_shows_the_unstable_branch():
    """The rudder that holds each rate: d = (b1 r + b3 r^3)/a, its extremes at r = +-sqrt(-b1/(3 b3))."""
    a, b1, b3 = 0.02, -0.02, 0.05
    stairs = np.array([1.2, 0.9, 0.6, 0.45, 0.3, 0.15, 0.0, -0.15, -0.3, -0.45, -0.6, -0.9, -1.2])
    wanted = np.repeat([*stairs, *stairs[-2::-1]], 400)
    rates = np.zeros(len(wanted))
    rudder = np.zeros(len(wanted))
    for k in range(1, len(wanted)):
        # A helmsman that brings the rate there within some 5 s, and hunts a little.
        change = float(np.clip((wanted[k] - rates[k - 1]) / 5.0, -0.05, 0.05))
        rates[k] = rates[k - 1] + 0.5 * change
        rudder[k] = (change + b1 * rates[k] + b3 * rates[k] ** 3) / a + 0.3 * np.sin(k / 3.0)
    frame = pd.DataFrame(
        {"t [s]": 0.5 * np.arange(len(rates)), "psi [deg]": 0.5 * np.cumsum(rates), "delta [deg]": rudder}
    )
    found = measure(Trial.from_frame(frame))
    assert found.title == "reversed spiral"
    r = np.sqrt(-b1 / (3 * b3))
    width = -2 * (b1 * r + b3 * r**3) / a
    # The stages stand at 0.3 and 0.45 deg/s, the extreme at 0.365.
    assert np.degrees(found.loop_width) == pytest.approx(width, rel=0.05)
    # Straight lines between the stages at 0.6 and 0.9 deg/s: the curve bends by 2.5 % there.
    assert np.degrees(found.loop_height) == pytest.approx(2 * np.sqrt(-b1 / b3), rel=0.03)
    assert found.slope == pytest.approx(a / b1, rel=0.05) and found.slope < 0


def test_stages_that_have_not_settled_give_no_loop():
    """Around the jump the ship takes longer than 60 s: a loop read there is of the hurry, not of the ship."""
    found = measure(direct(hold=60.0, b1=0.0, b3=0.01, a=0.002))
    assert found.loop_height is None and "had not settled in stage" in found.reasons["loop_height"]
    assert any("had not settled" in note for note in found.notes)
    json.dumps(found.to_dict(), allow_nan=False)
    assert "not known" in found.text() and "; hold the rudder longer there" in found.reasons["loop_width"]
    # The stages that have settled still hold the loop between two angles.
    assert sum("the loop is 0 deg to" in note for note in found.notes) == 1


def test_the_height_of_a_loop_asks_for_the_stages_at_midships_alone():
    """The jump lies at 2.25 deg, and a stage beside it is slow to leave; at midships she has settled."""
    found = measure(direct(hold=100.0, b1=-0.088))
    assert found.loop_width is None and "had not settled" in found.reasons["loop_width"]
    assert np.degrees(found.loop_height) == pytest.approx(2 * np.sqrt(0.088 / 0.05), rel=0.01)
    assert "loop_height" not in found.reasons


def test_no_zero_has_a_sign():
    trial = direct()
    frame = trial.to_frame()
    frame["delta [deg]"] -= 0.001
    assert re.findall(r"-0\.0+\b(?![1-9])", measure(Trial.from_frame(frame)).text()) == []


def test_a_gap_in_a_stage():
    trial = direct()
    frame = trial.to_frame()
    frame.loc[(trial["t"] > 2650) & (trial["t"] < 2790), "psi [deg]"] = np.nan
    found = measure(Trial.from_frame(frame))
    lost = [k for k, rate in enumerate(found.rates, start=1) if rate is None]
    assert len(lost) == 1 and "gap" in found.reasons[f"rates[{lost[0]}]"]


def test_a_zigzag_is_no_spiral(logged):
    with pytest.raises(e.NotAManoeuvreError, match="no spiral"):
        measure(logged(0.5)[0], "spiral")


def test_the_way_back_to_midships_is_no_stage():
    """A direct spiral after a straight approach, which ends with the rudder put amidships at once from its largest angle."""
    trial = sail(np.repeat([0.0, 15, 10, 5, 0, -5, -10, -15, -10, -5, 0, 5, 10, 15, 0], 160), b1=0.08, b3=0.0)
    found = measure(trial)
    assert found.title == "direct spiral"
    np.testing.assert_allclose(
        np.degrees(found.rudders), [0, 15, 10, 5, 0, -5, -10, -15, -10, -5, 0, 5, 10, 15, 0], atol=0.01
    )


def test_a_low_loop_of_stages_that_are_not_quite_settled_is_said_to_be_none():
    """Width and height stood on the sheet of a stable ship without a word, beside a slope that says she is stable."""
    found = measure(direct(hold=150.0))
    assert 0 < np.degrees(found.loop_height) < 0.05 * steady(15)[0] and found.slope > 0
    assert sum(note.startswith("no loop: its height is less than 5 %") for note in found.notes) == 1
    assert not any("no loop" in note for note in measure(direct(b1=-0.08)).notes)
