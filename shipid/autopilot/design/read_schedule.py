"""A schedule as a file: gains against speed with their units, and the ship they were designed for, so that it stands alone.

What a target machine is given can be edited by hand; what is read is therefore looked at as any input is.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import tomli_w

import shipid
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.design_autopilot import DESIGNS
from shipid.autopilot.design.plant import check_steerable
from shipid.autopilot.design.schedule import GAINS, Schedule
from shipid.autopilot.errors import ScheduleError
from shipid.declaration.tables import Table, read_table
from shipid.declaration.units import factor
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ParameterSetError, ShipidError, UnitError, nearest
from shipid.foundation.replacing import write_text
from shipid.parameters.catalogue import find_model, known_component
from shipid.parameters.parameter_file import parameter_table, parse_parameter_set
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.helm import DirectRudder

#: Limits of the steering machine, and the unit each is written in.
_LIMITS = {"delta_max": "rad", "delta_rate": "rad/s", "tau_delta": "s"}
_REQUESTS = {"omega_n": "rad/s", "damping": "1", "integral": "1", "rudder_weight": "1"}
_KEYS = {"kind", "written_by", "model", "actuator", "design", "request", "service_speed", "rudder_limit", "limits",
         "schedule", "ship", "condition", "warnings"}  # fmt: skip
_KIND = "shipid autopilot schedule"
_LAW = """\
# delta_order = Kp (psi_order - psi) - Kd r + Ki integral(psi_order - psi), within the rudder limit; the gains are
# straight between two speeds and stay as they are beyond the ends. Rudder and rate of turn positive to starboard.
"""


def write_schedule(pilot: Autopilot, path: str | Path, source: str | None = None) -> None:
    """Write a schedule as TOML.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    path : str or Path
        The file; it is replaced in one step.
    source : str, optional
        How the model is found again: a name, or ``path/to/file.py:Class``; the model's name when not given.
    """
    write_text(Path(path), _LAW + tomli_w.dumps(schedule_table(pilot, source)))


def schedule_table(pilot: Autopilot, source: str | None = None) -> dict[str, Plain]:
    """Return the table that TOML writes.

    Parameters
    ----------
    pilot, source
        As for `write_schedule`.

    Returns
    -------
    dict of str to Plain
    """

    def with_unit(value: Plain, unit: str) -> dict[str, Plain]:
        return {"value": value, "unit": unit}

    def numbers(values: np.ndarray) -> list[float]:
        return [float(f"{float(v):.15g}") for v in values]

    gains = {
        name: with_unit(numbers(table[0]) if len(table) == 1 else [numbers(row) for row in table], GAINS[name][0])
        for name, table in pilot.schedule.gains.items()
    }
    others = [{"ship": parameter_table(ship)} for ship in pilot.ships[1:]]
    return {
        "kind": _KIND,
        "written_by": f"shipid {shipid.__version__}",
        "model": source or pilot.model.name,
        "actuator": "" if pilot.actuator is DirectRudder else pilot.actuator.__name__,
        "design": pilot.design,
        "warnings": list(pilot.warnings),
        "service_speed": with_unit(pilot.service_speed, "m/s"),
        "rudder_limit": with_unit(float(f"{np.rad2deg(pilot.rudder_limit):.12g}"), "deg"),
        "request": {n: with_unit(v, _REQUESTS[n]) for n, v in pilot.request.items()},
        "limits": {n: with_unit(v, _LIMITS[n]) for n, v in pilot.limits.items()},
        "schedule": {"u": with_unit(numbers(pilot.speeds), "m/s"), **gains},
        "ship": parameter_table(pilot.ships[0]),
        **({"condition": others} if others else {}),
    }


def read_schedule(path: str | Path) -> Autopilot:
    """Read a schedule that `Autopilot.write` or ``shipid tune`` wrote, and somebody may have edited.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Autopilot

    Raises
    ------
    ScheduleError
        If it is no schedule, or says nonsense; the message names file and entry.
    """
    path = Path(path)
    raw = read_table(path, "schedule", ScheduleError).content
    if raw.get("kind") != _KIND:
        raise ScheduleError(f"{path} is no schedule of an autopilot: its first line is not kind = '{_KIND}'.")
    for key in raw:
        if key not in _KEYS:
            raise ScheduleError(f"{path} has an entry '{key}' it does not know. {nearest(key, _KEYS)}".strip())
    for key in ("model", "design", "service_speed", "rudder_limit", "schedule", "ship"):
        if key not in raw:
            raise ScheduleError(f"{path} lacks '{key}'.")
    if raw["design"] not in DESIGNS:
        raise ScheduleError(f"{path}: the design '{raw['design']}' is none of {', '.join(DESIGNS)}.")
    model = find_model(str(raw["model"]))
    check_steerable(model)
    ships = _ships(path, raw)
    schedule = _schedule(path, raw["schedule"], len(ships))
    limits = _table(path, "limits", raw.get("limits", {}), _LIMITS)
    for name in ("delta_max", "delta_rate"):
        if not limits.get(name, 0.0) > 0:
            raise ScheduleError(f"{path}, [limits]: '{name}' is missing or not greater than zero.")
    limit = _number(path, "rudder_limit", raw["rudder_limit"], "rad")
    if not 0 < limit <= limits["delta_max"] * (1 + 1e-9):
        raise ScheduleError(
            f"{path}: the rudder limit is {np.rad2deg(limit):.4g} deg, and has to lie above zero and within the "
            f"{np.rad2deg(limits['delta_max']):.4g} deg of the rudder."
        )
    service = _number(path, "service_speed", raw["service_speed"], "m/s")
    if not service > 0:
        raise ScheduleError(f"{path}: the service speed is {service:g} m/s, and has to be greater than zero.")
    actuator = known_component(str(raw["actuator"])) if raw.get("actuator") else DirectRudder
    pilot = Autopilot(
        model, ships, actuator, raw["design"], _table(path, "request", raw.get("request", {}), _REQUESTS), service,
        limit, limits, schedule, tuple(str(w) for w in raw.get("warnings", [])),
    )  # fmt: skip
    _check_sense(path, pilot)
    return pilot


def _check_sense(path: Path, pilot: Autopilot) -> None:
    """A schedule that does not hold the ship is nonsense, whoever wrote it."""
    for condition, name in enumerate(pilot.conditions):
        for speed in pilot.speeds:
            try:
                poles = pilot.poles(float(speed), condition)
            except ShipidError as error:
                raise ScheduleError(f"{path}: at {speed:.4g} m/s the ship {name} gives no loop. {error}") from None
            if poles.real.max() >= 0:
                raise ScheduleError(
                    f"{path}: at {speed:.4g} m/s the loop of ship {name} with these gains is unstable (a pole at "
                    f"{poles[0].real:.3g}{poles[0].imag:+.3g}i rad/s). Look at the gains at that speed."
                )


def _schedule(path: Path, raw: Plain, conditions: int) -> Schedule:
    where = f"{path}, [schedule]"
    if not isinstance(raw, Mapping) or "u" not in raw or not {"Kp", "Kd"} <= set(raw):
        raise ScheduleError(f"{where} has to hold u, Kp and Kd.")
    for name in raw:
        if name not in ("u", *GAINS):
            raise ScheduleError(
                f"{where} has an entry '{name}' it does not know. {nearest(name, ('u', *GAINS))}".strip()
            )
    speeds = _row(f"{where} u", raw["u"], "m/s")
    if speeds.ndim != 1 or speeds.min() <= 0 or not (np.diff(speeds) > 0).all():
        raise ScheduleError(f"{where}: the speeds {speeds.tolist()} have to be greater than zero and to rise.")
    gains = {}
    for name, (unit, _) in GAINS.items():
        if name in raw:
            table = np.atleast_2d(_row(f"{where} {name}", raw[name], unit))
            if table.shape != (conditions, len(speeds)):
                raise ScheduleError(
                    f"{where}: {name} has {table.shape[1]} values in {table.shape[0]} rows, and the schedule {len(speeds)} "
                    f"speeds and {conditions} load conditions."
                )
            gains[name] = table
    return Schedule(speeds, gains)


def _row(where: str, raw: Plain, unit: str) -> np.ndarray:
    if not isinstance(raw, Mapping) or set(raw) != {"value", "unit"}:
        raise ScheduleError(f"{where} has to be written {{ value = [..], unit = '{unit}' }}.")
    try:
        values = np.array(raw["value"], dtype=float)
    except (TypeError, ValueError):
        raise ScheduleError(f"{where} is {raw['value']!r}, which is no list of numbers.") from None
    if values.ndim not in (1, 2) or not values.size or not np.isfinite(values).all():
        raise ScheduleError(f"{where} is {raw['value']!r}, which is no list of finite numbers.")
    return np.asarray(values * _factor(where, raw["unit"], unit))


def _number(path: Path, name: str, raw: Plain, unit: str) -> float:
    where = f"{path}, '{name}'"
    good = isinstance(raw, Mapping) and set(raw) == {"value", "unit"}
    if (
        not good
        or isinstance(raw["value"], bool)
        or not isinstance(raw["value"], (int, float))
        or not np.isfinite(raw["value"])
    ):
        raise ScheduleError(f"{where} has to be written {{ value = 1.0, unit = '{unit}' }}, with a finite number.")
    return float(raw["value"]) * _factor(where, raw["unit"], unit)


def _factor(where: str, given: Plain, wanted: str) -> float:
    try:
        return factor(str(given), wanted, where)
    except UnitError as error:
        raise ScheduleError(str(error)) from None


def _table(path: Path, section: str, raw: Plain, units: Mapping[str, str]) -> dict[str, float]:
    if not isinstance(raw, Mapping):
        raise ScheduleError(f"{path}: '{section}' is no table.")
    for name in raw:
        if name not in units:
            raise ScheduleError(
                f"{path}, [{section}] has an entry '{name}' it does not know. {nearest(name, units)}".strip()
            )
    return {n: _number(path, f"{section}.{n}", v, units[n]) for n, v in raw.items()}


def _ships(path: Path, raw: Mapping[str, Plain]) -> tuple[ParameterSet, ...]:
    tables = [raw["ship"], *(c.get("ship") for c in raw.get("condition", []))]
    try:
        if not all(isinstance(t, dict) for t in tables):
            raise ParameterSetError(f"{path}: 'ship' is no table.")
        return tuple(parse_parameter_set(Table(t, str(path), ParameterSetError), path.stem) for t in tables)
    except ParameterSetError as error:
        raise ScheduleError(f"the ship in {error}") from None
