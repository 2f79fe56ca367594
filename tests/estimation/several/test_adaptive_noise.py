"""Noise that changes its level by itself."""

from __future__ import annotations

import numpy as np
import pytest

from shipid import Component, constant, given, join, output, state
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.foundation.errors import UnknownNameError, UsageError


class Drifting(Component):
    """A thing that drifts with a speed nobody measures."""

    place = state("m", "where it is", spread="10 m")
    drift = state("m/s", "how fast it drifts", spread="1 m/s", noise="0.01 m/s^1.5")
    push = given("m/s^2", "what pushes it", default=0.0)
    L = constant("m", "length", default=1.0)
    fix = output("m", "what the fix shows", measures="place", noise="5 m")

    @place.rate
    def moves(self):
        """By its drift."""
        return self.drift

    @drift.rate
    def keeps(self):
        """Unless pushed."""
        return self.push

    @fix.equals
    def shown(self):
        """Where it is."""
        return self.place


MODEL = join("drifting", Drifting)


@pytest.fixture(scope="module")
def quiet() -> ExtendedKalmanFilter:
    return ExtendedKalmanFilter(MODEL, model_noise=False)


@pytest.fixture(scope="module")
def adaptive(quiet: ExtendedKalmanFilter) -> AdaptiveFilter:
    return AdaptiveFilter(quiet, ["drift"], factors=(1.0, 30.0), lasting=("300 s", "20 s"))


@pytest.fixture(scope="module")
def record() -> dict[str, np.ndarray]:
    """A drift of 1 m/s that turns to -1 m/s at 200 s."""
    t = np.arange(400.0)
    place = np.where(t < 200, t, 400 - t)
    return {"t": t, "place": place + 5 * np.random.default_rng(1).standard_normal(t.size), "truth": place}


