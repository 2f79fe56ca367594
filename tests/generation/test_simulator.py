"""A model run along a clock by names, against closed forms and the record function it stands on."""

import numpy as np
import pytest

from shipid import Component, find_model, find_ship, given, join, parameter, state
from shipid.foundation.errors import DeclarationError, UsageError
from shipid.generation.ensemble import make_ensemble
from shipid.generation.simulator import (
    UnstatedInputError,
    coefficient_vector,
    initial_state,
    input_rows,
    make_simulator,
)

NOMOTO = find_model("nomoto")


class Windy(Component):
    """A yaw that reads a wind which nothing states."""

    r = state("rad/s", "rate of turn, positive to starboard", start="0.01 rad/s")
    delta = given("rad", "rudder angle, positive turns to starboard", default=0.0)
    gust = given("rad/s^2", "yaw acceleration by gusts")
    a = parameter("1/s", "damping", start="0.5 1/s")

    @r.rate
    def yaw(self):
        """Nobody (2000)."""
        return self.gust - self.a * self.r + 0.0 * self.a * self.a * self.delta


WINDY = join("windy", Windy)


def test_first_order_response_by_its_closed_form() -> None:
    t = np.linspace(0.0, 60.0, 601)
    found = make_simulator(NOMOTO, ("r",), coefficients=("K",))(
        t, {"K": 0.4, "tau": 12.0}, {"delta": 0.1, "u": 5.0, "cruise": 5.0}, {"r": 0.02}
    )
    exact = 0.04 + (0.02 - 0.04) * np.exp(-t / 12.0)
    np.testing.assert_allclose(found["r"], exact, rtol=1e-9)
    np.testing.assert_allclose(found.slopes[0, 0], 0.1 * (1 - np.exp(-t / 12.0)), atol=1e-9)
    assert found.finite.all()


def test_a_bias_is_added_to_the_input() -> None:
    t = np.linspace(0.0, 10.0, 101)
    run = make_simulator(NOMOTO, ("r",))
    values, flow = {"K": 0.4, "tau": 12.0}, {"u": 5.0, "cruise": 5.0}
    moved = run(t, values, {**flow, "delta": 0.1}, biases={"delta": 0.05})
    np.testing.assert_allclose(moved["r"], run(t, values, {**flow, "delta": 0.15})["r"], rtol=1e-14)


def test_an_input_that_nothing_states_is_refused_and_never_zero() -> None:
    t = np.linspace(0.0, 1.0, 11)
    with pytest.raises(UnstatedInputError, match=r"model windy reads 'gust' .*that nothing states") as error:
        make_simulator(WINDY, ("r",), compiled=False)(t, {"a": 1.0})
    assert error.value.exit_code == 2
    with pytest.raises(UnstatedInputError, match=r"that trial z20 does not record"):
        input_rows(WINDY, {}, 3, "trial z20")
    with pytest.raises(UnstatedInputError):
        make_ensemble(WINDY).run(2, {"a": 1.0}, {}, {}, np.full(2, 0.1), 10)
    # One that has no influence on what is wanted may stay unstated.
    assert input_rows(WINDY, {}, 3, needed=()).tolist() == [[0.0] * 3] * 2


def test_states_and_coefficients_stand_in_the_order_of_the_model() -> None:
    model = find_model("de-keizer")
    ship = find_ship("soesterberg")
    values = ship.values(model, 9.5)
    names = model.parameters + model.constants
    assert coefficient_vector(model, values).tolist() == [values[n] for n in names]
    many = coefficient_vector(model, {**values, "K": np.array([1.0, 2.0])})
    assert many.shape == (len(names), 2)
    assert many[names.index("K")].tolist() == [1.0, 2.0]
    assert many[names.index("tau")].tolist() == [values["tau"]] * 2
    assert initial_state(WINDY).tolist() == [0.01]
    assert initial_state(WINDY, {"r": np.array([1.0, 2.0]), "other": 3.0}).tolist() == [[1.0, 2.0]]
    with pytest.raises(DeclarationError, match="'K' of model de-keizer has no value"):
        coefficient_vector(model, {n: v for n, v in values.items() if n != "K"})


def test_an_ensemble_is_as_many_runs() -> None:
    t = np.arange(0.0, 6.4 + 1e-9, 0.1)
    gains = np.array([0.2, 0.4, 0.8])
    flow = {"delta": 0.1, "u": 5.0, "cruise": 5.0}
    ends = make_ensemble(NOMOTO).run(3, {"K": gains, "tau": 12.0}, flow, {}, np.full(3, 0.1), 64)
    run = make_simulator(NOMOTO, ("r", "psi"), hold="zero")
    for i, gain in enumerate(gains):
        alone = run(t, {"K": float(gain), "tau": 12.0}, flow)
        assert ends["r"][i] == pytest.approx(alone["r"][-1], rel=1e-12)
        assert ends["psi"][i] == pytest.approx(alone["psi"][-1], rel=1e-12)


def test_an_input_with_a_hole_is_refused() -> None:
    """NaN would run through every later sample without a word."""
    t = np.arange(10.0)
    delta = np.where((t > 3) & (t < 6), np.nan, 0.1)
    run = make_simulator(NOMOTO, ("r",))
    values = {"K": 0.1, "tau": 10.0}
    with pytest.raises(UsageError, match="'delta' of model nomoto has no value at 2 of 10 times"):
        run(t, values, {"delta": delta, "u": 5.0, "cruise": 5.0})
    assert run(t, values, {"delta": np.nan_to_num(delta), "u": 5.0, "cruise": 5.0}).finite.all()
