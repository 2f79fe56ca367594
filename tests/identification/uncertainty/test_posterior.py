"""The sampled posterior: against a closed form, and what it refuses."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import MissingExtraError, UsageError
from shipid.identification.errors import PosteriorError

pytest.importorskip("emcee")

SIGMA, COUNT = np.deg2rad(0.5), 240


@pytest.fixture(scope="module")
def linear(drift, drifting):
    """A fit whose posterior is a normal density: heading = psi0 + gain * integral of delta + swing * t, white noise."""
    trial, design = drifting(SIGMA, COUNT, seed=11)
    fit = shipid.identify(drift, [trial], noise={"psi": (SIGMA, "rad")}, rudder_bias=False, signals=["psi"])
    psi = trial["psi"]
    covariance = SIGMA**2 * np.linalg.inv(design.T @ design)
    mean = covariance @ design.T @ psi / SIGMA**2
    return fit, mean[:2], np.sqrt(np.diag(covariance))[:2]


@pytest.fixture(scope="module")
def drawn(linear):
    return linear[0].sample_posterior(8_000, seed=1)


def test_against_the_closed_form(linear, drawn):
    fit, mean, spread = linear
    assert drawn.names == ("gain", "swing") and fit.identified.problem.size == 3
    assert fit.identified.solution.parameters == pytest.approx(mean, rel=1e-6)
    assert drawn.mixed
    # So many independent draws tell a mean to 1/sqrt(n) and a standard deviation to 1/sqrt(2n) of it; four of those.
    few = drawn.independent.min()
    assert few > 200
    assert np.abs(drawn.draws.mean(axis=0) - mean).max() < (4 * spread / np.sqrt(few)).max()
    assert drawn.draws.std(axis=0) == pytest.approx(spread, rel=4 / np.sqrt(2 * few))
    assert drawn.quantiles[[0, -1]] == pytest.approx(
        mean + np.outer([-1.96, 1.96], spread), rel=0.15, abs=0.3 * spread.max()
    )
    # The fit takes its noise from the residuals, and is by as much off the closed form.
    for k, estimate in enumerate(fit.parameters.values()):
        assert drawn.width_over_gaussian(k) == pytest.approx(spread[k] / estimate.std, abs=0.12)


def test_what_it_gives(linear, drawn):
    plain = json.loads(json.dumps(drawn.to_dict(), allow_nan=False))
    assert set(plain) == {"draws", "walkers", "acceptance", "mixed", "parameters"}
    assert set(plain["parameters"]["gain"]["quantiles"]) == {"2.5", "16", "50", "84", "97.5"}
    assert list(drawn.to_frame().columns) == ["gain", "swing"] and len(drawn.to_frame()) >= 8_000
    assert "times as wide as the fit's" in drawn.text()
    short, again = (linear[0].sample_posterior(400, seed=3) for _ in range(2))
    assert not short.mixed and "TOO FEW" in short.text()
    assert np.array_equal(short.draws, again.draws)


def test_too_few_draws_are_refused(linear):
    with pytest.raises(UsageError, match=r"10 draws are 0.3 steps of 32 walkers; ask for 1600"):
        linear[0].sample_posterior(10)


def test_too_many_unknowns_are_refused(sail):
    trials = [sail("norrbin", "zeefakkel", sampling="4 s", seed=i, name=f"t{i}") for i in range(10)]
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1)
    with pytest.raises(PosteriorError, match="33 unknowns"):
        fit.sample_posterior()


def test_a_regression_has_no_likelihood(sail):
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="zeefakkel", method="equation-error")
    with pytest.raises(UsageError, match="this fit is by equation-error"):
        fit.sample_posterior()


def test_without_the_sampler(linear, monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'shipid\[posterior\]'"):
        linear[0].sample_posterior()