def test_levels_that_are_all_the_same_change_nothing(
    quiet: ExtendedKalmanFilter, record: dict[str, np.ndarray]
) -> None:
    calm = {n: c[:200] for n, c in record.items()}
    plain = quiet.filter(calm)
    same = AdaptiveFilter(quiet, ["drift"], factors=(1.0, 1.0, 1.0), lasting=("60 s", "30 s", "10 s")).filter(calm)
    np.testing.assert_allclose(same.x, plain.x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(same.covariance, plain.covariance, rtol=1e-8)
    np.testing.assert_allclose(same.nis, plain.nis, rtol=1e-8, atol=1e-12)
    # Rejected samples count as beyond the gate; there is none here.
    assert plain.innovations["fix"].rejected == 0
    assert same.log_likelihood == pytest.approx(plain.log_likelihood, rel=1e-10)
    # Nothing tells the levels apart: they stay as probable as they last, and then as often as they are entered.
    np.testing.assert_allclose(same.probabilities[0], [0.6, 0.3, 0.1], rtol=1e-12)


def test_levels_that_are_never_left_are_a_choice_between_filters(
    quiet: ExtendedKalmanFilter, record: dict[str, np.ndarray]
) -> None:
    """Bayes' rule by hand: two filters on their own, weighted by the likelihood of all that they have seen."""
    calm = {n: c[:150] for n, c in record.items()}
    mixed = AdaptiveFilter(quiet, ["drift"], factors=(1.0, 3.0), lasting=("1e12 s", "1e12 s")).filter(calm)
    alone = [
        quiet.filter(calm),
        ExtendedKalmanFilter(MODEL, model_noise=False, noise={"drift": "0.03 m/s^1.5"}).filter(calm),
    ]
    told = np.array([np.cumsum(r.out[:, r.design.layout.full["ll"]].ravel()) for r in alone])
    weight = np.exp(told - told.max(axis=0))
    weight /= weight.sum(axis=0)
    np.testing.assert_allclose(mixed.probabilities, weight.T, rtol=1e-6, atol=1e-9)
    mean = sum(w[:, None] * r.x for w, r in zip(weight, alone))
    np.testing.assert_allclose(mixed.x, mean, rtol=1e-6, atol=1e-6)
    spread = sum(w[:, None] * (r.std**2 + (r.x - mean) ** 2) for w, r in zip(weight, alone))
    np.testing.assert_allclose(mixed.std**2, spread, rtol=1e-5)
    whole = np.logaddexp(told[0, -1], told[1, -1]) + np.log(0.5)
    assert mixed.log_likelihood == pytest.approx(whole, rel=1e-8)


def test_it_is_quiet_before_a_jump_and_quick_after_it(
    quiet: ExtendedKalmanFilter, adaptive: AdaptiveFilter, record: dict[str, np.ndarray]
) -> None:
    t, run, plain = record["t"], adaptive.filter(record), quiet.filter(record)
    loud = ExtendedKalmanFilter(MODEL, model_noise=False, noise={"drift": "0.3 m/s^1.5"}).filter(record)
    steady, after = (t > 100) & (t < 200), (t > 200) & (t < 260)

    def off(which: np.ndarray, found: np.ndarray) -> float:
        return float(np.sqrt(np.mean((found - record["truth"])[which] ** 2)))

    assert off(steady, run["place"]) < 0.8 * off(steady, loud["place"])
    assert off(after, run["place"]) < 0.5 * off(after, plain["place"])
    np.testing.assert_allclose(run.probabilities.sum(axis=1), 1.0, rtol=1e-12)
    assert run.probabilities[steady, 1].mean() < 0.2 < 0.7 < run.probabilities[(t > 205) & (t < 260), 1].max()
    # In doubt about its level the filter is less sure of the drift, and says so.
    assert run.std_of("drift")[230] > 1.5 * run.std_of("drift")[190]


def test_samples_one_by_one_give_the_same(adaptive: AdaptiveFilter, record: dict[str, np.ndarray]) -> None:
    run, online = adaptive.filter(record), adaptive.start()
    assert online.probabilities is None
    for k, t in enumerate(record["t"]):
        estimate = online.update({"t": float(t), "place": float(record["place"][k])})
    np.testing.assert_allclose(estimate.x, run.x[-1], rtol=1e-9)
    np.testing.assert_allclose(estimate.std, run.std[-1], rtol=1e-9)
    np.testing.assert_allclose(online.probabilities, run.probabilities[-1], rtol=1e-9)
    with pytest.raises(UsageError, match="cannot be saved"):
        online.save("state.json")


def test_missing_samples_and_outliers(adaptive: AdaptiveFilter, record: dict[str, np.ndarray]) -> None:
    place = record["place"].copy()
    place[50:80] = np.nan
    place[120] += 1e4
    run = adaptive.filter({"t": record["t"], "place": place})
    innovations = run.innovations["fix"]
    assert innovations.t.size == record["t"].size - 30
    assert innovations.rejected == 1
    assert abs(run["place"][125] - record["truth"][125]) < 10


def test_what_a_mixture_cannot_do(
    quiet: ExtendedKalmanFilter, adaptive: AdaptiveFilter, record: dict[str, np.ndarray]
) -> None:
    with pytest.raises(UsageError, match="has no smoother"):
        quiet.smooth(adaptive.filter(record))


def test_what_does_not_fit_is_said(quiet: ExtendedKalmanFilter) -> None:
    with pytest.raises(UnknownNameError, match="'drfit'"):
        AdaptiveFilter(quiet, ["drfit"])
    with pytest.raises(UsageError, match=r"noise to raise \(0 given\)"):
        AdaptiveFilter(quiet, [])
    with pytest.raises(UsageError, match=r"at least two factors \(1\)"):
        AdaptiveFilter(quiet, ["drift"], factors=(1.0,), lasting=("10 s",))
    with pytest.raises(UsageError, match=r"as many times they last \(3\)"):
        AdaptiveFilter(quiet, ["drift"], lasting=("10 s", "10 s", "10 s"))
    with pytest.raises(UsageError, match="each must be above zero"):
        AdaptiveFilter(quiet, ["drift"], factors=(1.0, 0.0))
    with pytest.raises(UsageError, match="each time must be longer than zero"):
        AdaptiveFilter(quiet, ["drift"], lasting=("10 s", "0 s"))
    square = ExtendedKalmanFilter(MODEL, model_noise=False, form="square-root")
    with pytest.raises(UsageError, match="form='covariance'"):
        AdaptiveFilter(square, ["drift"])
    assert "x1 for 600 s, x20 for 60 s" in repr(AdaptiveFilter(quiet, ["drift"]))
