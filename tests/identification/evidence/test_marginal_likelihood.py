"""The spread of rudder biases: a linear model with normal noise, whose marginal likelihood has a closed form.

Each trial shows one slope, swing + gain (bias of the rudder): one-way random effects with known errors. The trials are equally
long, so that the likelihood of the spread s, with the mean integrated out, is the one of the scatter of n slopes about their mean,
(e^2 + s^2)^(-(n - 1) / 2) exp(-S / (2 (e^2 + s^2))), where e is the standard error of a slope over the gain and S the sum of
squares of the slopes over the gain about their mean (Searle, Casella and McCulloch 1992).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import quad
from scipy.stats import chi2

import shipid
from shipid.identification.evidence.bias_spread import EXPECTED, BiasSpread, probability_of_common
from shipid.identification.evidence.marginal_likelihood import Weighing, conclude
from shipid.identification.problem.box import box_of
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.prior import Prior
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.least_squares import minimise
from shipid.identification.uncertainty.covariance import covariance_of

GAIN, NOISE, MEAN = 0.05, np.deg2rad(0.5), np.deg2rad(3.0)
GRID = np.deg2rad([0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6])
BOX = box_of({"swing": (0.0, -1.0, 1.0)})


def problem_of(drift, biases, count=61, seed=1, steps=None):
    """Trials of a ship that drifts by 1e-4 rad/s, whose rudder is off by these biases in rad."""
    rng, trials = np.random.default_rng(seed), []
    for k, (bias, samples) in enumerate(zip(biases, steps or [count] * len(biases))):
        t = np.arange(samples, dtype=float)
        psi = (1e-4 + GAIN * bias) * t + NOISE * rng.standard_normal(samples)
        table = pd.DataFrame({"t [s]": t, "delta [rad]": 0.0 * t, "psi [rad]": psi, "u [m/s]": 5.0 + 0.0 * t})
        trials.append(prepare(drift, shipid.Trial.from_frame(table, name=f"trial-{k}"), ("psi",), None))
    sigma = np.array([NOISE])
    problem = make_problem(drift, trials, ("psi",), ("swing",), {"gain": GAIN}, sigma, ("delta",))
    return replace(problem, prior=Prior({"delta": np.deg2rad(0.4)}, {"delta": MEAN}, {}, {}))


def concluded(problem, records=None, given=True, least=0.02):
    said = []
    records = len(problem.trials) if records is None else records
    found = minimise(problem, problem.first_guess(BOX.start), BOX, most=50)
    return (*conclude(found, problem, BOX, Weighing(np.array([least]), given, 20.0, said.append, records)), said)


def closed_form(problem):
    """Density of the spread but for a factor, times the spread: even in its logarithm."""
    t = problem.trials[0].t
    slopes = np.array([np.polyfit(t, d.measured[0], 1)[0] for d in problem.trials]) / GAIN
    error = NOISE / np.sqrt(((t - t.mean()) ** 2).sum()) / GAIN
    squares, freedom = ((slopes - slopes.mean()) ** 2).sum(), len(slopes) - 1

    def density(spread):
        variance = error**2 + spread**2
        return spread * variance ** (-freedom / 2) * np.exp(-squares / (2 * variance)) / (1 + (spread / EXPECTED) ** 2)

    return density


def shares_of(problem):
    """Probabilities of the spreads that are tried, by the closed form, each over its neighbourhood in the logarithm."""
    logs = np.log(GRID)
    width = np.gradient(logs) * np.array([0.5, *[1.0] * 5, 0.5])
    share = closed_form(problem)(GRID) * width
    return share / share.sum()


@pytest.fixture(scope="module")
def problem(drift):
    return problem_of(drift, np.deg2rad([0.5, -0.3, 0.1, 0.9, -0.6]))


@pytest.fixture(scope="module")
def found(problem):
    return concluded(problem)


def test_probabilities_of_the_spread_are_those_of_the_closed_form(problem, found):
    solution, spread, said = found
    share = shares_of(problem)
    counted = np.where(share > 1e-3, share, 0.0)
    by_spread = {o.problem.prior.biases["delta"]: o.probability for o in solution.others}
    assert list(by_spread) == pytest.approx(list(GRID[counted > 0]))
    assert list(by_spread.values()) == pytest.approx(list((counted / counted.sum())[counted > 0]), rel=1e-3)
    assert spread.value == pytest.approx(np.exp(share @ np.log(GRID)), rel=1e-3)
    assert said[-1] == f"spread of the rudder biases: {np.rad2deg(spread.value):.2g} deg"


@pytest.mark.parametrize("biases", [(0.5, -0.3, 0.1, 0.9, -0.6), (0.02, -0.02, 0.0, 0.03), (0.37, -0.37)])
def test_seven_spreads_stand_for_all(drift, biases):
    """The mean of the logarithm and the interval by numerical integration over the range that is tried."""
    problem = problem_of(drift, np.deg2rad(biases), seed=3)
    _, spread, _ = concluded(problem)
    density = closed_form(problem)

    def by_log(log):
        return density(np.exp(log))

    first, last = np.log(GRID[[0, -1]])
    whole, _ = quad(by_log, first, last)
    mean, _ = quad(lambda x: x * by_log(x) / whole, first, last)
    assert np.log(spread.value) == pytest.approx(mean, abs=0.06)
    # A share lies anywhere in its neighbourhood, which is wide by a factor of two.
    for end, part in zip(spread.interval, (0.025, 0.975)):
        assert abs(quad(by_log, first, np.log(end))[0] / whole - part) < 0.02


def test_the_covariance_is_the_mean_over_the_spreads_and_the_scatter_about_the_estimate(drift):
    """The law of total covariance, of trials of unequal length: their estimates move with the spread."""
    problem = problem_of(drift, np.deg2rad([0.6, -0.2, 0.1]), steps=[200, 40, 40])
    solution, _, _ = concluded(problem)
    expected, moved = np.zeros((problem.size, problem.size)), []
    for one in solution.others:
        prior = replace(problem.prior, biases={"delta": one.problem.prior.biases["delta"]})
        alone = minimise(replace(problem, prior=prior), solution.q, BOX, most=50, tolerance=1e-12)
        step = alone.q - solution.q
        moved.append(step)
        expected += one.probability * (covariance_of(alone).matrix + np.outer(step, step))
    assert sum(o.probability for o in solution.others) == pytest.approx(1.0)
    own = covariance_of(solution)
    size = np.sqrt(np.diag(expected))
    # The search at each spread ends with a relative change of 1e-6.
    assert own.matrix / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=1e-3)
    # The mean bias is known to 3 degrees; how far they are apart is known well, and there both parts count.
    places = [problem.own(i).start + 1 for i in range(3)]
    apart = np.zeros(problem.size)
    apart[places] = [1.0, -0.5, -0.5]
    at_one = covariance_of(replace(solution, others=()))
    assert apart @ own.matrix @ apart == pytest.approx(apart @ expected @ apart, rel=1e-3)
    assert np.abs(moved @ apart).max() > 0.3 * np.sqrt(apart @ own.matrix @ apart)
    assert apart @ own.matrix @ apart > 1.05 * (apart @ at_one.matrix @ apart)
    assert own.excess == pytest.approx(at_one.excess * np.diag(own.matrix) / np.diag(at_one.matrix), rel=1e-6)


def test_every_variance_stays_positive_whatever_is_known_beforehand(found):
    solution, _, _ = found
    for std in (1e-9, 1e-3, np.inf):
        matrix = covariance_of(solution, np.array([std])).matrix
        assert np.linalg.eigvalsh(matrix).min() >= -1e-12 * np.abs(matrix).max()
        assert matrix[0, 0] > 0
    # What is known that well beforehand stays.
    assert covariance_of(solution, np.array([1e-9])).matrix[0, 0] == pytest.approx(1e-18, rel=0.01)


def test_two_trials_to_both_sides_have_opposite_biases_about_their_mean(drift):
    problem = problem_of(drift, np.deg2rad([0.7, -0.7]))
    solution, spread, _ = concluded(problem)
    bias = np.array([solution.q[problem.own(i)][-1] for i in range(2)])
    slopes = [np.polyfit(d.t, d.measured[0], 1)[0] / GAIN for d in problem.trials]
    # Each is drawn towards the other by the share of its error in the variance.
    error = NOISE / np.sqrt(((problem.trials[0].t - 30.0) ** 2).sum()) / GAIN
    share = spread.value**2 / (spread.value**2 + error**2)
    assert bias[0] - bias[1] == pytest.approx(share * (slopes[0] - slopes[1]), rel=1e-4)
    assert list(spread.alone) == ["trial-0", "trial-1"]
    free = [spread.alone[n][0] for n in spread.alone]
    assert free[0] - free[1] == pytest.approx(slopes[0] - slopes[1], rel=0.01)
    assert [spread.alone[n][1] for n in spread.alone] == pytest.approx([spread.alone["trial-0"][1]] * 2, rel=0.2)


def test_the_stretches_of_one_record_tell_nothing_of_the_spread(problem):
    solution, spread, said = concluded(problem, records=1)
    assert spread is None and solution.others == () and said == []
    assert solution.problem.prior.biases == problem.prior.biases


def test_without_a_bias_of_the_rudder_or_a_prior_there_is_no_spread(problem):
    for prior in (None, replace(problem.prior, biases={})):
        _, spread, _ = concluded(replace(problem, prior=prior))
        assert spread is None


def test_a_search_that_ran_away_is_not_gone_on_with(problem, monkeypatch):
    found = minimise(problem, problem.first_guess(BOX.start), BOX, most=50)
    weighing = Weighing(np.array([0.02]), True, 20.0, lambda _: None, 5)
    away = replace(found, residual=np.full_like(found.residual, 1e7))
    assert conclude(away, problem, BOX, weighing)[1] is None
    # One that runs away under weights of its own has none to take the mean of.
    with monkeypatch.context() as patch:
        patch.setattr(Weighing, "again", lambda *_: away)
        assert conclude(found, problem, BOX, weighing) == (away, None)
    # One that runs away only on every sample has no spread either.
    module = "shipid.identification.evidence.marginal_likelihood._on_every_sample"
    monkeypatch.setattr(module, lambda *_: away)
    assert conclude(found, problem, BOX, weighing) == (away, None)


def test_weights_follow_the_residuals_unless_they_are_given(problem):
    """White noise of one sample a second, and 20 s for independence: the root of a twentieth of its level."""
    assert concluded(problem, given=True)[0].problem.sigma[0] == NOISE
    sigma = concluded(problem, given=False)[0].problem.sigma[0]
    assert sigma == pytest.approx(NOISE / np.sqrt(20.0), rel=0.15)


def test_a_structure_that_is_wrong_is_told_from_noise(drift):
    """White noise as large as the error of a structure is none; a swing of the heading that the model lacks is one if large enough."""
    problem = problem_of(drift, np.deg2rad([0.5, -0.5]))
    assert not concluded(problem, least=NOISE)[1].structural
    lasting = []
    for data in problem.trials:
        swung = data.measured + np.deg2rad(2.0) * np.sin(2 * np.pi * data.t / 40.0)
        lasting.append(replace(data, measured=swung))
    wrong = replace(problem, trials=tuple(lasting))
    assert concluded(wrong)[1].structural
    assert not concluded(wrong, least=np.deg2rad(10.0))[1].structural


@pytest.mark.parametrize("apart", [0.0, 0.1, 0.5, 2.0])
def test_the_probability_of_a_common_bias_is_that_of_two_normal_ones(apart):
    """Their difference over the root of both variances and twice the spread, integrated over the half-Cauchy distribution."""
    first, second = np.deg2rad([0.2, 0.1])
    bias = np.deg2rad(1.0) + np.deg2rad(apart) * np.array([0.5, -0.5])

    def integrand(spread):
        square = np.deg2rad(apart) ** 2 / (first**2 + second**2 + 2 * spread**2)
        return chi2.sf(square, 1) * 2 / (np.pi * EXPECTED * (1 + (spread / EXPECTED) ** 2))

    # The tail beyond holds the rest of the probability, and any bias agrees with so large a spread.
    expected = quad(integrand, 0, 20 * EXPECTED, limit=200)[0] + quad(integrand, 20 * EXPECTED, np.inf, limit=400)[0]
    found = probability_of_common(bias, np.diag([first**2, second**2]))
    assert found == pytest.approx(expected, abs=2e-3)


def test_errors_that_trials_share_do_not_put_biases_apart():
    """Covariance that is common to all moves the mean alone."""
    bias, own = np.deg2rad([0.3, -0.1, 0.4]), np.deg2rad(0.2) ** 2 * np.eye(3)
    shared = own + np.deg2rad(5.0) ** 2
    assert probability_of_common(bias, shared) == pytest.approx(probability_of_common(bias, own), rel=1e-6)


@pytest.mark.parametrize(
    ("p_value", "structural", "agree"), [(0.04, True, False), (0.06, True, True), (0.0, False, True)]
)
def test_biases_that_disagree_are_an_error_of_the_structure_where_one_is_left(p_value, structural, agree):
    alone = {"port": (np.deg2rad(-0.86), 1e-3), "starboard": (np.deg2rad(-0.12), 1e-3)}
    spread = BiasSpread(np.deg2rad(0.4), tuple(np.deg2rad([0.1, 1.2])), alone, p_value, structural)
    assert spread.agree is agree and spread.to_dict()["agree"] is agree
    assert spread.words == "spread from trial to trial 0.4 deg, 95 % from 0.1 to 1.2 deg"
    if agree:
        assert spread.notice is None
        return
    assert spread.notice.kind == "biases-disagree" and not spread.notice.serious
    assert str(spread.notice).startswith(
        "With a rudder bias of its own each trial asks for -0.86 deg (port), -0.12 deg (starboard): rudders are so far apart with a "
        "probability of 0.04, and the model leaves more of the trials than noise."
    )
