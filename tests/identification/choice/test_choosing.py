"""The choice: what is tied, what is taken of it, how firmly, and what would decide it."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.identification.choice.choosing import Rank, chosen, tied_models, weights_of
from shipid.identification.choice.hard_turn import HardTurn
from shipid.identification.choice.ranking import Ranking

STEADY = HardTurn(0.6, 0.01, 0.05, 0.0)


def rank(model: str, free: int, shares: tuple[float, ...], *, spread: float = 0.0, **more: object) -> Rank:
    score = float(np.exp(np.mean(np.log(shares))))
    values = {"coefficients": 9, "reads": 1, "unexplained": 0.2, "turn": STEADY} | more
    return Rank(
        model=model, free=free, score=score, std=0.0, shares=shares, measures={}, validation={}, spread=spread, **values
    )


def test_models_are_tied_within_a_factor_of_the_smallest_error():
    ranks = [rank("one", 5, (0.2,)), rank("two", 5, (0.24,)), rank("three", 5, (0.26,))]
    assert tied_models(ranks) == ("one", "two")
    assert tied_models(ranks, 2.0) == ("one", "two", "three")


def test_a_spread_of_the_coefficients_is_an_error():
    ranks = [rank("lucky", 2, (0.2,), spread=0.3), rank("known", 5, (0.22,), spread=0.05)]
    assert tied_models(ranks) == ("known",)
    assert ranks[0].error == pytest.approx(np.hypot(0.2, 0.3))


def test_of_tied_models_the_one_with_most_beliefs_is_taken():
    ranks = [rank("lucky", 8, (0.1, 0.3)), rank("known", 3, (0.14, 0.24))]
    assert chosen(ranks) == "known"
    # Then the one that reads the wind of the log, then the one of the smallest error.
    assert chosen([*ranks, rank("in wind", 3, (0.15, 0.25), reads=3)]) == "in wind"
    assert chosen([*ranks, rank("better", 3, (0.14, 0.23), coefficients=11)]) == "better"


def test_a_model_that_can_run_away_wins_no_tie():
    away = rank("away", 2, (0.2,), turn=HardTurn(0.6, 0.02, 3.0, 0.2))
    ranks = [away, rank("bounded", 6, (0.21,))]
    assert chosen(ranks) == "bounded"
    ranking = Ranking(tuple(ranks), ("a",))
    assert "away can run away in a hard turn" in " ".join(ranking.words) and not ranking.warnings
    # Alone it is taken, with a warning.
    alone = Ranking((away,), ("a",))
    assert alone.best == "away" and [n.kind for n in alone.warnings] == ["runs-away"]


def test_a_model_that_holds_in_a_hard_turn_is_taken_within_twice_the_smallest_error():
    away = rank("away", 2, (0.1,), turn=HardTurn(0.6, None, 3.0, 1.0))
    near = Ranking((away, rank("bounded", 6, (0.19,))), ("a",))
    assert near.tied == ("away",) and near.best == "bounded" and not near.warnings
    assert near.words[0].startswith("away can run away in a hard turn. bounded, whose error is within twice")
    far = Ranking((away, rank("bounded", 6, (0.21,))), ("a",))
    assert far.best == "away" and [n.kind for n in far.warnings] == ["runs-away"]


def test_how_firm_a_choice_is_and_what_would_decide_it():
    first, second = rank("first", 3, (0.2, 0.4)), rank("second", 2, (0.2, 0.8), turn=HardTurn(0.6, 0.02, 0.1, 0.0))
    ranking = Ranking((first, second), ("a", "b"))
    assert ranking.best == "first" and ranking.others == {"a": "first", "b": "second"}
    assert "The choice is not firm: without b it would be second." in ranking.words
    close = Ranking((first, rank("third", 4, (0.2, 0.41), turn=HardTurn(0.6, 0.02, 0.1, 0.0))), ("a", "b"))
    assert close.words[1] == "The choice is firm: it is the same without any one of the 2 trials."
    assert close.words[2].startswith(
        "It would be decided by a turning circle with 34 deg of rudder: first turns at 0.573"
    )
    same = Ranking((first, rank("third", 4, (0.2, 0.41))), ("a", "b"))
    assert same.words[2].startswith("It would be decided by more zig-zags")


def test_a_campaign_that_is_too_poor_gets_the_simplest_model():
    ranks = (rank("rich", 6, (0.2,)), rank("plain", 2, (0.35,)))
    assert Ranking(ranks, ("a",)).best == "rich"
    poor = Ranking(ranks, ("a",), ("A second trial is missing.",))
    assert poor.best == "plain"
    # Two trials that agree show nothing where neither shows enough.
    twice = Ranking((rank("rich", 6, (0.2, 0.2)), rank("plain", 2, (0.35, 0.35))), ("a", "b"), poor.lacking)
    assert "The choice is firm" not in twice.text() and "How firm the choice is cannot be told" in twice.text()
    assert [n.kind for n in poor.warnings] == ["too-poor-to-choose"] and "A second trial is missing." in poor.warnings[
        0
    ]


def test_where_nothing_is_explained_nothing_is_taken():
    ranking = Ranking((rank("one", 2, (0.9,), unexplained=0.97), rank("two", 3, (0.8,), unexplained=0.93)), ("a",))
    assert ranking.best is None and ranking.words == ()
    (said,) = ranking.warnings
    assert said.serious and said.kind == "not-determined" and "93 % of the rate of turn itself" in said
    assert "to take" not in ranking.text()


def test_where_no_candidate_could_be_fitted_nothing_is_taken_and_it_is_serious():
    lost = Rank("lost", 1, 1, 1, None, None, (), {}, {}, message="the trial is too short.")
    ranking = Ranking((lost,), ("a", "b"), ("A second trial is missing.",))
    assert ranking.best is None and ranking.words == ()
    (said,) = ranking.warnings
    assert said.serious and said.kind == "not-determined" and "no candidate could be fitted" in said
    assert said.endswith("A second trial is missing.")


def test_weights_are_shares_of_one_and_favour_what_predicts():
    weights = weights_of(
        [rank("one", 2, (0.1,)), rank("two", 3, (0.2,)), Rank("lost", 1, 1, 1, None, None, (), {}, {})]
    )
    assert weights == pytest.approx({"one": 16 / 17, "two": 1 / 17, "lost": 0.0})
