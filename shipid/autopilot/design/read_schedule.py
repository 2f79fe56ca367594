"""Reading a schedule: the file may have been edited by hand, so that each entry is checked, and the loop with these gains."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from shipid.autopilot.design.autopilot import REQUEST_UNITS, Autopilot, Design, Mode
from shipid.autopilot.design.closed_loop import schedule_poles
from shipid.autopilot.design.design_autopilot import DESIGNS, MODES
from shipid.autopilot.design.plant import check_carries_delay, check_steerable
from shipid.autopilot.design.schedule import GAINS, Schedule
from shipid.autopilot.design.write_schedule import KIND, LIMIT_UNITS
from shipid.autopilot.errors import ModelFileError, ScheduleError
from shipid.declaration.component import Component, declared_quantities
from shipid.declaration.model import Model
from shipid.declaration.tables import Table, read_table
from shipid.declaration.units import factor
from shipid.declaration.vocabulary import angle
from shipid.foundation.errors import ParameterSetError, ShipidError, UnitError
from shipid.foundation.numbers import brief
from shipid.parameters.catalogue import find_model, known_component, model_of, names_a_file
from shipid.parameters.parameter_file import parse_parameter_set
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.helm import DirectRudder
from shipid.parts.rudder_delay import actuator_of

#: Lengths that differ by a larger share are those of two ships: one is measured between perpendiculars, another over all.
_SAME = 0.1
_REQUIRED = ("model", "design", "service_speed", "rudder_limit", "schedule", "ship")
_KEYS = (*_REQUIRED, "kind", "written_by", "actuator", "mode", "request", "limits", "condition", "warnings")


def read_schedule(path: str | Path, model: Model | type[Component] | str | None = None) -> Autopilot:
    """Read a schedule that `write_schedule` or ``shipid tune`` wrote.

    A schedule is data: it may name a model that is installed, and runs no model file.

    Parameters
    ----------
    path : str or Path
        The file.
    model : Model, component class or str, optional
        The model of a schedule that names a model file, or a model that is not installed: what it was designed with.

    Returns
    -------
    Autopilot

    Raises
    ------
    ModelFileError
        If it names a model file, and no model is given.
    ScheduleError
        If it is no schedule, an entry is wrong or the loop is unstable, or it belongs to another model; the message names file
        and entry.
    UnknownNameError
        If there is no model of the name it holds.
    """
    path = Path(path)
    table = read_table(path, "schedule", ScheduleError)
    if table.content.get("kind") != KIND:
        raise ScheduleError(f"{path} is no schedule of an autopilot: it has no entry kind = '{KIND}'.")
    table.check_keys(_KEYS, _REQUIRED)
    found = _model(table, model)
    check_steerable(found)
    ships = _ships(table, path.stem)
    schedule = _schedule(table.table("schedule"), len(ships))
    limits = _numbers(table.table("limits"), LIMIT_UNITS)
    for name in ("delta_max", "delta_rate"):
        if not limits.get(name, 0.0) > 0:
            raise table.table("limits").fail(f"'{name}' is missing or not greater than zero.")
    rudder_limit, service_speed = _positive(table, "rudder_limit", "rad"), _positive(table, "service_speed", "m/s")
    if rudder_limit > limits["delta_max"] * (1 + 1e-9):
        raise table.fail(
            f"the rudder limit is {angle(rudder_limit)}, and has to lie within the {angle(limits['delta_max'])} of the rudder."
        )
    actuator = table.value("actuator", str, "")
    return Autopilot(
        model=found,
        ships=ships,
        actuator=_actuator(table, actuator, found),
        design=cast(Design, table.choice("design", DESIGNS)),
        mode=cast(Mode, table.choice("mode", MODES, "course")),
        request=_numbers(table.table("request"), REQUEST_UNITS),
        service_speed=service_speed,
        rudder_limit=rudder_limit,
        limits=limits,
        schedule=schedule,
        poles=_stable_poles(path, found, ships, schedule),
        warnings=tuple(str(w) for w in table.value("warnings", list, [])),
    )


def check_same_ship(path: str | Path, pilot: Autopilot, ship: ParameterSet) -> None:
    """Check that a schedule was designed for the ship that is sailed under it: its gains and its limits of the rudder are hers.

    Parameters
    ----------
    path : str or Path
        The schedule's file, for the message.
    pilot : Autopilot
        The schedule.
    ship : ParameterSet
        The ship that is sailed.

    Raises
    ------
    ScheduleError
        If their lengths differ: it is another ship.
    """
    length, designed = ship.particular("L", "m"), pilot.ship.particular("L", "m")
    if length and designed and abs(length - designed) > _SAME * designed:
        raise ScheduleError(
            f"{path} was designed for ship {pilot.ship.name} of {brief(designed, 5)} m, and {ship.name} has {brief(length, 5)} m. Design one for her: "
            f"shipid tune {pilot.model.name} --ship {ship.name}."
        )


def _model(table: Table, given: Model | type[Component] | str | None) -> Model:
    """The model of a schedule: the one it names, which is installed, or the one that is given for it."""
    name = table.value("model", str)
    if given is None:
        if names_a_file(name):
            raise ModelFileError(
                f"{table.where}: the model is '{name}', a model file, which is code, and a schedule runs none. If you trust that file, give it "
                f"yourself: shipid tune {name} --compare ..., or read_schedule(path, '{name}')."
            )
        return find_model(name)
    model = model_of(given)
    if name not in (model.name, given) and not (names_a_file(name) and name.rpartition(":")[2] in _names(given, model)):
        raise table.fail(f"the schedule belongs to model '{name}', and '{model.name}' is given for it.")
    return model


def _names(given: Model | type[Component] | str, model: Model) -> set[str]:
    """What a model file may call a model."""
    if isinstance(given, str):
        return {given.rpartition(":")[2]}
    return {model.name, *(c.__name__ for c in model.components)}


def _actuator(table: Table, name: str, model: Model) -> type[Component]:
    if not name:
        return actuator_of(model, DirectRudder)
    actuator = known_component(name)
    stated = {n for n, q in declared_quantities(actuator).items() if q.kind in ("state", "derived")}
    if "delta" not in stated or "delta_order" not in declared_quantities(actuator):
        raise table.fail(
            f"'actuator' is {name}, which turns no order into a rudder angle. Write SteeringMachine, or ''."
        )
    actuator = actuator_of(model, actuator)
    check_carries_delay(model, actuator)
    return actuator


def _stable_poles(
    path: Path, model: Model, ships: tuple[ParameterSet, ...], schedule: Schedule
) -> tuple[tuple[np.ndarray, ...], ...]:
    """The poles at each speed; an unstable loop is an error."""
    try:
        poles = schedule_poles(model, ships, schedule)
    except ShipidError as error:
        raise ScheduleError(f"{path}: the ship gives no loop at these speeds. {error}") from None
    for ship, at_speeds in zip(ships, poles):
        for speed, found in zip(schedule.speeds, at_speeds):
            if found.real.max() >= 0:
                raise ScheduleError(
                    f"{path}: at {brief(speed, 4)} m/s the loop of ship {ship.name} with these gains is unstable (a pole at "
                    f"{found[0].real:.3g}{found[0].imag:+.3g}i rad/s). Correct the gains at that speed."
                )
    return poles


def _schedule(table: Table, conditions: int) -> Schedule:
    table.check_keys(("u", *GAINS), ("u", "Kp", "Kd"))
    speeds = _row(table, "u", "m/s")
    if speeds.ndim != 1 or speeds.min() <= 0 or not (np.diff(speeds) > 0).all():
        raise table.fail(f"the speeds {speeds.tolist()} have to be greater than zero and to rise.")
    gains = {}
    for name, (unit, _) in GAINS.items():
        if name in table:
            gains[name] = np.atleast_2d(_row(table, name, unit))
            if gains[name].shape != (conditions, len(speeds)):
                rows, columns = gains[name].shape
                raise table.fail(
                    f"{name} has {columns} values in {rows} rows, and the schedule {len(speeds)} speeds and {conditions} "
                    "load conditions."
                )
    return Schedule(speeds, gains)


def _row(table: Table, name: str, unit: str) -> np.ndarray:
    """Numbers with one unit, in one row or in several, SI."""
    raw = table.content[name]
    if not isinstance(raw, Mapping) or set(raw) != {"value", "unit"}:
        raise table.fail(f"'{name}' has to be written {{ value = [..], unit = '{unit}' }}.")
    try:
        values = np.array(raw["value"], dtype=float)
    except (TypeError, ValueError):
        raise table.fail(f"'{name}' is {raw['value']!r}, which is no list of numbers.") from None
    if values.ndim not in (1, 2) or not values.size or not np.isfinite(values).all():
        raise table.fail(f"'{name}' is {raw['value']!r}, which is no list of finite numbers.")
    try:
        return np.asarray(values * factor(str(raw["unit"]), unit, f"{table.where} {name}"))
    except UnitError as error:
        raise ScheduleError(str(error)) from None


def _positive(table: Table, name: str, unit: str) -> float:
    number = table.quantity(name, unit)
    if number is None or not number > 0:
        raise table.fail(f"'{name}' is {number:g} {unit}, and has to be greater than zero.")
    return number


def _numbers(table: Table, units: Mapping[str, str]) -> dict[str, float]:
    table.check_keys(units)
    return {n: number for n in table if (number := table.quantity(n, units[n])) is not None}


def _ships(table: Table, name: str) -> tuple[ParameterSet, ...]:
    ships = [
        table.table("ship"),
        *(Table(c, table.where, ScheduleError).table("ship") for c in table.value("condition", list, [])),
    ]
    try:
        return tuple(parse_parameter_set(Table(s.content, s.where, ParameterSetError), name) for s in ships)
    except ParameterSetError as error:
        raise ScheduleError(f"the ship in {error}") from None
