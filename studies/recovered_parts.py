"""The parts of chapter 2 beside rudder and hull come back: wind, leeway, even terms, instruments with faults, a dead time, the shaft.

Each row sails a ship with a part whose coefficients are known, with the standard noise of the sensors, and identifies the same model
from the records with the defaults of `shipid.identify`, several times. Asked: no estimate is farther than four of its standard
deviations from the truth, their mean is within 5 % of the truth or within three standard errors, and each is called determined.

    python studies/recovered_parts.py [--runs 5] [--short] [--json]
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from _table import Row, show

import shipid
from shipid import models
from shipid.declaration.units import to_si
from shipid.foundation.numbers import number

HULL = ("DeKeizer", "VanLeeuwenSway", "PlanarMotion")
#: Held in the truth beside what is looked at: an offset of rudder or compass is not told from a bias of the record.
HELD = ("alpha0", "psi_offset")
NOTES = (
    "An offset of the rudder (alpha0) and one of the compass are not in the table: no record tells them from its own bias of the rudder\n"
    "and its own initial heading, and shipid calls them not determined."
)
FARTHEST, NEAR, ERRORS = 4.0, 0.05, 3.0


@dataclass(frozen=True)
class Case:
    """A part, what is known of it, and how the ship is sailed.

    Attributes
    ----------
    words : str
        What it is.
    parts : tuple of str
        Components that are joined, or one shipped model.
    truth : mapping of str to str or float
        The coefficients that have to come back.
    manoeuvres : tuple of str
        One record each.
    ship : str
        The ship.
    sailing : mapping of str to Any
        Weather and inputs, see `shipid.simulate`.
    signals : tuple of str or None
        What is fitted; all by default.
    sailed : str
        The model that sails, to which `shipid.simulate` adds the weather; by default the one that is identified.
    """

    words: str
    parts: tuple[str, ...]
    truth: Mapping[str, str | float]
    manoeuvres: tuple[str, ...] = ("zigzag:20/20", "turn:20")
    ship: str = "soesterberg"
    sailing: Mapping[str, Any] = field(default_factory=dict)
    signals: tuple[str, ...] | None = None
    sailed: str = ""

    @property
    def model(self) -> shipid.Model:
        """The model."""
        if len(self.parts) == 1:
            return shipid.find_model(self.parts[0])
        return shipid.join(self.words, *(getattr(models, name) for name in self.parts))


WIND = {"wind": "15 m/s from 60 deg"}
TANK = {"wind": "1.5 m/s from 60 deg"}
CASES = (
    Case("even term of the rudder, eq. (2.27)", ("de-keizer-asymmetric",), {"alpha2": 0.3, "alpha0": 0.02},
         ("zigzag:20/20", "zigzag:-10/10", "turn:20", "turn:-20")),
    Case("force and moment by the wind, eq. (2.76)", (*HULL, "Wind"), {"N_w": "5e-7 rad/m^2", "F_w": "5e-7 1/m^2"}, sailing=WIND),
    Case("the same from heading and track alone", (*HULL, "Wind"), {"N_w": "5e-7 rad/m^2", "F_w": "5e-7 1/m^2", "K": 1.6, "tau": 1.7},
         sailing=WIND, signals=("psi", "x", "y")),
    Case("the wind that is simulated, read from the log", ("de-keizer-wind",), {"N_w": "3.3e-7 rad/m^2", "F_w": "3.5e-7 1/m^2", "K": 1.6},
         sailed="de-keizer", sailing=WIND),
    Case("the same from heading, rate and speed", ("de-keizer-wind",), {"N_w": "3.3e-7 rad/m^2", "F_w": "3.5e-7 1/m^2", "K": 1.6},
         sailed="de-keizer", sailing=WIND, signals=("psi", "r", "u")),
    Case("the same from heading and track", ("de-keizer-wind",), {"N_w": "3.3e-7 rad/m^2", "F_w": "3.5e-7 1/m^2", "K": 1.6},
         sailed="de-keizer", sailing=WIND, signals=("psi", "x", "y")),
    Case("no wind, heading and track alone", ("de-keizer",), {"K": 1.6, "tau": 1.7}, signals=("psi", "x", "y")),
    Case("leeway, eq. (2.83)", ("DeKeizer", "VanLeeuwenSwayInWind", "PlanarMotion", "Leeway"), {"k_w": 0.01}, sailing=WIND),
    Case("force to the side by the wind, eq. (2.76)", ("CrossFlow", "PlanarMotion", "Wind", "LateralWind"),
         {"Y_w": "4e-4 1/m^2", "N_w": "1e-4 rad/m^2", "F_w": "3e-4 1/m^2"}, ship="kvlcc2-7m", sailing=TANK),
    Case("compass with a lag", (*HULL, "FaultyCompass"), {"tau_compass": "4 s", "psi_offset": "0 rad"}),
    Case("gyro with scale and bias, eq. (5.21)", (*HULL, "FaultyGyro"), {"r_scale": 1.1, "r_bias": "0.02 deg/s"}),
    Case("log with a scale", (*HULL, "FaultyLog"), {"u_scale": 0.9}),
    Case("resistance, at the shaft speed of the log, eq. (2.29)", ("mmg-revolutions",), {"R_0": 0.022}, ship="kvlcc2-7m", sailing={"inputs": {"n": "10 rps"}}),
)  # fmt: skip


#: Cases of one part differ by what is logged: the short form has one of them, and of the parts every other one.
VARIANTS = ("the same", "no wind")
SHORT = tuple(case for case in CASES if not case.words.startswith(VARIANTS))[1::2]


def identified(case: Case, run: int) -> shipid.Fit:
    """Sail the ship once more, with other noise, and identify her."""
    model = case.model
    trials = [
        shipid.simulate(
            case.sailed or model,
            case.ship,
            manoeuvre,
            noise="standard",
            seed=100 * run + k,
            values=case.truth,
            name=manoeuvre,
            **case.sailing,
        )
        for k, manoeuvre in enumerate(case.manoeuvres)
    ]
    return shipid.identify(model, trials, ship=case.ship, signals=case.signals)


def row(case: Case, name: str, truth: float, fits: list[shipid.Fit]) -> Row:
    """Compare the estimates of one coefficient with the truth."""
    estimates = [fit.parameters[name] for fit in fits]
    values, stds = (np.array([getattr(e, part) for e in estimates], float) for part in ("value", "std"))
    mean, spread = float(values.mean()), float(np.median(stds))
    farthest = float(np.abs((values - truth) / stds).max())
    off = abs(mean - truth)
    determined = sum(e.identifiable for e in estimates)
    holds = farthest <= FARTHEST and off <= max(NEAR * abs(truth), ERRORS * spread / np.sqrt(len(fits)))
    return Row(
        f"{case.words}: {name}",
        f"{number(truth, 4)}, determined",
        f"{number(mean, 4)} ± {number(spread, 2)}, farthest {number(farthest, 2)} deviations, {determined} of {len(fits)} determined",
        bool(holds and determined == len(fits)),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5, help="times that each is sailed")
    parser.add_argument("--short", action="store_true", help="every other part once, from one kind of log")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    given = parser.parse_args()
    rows = []
    for case in SHORT if given.short else CASES:
        fits = [identified(case, run) for run in range(1 if given.short else given.runs)]
        for name, stated in case.truth.items():
            if name not in HELD:
                rows.append(row(case, name, to_si(stated, case.model[name].unit), fits))
    show("Parts of chapter 2, recovered", rows, NOTES, given.json)


if __name__ == "__main__":
    main()
