"""What a record is that is no manoeuvre."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.measuring.instead import propeller_words
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


def steered(course, interval=1.0, duration=1200.0, noise=0.0):
    """An autopilot that keeps and changes courses, on Nomoto's ship; deg."""
    t = np.arange(0, duration, interval)
    rng = np.random.default_rng(2)
    psi, rate, rows = course(0.0), 0.0, []
    for now in t:
        delta = float(np.clip(1.2 * (course(now) - psi) - 12.0 * rate, -15, 15))
        rows.append((now, psi, delta))
        rate += interval * (0.08 * delta - rate) / 12.0 + noise * rng.normal()
        psi += interval * rate
    return Trial.from_frame(pd.DataFrame(rows, columns=["t [s]", "psi [deg]", "delta [deg]"]))


def test_course_changes_are_named():
    trial = steered(lambda t: 45.0 + 20.0 * (int(t / 200) % 2), noise=0.002)
    with pytest.raises(e.NotAManoeuvreError, match=r"courses kept and changed: 5 changes of up to 20 deg.*closed loop"):
        measure(trial)


def test_course_keeping_is_named():
    trial = steered(lambda t: 45.0, noise=0.01)
    with pytest.raises(e.NotAManoeuvreError, match="neither a zig-zag nor a turning circle"):
        measure(trial)


def test_a_rudder_that_stays(logged):
    trial, *_ = logged(0.5)
    frame = trial.to_frame()
    frame["delta [deg]"] = 2.0
    with pytest.raises(e.NotAManoeuvreError, match="The rudder stays where it is"):
        measure(Trial.from_frame(frame))


@pytest.mark.parametrize(("late", "word"), [(0.0, "stopped"), (-1.0, "reversed")])
def test_the_propeller_is_named(late, word):
    t = np.arange(0, 100.0)
    n = np.where(t < 3, 0.0, np.where(t < 60, 2.0, late))
    table = pd.DataFrame({"t [s]": t, "psi [deg]": 0.0, "n [rps]": n})
    assert propeller_words(Trial.from_frame(table)) == f"The propeller is {word} at 60 s."
    table["n [rps]"] = 2.0
    assert propeller_words(Trial.from_frame(table)) == ""


def test_amidships_between_two_plates_is_no_reversal():
    """35 deg, 20 s amidships, then the other way: a berthing, not a zig-zag."""
    t = np.arange(0, 120.0, 0.5)
    delta = np.select([t < 20, t < 35, t < 60, t < 75], [0.0, 35.0, 0.0, -35.0], 0.0)
    rate = np.zeros_like(t)
    for k in range(1, len(t)):
        rate[k] = rate[k - 1] + 0.5 * (0.08 * delta[k - 1] - rate[k - 1]) / 8.0
    frame = pd.DataFrame({"t [s]": t, "psi [deg]": 0.5 * np.cumsum(rate), "delta [deg]": delta})
    with pytest.raises(e.NotAManoeuvreError, match="is no zig-zag"):
        measure(Trial.from_frame(frame), "zig-zag")
