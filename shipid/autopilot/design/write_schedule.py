"""A schedule as a file: gains against speed with their units, and the ship they were designed for, so that it is complete."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import tomli_w

import shipid
from shipid.autopilot.design.autopilot import REQUEST_UNITS, Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.foundation.aliases import Plain
from shipid.foundation.replacing import write_text
from shipid.parameters.parameter_file import parameter_table
from shipid.parts.helm import DirectRudder
from shipid.parts.rudder_delay import LateDirectRudder

#: The entry ``kind`` of every schedule.
KIND = "shipid autopilot schedule"
#: Limits of the steering machine, and the unit each is written in.
LIMIT_UNITS = {"delta_max": "rad", "delta_rate": "rad/s", "tau_delta": "s"}
#: The control law of each mode.
_LAWS = {
    "course": "Kp (psi_order - psi) - Kd r + Ki integral(psi_order - psi)",
    "rate": "Kd (r_order - r) + Kp integral(r_order - r)",
}
_HEAD = """\
# delta_order = {law}, within the rudder limit; the gains are
# straight between two speeds and stay as they are beyond the ends. Rudder and rate of turn positive to starboard.
"""


def write_schedule(pilot: Autopilot, path: str | Path, source: str | None = None) -> None:
    """Write a schedule as TOML, with the ship it was designed for; `read_schedule` reads it.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    path : str or Path
        The file; it is replaced in one step.
    source : str, optional
        How the model is found again: a name, or ``path/to/file.py:Class``; the model's name when not given.
    """
    write_text(Path(path), _HEAD.format(law=_LAWS[pilot.mode]) + tomli_w.dumps(schedule_table(pilot, source)))


def schedule_table(pilot: Autopilot, source: str | None = None) -> dict[str, Plain]:
    """Return the table that TOML writes.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    source : str, optional
        As for `write_schedule`.
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
        "kind": KIND,
        "written_by": f"shipid {shipid.__version__}",
        "model": source or pilot.model.name,
        "actuator": "" if pilot.actuator in (DirectRudder, LateDirectRudder) else pilot.actuator.__name__,
        "design": pilot.design,
        "mode": pilot.mode,
        "warnings": list(pilot.warnings),
        "service_speed": with_unit(pilot.service_speed, "m/s"),
        "rudder_limit": with_unit(float(f"{np.rad2deg(pilot.rudder_limit):.12g}"), "deg"),
        "request": {n: with_unit(v, REQUEST_UNITS[n]) for n, v in pilot.request.items()},
        "limits": {n: with_unit(v, LIMIT_UNITS[n]) for n, v in pilot.limits.items()},
        "schedule": {"u": with_unit(numbers(pilot.speeds), "m/s"), **gains},
        "ship": parameter_table(pilot.ships[0]),
        **({"condition": others} if others else {}),
    }
