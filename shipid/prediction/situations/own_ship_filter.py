"""The filter a prediction begins from: the ship's own model, with the current and the disturbance of its yaw as further states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join, replace_component
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.settings.instruments import Amount
from shipid.identification.problem.prior import INDEPENDENT, STRUCTURE_ANGLE, STRUCTURE_SPEED
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import range_of
from shipid.parts.planar_motion import PlanarMotion
from shipid.parts.unmeasured import SlowCurrent, SlowDisturbance, SlowResidual, SlowSurge, UncertainLog, UncertainMotion
from shipid.prediction.situations.fix_errors import SWAY_CONSTANT

#: What an ordinary bridge measures: the standard deviation of one sample.
BRIDGE: Mapping[str, str] = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "10 m", "y": "10 m"}
#: States in which a yaw acceleration is estimated that nobody measures.
DISTURBANCES = ("r_disturbance", "r_residual")
#: Spread of the first estimates and noise of current and disturbance in the prime system: of U, and of (U/L)^2.
_CURRENT, _DISTURBANCE = (0.1, 0.007), (0.15, 0.005)
#: Instruments are not coarser than these shares of the ship's speed and of her length: a model in a tank is not sailed by satellites.
_COARSEST: Mapping[str, tuple[str, float]] = {"u": ("speed", 0.05), "x": ("length", 0.25), "y": ("length", 0.25)}
#: By how much the scale of a log, which is as unsure as a speed by a model, changes in one L/U.
_LOG_CHANGES = 0.001
#: The errors of fixes last: of those that come every 0.4 s so many count as one.
_FIXES_AS_ONE = 10
#: Standard deviation of the error of the sway constant gamma*: of a model that was not identified on the ship, and of one without a
#: sway speed. The constants of the ships of this project lie between 0.27 and 0.57.
_SWAY_ASSUMED, _SWAY_NONE = 0.2, 0.5
#: The quantities that are shown by sensors of their own where log and model are not exact.
_SHOWN_BY: Mapping[str, str] = {"u": "log", "v": "sway_log"}


def own_ship_model(model: Model | type[Component] | str, *, structure: bool = False) -> Model:
    """Return a ship's model with the current and the disturbance it reads as states.

    Parameters
    ----------
    model : Model, component class or str
        The ship.
    structure : bool
        Whether the error of the model's sway speed and that of the log are states as well, where the model has a `PlanarMotion`.
    """
    whole = model_of(model)
    parts: list[type[Component]] = [SlowCurrent] if "current_north" in whole.inputs else []
    # A model that reads the wind states its moment; what else acts on her yaw comes on top.
    parts += [SlowDisturbance] if "r_disturbance" in whole.inputs else []
    parts += [SlowResidual] if "r_residual" in whole.inputs else []
    if structure and PlanarMotion in whole.components and not whole.outputs:
        whole = replace_component(whole, PlanarMotion, UncertainMotion)
        parts += [UncertainLog] if "u" in whole.states else []
        parts += [SlowSurge] if "u_disturbance" in whole.inputs else []
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
    structure: bool = False,
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
    structure : bool
        Whether model and log are taken as not exact, so that their errors are not read as a current. Without it the current is that of
        a ship which is exactly her model.

    Returns
    -------
    ExtendedKalmanFilter
        Current and disturbance are random walks whose noise is in proportion to U and (U/L)^2 of the ship.
    """
    known = ship_of(ship)
    length, speed = known.particular("L", "m"), known.particular("speed", "m/s")
    plain = model_of(model)
    whole = own_ship_model(plain, structure=structure and bool(length and speed))
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
        if "u_disturbance" in whole.states:
            initial["u_disturbance"] = f"{_DISTURBANCE[0] * speed / unit_time} m/s^2"
            levels["u_disturbance"] = f"{_DISTURBANCE[1] * speed / unit_time**1.5} m/s^2.5"
        if "sway_missed" in whole.derived:
            lasts = (2 / (INDEPENDENT * unit_time)) ** 0.5
            sway = _sway_error(plain, known)
            initial |= {"drift_error": f"{STRUCTURE_ANGLE} rad", "sway_error": sway}
            levels |= {
                "drift_error": f"{STRUCTURE_ANGLE * lasts} rad/s^0.5",
                "sway_error": f"{sway * lasts} 1/s^0.5",
            }
            if "log_error" in whole.states:
                initial["log_error"] = STRUCTURE_SPEED
                levels["log_error"] = f"{_LOG_CHANGES / unit_time**0.5} 1/s^0.5"
                levels["u"] = f"{STRUCTURE_SPEED * speed * lasts} m/s^1.5"
            if not estimated and "r" in whole.states:
                # Where coefficients are estimated, the error of the rate of turn is theirs.
                levels["r"] = f"{STRUCTURE_ANGLE / unit_time * lasts} rad/s^1.5"
            if "v" in whole.states:
                levels["v"] = f"{STRUCTURE_ANGLE * speed * lasts} m/s^1.5"
    seen = (*whole.states, *whole.derived, *whole.outputs)
    shown = {n: level for n, level in (measured or bridge_levels(length, speed, structure)).items() if n in seen}
    if "sway_missed" in whole.derived:
        own = {n: s for n, s in _SHOWN_BY.items() if s in whole.outputs}
        shown = {own.get(n, n): level for n, level in shown.items()}
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


def bridge_levels(length: float | None, speed: float | None, lasting: bool = False) -> dict[str, str]:
    """Return the standard deviation of one sample of what an ordinary bridge measures, not coarser than suits the ship.

    Parameters
    ----------
    length, speed : float or None
        Of the ship in m and m/s, where they are known.
    lasting : bool
        Whether the levels of fixes are those of errors that last.
    """
    sizes = {"length": length, "speed": speed}
    levels = dict(BRIDGE)
    for name, (what, share) in _COARSEST.items():
        size = sizes[what]
        value, unit = BRIDGE[name].split()
        if size:
            wider = _FIXES_AS_ONE**0.5 if lasting and what == "length" else 1.0
            levels[name] = f"{wider * min(float(value), share * size):.4g} {unit}"
    return levels


def _sway_error(model: Model, ship: ParameterSet) -> float:
    """How far off the sway constant of a model is."""
    if "v" not in (*model.states, *model.derived):
        return _SWAY_NONE
    found = range_of(ship, model)
    return SWAY_CONSTANT if found is not None and found[1].names else _SWAY_ASSUMED
