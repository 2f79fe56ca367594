"""A model that lacks an effect of the ship's gives wide intervals and says why; one that lacks none gives those of noise."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

import shipid
from shipid.identification.evidence.missing_effect import _coloured, missing_effect

#: Gain of the Mariner, and T1 + T2 - T3 (Fossen 1994, after Chislett and Stroem-Tejsen 1965).
GAIN, TIME = 0.185, 118.0 + 7.8 - 18.5


@pytest.fixture(scope="module")
def records():
    sailed = [
        shipid.simulate("nomoto-second-order", "mariner", m, noise="standard", seed=k, name=m)
        for k, m in enumerate(("zigzag:20/20", "zigzag:10/10", "turn:20"))
    ]
    return sailed[:2], sailed[2]


@pytest.fixture(scope="module")
def too_simple(records):
    fitted, kept = records
    return shipid.assess(shipid.identify("nomoto", fitted, ship="mariner", validate=[kept], starts=1))


def test_a_first_order_model_of_a_second_order_ship_holds_her_gain_and_says_what_it_lacks(too_simple):
    """It gave K as 0.107 ± 0.002, where 0.185 is right, without a word."""
    for name, truth in (("K", GAIN), ("tau", TIME)):
        e = too_simple.parameters[name]
        assert e.ci95[0] <= truth <= e.ci95[1]
        assert abs(e.value - truth) > 0.3 * truth and not e.identifiable
    (notice,) = [n for n in too_simple.warnings if n.kind == "effect-missing"]
    assert not notice.serious and "lag" in notice.known["effect"] and notice.known["wider"] > 10
    assert str(notice).startswith("The model lacks an effect: what it leaves of the turns goes with ")
    assert "the rudder through another time constant" in notice
    assert str(notice) in too_simple.text().splitlines()[1]
    assert json.dumps(too_simple.to_dict(), allow_nan=False)
    # The ship that is written has the same spread, and a steady turn a band as wide: none, or one that holds what she does.
    assert too_simple.ship.sections["nomoto"]["K"].std == pytest.approx(too_simple.parameters["K"].std, rel=1e-3)
    rate = too_simple.assessment.manoeuvres["turn:20"].turn["steady_rate"]
    assert rate.band95 is None or rate.band95[0] <= rate.measured <= rate.band95[1]


def test_the_structure_of_the_ship_lacks_nothing_in_waves_and_noise(records):
    fit = shipid.identify("nomoto-second-order", records[0], ship="mariner", starts=1)
    assert fit.lacks is None and not fit.warnings
    in_waves = shipid.simulate(
        "nomoto", "zeefakkel", "zigzag:20/20", noise="standard", waves="0.5 deg from 40 deg", seed=3
    )
    assert shipid.identify("nomoto", [in_waves], ship="zeefakkel", starts=1).lacks is None


def test_a_lost_speed_is_told_from_a_lag():
    """K* U/L and tau* L/U of the ship before the manoeuvre lie in the intervals."""
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", noise="standard", seed=1)
    fit = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1)
    assert fit.lacks is not None and fit.lacks.names == ("speed",) and fit.lacks.lasting
    for name, truth in (("K", 1.6 * 9.5 / 226), ("tau", 1.7 * 226 / 9.5)):
        e = fit.parameters[name]
        assert e.identifiable and e.ci95[0] <= truth <= e.ci95[1]


def test_a_variance_that_is_infinite_stays_and_another_method_is_left_alone(too_simple):
    solution, fitted = too_simple.identified.solution, too_simple.fitted
    unit_time = too_simple.identified.scale.unit_time
    found = missing_effect(solution, np.diag([np.inf, 1.0]), fitted, unit_time)
    assert np.isinf(found.covariance[0, 0]) and found.covariance[0, 1] == 0.0 and found.covariance[1, 1] > 1.0
    from dataclasses import replace

    other = replace(solution, covariance=np.eye(solution.problem.size))
    assert missing_effect(other, np.eye(2), fitted, unit_time) is None


def residuals(*series):
    """A solution whose trials leave these residuals of the rate of turn."""
    ends = np.cumsum([s.size for s in series])
    trials = [SimpleNamespace(regular=True, there=np.ones((1, s.size), dtype=bool)) for s in series]
    rows = [slice(end - s.size, end) for s, end in zip(series, ends)]
    return SimpleNamespace(
        residual=np.concatenate(series), problem=SimpleNamespace(signals=("r",), trials=trials, rows=rows)
    )


def test_of_many_series_one_looks_coloured_by_chance():
    """A record in stretches has a dozen series of white noise, of which the criterion finds one to be coloured."""
    white = np.random.default_rng(2).standard_normal((12, 40))
    by_chance = [k for k, w in enumerate(white) if _coloured(residuals(w), [0])]
    assert by_chance and not _coloured(residuals(*white), [0])
    coloured = lfilter([1.0], [1.0, -0.45], white)
    assert len(_coloured(residuals(*coloured), [0])) == 12
