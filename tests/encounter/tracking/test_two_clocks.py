"""Plots of two clocks in one log, and of a clock that began again: the cause is told, and not told where there is another."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.plots.plots import make_plots
from shipid.encounter.tracking.track import track

TIMES = 3.0 * np.arange(60)


def log(speed, shift=None, bearing_std=0.0):
    """A ship seen by one clock, or by two so many seconds apart; plots err by 10 m, and in bearing."""
    rng = np.random.default_rng(1)
    true = TIMES if shift is None else np.tile(TIMES, 2)
    stamps = true + (0.0 if shift is None else np.repeat([0.0, shift], TIMES.size))
    x, y = 3000 - 0.8 * speed * true, 500 + 0.6 * speed * true
    turned = rng.normal(0, bearing_std, true.size)
    seen = x - turned * y + rng.normal(0, 10, true.size), y + turned * x + rng.normal(0, 10, true.size)
    order = np.argsort(stamps, kind="stable")
    return make_plots(stamps[order], *(v[order] for v in seen))


def told(found):
    return [w for w in found.warnings if w.kind == "two-clocks"]


def test_two_tracks_of_one_ship_by_two_clocks():
    found = track(log(10.0, 10.0))
    (said,) = told(found)
    assert len(found.tracks) > 1 and said.serious and "sail one line at one speed, 10 s apart" in said


def test_one_track_between_two_clocks():
    found = track(log(4.0, 10.0))
    (said,) = told(found)
    assert len(found.tracks) == 1 and "on two sides of the tracks" in said and "latency in a format file" in said
    assert said.known["seconds"] == pytest.approx(10, abs=2)


@pytest.mark.parametrize("bearing_std", [0.0, 0.02])
def test_one_clock_is_not_taken_for_two(bearing_std):
    assert told(track(log(7.0, None, bearing_std))) == []


def test_an_echo_behind_a_ship_for_a_while_is_no_second_clock():
    rng = np.random.default_rng(2)
    behind = TIMES[10:36]
    t = np.concatenate([TIMES, behind])
    sailed = t - np.repeat([0.0, 20.0], [TIMES.size, behind.size])
    x, y = 3000 - 8 * sailed, 500 + 6 * sailed
    order = np.argsort(t, kind="stable")
    seen = (v[order] + rng.normal(0, 10, t.size) for v in (x, y))
    found = track(make_plots(t[order], *seen))
    assert len(found.tracks) == 2 and told(found) == []


def test_a_clock_that_goes_back_is_told():
    x, y = 3000 - 5 * TIMES, 500 + 2 * TIMES
    again = make_plots(np.tile(TIMES, 2), np.concatenate([x, x - 900]), np.tile(y, 2))
    (said,) = [n for n in again.notes if n.kind == "clock-goes-back"]
    assert "goes back by 177 s" in said and "cut the log there" in said
    # A plot that comes late is put in its place.
    order = [1, 0, *range(2, TIMES.size)]
    assert [n.kind for n in make_plots(TIMES[order], x[order], y[order]).notes] == ["plots-out-of-order"]
