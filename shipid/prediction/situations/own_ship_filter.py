"""The filter a prediction begins from: the ship's own model, with the current and the disturbance of its yaw as further states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.settings.instruments import Amount
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.unmeasured import SlowCurrent, SlowDisturbance, SlowResidual

#: What an ordinary bridge measures: the standard deviation of one sample.
BRIDGE: Mapping[str, str] = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "10 m", "y": "10 m"}
#: States in which a yaw acceleration is estimated that nobody measures.
DISTURBANCES = ("r_disturbance", "r_residual")
#: Spread of the first estimates and noise of current and disturbance in the prime system: of U, and of (U/L)^2.
_CURRENT, _DISTURBANCE = (0.1, 0.007), (0.15, 0.005)
#: Instruments are not coarser than these shares of the ship's speed and of her length: a model in a tank is not sailed by satellites.
_COARSEST: Mapping[str, tuple[str, float]] = {"u": ("speed", 0.05), "x": ("length", 0.25), "y": ("length", 0.25)}


def own_ship_model(model: Model | type[Component] | str) -> Model:
    """Return a ship's model with the current and the disturbance it reads as states.

    Parameters
    ----------
    model : Model, component class or str
        The ship.
    """
    whole = model_of(model)
    parts: list[type[Component]] = [SlowCurrent] if "current_north" in whole.inputs else []
    # A model that reads the wind states its moment; what else acts on her yaw comes on top.
    parts += [SlowDisturbance] if "r_disturbance" in whole.inputs else []
    parts += [SlowResidual] if "r_residual" in whole.inputs else []
    return join(f"{whole.name}-own-ship", whole, *parts) if parts else whole


def own_ship_filter(
    model: Model | type[Component] | str,
    ship: ParameterSet | str,
    *,
    measured: Mapping[str, Amount | None] | None = None,
    values: Mapping[str, float] | None = None,
    estimated: Sequence[str] = (),
    noise: Mapping[str, Amount] | None = None,
    gate: float | None = 5.0,
    switchable: bool = False,
) -> ExtendedKalmanFilter:
    """Return the filter of a ship's own model that a prediction begins from.

    Parameters
    ----------
    model : Model, component class or str
        The ship.
    ship : ParameterSet or str
        Its coefficients and particulars.
    measured : mapping of str to str, optional
        Standard deviation of one sample of each sensor; by default those of an ordinary bridge (`BRIDGE`).
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI.
    estimated : sequence of str
        Coefficients that are estimated as well.
    noise : mapping of str to str, optional
        Noise of states, in place of the defaults.
    gate : float or None
        See `ExtendedKalmanFilter`.
    switchable : bool
        Whether the adaptation of the coefficients can be switched off sample by sample.

    Returns
    -------
    ExtendedKalmanFilter
        Current and disturbance are random walks whose noise is in proportion to U and (U/L)^2 of the ship.
    """
    known = ship_of(ship)
    length, speed = known.particular("L", "m"), known.particular("speed", "m/s")
    whole = own_ship_model(model)
    initial: dict[str, Amount] = {}
    levels: dict[str, Amount] = {}
    if length and speed:
        scale = Scale(length, speed)
        unit_time = scale.unit_time
        for name in ("current_north", "current_east"):
            if name in whole.states:
                initial[name] = f"{_CURRENT[0] * speed} m/s"
                levels[name] = f"{_CURRENT[1] * speed / unit_time**0.5} m/s^1.5"
        for name in DISTURBANCES:
            if name in whole.states:
                initial[name] = f"{_DISTURBANCE[0] / unit_time**2} rad/s^2"
                levels[name] = f"{_DISTURBANCE[1] / unit_time**2.5} rad/s^2.5"
    seen = (*whole.states, *whole.derived, *whole.outputs)
    shown = {n: level for n, level in (measured or bridge_levels(length, speed)).items() if n in seen}
    return ExtendedKalmanFilter(
        whole,
        known,
        values=values,
        measured=shown,
        estimated=estimated,
        noise=levels | dict(noise or {}),
        initial=initial,
        gate=gate,
        switchable=switchable,
    )


def bridge_levels(length: float | None, speed: float | None) -> dict[str, str]:
    """Return the standard deviation of one sample of what an ordinary bridge measures, not coarser than suits the ship.

    Parameters
    ----------
    length, speed : float or None
        Of the ship in m and m/s, where they are known.
    """
    sizes = {"length": length, "speed": speed}
    levels = dict(BRIDGE)
    for name, (what, share) in _COARSEST.items():
        size = sizes[what]
        value, unit = BRIDGE[name].split()
        if size:
            levels[name] = f"{min(float(value), share * size):.4g} {unit}"
    return levels
