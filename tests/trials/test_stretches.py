"""Inputs between their samples, and the stretches that are left where a hole is too long to fill."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from shipid.trials.errors import NoStretchError
from shipid.trials.filling import samples_of, usual_interval
from shipid.trials.stretches import fill_input, is_note, stretches_of
from shipid.trials.trial import Trial

NAN = np.nan


def made(rows: int = 100, **columns: np.ndarray) -> Trial:
    t = np.arange(rows) * 0.5
    table = {"t": t, "psi": 0.1 * t, "u": np.full(rows, 5.0), "delta": np.sin(t)} | columns
    return Trial("made", pd.DataFrame(table))


def holed(trial: Trial, name: str, *rows: slice) -> Trial:
    table = trial.table.copy()
    for part in rows:
        table.loc[part.start : part.stop - 1, name] = NAN
    return Trial(trial.name, table)


def test_a_whole_trial_is_the_trial_itself():
    trial = holed(made(), "psi", slice(20, 60))
    assert stretches_of(trial, ["delta"]) == (trial,), "what is predicted may have holes"
    assert stretches_of(trial, []) == (trial,)


def test_a_feedback_is_interpolated_and_an_order_held():
    t, values = np.arange(8.0), np.array([0.0, NAN, NAN, 6.0, 8.0, NAN, NAN, NAN])
    line, order = fill_input(t, values, False), fill_input(t, values, True)
    np.testing.assert_allclose(line.values[:5], [0, 2, 4, 6, 8])
    np.testing.assert_allclose(order.values, [0, 0, 0, 6, 8, 8, 8, 8])
    assert line.filled == 2 and order.filled == 5 and not line.begins.size


def test_an_order_is_known_by_its_name():
    trial = holed(made(n=np.repeat(np.arange(20.0), 5)), "n", slice(7, 9))
    (stretch,) = stretches_of(trial, ["n"])
    np.testing.assert_array_equal(stretch["n"][5:10], [1, 1, 1, 1, 1])
    assert any("n: held between its 98 samples, in 2 of 100 rows" in note for note in stretch.source.notes)


def test_a_short_hole_is_filled_and_said():
    """Five intervals are filled, six are not: as many rows less one are missing."""
    filled = stretches_of(holed(made(), "delta", slice(30, 34)), ["delta"])
    assert len(filled) == 1 and filled[0].name == "made" and len(filled[0]) == 100
    np.testing.assert_allclose(filled[0]["delta"][29:35], np.linspace(np.sin(14.5), np.sin(17.0), 6))
    assert [n for n in filled[0].source.notes if is_note(n)] == [
        "Filled input delta: interpolated between its 96 samples, in 4 of 100 rows."
    ]
    assert len(stretches_of(holed(made(), "delta", slice(30, 35)), ["delta"])) == 2


def test_a_long_hole_splits_the_record():
    first, second = stretches_of(holed(made(), "delta", slice(30, 60)), ["delta"])
    assert (first.name, second.name) == ("made@0:14.5", "made@30:49.5")
    assert len(first) == 30 and len(second) == 40
    # The speed before the manoeuvre is one number a trial: a stretch begins in the middle of it.
    assert set(first["cruise"]) == set(second["cruise"]) == {5.0}
    notes = " ".join(second.source.notes)
    assert "0 to 14.5 s, 30 to 49.5 s" in notes
    assert "Rows of the record: 100, of which 70 are used" in notes


def test_a_gap_in_the_clock_splits_as_well():
    trial = made()
    table = trial.table.drop(index=range(30, 60)).reset_index(drop=True)
    assert [s.name for s in stretches_of(Trial("made", table), ["delta"])] == ["made@0:14.5", "made@30:49.5"]


def test_holes_of_two_inputs_add_up():
    trial = holed(holed(made(n=np.ones(100)), "delta", slice(30, 60)), "n", slice(45, 70))
    first, second = stretches_of(trial, ["delta", "n"])
    # The order holds for five intervals after its last sample; the rudder is back before the revolutions are.
    assert first["t"][-1] == 14.5 and second["t"][0] == 35.0


def test_a_stretch_that_is_too_short_is_left_out_with_a_word():
    trial = holed(made(), "delta", slice(30, 40), slice(45, 60))
    kept = stretches_of(trial, ["delta"])
    assert [s["t"][0] for s in kept] == [0.0, 30.0]
    assert any(n == "Too short between holes: 1 stretches are left out, 20 to 22 s." for n in kept[0].source.notes)
    assert len(stretches_of(trial, ["delta"], least=15.0)) == 1
    with pytest.raises(NoStretchError, match=r"lasts 19\.5 s, and at least 10 samples and 30 s are needed"):
        stretches_of(trial, ["delta"], least=30.0)


def test_an_input_keeps_its_own_clock():
    """One sample a second on a clock of ten a second is no hole; 3 ms between two sensors make no gap of it."""
    heading = np.arange(0, 60, 0.1)
    rudder = np.arange(0, 60, 1.0) + 0.003
    t = np.sort(np.concatenate([heading, rudder]))
    on = np.isin(t, rudder)
    table = pd.DataFrame({"t": t, "psi": np.where(on, NAN, 0.1 * t), "delta": np.where(on, np.sin(t), NAN)})
    (stretch,) = stretches_of(Trial("two", table), ["delta"])
    assert stretch.name == "two" and np.isfinite(stretch["delta"]).all()
    assert usual_interval(t) == pytest.approx(0.1, rel=0.2)
    assert stretch["t"][0] == 0.003 and stretch["t"][-1] == pytest.approx(59.003)


def test_samples_missing_at_random_are_no_holes():
    rng = np.random.default_rng(0)
    gone = rng.random(600) < 0.5
    trial = made(600)
    table = trial.table.assign(delta=trial.table["delta"].mask(gone))
    stretches = stretches_of(Trial("random", table), ["delta"])
    assert sum(len(s) for s in stretches) > 580 and len(stretches) <= 2


def test_bursts_count_as_one_sample():
    t = np.sort(np.concatenate([np.arange(100.0) + k * 0.002 for k in range(6)]))
    assert usual_interval(t) == pytest.approx(1.0)
    assert usual_interval(np.concatenate([np.arange(10.0), 500 + np.arange(10.0)])) == 1.0, "one pause is no burst"


def test_samples_that_might_be_there():
    t = np.arange(0, 100, 0.1)
    slow = np.where(np.arange(1000) % 10 == 0, 1.0, NAN)
    assert samples_of(t, np.ones(1000)) == (1000, 1000)
    assert samples_of(t, slow) == (100, 100)
    slow[200:300] = NAN
    assert samples_of(t, slow) == (90, 100)
    assert samples_of(t, np.where(np.random.default_rng(0).random(1000) < 0.3, 1.0, NAN))[1] == 1000
