"""A turn that is broken off has no closed loop in it; a change of course is no turning circle."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.listing import manoeuvres_in
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


def sailed(helm, duration=220.0, disturbance=0.0):
    """Sail Nomoto's ship by a helm, a function of time, heading and rate of turn in deg."""
    step, rng = 0.05, np.random.default_rng(0)
    t = np.arange(0, duration, step)
    psi, r, delta, pushed = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t), 0.0
    for k in range(len(t) - 1):
        order = helm(t[k], psi[k], r[k])
        pushed += -step * pushed / 20 + disturbance * np.sqrt(step) * rng.standard_normal()
        delta[k + 1] = delta[k] + np.clip(order - delta[k], -3 * step, 3 * step)
        r[k + 1] = r[k] + step * (0.08 * delta[k] - r[k] + pushed) / 12
        psi[k + 1] = psi[k] + step * r[k]
    noise = rng.standard_normal((3, len(t[::10])))
    table = {
        "t [s]": t[::10], "psi [deg]": 40 + psi[::10] + 0.03 * noise[0], "r [deg/s]": r[::10] + 0.01 * noise[1],
        "delta [deg]": delta[::10] + 0.05 * noise[2],
    }  # fmt: skip
    return Trial.from_frame(pd.DataFrame(table), name="sailed")


def pilot(course, start=60.0, limit=20.0):
    """Return an autopilot that changes the course once."""
    return lambda t, psi, r: float(np.clip(1.2 * (course * (t > start) - psi) - 12 * r, -limit, limit))


def put_over(until):
    """Return a helm that is hard over until a heading, and amidships from then on."""
    done = []

    def helm(t, psi, r):
        if psi > until:
            done.append(t)
        return 35.0 if t > 30 and not done else 0.0

    return helm


@pytest.mark.parametrize("until", [45, 60, 75, 100])
def test_a_turn_that_is_broken_off_is_no_closed_loop(until):
    trial = sailed(put_over(until))
    diagnosis = check_trial(trial)
    assert not [f.kind for f in diagnosis.findings]
    if until < 60:
        with pytest.raises(NotAManoeuvreError) as refused:
            measure(trial)
        assert "closed loop" not in str(refused.value)
    if until == 100:
        assert measure(trial).kind == "turning circle" and not measure(trial).notes[1:]
        assert "turning circle" in manoeuvres_in(trial, diagnosis)[0].title


def test_an_autopilot_that_changes_the_course_is_still_found():
    found = [f.kind for f in check_trial(sailed(pilot(60), 400.0, 0.06)).findings]
    assert "closed-loop" in found


def test_a_change_of_course_is_called_one():
    """An autopilot turns by 180 deg at its limit of 20 deg, and eases the rudder."""
    trial = sailed(pilot(180), 500.0, 0.06)
    (listed,) = manoeuvres_in(trial, check_trial(trial))
    assert listed.title.startswith("change of course with 20 deg of rudder")
    assert any("it is a change of course" in str(note) for note in measure(trial).notes)
