"""A run and the moment from which its model is not valid."""

from __future__ import annotations

import numpy as np
import pytest

from shipid import Component, constant, find_model, find_ship, guard, join, state
from shipid.generation.departure import Departure, first_departure
from shipid.generation.record import make_record
from shipid.generation.simulator import make_simulator


class Growing(Component):
    """A state that grows by one a second, and two limits of it."""

    x = state("1", "what grows")
    pace = constant("1/s", "how fast", default=1.0)
    below_two = guard("1", "it is above two")
    below_one = guard("1", "it is above one")

    @x.rate
    def growth(self):
        """Straight up."""
        return self.pace

    @below_two.equals
    def far(self):
        """Two."""
        return 2 - self.x

    @below_one.equals
    def near(self):
        """One."""
        return 1 - self.x


@pytest.mark.parametrize("compiled", [True, False])
def test_a_run_shows_the_first_guard_that_is_active(compiled):
    t = np.arange(0.0, 3.0, 0.25)
    simulator = make_simulator(join("growing", Growing), ["x"], compiled=compiled)
    run = simulator(t, {})
    # At 1.0 the margin is zero, and the model holds.
    assert run.departure == Departure(1.25, "it is above one", "below_one")
    assert str(run.departure) == "not sailed by this model: it is above one from 1.25 s on"
    assert simulator(t[:5], {}).departure is None


def test_guards_change_no_output_and_no_slope():
    """They are computed beside the outputs, and have no derivatives."""
    model = find_model("de-keizer")
    given = {"delta": 0.5, "cruise": 9.5}
    known = find_ship("soesterberg").values(model)
    t = np.arange(0.0, 200.0, 1.0)
    table = np.tile([[given.get(n, 0.0)] for n in model.inputs], t.size)
    names = model.parameters + model.constants
    x0 = np.array([9.5 if s == "u" else 0.0 for s in model.states])
    found = []
    for guarded in (False, True):
        record = make_record(model, ("psi", "u"), ("K", "K_u"), ("r",), guarded=guarded)
        found.append(record.run(x0, table, np.diff(t, append=t[-1]), np.array([known[n] for n in names])))
    (y, dy, none), (y_guarded, dy_guarded, margins) = found
    np.testing.assert_allclose(y_guarded, y, rtol=1e-12)
    np.testing.assert_allclose(dy_guarded, dy, rtol=1e-9, atol=1e-12)
    assert none.shape == (0, t.size)
    np.testing.assert_allclose(margins, y[1:] - 0.05 * 9.5, rtol=1e-12)


def test_what_is_not_finite_is_a_departure():
    model, t = join("growing", Growing), np.arange(3.0)
    inside = {"below_one": np.ones(3)}
    columns = np.array([[0.0, 1.0, np.inf], [0.0, np.nan, 1.0]])
    assert first_departure(model, t, inside, columns) == Departure(1.0, "the model runs away")
    assert first_departure(model, t, {"below_one": np.array([1.0, np.nan, 1.0])}).time == 1.0
    assert first_departure(model, t, inside, columns[:, :1]) is None
    # At one sample, the guard says more than the number that is none.
    both = first_departure(model, t, {"below_one": np.array([1.0, -1.0, 1.0])}, columns)
    assert both.guard == "below_one"


class Drifting(Component):
    """A sway whose damping divides by it: no value at rest."""

    v = state("m/s", "sway speed")
    x = state("m", "position")
    T = constant("s", "time constant", default=10.0)

    @v.rate
    def sway(self):
        """Made up."""
        return -self.v * self.v / abs(self.v) / self.T

    @x.rate
    def way(self):
        """Made up."""
        return self.v


@pytest.mark.parametrize("compiled", [True, False])
def test_an_equation_without_a_value_at_rest_is_named(compiled):
    """It was said to run away, with the advice of less rudder."""
    simulator = make_simulator(join("drifting", Drifting), ["x"], compiled=compiled)
    t = np.arange(0.0, 3.0, 0.25)
    departure = simulator(t, {}).departure
    assert departure.time == 0 and departure.reason.startswith(
        "dv/dt has no finite value where the run begins: by a division"
    )
    assert simulator(t, {}, start={"v": 1.0}).departure is None
