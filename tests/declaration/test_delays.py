"""Dead times of inputs: what they shift, and where a model with one is refused."""

import numpy as np
import pytest

from shipid import Component, find_model, given, join, parameter
from shipid.declaration.delays import refuse_delay, refuse_estimated_delay, shifted_rows
from shipid.foundation.errors import DeclarationError, UnitError, UsageError
from shipid.parts.rudder_delay import LateSteeringMachine, gear_of
from shipid.parts.steering_machine import SteeringMachine


@pytest.fixture(scope="module")
def late():
    return find_model("nomoto-delay")


def test_a_record_is_shifted_in_straight_lines_and_held_at_its_ends(late) -> None:
    t = np.array([0.0, 1.0, 3.0])
    rows = np.zeros((len(late.inputs), 3))
    at = late.inputs.index("delta")
    rows[at] = [0.0, 2.0, 0.0]
    acting, slopes = shifted_rows(late, t, rows, {"delta": 0.5})
    assert acting[at].tolist() == [0.0, 1.0, 0.5]
    assert slopes[at].tolist() == [0.0, -2.0, 1.0]
    acting, slopes = shifted_rows(late, t, rows, {"delta": -0.5})
    assert acting[at].tolist() == [1.0, 1.5, 0.0]
    assert slopes[at].tolist() == [-2.0, 1.0, 0.0]
    others = [i for i in range(len(rows)) if i != at]
    assert not acting[others].any()


def test_every_model_that_reads_the_rudder_has_one_by_name(late) -> None:
    assert late.delays == {"delta": "delay"}
    assert late["delay"].unit == "s"
    assert set(late.known_as) >= {"nomoto-delay", "nomoto"}
    assert find_model("cubic-wind-delay").delays == {"delta": "delay"}
    assert find_model("nomoto").delays == {}


def test_a_closed_loop_has_a_steering_machine_that_is_late(late) -> None:
    assert gear_of(late) == (LateSteeringMachine,)
    assert gear_of(find_model("nomoto")) == (SteeringMachine,)
    # What is no input is not shifted a second time.
    assert join("steered", late, LateSteeringMachine).delays == {}
    with pytest.raises(DeclarationError, match=r"'delay' delays the input 'delta', and SteeringMachine .* without it"):
        join("steered", late, SteeringMachine)


def test_a_dead_time_is_one_of_an_input_and_in_seconds() -> None:
    class Nothing(Component):
        """A dead time of what nobody reads."""

        wait = parameter("s", "dead time", start=1.0, delays="flaps")

    class Length(Component):
        """A dead time in metres."""

        wait = parameter("m", "dead time", start=1.0, delays="delta")
        delta = given("rad", "rudder angle")

    with pytest.raises(DeclarationError, match="'wait' delays 'flaps', which no component reads"):
        join("ship", find_model("nomoto"), Nothing)
    with pytest.raises(UnitError, match="the dead time 'wait' is in m, and not in s"):
        join("ship", find_model("nomoto"), Length)


def test_what_cannot_carry_one_says_so(late) -> None:
    with pytest.raises(UsageError, match=r"'delta' acts 'delay' later than it is given\. A balloon cannot carry it"):
        refuse_delay(late, "A balloon")
    with pytest.raises(UsageError, match="A filter does not estimate the dead time 'delay'"):
        refuse_estimated_delay(late, ["K", "delay"], "A filter")
    refuse_estimated_delay(late, ["K"], "A filter")
    refuse_delay(find_model("nomoto"), "A balloon")
