"""A length that the record of a trial contradicts is told; sound records are left alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

import shipid
from shipid.trials.measuring.measure import measure
from shipid.trials.signals.ship_length import SHIP_LENGTH, length_notice


@pytest.fixture(scope="module", params=["zigzag:20/20", "zigzag:10/10", "turn:35"])
def trial(request):
    return shipid.simulate("de-keizer", ship="soesterberg", manoeuvre=request.param, noise="standard", seed=1)


def test_the_right_length_is_silent(trial):
    assert length_notice(trial, 226.0) is None
    assert all(length_notice(trial, 226.0 * factor) is None for factor in (0.5, 2.0))


@pytest.mark.parametrize("factor", [10.0, 0.1])
def test_a_length_ten_times_off_is_serious(trial, factor):
    notice = length_notice(trial, 226.0 * factor)
    assert notice is not None and notice.serious and notice.kind == SHIP_LENGTH
    assert notice.startswith(f"the length of {226 * factor:.4g} m does not fit trial ")


def test_what_tells_nothing(trial):
    frame = trial.table
    assert length_notice(trial, None) is None
    no_speed = replace(trial, table=frame.drop(columns=[c for c in ("u", "v", "U") if c in frame]))
    assert length_notice(no_speed, 2260.0) is None
    kept = replace(trial, table=frame.assign(delta=0.0))
    assert length_notice(kept, 2260.0) is None


def test_measuring_tells_it(trial):
    assert not any("does not fit trial" in str(n) for n in measure(trial, length="226 m").notes)
    assert any("does not fit trial" in str(n) for n in measure(trial, length="2260 m").notes)
