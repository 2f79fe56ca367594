"""A heading of two sources in turn, a clock that nothing checks, a heading that stands, silences by chance, orders across a gap."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


@pytest.fixture
def frame(simulated):
    return simulated().to_frame().drop(columns="delta_order [deg]", errors="ignore")


def alone(frame):
    return frame[["t [s]", "psi [deg]", "delta [deg]"]]


def checked(frame):
    return check_trial(Trial.from_frame(frame, name="log"))


def kinds(frame):
    return {f.kind for f in checked(frame).findings if f.confidence >= 0.5}


@pytest.mark.parametrize("pattern", [lambda k: k % 2, lambda k: (k // 12) % 2, lambda k: k % 5 == 0])
@pytest.mark.parametrize("variation", [6.0, -11.0])
@pytest.mark.parametrize("columns", [slice(None), ["t [s]", "psi [deg]", "delta [deg]"]])
def test_true_and_magnetic_in_turn(frame, pattern, variation, columns):
    other = variation * pattern(np.arange(len(frame)))
    mixed = frame.assign(**{"psi [deg]": frame["psi [deg]"] + other}).loc[:, columns]
    [found] = [f for f in checked(mixed).findings if f.kind == "heading-two-sources"]
    assert found.serious and float(found.message.partition(" values ")[2].split()[0]) == pytest.approx(
        abs(variation), rel=0.05
    )
    assert "heading-glitch" not in kinds(mixed) and any(
        getattr(n, "kind", "") == found.kind for n in measure(Trial.from_frame(mixed)).notes
    )


def test_digits_and_noise_are_no_second_source(frame):
    noisy = frame["psi [deg]"] + np.random.default_rng(0).normal(0, 0.6, len(frame))
    for psi in (noisy, np.round(frame["psi [deg]"]), np.round(noisy)):
        assert "heading-two-sources" not in kinds(frame.assign(**{"psi [deg]": psi}))


@pytest.mark.parametrize("factor", [1e-3, 1 / 60, 60.0, 1e3])
def test_a_lone_clock_in_another_unit(frame, factor):
    [found] = [
        f for f in checked(alone(frame).assign(**{"t [s]": frame["t [s]"] * factor})).findings if f.channel == "t"
    ]
    assert found.kind == "clock-scale" and found.serious and "another unit" in found.message


def test_a_lone_clock_that_nothing_checks_is_not_known(frame):
    for factor in (1.0, 1.7):
        told = checked(alone(frame).assign(**{"t [s]": frame["t [s]"] * factor}))
        assert any("Not known: whether the clock runs at the right speed" in note for note in told.notes)
    assert not any("Not known" in note for note in checked(frame).notes)


def test_a_heading_alone_that_stands(frame):
    turning = np.abs(np.gradient(frame["psi [deg]"]))
    k = int(np.argmax(turning[60:-60])) + 60
    psi = frame["psi [deg]"].to_numpy().copy()
    psi[k : k + 25] = psi[k]
    assert "frozen" in kinds(alone(frame).assign(**{"psi [deg]": psi}))
    assert "frozen" not in kinds(alone(frame))


def test_single_samples_that_are_missing_are_no_hole(frame):
    rate = frame["r [deg/s]"].to_numpy().copy()
    rate[np.random.default_rng(3).random(len(rate)) < 0.12] = np.nan
    rate[200:205] = np.nan
    assert "missing" in kinds(frame.assign(**{"r [deg/s]": rate}))


def test_a_rudder_that_moved_in_a_gap_was_not_put_over_at_once(frame):
    delta = frame["delta [deg]"].to_numpy()
    over = np.abs(np.diff(delta)) > 0.02 * np.ptp(delta)
    moving = np.convolve(over, np.ones(7), "same") > 0
    assert "order-not-feedback" not in kinds(frame[~np.append(moving, False)])


def test_a_speed_over_ground_that_stands(frame):
    still = frame.drop(columns=[c for c in frame if c[:2] in ("u ", "v ", "U ")]).assign(**{"SOG [kn]": 0.01})
    still.loc[::7, "SOG [kn]"] = 0.02
    assert "speed-stands" in kinds(still)


def test_two_near_headings_under_noise(simulated):
    """2.5 deg apart, each scattering by 0.2 deg: the largest steps are half as large again as the usual ones."""
    frame = simulated(noise="none").to_frame().drop(columns="delta_order [deg]", errors="ignore")
    k = np.arange(len(frame))
    noisy = frame["psi [deg]"] + np.random.default_rng(1).normal(0, 0.2, len(frame))
    assert "heading-two-sources" in kinds(frame.assign(**{"psi [deg]": noisy + 2.5 * (k % 2)}))
    assert "heading-two-sources" not in kinds(frame.assign(**{"psi [deg]": noisy}))
