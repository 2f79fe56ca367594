"""What no ship does in a manoeuvre, and the state that remembers it."""

from __future__ import annotations

import numpy as np
import pytest

from shipid import Component, constant, find_model, guard, join, state
from shipid.declaration.model import Evaluation
from shipid.generation.ensemble import make_ensemble
from shipid.parts.guard_watch import DEPARTED, guard_watch
from shipid.parts.manoeuvring_range import ManoeuvringRange, manoeuvring_range

L, U = 226.0, 9.5


@pytest.mark.parametrize(
    ("r", "u", "turns", "keeps"),
    [
        (1.49 * U / L, U, True, True),
        (-1.49 * U / L, 0.21 * U, True, True),
        (1.51 * U / L, U, False, True),
        (-1.51 * U / L, U, False, True),
        (0.0, 0.19 * U, True, False),
        (0.0, -U, True, False),
    ],
)
def test_the_limits_of_a_manoeuvre(r, u, turns, keeps):
    """A circle of 2/1.5 lengths at the approach speed, and a fifth of that speed."""
    found = Evaluation(join("range", ManoeuvringRange), {"r": r, "u": u, "cruise": U, "L": L})
    assert (found["turn_of_a_ship"] >= 0) == turns
    assert (found["speed_of_a_ship"] >= 0) == keeps


def test_a_model_without_a_rate_of_turn_has_none():
    assert manoeuvring_range(find_model("norrbin")) == (ManoeuvringRange,)
    assert manoeuvring_range(find_model("pershitz-track")) == ()


class Swing(Component):
    """A swing that is outside for a while, and back at the end."""

    x = state("1", "what swings")
    y = state("1", "its rate, of which a second is one", start=1.0)
    second = constant("s", "one second", default=1.0)
    near = guard("1", "it is above 0.9")

    @x.rate
    def swing(self):
        """An oscillator."""
        return self.y / self.second

    @y.rate
    def pull(self):
        """An oscillator."""
        return -self.x / self.second

    @near.equals
    def margin(self):
        """Nine tenths."""
        return 0.9 - self.x


def test_a_departure_is_remembered_after_the_run_is_back():
    """sin(t) passes 0.9 at 1.12 s; the last state alone shows nothing of it."""
    model = join("swing", Swing)
    assert guard_watch(find_model("norrbin")) == ()
    watched = join("watched", model, *guard_watch(model))
    ensemble = make_ensemble(watched)
    ends = {}
    for seconds in (1.0, 3.0):
        end = ensemble.run(1, {}, {}, {"y": 1.0}, np.array([seconds / 640]), 640)
        ends[seconds] = (float(end["x"][0]), float(end[DEPARTED][0]))
    assert ends[1.0] == pytest.approx((np.sin(1.0), 0.0), abs=1e-6)
    assert ends[3.0] == pytest.approx((np.sin(3.0), 1.0), abs=1e-6)
