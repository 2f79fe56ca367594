"""The dead time of a rudder: along a record, and in a closed loop, where there is no record of the rudder before.

A dead time of a steering gear and one of the logger's clock look the same in a trial, and one number holds both. Along a record it
is a shift of the rudder (`shipid.declaration.delays`); in a closed loop it is approximated by a Padé approximant.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.quantity import derived, given, parameter, state
from shipid.foundation.aliases import Expression
from shipid.parts.helm import DirectRudder
from shipid.parts.steering_machine import SteeringMachine

_DEAD_TIME = "time by which the rudder acts later than it is recorded"


class RudderDelay(Component):
    """A rudder that acts later than it is recorded: the dead time of a steering gear, or a clock of the logger."""

    delta = given("rad", "rudder angle as it is recorded, positive turns to starboard", latex=r"\delta")
    # In ship lengths sailed, like the responses it has to be told from. Negative where the rudder is logged late.
    delay = parameter("s", _DEAD_TIME, start=0.0, low=-0.5, high=1.0, prime=True, latex=r"\tau_0", delays="delta")
    same_at_any_loading = ("delay",)


class LateRudder(Component):
    """A rudder that is moved in a closed loop and acts behind a dead time, by the Padé approximant of order 2/3 of exp(-s tau).

    ``(1 - 2/5 s tau + (s tau)^2/20) / (1 + 3/5 s tau + 3/20 (s tau)^2 + (s tau)^3/60)``, in controllable form. It is strictly proper:
    a step shows only after a while.
    """

    delay = given("s", _DEAD_TIME, latex=r"\tau_0")
    T_s = given("s", "sampling interval")
    delta_recorded = given("rad", "rudder angle as it is recorded, positive turns to starboard", latex=r"\delta")
    behind = state("rad", "first state of an angle behind a dead time", nominal="10 deg", latex=r"\xi_1")
    behind_rate = state("rad/s", "second state of an angle behind a dead time", nominal="1 deg/s", latex=r"\xi_2")
    behind_bend = state("rad/s^2", "third state of an angle behind a dead time", nominal="1 deg/s^2", latex=r"\xi_3")
    delta = derived("rad", "rudder angle that acts, positive turns to starboard", latex=r"\delta_0")

    def late(self) -> Expression:
        """Return the dead time in s, of two samples at least: the bound keeps steps stable, and nothing acts before it is ordered."""
        return np.maximum(self.delay, 2 * self.T_s)

    @behind.rate
    def moves(self):
        """Padé (1892), approximant of order 2/3."""
        return self.behind_rate

    @behind_rate.rate
    def turns(self):
        """Padé (1892), approximant of order 2/3."""
        return self.behind_bend

    @behind_bend.rate
    def bends(self):
        """Padé (1892), approximant of order 2/3."""
        late = self.late()
        wanted = 60 / late**3 * (self.delta_recorded - self.behind)
        return wanted - 36 / late**2 * self.behind_rate - 9 / late * self.behind_bend

    @delta.equals
    def acts(self):
        """Padé (1892), the numerator of the approximant."""
        late = self.late()
        return self.behind - 2 / 5 * late * self.behind_rate + late**2 / 20 * self.behind_bend


class LateDirectRudder(LateRudder):
    """A rudder that is where it is ordered, and acts behind a dead time."""

    delta_order = given("rad", "rudder order, positive turns to starboard")
    delta_recorded = derived("rad", "rudder angle as it is recorded, positive turns to starboard", latex=r"\delta")

    @delta_recorded.equals
    def direct(self) -> Expression:
        """No lag of the rudder itself."""
        return self.delta_order


class LateSteeringMachine(LateRudder, SteeringMachine):
    """A steering machine whose rudder acts behind a dead time."""

    delta_recorded = state(
        "rad", "rudder angle as it is recorded, positive turns to starboard", nominal="10 deg", latex=r"\delta"
    )

    @delta_recorded.rate
    def servo(self):
        """Passenier (1989), fig. 2.9, of the rudder that is recorded."""
        return self.towards_order(self.delta_recorded)


#: By actuator, the one of a rudder that acts late.
_LATE: dict[type[Component], type[Component]] = {SteeringMachine: LateSteeringMachine, DirectRudder: LateDirectRudder}


def steered_by(model: Model) -> str | None:
    """Return the input by which a model is steered, or None where it reads none.

    Parameters
    ----------
    model : Model
        A ship model.

    Returns
    -------
    str or None
        ``"delta"``, the rudder angle; ``"delta_order"`` of a model that has a steering machine of its own, which states ``delta``.
    """
    if "delta" in model.inputs:
        return "delta"
    return "delta_order" if "delta_order" in model.inputs and "delta" in model else None


def not_steered(model: Model) -> str:
    """Return what to say of a model that nothing steers (`steered_by`): what it would have to read, and what can be done with it as it is.

    Parameters
    ----------
    model : Model
        A ship model.
    """
    return (
        f"model {model.name} reads no rudder angle 'delta', and states none behind a rudder order 'delta_order', so there is nothing to "
        "steer. Rudders that move together are derived from one delta in an equation; what other inputs move is fitted to a log "
        "(shipid identify)."
    )


def gear_of(model: Model, *, direct: bool = False) -> tuple[type[Component], ...]:
    """Return the steering machine that a model is joined with: one of a rudder that acts late where it has a dead time, none where it has its own.

    Parameters
    ----------
    model : Model
        A ship model that is steered (`steered_by`).
    direct : bool
        Whether the rudder is where it is ordered, without a machine.
    """
    return (actuator_of(model, DirectRudder if direct else SteeringMachine),) if "delta" in model.inputs else ()


def actuator_of(model: Model, actuator: type[Component]) -> type[Component]:
    """Return what turns an order into the rudder of a model: an actuator, or its counterpart that acts behind a dead time.

    Parameters
    ----------
    model : Model
        A ship model that reads the rudder angle.
    actuator : type[Component]
        The steering machine of a ship without a dead time, or a rudder that is where it is ordered. Any other is returned as it is.
    """
    return _LATE.get(actuator, actuator) if "delta" in model.delays else actuator


def at_rest(model: Model, known: Mapping[str, float]) -> dict[str, float]:
    """Return what is known of a ship, with the states of a rudder that has stood where it is for longer than its dead time.

    Parameters
    ----------
    model : Model
        A ship model joined with `LateRudder`, or any other: then nothing is added.
    known : mapping of str to float
        Quantities of the model, SI; the rudder angle is ``delta``.
    """
    rudder = known.get("delta")
    if rudder is None or "behind" not in model.states:
        return dict(known)
    return {"behind": rudder, "delta_recorded": rudder, **known}


def recorded_rudder(model: Model) -> str:
    """Return the name of the rudder angle that a log of a model in closed loop holds: not the one that acts behind a dead time.

    Parameters
    ----------
    model : Model
        A ship model, joined with its steering machine or not.
    """
    return "delta_recorded" if "delta_recorded" in model else "delta"
