"""Simulate a manoeuvre: ship, steering machine, helmsman, sensors, current and wind in one record."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

import shipid
from shipid.declaration.component import Component
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ShipidError, UsageError
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.numbers import brief
from shipid.generation.simulator import make_simulator
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import ParameterSet, lacks_length, lacks_speed, missing_values
from shipid.parameters.replaced import with_values
from shipid.parameters.validity import beyond_in_run
from shipid.parts.manoeuvring_range import manoeuvring_range
from shipid.parts.rudder_delay import gear_of, not_steered, recorded_rudder, steered_by
from shipid.parts.sensors import shown_by
from shipid.parts.waves import Waves
from shipid.trials.manoeuvres.flows import (
    Flow,
    check_flows,
    flow_inputs,
    flow_of,
    logged_beside,
    met_words,
    number,
    parts_in_wind,
)
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre, parse_manoeuvre, plan, steps_of_helm
from shipid.trials.manoeuvres.noise import measured, noise_words, own_seed, parse_noise
from shipid.trials.manoeuvres.sea import DAMPING, FREQUENCY, driven_by, froude_share, wave_noise
from shipid.trials.source import Source
from shipid.trials.trial import Trial

#: What a simulated trial records, where the model has it.
RECORDED = ("x", "y", "psi", "u", "v", "r", "delta", "delta_order")
#: What is recorded as well where the ship states it: shaft speed, roll.
_OWN = ("n", "phi", "p")
#: What shows the waves, and the quantity of the waves in it.
_WAVED = {"psi": "psi_wave", "r": "r_wave"}
#: Steps that still fit into memory, with room to spare.
_MOST_STEPS = 1e7
_INTERVALS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
_ROLES = {"given": "an input", "state": "a state", "output": "a sensor"}


class NotSailedError(ShipidError):
    """The model leaves the range in which it is valid, or runs away to values that are not finite."""

    exit_code = ExitCode.NO_CONVERGENCE


def simulate(
    model: Model | type[Component] | str,
    ship: ParameterSet | str | Path | None,
    manoeuvre: Manoeuvre | str,
    *,
    speed: str | float | None = None,
    duration: str | float | None = None,
    sampling: str | float | None = None,
    heading: str | float = 0.0,
    noise: str | Mapping[str, str | float] | None = None,
    current: Flow | None = None,
    wind: Flow | None = None,
    waves: Flow | None = None,
    inputs: Mapping[str, str | float] | None = None,
    steering: bool = True,
    values: Mapping[str, str | float] | None = None,
    seed: int = 0,
    name: str | None = None,
) -> Trial:
    """Simulate a manoeuvre and return it as a trial.

    Parameters
    ----------
    model : Model, component class or str
        A ship model with a heading ``psi`` that reads the rudder angle ``delta``, or with a steering machine of its own that states
        it behind ``delta_order``; or its name.
    ship : ParameterSet, str or Path
        The ship, its name or its file.
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
    current, wind : str or tuple, optional
        Speed and direction it flows TO, with units or in SI. Wind needs the wind coefficients among `values` or in
        the ship's set.
    waves : str or tuple, optional
        Root mean square of the heading by waves, and the direction they run TO, with units or in SI. They show in ``psi`` and ``r``,
        which the instruments measure; the helmsman steers by the heading without them, and they do not change the path. A model
        with `shipid.parts.waves.WaveMoment` is moved by them: its size is then the significant height, ``"2 m from 300 deg"``.
    inputs : mapping of str to str or float, optional
        Inputs of the model that are held, with units or in SI.
    steering : bool
        Whether the rudder follows through the ship's steering machine (limit and rate limit). A machine that the model has of its
        own stays.
    values : mapping of str to str or float, optional
        Values with units that replace those of the ship.
    seed : int
        Of the noise and the random telegraph. Another manoeuvre, or another speed, has other noise under the same seed.
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
    UnstatedInputError
        If the model reads another input that declares no default.
    ParameterSetError
        If the ship lacks something the model needs.
    NotSailedError
        If the model leaves the range in which it is valid, or runs away.
    """
    model, ship = hold_inputs(model_of(model), inputs or {}), ship_of(ship)
    manoeuvre = parse_manoeuvre(manoeuvre) if isinstance(manoeuvre, str) else manoeuvre
    u0, length = _speed(ship, speed), _length(ship)
    unit_time = length / u0
    course = number(heading, "rad", "the heading")
    limit = ship.particular("delta_max", "rad") or np.deg2rad(35)
    seconds = None if duration is None else number(duration, "s", "the duration")
    if seconds is not None and not 0 < seconds < np.inf:
        raise UsageError(f"a manoeuvre of {seconds:g} s is none: give a duration greater than zero.")
    planned = plan(manoeuvre, unit_time, course, limit, seed, seconds, ship.particular("delta_rate", "rad/s"))
    interval = usual_interval_of(unit_time) if sampling is None else number(sampling, "s", "the sampling interval")
    if not 0 < interval < planned.duration:
        raise UsageError(f"a sampling interval of {interval:g} s does not fit a manoeuvre of {planned.duration:g} s.")

    check_flows(model, current, wind)
    driven, unit_of_waves, share = driven_by(model)
    shows = waves is not None and driven == "wave_noise"
    whole = _with_steering(model, planned.helm, steering, wind, shows)
    whole, replaced = _with_values(whole, values or {})
    known = ship.values(whole, speed=u0) | replaced | planned.constants
    lacking = missing_values(whole, known, f"ship {ship.name}")
    if lacking:
        raise lacking

    draws = own_seed(seed, f"{manoeuvre}, {brief(u0, 4)} m/s")
    fine = steps_of_helm(interval, unit_time)
    if planned.duration / interval * fine > _MOST_STEPS:
        raise UsageError(
            f"{manoeuvre} for {brief(planned.duration, 3)} s at {brief(interval, 3)} s takes more than {_MOST_STEPS:.0e} steps. "
            "Ask for a shorter duration."
        )
    count = round(planned.duration / interval) + 1
    t = np.arange((count - 1) * fine + 1) * (interval / fine)
    acting: dict[str, float | np.ndarray] = {"u": u0, "cruise": u0, **flow_inputs(current, wind)}
    if (sea := flow_of(waves, "waves", unit_of_waves)) is not None:
        frequency = FREQUENCY / froude_share(length)
        push = wave_noise(t.size, np.array([interval / fine]), draws, frequency=frequency, heading=share * sea[0])[:, 0]
        known = known | {"wave_frequency": frequency, "wave_damping": DAMPING}
        acting |= {driven: push, "wave_direction": sea[1]}
    if planned.schedule:
        acting["helm_schedule"] = planned.scheduled(t)
    # Not compiled: a model that is simulated once is sooner run than compiled.
    logged = recorded_rudder(whole)
    # What an output measures is recorded under the name of that; another is a column of its own.
    shown = [n for n in model.outputs if model[n].quantity.measures is None]
    own = {n: model[n].unit for n in (*model.states, *shown) if n not in FIELDS}
    deviations = parse_noise(noise, own)
    kept = (*RECORDED, *(n for n in (*model.states, *shown) if n in _OWN or (n in own and n in deviations)))
    there = [n for n in (*kept, *_WAVED.values()) if n in whole]
    reading = dict(zip(there, shown_by(whole, there))) | ({"delta": logged} if "delta" in there else {})
    columns_shown = list(reading.values())
    simulator = make_simulator(whole, columns_shown, hold="zero", compiled=False)
    # A compass that follows late has reached the heading of the approach.
    run = simulator(t, known, acting, {"u": u0, "psi": course, "psi_behind": course})
    if run.departure is not None:
        steered = {"delta": run[logged]}
        remedy = "Less rudder, or a shorter duration, keeps it within its range."
        if run.departure.time == 0:
            remedy = "No manoeuvre is within its range so: state another value of the ship, another speed or input, or take another model."
        raise NotSailedError(
            f"{manoeuvre} of ship {ship.name} at {brief(u0, 3)} m/s is {NOT_SAILED} ({model.name}): {run.departure.reason}, "
            f"{brief(run.departure.time, 4)} s after the start. {remedy}"
            + "".join(f" {said}" for said in beyond_in_run(model, ship, u0, steered, known=True))
        )
    columns = {n: run.columns[reading[n]] for n in kept if n in reading}
    if shows:
        # The reading of an instrument has the waves already.
        columns |= {n: columns[n] + run.columns[wave] for n, wave in _WAVED.items() if reading.get(n) == n}
    table = measured({n: column[::fine] for n, column in columns.items()}, t[::fine], deviations, draws)
    # What was held is known, and what reads the trial needs it: the loading, the revolutions of the propeller.
    beside, units = logged_beside(model, wind, known)
    table = table.assign(**{n: value for n, value in beside.items() if n not in table})
    met = met_words(current, wind, waves, unit_of_waves)
    met += "".join(f"; {n} {value} held" for n, value in (inputs or {}).items())
    changed = "".join(f", {n} {value}" for n, value in (values or {}).items())
    comment = (
        f"Simulated, not measured: shipid {shipid.__version__}, model {model.name}, ship {ship.name}, {manoeuvre}, "
        f"{brief(u0, 4)} m/s{changed}, noise {noise_words(deviations, own)}, seed {seed}{met}"
    )
    # A range that the set does not state is told by ``shipid ship``; it is no news about this run.
    stated = with_values(ship, {n: v for n, v in (values or {}).items() if n in model.parameters}, (model,))
    notes = beyond_in_run(model, stated, u0, columns, known=True)
    source = Source(simulated=True, comment=comment, notes=(comment, *notes))
    units |= {n: unit for n, unit in own.items() if n in table}
    return Trial(
        name or f"{model.name}-{str(manoeuvre).replace(':', '-').replace('/', '-')}", table, source, ship.name, units
    )


def _speed(ship: ParameterSet, speed: str | float | None) -> float:
    own = ship.particular("speed", "m/s")
    u0 = own if speed is None else number(speed, "m/s", "the speed")
    if u0 is None:
        raise lacks_speed(ship, "--speed '9 kn'")
    if not u0 > 0:
        raise UsageError(f"a speed of {u0:g} m/s does not steer a ship: give one greater than zero.")
    return u0


def _length(ship: ParameterSet) -> float:
    length = ship.particular("L", "m")
    if length is None or length <= 0:
        raise lacks_length(ship, "which sets the pace of a manoeuvre")
    return length


def usual_interval_of(unit_time: float) -> float:
    """Return a round sampling interval in s, of at most a twentieth of L/U.

    Parameters
    ----------
    unit_time : float
        L/U in s.
    """
    return max((i for i in _INTERVALS if i <= unit_time / 20), default=_INTERVALS[0])


def _with_steering(model: Model, helm: type[Component], steering: bool, wind: Flow | None, waves: bool) -> Model:
    if steered_by(model) is None:
        raise UsageError(not_steered(model))
    extra = (*parts_in_wind(model, wind), *((Waves,) if waves else ()))
    return join(model.name, model, *gear_of(model, direct=not steering), helm, *extra, *manoeuvring_range(model))


def _with_values(whole: Model, values: Mapping[str, str | float]) -> tuple[Model, dict[str, float]]:
    """Return the model, published coefficients imposed on it, and the values of a user in SI."""
    replaced = {n: to_si(v, whole[n].given_unit, f"'{n}' ({whole[n].quantity.meaning})") for n, v in values.items()}
    for n in replaced:
        if whole[n].quantity.kind not in ("parameter", "constant", "derived"):
            raise UsageError(f"'{n}' is {_ROLES[whole[n].quantity.kind]} of model {whole.name}, and takes no value.")
    published = [n for n in replaced if whole[n].quantity.kind == "derived"]
    return (whole.impose(published) if published else whole), replaced
