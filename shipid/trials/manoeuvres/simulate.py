"""Simulate a manoeuvre: ship, steering machine, helmsman, sensors, current and wind in one record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

import shipid
from shipid.declaration.component import Component, declared_quantities
from shipid.declaration.join import join
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ParameterSetError, ShipidError, UnknownNameError, UsageError
from shipid.foundation.exit_codes import ExitCode
from shipid.generation.record import make_record
from shipid.parameters.catalogue import find_ship
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.parts import sensors
from shipid.parts.environment import Wind
from shipid.parts.helm import DirectRudder
from shipid.parts.steering_machine import SteeringMachine
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre, parse_manoeuvre, plan
from shipid.trials.source import Source
from shipid.trials.trial import Trial

#: What a simulated trial records, where the model has it.
RECORDED = ("x", "y", "psi", "u", "v", "r", "delta", "delta_order")
#: Steps that still fit into memory, with room to spare.
_MOST_STEPS = 1e7
_INTERVALS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)


_ROLES = {"given": "an input", "state": "a state", "output": "a sensor"}


class SimulationDivergedError(ShipidError):
    """The model ran away to values that are not finite."""

    exit_code = ExitCode.NO_CONVERGENCE


def standard_noise() -> dict[str, float]:
    """Return the standard deviation per sample of the standard sensors, SI, by the quantity they measure."""
    found: dict[str, float] = {}
    for thing in vars(sensors).values():
        if isinstance(thing, type) and issubclass(thing, Component):
            for q in declared_quantities(thing).values():
                if q.kind == "output" and q.measures and q.noise:
                    found[q.measures] = to_si(q.noise, q.unit, f"noise of {q.name}")
    return found


def parse_noise(text: str | Mapping[str, str | float] | None) -> dict[str, float]:
    """Read sensor noise: ``"none"``, ``"standard"``, or ``"psi=0.2 deg,r=0.02 deg/s"``.

    Returns
    -------
    dict of str to float
        Standard deviation per sample by column, SI.

    Raises
    ------
    UsageError, UnitError, UnknownNameError
        If the text does not say a column and a value with a unit.
    """
    if text is None or text == "none":
        return {}
    if text == "standard":
        return standard_noise()
    pairs: Mapping[str, str | float]
    if isinstance(text, str):
        parts = [p.partition("=") for p in text.split(",")]
        if not all(sign and value.strip() for _, sign, value in parts):
            raise UsageError(
                f"the noise '{text}' is neither none nor standard nor a list such as psi=0.2 deg,r=0.02 deg/s."
            )
        pairs = {n.strip(): v for n, _, v in parts}
    else:
        pairs = text
    for name in pairs:
        if name not in FIELDS:
            raise UnknownNameError("column to put noise on called", name, FIELDS)
    deviations = {
        n: to_si(v, FIELDS[n].unit, f"noise on {n}") if isinstance(v, str) else float(v) for n, v in pairs.items()
    }
    for name, deviation in deviations.items():
        if not 0 <= deviation < np.inf:
            raise UsageError(f"the noise on {name} is {pairs[name]}: a standard deviation is zero or more.")
    return deviations


def simulate(
    model: Model,
    ship: ParameterSet | str,
    manoeuvre: Manoeuvre | str,
    *,
    speed: str | float | None = None,
    duration: str | float | None = None,
    sampling: str | float | None = None,
    heading: str | float = 0.0,
    noise: str | Mapping[str, str | float] | None = None,
    current: tuple[str | float, str | float] | None = None,
    wind: tuple[str | float, str | float] | None = None,
    steering: bool = True,
    values: Mapping[str, str | float] | None = None,
    seed: int = 0,
    name: str | None = None,
) -> Trial:
    """Simulate a manoeuvre and return it as a trial.

    Parameters
    ----------
    model : Model
        A ship model with a heading ``psi`` that reads the rudder angle ``delta``.
    ship : ParameterSet or str
        The ship, or its name.
    manoeuvre : Manoeuvre or str
        Such as ``"zigzag:20/20"``; see `shipid.trials.manoeuvres.manoeuvre.KINDS`.
    speed : str or float, optional
        Speed before the manoeuvre, ``"9 kn"`` or in m/s; by default the ship's own.
    duration, sampling : str or float, optional
        In s; by default long enough for the manoeuvre, and a round interval near L/U/30.
    heading : str or float
        Heading of the approach, in rad or with a unit.
    noise : str or mapping, optional
        ``"none"``, ``"standard"``, ``"psi=0.2 deg"``, or standard deviations by column. A trial with sensors does not
        hold a speed through the water that none of them measures.
    current, wind : tuple, optional
        Speed and direction it flows TO, with units or in SI. Wind needs the wind coefficients among `values` or in
        the ship's set.
    steering : bool
        Whether the rudder follows through the ship's steering machine (limit and rate limit).
    values : mapping of str to str or float, optional
        Values with units that replace those of the ship.
    seed : int
        Of the noise and the random telegraph.
    name : str, optional
        Name of the trial.

    Returns
    -------
    Trial
        SI columns; the source says that it is simulated, and how.

    Raises
    ------
    UsageError
        If the manoeuvre, the speed or another argument does not fit, or the model does not read a current or wind
        that is asked for.
    ParameterSetError
        If the ship lacks something the model needs.
    SimulationDivergedError
        If the model runs away.
    """
    ship = find_ship(ship) if isinstance(ship, str) else ship
    manoeuvre = parse_manoeuvre(manoeuvre) if isinstance(manoeuvre, str) else manoeuvre
    u0 = _speed(ship, speed)
    length = ship.particular("L", "m")
    if length is None or length <= 0:
        raise ParameterSetError(
            f"ship {ship.name} has no length L greater than zero, which sets the pace of a manoeuvre."
        )
    course = _si(heading, "rad", "the heading")
    limit = ship.particular("delta_max", "rad") or 35 * np.pi / 180
    seconds = None if duration is None else _si(duration, "s", "the duration")
    if seconds is not None and not 0 < seconds < np.inf:
        raise UsageError(f"a manoeuvre of {seconds:g} s is none: give a duration greater than zero.")
    sailed = plan(manoeuvre, length / u0, course, limit, seed, seconds)
    interval = _interval(length / u0) if sampling is None else _si(sampling, "s", "the sampling interval")
    if not 0 < interval < sailed.duration:
        raise UsageError(f"a sampling interval of {interval:g} s does not fit a manoeuvre of {sailed.duration:g} s.")

    for flow, quantity in (("current", "current_north"), ("wind", "r_disturbance")):
        asked = current if flow == "current" else wind
        if asked is not None and quantity not in model.inputs:
            raise UsageError(f"model {model.name} reads no '{quantity}', so a {flow} does not act on it: leave it out.")
    whole = _with_steering(model, sailed.helm, steering, wind is not None)
    replaced = {n: to_si(v, whole[n].unit, f"'{n}' ({whole[n].quantity.meaning})") for n, v in (values or {}).items()}
    for n in replaced:
        if whole[n].quantity.kind not in ("parameter", "constant", "derived"):
            raise UsageError(f"'{n}' is {_ROLES[whole[n].quantity.kind]} of model {whole.name}, and takes no value.")
    published = [n for n in replaced if whole[n].quantity.kind == "derived"]
    whole = whole.impose(published) if published else whole
    known = ship.values(whole, speed=u0) | replaced | sailed.constants
    lacking = missing_values(whole, known, f"ship {ship.name}")
    if lacking:
        raise lacking

    # The steering machine and the helmsman want a finer clock than the record.
    fine = max(1, int(np.ceil(interval / min(0.02 * length / u0, 0.25) - 1e-9)))
    if sailed.duration / interval * fine > _MOST_STEPS:
        raise UsageError(
            f"{manoeuvre} for {sailed.duration:.3g} s at {interval:.3g} s takes more than {_MOST_STEPS:.0e} steps. "
            "Ask for a shorter duration."
        )
    count = round(sailed.duration / interval) + 1
    t = np.arange((count - 1) * fine + 1) * (interval / fine)
    inputs = _inputs(whole, u0, sailed, t, current, wind)
    x0 = {s: whole[s].number("start") or 0.0 for s in whole.states}
    x0 |= {s: v for s, v in {"u": u0, "psi": course}.items() if s in x0}
    shown = tuple(n for n in RECORDED if n in whole)
    record = make_record(whole, shown, hold="zero", compiled=False)
    p = record.system.vector(record.system.coefficients, known)
    y, _ = record(np.array(list(x0.values())), inputs, np.diff(t, append=t[-1]), p)
    if not np.isfinite(y).all():
        first = t[int(np.argmin(np.isfinite(y).all(axis=0)))]
        raise SimulationDivergedError(
            f"model {model.name} with ship {ship.name} runs away {first:.4g} s into {manoeuvre} at {u0:.3g} m/s. "
            "Less rudder keeps it within the range the model describes."
        )
    deviations = parse_noise(noise)
    table = _measured(shown, y[:, ::fine], t[::fine], deviations, seed)
    story = _story(model, ship, manoeuvre, u0, deviations, current, wind, seed)
    source = Source(simulated=True, comment=story, notes=(story,))
    return Trial(
        name or f"{model.name}-{str(manoeuvre).replace(':', '-').replace('/', '-')}", table, source, ship=ship.name
    )


def _si(value: str | float, unit: str, what: str) -> float:
    return to_si(value, unit, what) if isinstance(value, str) else float(value)


def _speed(ship: ParameterSet, speed: str | float | None) -> float:
    own = ship.particular("speed", "m/s")
    u0 = own if speed is None else _si(speed, "m/s", "the speed")
    if u0 is None:
        raise ParameterSetError(f"ship {ship.name} has no speed of its own: give one, as in --speed '9 kn'.")
    if not u0 > 0:
        raise UsageError(f"a speed of {u0:g} m/s does not steer a ship: give one greater than zero.")
    return u0


def _interval(unit_time: float) -> float:
    return max((i for i in _INTERVALS if i <= unit_time / 20), default=_INTERVALS[0])


def _with_steering(model: Model, helm: type[Component], steering: bool, wind: bool) -> Model:
    if "delta" not in model.inputs:
        raise UsageError(f"model {model.name} reads no rudder angle 'delta', so there is nothing to steer.")
    rudder = SteeringMachine if steering else DirectRudder
    extra = (Wind,) if wind else ()
    return join(model.name, model, rudder, helm, *extra)


def _inputs(
    whole: Model,
    u0: float,
    sailed: Any,
    t: np.ndarray,
    current: tuple[str | float, str | float] | None,
    wind: tuple[str | float, str | float] | None,
) -> np.ndarray:
    known: dict[str, Any] = {"u": u0, "cruise": u0}
    if sailed.schedule:
        known["helm_schedule"] = sailed.scheduled(t)
    if current is not None:
        rate, direction = _si(current[0], "m/s", "the current"), _si(current[1], "rad", "direction of the current")
        known |= {"current_north": rate * np.cos(direction), "current_east": rate * np.sin(direction)}
    if wind is not None:
        known |= {
            "wind_speed": _si(wind[0], "m/s", "the wind"),
            "wind_direction": _si(wind[1], "rad", "direction of the wind"),
        }
    rows = np.empty((len(whole.inputs), t.size))
    for i, name in enumerate(whole.inputs):
        default = whole[name].number("default")
        if name not in known and default is None:
            raise UsageError(
                f"model {whole.name} reads '{name}' ({whole[name].quantity.meaning}), which nothing states."
            )
        rows[i] = known.get(name, default)
    return rows


def _measured(
    shown: tuple[str, ...], y: np.ndarray, t: np.ndarray, deviations: Mapping[str, float], seed: int
) -> pd.DataFrame:
    rng = np.random.default_rng([seed, 0])
    table = {"t": t}
    unmeasured = {"u", "v"} - set(deviations) if deviations else set()
    for name, row in zip(shown, y):
        # Drawn for every column, so that the noise on one does not depend on which others carry noise.
        draw = rng.standard_normal(t.size)
        if name not in unmeasured:
            table[name] = row + deviations.get(name, 0.0) * draw
    return pd.DataFrame(table)


def _story(
    model: Model,
    ship: ParameterSet,
    manoeuvre: Manoeuvre,
    u0: float,
    deviations: Mapping[str, float],
    current: tuple[str | float, str | float] | None,
    wind: tuple[str | float, str | float] | None,
    seed: int,
) -> str:
    noise = ", ".join(f"{n} {d:.4g} {FIELDS[n].unit}" for n, d in deviations.items()) or "none"
    flows = "".join(f"; {what} {w[0]} to {w[1]}" for what, w in (("current", current), ("wind", wind)) if w is not None)
    return (
        f"Simulated, not measured: shipid {shipid.__version__}, model {model.name}, ship {ship.name}, {manoeuvre}, "
        f"{u0:.4g} m/s, noise {noise}, seed {seed}{flows}"
    )
