"""The structure that made the data wins, the simpler of two that are tied is taken, and training errors never enter."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UsageError
from shipid.identification.choice.ranking import Ranking
from shipid.identification.choice.scoring import MEASURES
from shipid.identification.compare_models import compare_models


@pytest.fixture(scope="module")
def cubic_trials(sail):
    return [
        sail("norrbin", "zeefakkel", m, seed=i, name=f"t{i}", sampling="0.5 s")
        for i, m in enumerate(("zigzag:20/20", "zigzag:10/10", "zigzag:30/15"))
    ]


@pytest.fixture(scope="module")
def ranking(cubic_trials) -> Ranking:
    return compare_models(["nomoto", "norrbin"], cubic_trials, ship="zeefakkel", starts=1, workers=1)


def test_trials_that_do_not_show_how_a_ship_turns_are_not_judged(cubic_trials):
    """Every prediction of them was worthless, and the first of them was to be taken."""
    still = [replace(t, table=t.table[["t", "u", "delta"]]) for t in cubic_trials]
    with pytest.raises(UsageError, match=r"by heading and rate of turn, and no trial has one of them \(psi, r\)"):
        compare_models(["nomoto"], still, ship="zeefakkel", starts=1, workers=1)


def test_the_structure_that_made_the_data_wins(ranking):
    assert ranking.best == "norrbin"
    assert [r.model for r in ranking.ranks] == ["norrbin", "nomoto"]
    right, wrong = ranking.ranks
    assert wrong.score - right.score > 3 * np.hypot(wrong.std, right.std)
    assert all(right.measures[n] < wrong.measures[n] for n in MEASURES if n not in ("speed", "sway"))
    # Both take the speed as given, and no sway: neither gains by what it does not predict.
    assert [right.measures[n] for n in ("speed", "sway")] == [wrong.measures[n] for n in ("speed", "sway")]
    assert len(right.shares) == 3 and right.reads == 1  # the rudder, and not the speed that both are given
    assert right.score == pytest.approx(np.exp(np.mean(np.log(right.shares))))


def test_a_trial_beyond_the_others_is_named_and_not_a_ship_file(ranking):
    told = [str(n) for n in ranking.beyond]
    assert any(n.startswith("t2: the rudder goes to 30 deg") for n in told)
    assert len(told) == len(set(told)) and not any("coefficients of ship" in n for n in told)
    # The trials were simulated by a model without a sway: of a drift angle they say nothing.
    assert not any("drift" in n for n in told)


def test_every_trial_is_left_out_once(ranking):
    assert ranking.folds == ("t0", "t1", "t2")


def test_the_simpler_of_two_tied_models_is_taken(sail):
    """A linear ship: the cubic predicts as well with one coefficient more, and gains nothing."""
    trials = [
        sail("nomoto", "zeefakkel", m, seed=i, name=f"t{i}", sampling="0.5 s")
        for i, m in enumerate(("zigzag:20/20", "zigzag:10/10"))
    ]
    ranking = compare_models(["norrbin", "nomoto"], trials, ship="zeefakkel", starts=1, workers=1)
    counts = {r.model: r.coefficients for r in ranking.ranks}
    assert counts == {"nomoto": 2, "norrbin": 3}
    assert ranking.best == "nomoto" and set(ranking.tied) == {"nomoto", "norrbin"}


def test_a_single_trial_predicts_itself_by_halves(cubic_trials):
    ranking = compare_models(["norrbin"], cubic_trials[:1], ship="zeefakkel", starts=1, workers=1)
    assert len(ranking.folds) == 2
    assert all("@" in f for f in ranking.folds)
    assert ranking.best == "norrbin"
    assert ranking.warnings[0].kind == "too-poor-to-choose" and "A second trial is missing" in ranking.warnings[0]


def test_a_ship_that_goes_astern_is_named_for_a_model_of_one_speed(sail):
    """The others refuse such a trial: the one that does not see it was chosen, and said to be a firm choice."""
    trials = [sail("nomoto", "zeefakkel", m, name=m[:8], duration="100 s") for m in ("zigzag:20/20", "zigzag:-10/10")]
    backing = trials[0].table.assign(u=np.where(trials[0]["t"] < 70, 5.0, -1.5))
    trials[0] = shipid.Trial("backing", backing[[n for n in backing if n not in "xy"]])
    found = compare_models(["nomoto"], trials, ship="zeefakkel", starts=1, workers=1)
    (told,) = [n for n in found.warnings if n.kind == "goes-astern"]
    assert (
        told.serious
        and "warning: backing: the ship goes astern from 70 s on, and nomoto knows one speed" in found.text()
    )


def test_trials_kept_apart_are_reported_and_do_not_rank(cubic_trials):
    options = {"ship": "zeefakkel", "starts": 1, "workers": 1}
    again = compare_models(["nomoto", "norrbin"], cubic_trials[:2], validate=cubic_trials[2:], **options)
    alone = compare_models(["nomoto", "norrbin"], cubic_trials[:2], **options)
    assert {r.model: r.score for r in again.ranks} == {r.model: r.score for r in alone.ranks}
    assert "predictions of t2, which was kept apart and does not count" in again.text()
    rate = np.rad2deg(again.ranks[0].validation["t2"]["rate"])
    assert f"{rate:.3g}" in again.text().split("predictions of t2")[1]
    assert set(again.ranks[0].validation) == {"t2"}
    assert alone.ranks[0].validation == {}


def test_a_model_that_cannot_be_fitted_ranks_last_and_stops_nothing(cubic_trials):
    lost = shipid.find_model("davidson-schiff")
    ranking = compare_models([lost, "norrbin"], cubic_trials[:2], starts=1, workers=1)
    assert ranking.best == "norrbin"
    last = ranking.ranks[-1]
    assert last.model == "davidson-schiff" and last.score is None and "needs L" in last.message


def test_the_result_is_json_without_nan_and_a_table(ranking):
    result = json.loads(json.dumps(ranking.to_dict(), allow_nan=False))
    assert result["best"] == "norrbin"
    assert set(result["ranking"][0]) >= {"model", "score", "std", "spread", "error", "weight", "measures", "hard_turn"}
    assert result["measure_weights"]["overshoot_closed"] == 1.0 and result["measure_weights"]["heading"] == 0.0
    assert result["without"] == dict.fromkeys(("t0", "t1", "t2"), "norrbin")
    assert ranking.to_frame().loc["norrbin", "rate [deg/s]"] == pytest.approx(
        np.rad2deg(ranking.ranks[0].measures["rate"])
    )
    assert "to take: norrbin" in ranking.text()
    assert "weights in the score: rate 1, bias 1, open 1, closed 1, period 0.5" in ranking.text()
    assert "The choice is firm: it is the same without any one of the 3 trials." in ranking.text()


@pytest.mark.parametrize(("models", "trials"), [([], [1]), (["nomoto"], [])])
def test_nothing_to_compare(models, trials):
    with pytest.raises(shipid.ShipidError, match="at least one model and one trial"):
        compare_models(models, trials)


def test_a_misspelt_model_is_refused_before_any_fit(cubic_trials):
    with pytest.raises(shipid.ShipidError, match="Did you mean norrbin"):
        compare_models(["nomoto", "norbin"], cubic_trials)


def test_a_shared_rudder_bias_is_found(sail):
    trials = []
    for i in range(2):
        frame = sail("norrbin", "zeefakkel", seed=i).table.copy()
        frame["delta"] -= np.deg2rad(1.5)
        units = {n: FIELDS[n].unit for n in frame.columns}
        trials.append(shipid.Trial.from_frame(frame, name=f"t{i}", units=units))
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", purpose="prediction", starts=2)
    assert [np.rad2deg(c.bias) for c in fit.fitted] == pytest.approx([1.5, 1.5], abs=0.1)


def test_an_unknown_purpose_is_refused(cubic_trials):
    with pytest.raises(shipid.ShipidError, match="purpose"):
        shipid.identify("norrbin", cubic_trials[:1], purpose="glory")
