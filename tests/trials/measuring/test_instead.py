"""What a record is that is no manoeuvre."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.measuring.instead import propeller_words, steered_by_hand
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


def by_hand(orders, slow=150.0):
    """A ship that loses way, and a rudder that is put over by hand: from when [s] on which angle [deg]."""
    t = np.arange(0, 300, 0.5)
    u = np.exp(-t / slow)
    delta, rate, psi = np.zeros(t.size), np.zeros(t.size), np.zeros(t.size)
    for k in range(1, t.size):
        wanted = next((angle for when, angle in reversed(orders) if t[k] >= when), 0.0)
        delta[k] = delta[k - 1] + np.clip(wanted - delta[k - 1], -1.5, 1.5)
        rate[k] = rate[k - 1] + 0.05 * u[k] * (0.05 * u[k] ** 2 * delta[k - 1] - rate[k - 1])
        psi[k] = psi[k - 1] + 0.5 * rate[k]
    return pd.DataFrame({"t [s]": t, "psi [deg]": psi, "delta [deg]": delta, "u [m/s]": 3 * u})


BY_HAND = [
    [
        (15, -35),
        (41, 0),
        (51, 35),
        (58, 0),
        (69, -35),
        (86, 35),
        (115, -35),
        (143, 35),
        (151, 0),
        (157, 35),
        (183, -35),
    ],
    [(23, 35), (47, 0), (54, 6), (71, 35), (88, 0), (94, -35), (133, 35), (154, 0), (157, -35), (185, 35), (197, 0)],
    [(17, -35), (47, 0), (51, 35), (63, 0), (68, 35), (81, -35), (108, 0), (116, -6), (127, 35), (142, -35), (154, 0)],
]


@pytest.mark.parametrize("orders", BY_HAND)
@pytest.mark.parametrize("columns", [["u [m/s]"], []])
def test_a_rudder_that_is_put_over_by_hand_is_no_manoeuvre(orders, columns):
    """A berthing without revolutions: no heading orders the reversals."""
    frame = by_hand(orders)[["t [s]", "psi [deg]", "delta [deg]", *columns]]
    with pytest.raises((e.NotAManoeuvreError, e.SeveralManoeuvresError)):
        measure(Trial.from_frame(frame))


def test_reversals_that_no_heading_orders_are_doubted_where_the_kind_is_stated():
    found = measure(Trial.from_frame(by_hand(BY_HAND[0])), "zig-zag")
    assert found.doubt and next(n.kind for n in found.notes if getattr(n, "serious", False)) == "no-zigzag"


@pytest.mark.parametrize(
    ("headings", "others", "word"),
    [
        ((10.0, 10.4, 9.8, 10.1), 9, ""),
        ((10.0, 9.0), 0, ""),
        ((10.0, None, 9.0), 0, ""),
        ((-3.9, 1.9, -0.2), 0, "no heading ordered it"),
        ((20.0, 3.0, 31.0, 9.0), 0, "at no one heading"),
        ((20.0, 3.0), 0, "at no one heading"),
        ((20.0,), 6, "over 6 times more"),
    ],
)
def test_what_orders_a_reversal(headings, others, word):
    said = steered_by_hand([None if h is None else np.radians(h) for h in headings], others)
    assert (word in said) if word else said == ""


def test_a_ship_that_loses_her_way(logged):
    trial, *_ = logged(0.5)
    frame = trial.to_frame()
    frame["u [m/s]"] = 8 * np.exp(-frame["t [s]"] / 60)
    [told] = [n for n in measure(Trial.from_frame(frame)).notes if getattr(n, "kind", "") == "propeller"]
    assert told.serious and "no rudder brakes a ship so far" in told


@pytest.mark.parametrize("rate", [True, False])
def test_a_rudder_that_counts_to_port_is_named_where_nothing_is_measured(logged, rate):
    """Without a rate of turn the sign is told from the heading."""
    trial, *_ = logged(0.5, noise=0.05)
    frame = trial.to_frame()
    frame["delta [deg]"] *= -1.0
    if rate:
        frame["r [deg/s]"] = np.degrees(np.gradient(trial["psi"], trial["t"]))
    with pytest.raises(
        e.NotAManoeuvreError, match=r"The doctor finds rudder-sign .*positive delta turns the ship to port"
    ):
        measure(Trial.from_frame(frame))
