"""A model of another structure than the ship: is a number that a user takes home right, or is it told that it may not be?

Ships whose structure is known sail zig-zags; models of lower order, and models that do not know what acts on the ship, are identified
from the records by the defaults, with the noise of sensors on them. Looked at is what is taken home: coefficients that have a
counterpart in the ship, the overshoots of a zig-zag that was kept apart, and the rate and the diameter of a turn that was kept apart.

- right: the truth lies in the 95 % interval or band that is printed, or within 5 % (of an overshoot: within half a degree);
- told: it does not, and the coefficient is called not determined, no band is given, a serious notice or finding says that the fit is
  not to be used, or a notice that this prediction goes beyond what was fitted;
- SILENT: it does not, and nothing says so.

Asked: nothing is silent but where no log of these signals can show the difference; the reason stands beside it.
For the default choice, `shipid.compare_models` finds the model.

    python studies/wrong_structure.py [--runs 1] [--only WORD] [--no-choice] [--json]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
from _table import Row, show
from scipy.signal import lfilter
from threadpoolctl import threadpool_limits

import shipid
from shipid import models
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import FIELDS
from shipid.generation.simulator import make_simulator
from shipid.parameters.validity import BEYOND

FITTED, KEPT, TURN = ("zigzag:20/20", "zigzag:10/10"), "zigzag:15/15", "turn:20"
#: Noise of the sensors by column, SI. Positions are not logged.
NOISE = {"psi": np.deg2rad(0.1), "r": np.deg2rad(0.02), "u": 0.05, "v": 0.05}
SHARE, DEGREES = 0.05, 0.5
#: The model that `shipid.compare_models` takes.
CHOICE = "the choice"
#: What is looked at of a kept turn.
CIRCLE = ("steady_rate", "tactical_diameter")
Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Ship:
    """A ship of a known structure, and the models that are fitted to her records.

    Attributes
    ----------
    words : str
        What the fitted models do not know.
    model : str or tuple of str
        Her model, or the components that are joined to it.
    ship : str
        Her parameter set.
    fitted : mapping of str to mapping of str to float
        Models, each with the coefficients that have a counterpart, SI.
    values : mapping of str to str
        Coefficients that replace those of the ship.
    sailing : mapping of str to Any
        See `shipid.simulate`.
    acts : callable or None
        What acts on her in truth, by input, from the columns of the record and a generator: she is sailed again with it.
    logged : callable or None
        What the log makes of the columns.
    calm : bool
        Whether the manoeuvres that are kept apart are sailed without what acts on her, which is of one day.
    unseen : mapping of str to str
        Coefficients about which no such log can tell that they are wrong, and why.
    """

    words: str
    model: str | tuple[str, ...]
    ship: str
    fitted: Mapping[str, Mapping[str, float]]
    values: Mapping[str, str] = field(default_factory=dict)
    sailing: Mapping[str, Any] = field(default_factory=dict)
    acts: Callable[[Columns, np.random.Generator], Columns] | None = None
    logged: Callable[[Columns], Columns] | None = None
    calm: bool = False
    unseen: Mapping[str, str] = field(default_factory=dict)

    def record(self, manoeuvre: str, rng: np.random.Generator, noise: float = 1.0) -> shipid.Trial:
        """Sail a manoeuvre and log it, with so many times the noise of the sensors."""
        model = (
            shipid.find_model(self.model)
            if isinstance(self.model, str)
            else shipid.join(self.words, *(getattr(models, n) for n in self.model))
        )
        sailed = shipid.simulate(model, self.ship, manoeuvre, values=self.values, name=manoeuvre, **self.sailing)
        columns = {n: sailed[n] for n in ("t", "delta", *NOISE) if sailed.has(n)}
        if self.acts is not None:
            inputs = {n: sailed[n] for n in model.inputs if sailed.has(n)}
            inputs |= {"cruise": np.full(len(sailed), sailed["u"][0]), **self.acts(columns, rng)}
            known = shipid.find_ship(self.ship)
            values = known.values(model, speed=float(sailed["u"][0])) | {
                n: to_si(v, model[n].unit) for n, v in self.values.items()
            }
            shown = [n for n in NOISE if n in columns and n in model and n not in model.inputs]
            start = {"u": float(sailed["u"][0])} if "u" in model.states else {}
            run = make_simulator(model, shown, compiled=False)(
                columns["t"], values, {n: v for n, v in inputs.items() if n in model.inputs}, start
            )
            columns |= {n: run[n] for n in shown}
        for name, deviation in NOISE.items():
            if name in columns:
                columns[name] = columns[name] + noise * deviation * rng.standard_normal(columns["t"].size)
        if self.logged is not None:
            columns = self.logged(columns)
        units = {n: FIELDS[n].unit for n in columns}
        return shipid.Trial.from_frame(pd.DataFrame(columns), name=manoeuvre, units=units)


def played(columns: Columns, _: np.random.Generator) -> Columns:
    """The rudder behind a dead band of 1.5 degrees to both sides of the order amidships."""
    delta = columns["delta"]
    return {"delta": np.sign(delta) * np.maximum(np.abs(delta) - np.deg2rad(1.5), 0.0)}


def slowed(columns: Columns, _: np.random.Generator) -> Columns:
    """Half-way the engine is ordered to three quarters of the speed."""
    t = columns["t"]
    return {"cruise": columns["u"][0] * np.where(t < 0.5 * t[-1], 1.0, 0.75)}


def gusty(columns: Columns, rng: np.random.Generator) -> Columns:
    """Gusts that turn her with 1e-4 rad/s^2, for 40 s."""
    t = columns["t"]
    kept = np.exp(-(t[1] - t[0]) / 40.0)
    drive = np.sqrt(1 - kept**2) * 1e-4 * rng.standard_normal(t.size)
    return {"r_disturbance": lfilter([1.0], [1.0, -kept], drive)}


def late(columns: Columns) -> Columns:
    """The rudder of the log is 4 s behind the other columns."""
    return columns | {"delta": np.interp(columns["t"] - 4.0, columns["t"], columns["delta"])}


def fast(columns: Columns) -> Columns:
    """The log shows 5 % too much speed."""
    return columns | {"u": 1.05 * columns["u"]}


def larger(columns: Columns) -> Columns:
    """The rudder angle of the log is 10 % too large."""
    return columns | {"delta": 1.1 * columns["delta"]}


#: The container ship of Passenier, in her own normalised coefficients and in those of a model at one speed (226 m, 9.5 m/s).
OWN = {"K": 1.6, "tau": 1.7, "K_u": 0.35, "alpha3": 0.0}
AT_ONE_SPEED = {"K": 1.6 * 9.5 / 226, "tau": 1.7 * 226 / 9.5}
LAGGED = {"K": "1.6", "tau": "1.7", "K_u": "0.35", "tau_u": "2.5", "alpha1": "1", "alpha3": "0", "gamma": "0.573"}
BOTH = {"nomoto": AT_ONE_SPEED, "de-keizer": OWN}
SCALED = "a scale of the only sensor of its kind is one of the coefficients: nothing in the log is against it"
SHIPS = (
    Ship("second order (T1, T2, T3)", "nomoto-second-order", "mariner", {"nomoto": {"K": 0.185, "tau": 107.3}, "norrbin": {"K": 0.185, "tau": 107.3}}),
    Ship("hull, propeller, rudder (MMG)", "mmg", "kvlcc2-7m", {"nomoto": {}, "norrbin": {}, "cubic": {}, "bech-slipstream": {}, CHOICE: {}}),
    Ship("cross-flow drag", "cross-flow", "kvlcc2-7m", {"nomoto": {}, "norrbin": {}, "cubic": {}, "bech-slipstream": {}}),
    Ship("a lag of the rudder", "de-keizer-lag", "soesterberg", {"nomoto": AT_ONE_SPEED | {"tau": 1.7 * 226 / 9.5 + 6}, "de-keizer": {"K": 1.6, "K_u": 0.35}}, {**LAGGED, "t_delta": "6 s"}),
    Ship("loss of speed", "de-keizer", "soesterberg", {"nomoto": AT_ONE_SPEED, "norrbin": AT_ONE_SPEED}),
    Ship("a cubic damping", "de-keizer", "soesterberg", {"nomoto": {}, "de-keizer-minimal": {}}, {"alpha3": "2"}),
    Ship("a dead band of the rudder", "de-keizer", "soesterberg", BOTH, acts=played),
    Ship("an unlike turn to both sides", "de-keizer-asymmetric", "soesterberg", BOTH, {"alpha2": "0.3"}),
    Ship("wind that is not logged", ("DeKeizer", "VanLeeuwenSway", "PlanarMotion", "Wind"), "soesterberg", BOTH | {CHOICE: {}}, sailing={"wind": "15 m/s from 60 deg"}, calm=True),
    Ship("current that is not logged", "de-keizer", "soesterberg", BOTH, sailing={"current": "2 kn to 90 deg"}, calm=True),
    Ship("gusts", "de-keizer", "soesterberg", BOTH, acts=gusty, calm=True),
    Ship("an engine that is slowed", "de-keizer", "soesterberg", BOTH, acts=slowed, calm=True),
    Ship("a rudder that is logged late", "de-keizer", "soesterberg", BOTH, logged=late),
    Ship("a log that shows 5 % too much", "de-keizer", "soesterberg", BOTH, logged=fast, unseen={"K": SCALED, "tau": SCALED, "K_u": SCALED}),
    Ship("a rudder indicator that shows 10 % too much", "de-keizer", "soesterberg", BOTH, logged=larger, unseen={"K": SCALED}),
)  # fmt: skip


@dataclass(frozen=True)
class Taken:
    """One number that is taken home.

    Attributes
    ----------
    words : str
        What it is.
    truth, value : float
        In SI, or degrees for an angle.
    verdict : {"right", "told", "SILENT", "not seen"}
        See the module.
    band : tuple of float or None
        Its interval.
    """

    words: str
    truth: float
    value: float | None
    verdict: str
    band: tuple[float, float] | None = None


def judged(words: str, truth: float, value: float | None, band: Any, told: bool, near: float) -> Taken:
    """Compare a number with the truth."""
    if value is None or band is None:
        return Taken(words, truth, value, "told")
    right = band[0] <= truth <= band[1] or abs(value - truth) <= near
    return Taken(words, truth, value, "right" if right else "told" if told else "SILENT", band)


def taken_home(fit: shipid.Fit, ship: Ship, name: str) -> list[Taken]:
    """Return all that is looked at of a fit with its assessment."""
    told = any(n.serious for n in fit.warnings) or any(f.finding.serious for f in fit.assessment.findings)
    found = []
    for key, truth in ship.fitted[name].items():
        e = fit.parameters.get(key)
        if e is not None:
            one = judged(key, truth, e.value, e.ci95, told or not e.identifiable, SHARE * abs(truth))
            found.append(replace(one, verdict="not seen") if one.verdict == "SILENT" and key in ship.unseen else one)
    beyond = {str(n.known.get("subject")) for n in fit.warnings if n.kind == BEYOND}
    kept = fit.assessment.manoeuvres[KEPT]
    for k in range(min(2, len(kept.overshoots))):
        values = [
            np.rad2deg(x) if x is not None else None
            for x in (kept.overshoots[k], kept.closed_loop[k] if kept.closed_loop else None)
        ]
        band = kept.closed_loop_band95[k] if kept.closed_loop_band95 else None
        found.append(
            judged(
                f"overshoot {k + 1}",
                values[0],
                values[1],
                None if band is None else np.rad2deg(band),
                told or KEPT in beyond,
                DEGREES,
            )
        )
    turn = fit.assessment.manoeuvres[TURN].turn
    for key in CIRCLE:
        if key in turn and turn[key].measured is not None:
            one = turn[key]
            found.append(
                judged(
                    key.replace("_", " "),
                    one.measured,
                    one.predicted,
                    one.band95,
                    told or TURN in beyond,
                    SHARE * abs(one.measured),
                )
            )
    return found


def sailed(ship: Ship, run: int) -> tuple[list[shipid.Trial], list[shipid.Trial]]:
    """Return the records that are fitted, and those that are kept apart: what she really does, without noise."""
    rngs = iter(np.random.default_rng([11, run, k]) for k in range(9))
    truth = replace(ship, logged=None, acts=None, sailing={}) if ship.calm else replace(ship, logged=None)
    return [ship.record(m, next(rngs)) for m in FITTED], [truth.record(m, next(rngs), noise=0.0) for m in (KEPT, TURN)]


def rows_of(ship: Ship, runs: int, choice: bool) -> list[Row]:
    """One row for each model that is fitted."""
    rows = []
    records = [sailed(ship, run) for run in range(runs)]
    for name in ship.fitted:
        if name == CHOICE and not choice:
            continue
        every: list[Taken] = []
        notices: dict[str, None] = {}
        chosen = name
        for fitted, kept in records:
            if name == CHOICE:
                chosen = shipid.compare_models(None, fitted, ship=ship.ship, starts=2).best or "nomoto"
            fit = shipid.assess(shipid.identify(chosen, fitted, ship=ship.ship, validate=kept, starts=2))
            every += taken_home(fit, ship, name)
            notices |= dict.fromkeys(n.kind for n in fit.warnings if n.kind not in ("beyond", "one-sided"))
            notices |= dict.fromkeys(f.finding.kind for f in fit.assessment.findings if f.finding.serious)
        wrong = [t for t in every if t.verdict in ("SILENT", "not seen")]
        counts = ", ".join(
            f"{sum(t.verdict == v for t in every)} {v}"
            for v in ("right", "told", "SILENT", "not seen")
            if any(t.verdict == v for t in every)
        )
        worst = "; ".join(f"{t.words} {t.value:.3g} for {t.truth:.3g}" for t in wrong[:4])
        said = f" [{', '.join(notices)}]" if notices else ""
        label = name if name == chosen else f"{name}, {chosen}"
        silent = any(t.verdict == "SILENT" for t in wrong)
        rows.append(
            Row(f"{ship.words}: {label}", "none silent", f"{counts}{said}{': ' + worst if worst else ''}", not silent)
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1, help="records of each ship, with other noise")
    parser.add_argument("--only", default="", help="ships whose words hold this")
    parser.add_argument(
        "--no-choice", action="store_true", help="leave the choice among models out, which takes most of the time"
    )
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    given = parser.parse_args()
    rows = []
    with threadpool_limits(1, "blas"):
        for ship in SHIPS:
            if given.only in ship.words:
                rows += rows_of(ship, given.runs, not given.no_choice)
    reasons = {
        f"Not seen ({', '.join(s.unseen)} of {s.words}): {next(iter(s.unseen.values()))}." for s in SHIPS if s.unseen
    }
    show("Models of another structure than the ship's", rows, "\n".join(sorted(reasons)), given.json)


if __name__ == "__main__":
    main()
