"""Measuring: what `measure` reads from zig-zags and turns whose numbers are known, simulated and real.

Simulated: a Nomoto ship (K 0.08 1/s, tau 12 s) sails 20/20 zig-zags in steps of 0.01 s. Asked of logs at 10, 1 and 0.5 Hz, with
a quick and a slow rudder, the order logged or not, with and without noise: no mean error beyond 0.1 deg, at least 90 % of the
overshoots within the 95 % uncertainty stated, nothing stated inside a gap, and a turning circle in a current within 1 % of
the one in still water. Of advance, transfer and tactical diameter of two ships, 60 circles each under three noises of fixes and compass:
88 % or more within the 95 % uncertainty stated (95 % less two and a half standard errors of so few).

Real: the facts tabulated with the trials, within 0.3 deg and 1 %. They were read where the rudder has left its plate, so they are
compared in that reading (`execute="moved"`); what the order gives stands beside them.

    python studies/measuring.py [--short] [--data FOLDER] [--json]

The real trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``, and ``--short`` leaves them out.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd
from _table import Row, close, show

import shipid
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.listing import manoeuvres_in
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.results.zigzag import ZigZag

FORMATS = Path(__file__).parent / "formats"
STEP = 0.01


@lru_cache
def sailed(rudder_rate: float, start: float) -> tuple[np.ndarray, ...]:
    """Times, heading, rudder, order [s, deg], and the overshoots beyond the orders [deg]."""
    t = np.arange(0, 300 + STEP / 2, STEP)
    rows = np.zeros((t.size, 3))
    rate = heading = angle = ordered = 0.0
    orders: list[int] = []
    for k, now in enumerate(t):
        if (not orders and now >= start) or (orders and np.sign(ordered) * heading >= 20):
            ordered = -ordered if orders else 20.0
            orders.append(k)
        rows[k] = heading, angle, ordered
        angle += min(max(ordered - angle, -rudder_rate * STEP), rudder_rate * STEP)
        heading += STEP * rate
        rate += STEP * (0.08 * angle - rate) / 12
    edges = [*orders[1:], t.size - 1]
    beyond = [np.abs(rows[a:b, 0]).max() - abs(rows[a, 0]) for a, b in itertools.pairwise(edges)]
    # The last swing may not be over.
    return t, *rows.T, np.array(beyond[:-1])


def logged(rudder_rate: float, start: float, interval: float, noise: float, order: str, seed: int) -> shipid.Trial:
    """The zig-zag as a logger writes it."""
    t, psi, delta, ordered, _ = (column[:: round(interval / STEP)] for column in sailed(rudder_rate, start))
    table = {"t [s]": t, "psi [deg]": psi + np.random.default_rng(seed).normal(0, noise, t.size) if noise else psi}
    if order != "only":
        table["delta [deg]"] = delta
    if order != "not logged":
        table["delta_order [deg]"] = ordered
    return shipid.Trial.from_frame(pd.DataFrame(table))


def simulated(phases: int) -> Iterator[Row]:
    """Mean error and coverage of the overshoots, over the phases of the sampling."""
    for rudder_rate in (3.0, 1.0):
        for interval in (0.1, 1.0, 2.0):
            for order in ("not logged", "logged", "only"):
                for noise in (0.0, 0.2):
                    errors, within = [], []
                    for k in range(phases):
                        start = 10 + round(interval / phases * k, 2)
                        truth = sailed(rudder_rate, start)[-1]
                        found = measure(logged(rudder_rate, start, interval, noise, order, k))
                        assert isinstance(found, ZigZag)
                        n = min(len(truth), len(found.leading_overshoots))
                        error = np.degrees(found.leading_overshoots[:n]) - truth[:n]
                        errors += list(error)
                        stated = [np.degrees(u or 0.0) for u in (found.overshoot_uncertainties or ())[:n]]
                        within += list(np.abs(error) <= np.array(stated) + 0.05)
                    what = f"{rudder_rate:g} deg/s, every {interval:g} s, order {order}, noise {noise:g} deg"
                    mean, spread = float(np.mean(errors)), float(np.std(errors) / np.sqrt(len(errors)))
                    good = abs(mean) <= 0.1 + 2 * spread and float(np.mean(within)) >= 0.9
                    yield Row(
                        what, "mean error 0 ± 0.1 deg, 90 % within",
                        f"mean {mean:+.3f}, largest {np.abs(errors).max():.2f} deg, {np.mean(within):.0%} within", good,
                    )  # fmt: skip


def holes() -> Iterator[Row]:
    """A gap over the first peak, and one over the second execute."""
    trial = logged(3.0, 10.0, 1.0, 0.0, "not logged", 0)
    for name, column, start, end in (("heading", "psi [deg]", 40, 70), ("rudder", "delta [deg]", 30, 48)):
        frame = trial.to_frame()
        frame.loc[(trial["t"] > start) & (trial["t"] < end), column] = np.nan
        found = measure(shipid.Trial.from_frame(frame))
        assert isinstance(found, ZigZag) and found.overshoots is not None
        told = found.reasons.get("overshoots[1]", "")
        yield Row(
            f"gap of the {name} from {start} to {end} s", "first overshoot not known, second known",
            f"{told or found.overshoots[0]}; {'known' if found.overshoots[1] is not None else 'not known'}",
            found.overshoots[0] is None and f"gap {start} to {end} s" in told and found.overshoots[1] is not None,
        )  # fmt: skip


def currents() -> Iterator[Row]:
    """A turning circle of the container ship with and without a current.

    Her speed settles over the first turns: what she still loses from one turn to the next looks like a drift.
    """
    model = shipid.find_model("de-keizer")
    for turned, within in ((760, 0.05), (1480, 0.01)):
        asked, found = (
            measure(shipid.simulate(model, "soesterberg", f"turn:35/{turned}", current=current))
            for current in (None, ("1 m/s", "90 deg"))
        )
        assert isinstance(asked, TurningCircle) and isinstance(found, TurningCircle)
        yield close(f"turning circle of {turned} deg in 1 m/s: drift", 1.0, found.drift_speed or 0.0, within, "m/s")
        for name in ("advance", "transfer", "tactical_diameter"):
            truth, value = getattr(asked, name), getattr(found, f"{name}_still_water") or float("nan")
            ground = getattr(found, name)
            share = max(0.01, 0.4 * within)
            yield Row(
                f"  {name.replace('_', ' ')}, still water", f"{truth:.1f} m ± {100 * share:g} %",
                f"{value:.1f} m (over the ground {ground:.1f})", abs(value - truth) <= share * truth,
            )  # fmt: skip


def distances(runs: int) -> Iterator[Row]:
    """How often the distances of a circle without noise lie within the uncertainty that is stated under noise."""
    for model, ship, sampling in (("norrbin", "zeefakkel", "0.2 s"), ("de-keizer", "soesterberg", "1 s")):
        truth = measure(shipid.simulate(model, ship, "turn:35", sampling=sampling))
        for compass, fixes in (("0.2 deg", "10 m"), ("0.2 deg", "1 m"), ("1 deg", "2 m")):
            noise = f"psi={compass},x={fixes},y={fixes}"
            found = [
                measure(shipid.simulate(model, ship, "turn:35", sampling=sampling, noise=noise, seed=k))
                for k in range(runs)
            ]
            held, wide = [], []
            for name in ("advance", "transfer", "tactical_diameter"):
                off = np.array([getattr(one, name) - getattr(truth, name) for one in found])
                stated = np.array([getattr(one, f"{name}_uncertainty") for one in found])
                held.append(float(np.mean(np.abs(off) <= stated)))
                wide.append(float(np.median(stated) / np.std(off)))
            yield Row(
                f"{ship}, circle, fixes {fixes}, compass {compass}",
                "88 % or more of each distance within",
                f"{', '.join(f'{h:.0%}' for h in held)}; half widths {', '.join(f'{w:.1f}' for w in wide)} times the scatter",
                min(held) >= 0.88,
            )


def abilities(runs: int) -> Iterator[Row]:
    """How often the initial turning ability of a 10/10 without noise lies within the uncertainty that is stated under noise."""
    for model, ship, sampling in (("norrbin", "zeefakkel", "0.2 s"), ("de-keizer", "soesterberg", "1 s")):
        fine = shipid.simulate(model, ship, "zigzag:10/10", sampling="0.02 s").table
        begin = int(np.argmax(fine["delta_order"].to_numpy() > 0))
        heading = fine["psi"].to_numpy() - fine["psi"].to_numpy()[0]
        there = int(np.argmax(heading >= np.radians(10)))
        speed = np.hypot(fine["u"], fine.get("v", 0.0)).to_numpy()[begin : there + 1]
        truth = float(np.trapezoid(speed, fine["t"].to_numpy()[begin : there + 1]))
        for compass, log in (("0.2 deg", "0.1 m/s"), ("1 deg", "0.1 m/s"), ("0.1 deg", "0.5 m/s")):
            trials = (
                shipid.simulate(model, ship, "zigzag:10/10", sampling=sampling, noise=f"psi={compass},u={log}", seed=k)
                for k in range(runs)
            )
            found = [measure(trial) for trial in trials]
            off = np.array([one.initial_turning_ability - truth for one in found])
            stated = np.array([one.initial_turning_ability_uncertainty for one in found])
            held = float(np.mean(np.abs(off) <= stated))
            yield Row(
                f"{ship}, initial turning ability, compass {compass}, log {log}",
                "88 % or more within",
                f"{held:.0%}; {truth:.0f} m off by {np.mean(off):+.1f} ± {np.std(off):.1f} m, half width {np.median(stated):.1f} m",
                held >= 0.88,
            )


@dataclass(frozen=True)
class Fact:
    """A zig-zag, and what is tabulated of it."""

    campaign: str
    file: str
    nominal: str
    overshoots: tuple[float, ...]
    period: float | None = None
    executes: tuple[float, ...] = ()


MARIN, HSVA, ESSO, GUNNERUS = (
    "MARIN_FREE_KVLCC2_{}_m.dat", "HSVA_CPMC_KVLCC2_Z_{}.dat", "zigzag_31-Jul-2020_{}.csv", "RVG_ManeuveringTests_part1.csv"
)  # fmt: skip
FACTS = (
    Fact("kvlcc2-marin", MARIN.format("zz_20"), "20/20", (14.2, 12.3, 12.9), 463, (86.5, 312.2, 549.0)),
    Fact("kvlcc2-marin", MARIN.format("zz_-20"), "20/20", (12.7, 14.0, 10.7)),
    Fact("kvlcc2-marin", MARIN.format("zz_10"), "10/10", (9.1, 14.5)),
    Fact("kvlcc2-hsva", HSVA.format("20_10_S"), "20/10", (10.3, 13.7, 10.8, 11.0), 55),
    Fact("kvlcc2-hsva", HSVA.format("10_10_P"), "10/10", (9.0, 16.7)),
    Fact("kvlcc2-hsva", HSVA.format("35_05"), "35/5", (12.0, 16.3), 39),
    Fact("esso-osaka", ESSO.format("13_14_21"), "30/30", (7.8, 8.5, 9.1, 8.3), 45),
    Fact("esso-osaka", ESSO.format("14_03_39"), "20/20", (6.3, 7.5, 10.2)),
    Fact("esso-osaka", ESSO.format("13_42_53"), "30/30", (3.3, 6.6, 4.1, 6.8), 70),
    Fact("gunnerus", f"{GUNNERUS}@1622:1712", "10/10", (5.3, 4.0, 4.6, 5.1)),
    Fact("gunnerus", f"{GUNNERUS}@1958:2195", "10/20", (), 58.5),
    Fact("gunnerus", f"{GUNNERUS}@2690:2900", "5/10", (), 62),
)


def numbers(values: object) -> str:
    """Overshoots in degrees, as printed."""
    return ", ".join("-" if v is None else f"{np.degrees(v):.1f}" for v in values)  # type: ignore[attr-defined]


def real(data: Path) -> Iterator[Row]:
    """The tabulated facts of the four campaigns."""
    for fact in FACTS:
        trial = shipid.read_trial(data / fact.campaign / fact.file, FORMATS / f"{fact.campaign}.toml")
        moved, ordered = (measure(trial, execute=reading) for reading in ("moved", "order"))
        assert isinstance(moved, ZigZag) and isinstance(ordered, ZigZag)
        n = len(fact.overshoots)
        name = f"{fact.campaign} {fact.file.partition('@')[2] or fact.file.removesuffix('.dat').removesuffix('.csv')}"
        if n:
            error = np.abs(np.degrees([v or np.nan for v in (moved.overshoots or ())[:n]]) - fact.overshoots)
            yield Row(
                name, ", ".join(map(str, fact.overshoots)) + " ± 0.3 deg",
                f"{numbers((moved.overshoots or ())[:n])} (by the order {numbers((ordered.overshoots or ())[:n])})",
                # The facts are printed with one decimal.
                moved.nominal == fact.nominal and bool(np.all(error <= 0.3 + 0.05)),
            )  # fmt: skip
        else:
            yield Row(f"{name}: nominal", fact.nominal, moved.nominal, moved.nominal == fact.nominal)
        if fact.period is not None:
            # 56 to 61 s, and printed in whole seconds.
            yield close(f"{name}: period", fact.period, moved.period or 0.0, max(0.02 * fact.period, 1.0), "s")
        if fact.executes:
            late = np.abs(np.array((moved.executes or ())[: len(fact.executes)], dtype=float) - fact.executes)
            yield Row(f"{name}: executes", "± 0.3 s", f"{late.max():.2f} s off", bool(late.max() <= 0.3))
    yield from turns(data / "esso-osaka")
    whole = shipid.read_trial(data / "gunnerus" / GUNNERUS, FORMATS / "gunnerus.toml")
    found = [m for m in manoeuvres_in(whole, check_trial(whole)) if m.kind == "zig-zag"]
    starts = [f"{m.start:.0f}" for m in found]
    listed = all(any(abs(m.start - s) < 6 for m in found) for s in (1625, 1961, 2696))
    yield Row("Gunnerus, 55 min: zig-zags listed", "1625, 1961, 2696 s among them", ", ".join(starts), listed)


def turns(folder: Path) -> Iterator[Row]:
    """Turns after hand steering, and a berthing."""
    turn = {
        run: measure(shipid.read_trial(folder / f"turn_14-Oct-2020_{run}.csv", FORMATS / "esso-osaka.toml"))
        for run in ("15_21_57", "14_17_39")
    }
    for run, side, when in (("15_21_57", "port", 109.9), ("14_17_39", "starboard", 199.9)):
        found = turn[run]
        assert isinstance(found, TurningCircle)
        yield close(f"esso-osaka turn {run}: execute", when, found.first_execute or 0.0, 0.1, "s")
        yield Row(f"esso-osaka turn {run}: side", side, found.side, found.side == side)
    first = turn["15_21_57"]
    assert isinstance(first, TurningCircle)
    yield close("esso-osaka turn 15_21_57: advance", 7.42, first.advance or 0.0, 0.0742, "m")
    yield close("esso-osaka turn 15_21_57: tactical diameter", 8.66, first.tactical_diameter or 0.0, 0.0866, "m")
    berthing = shipid.read_trial(folder / "berthing_12-Nov-2020_11_07_23.csv", FORMATS / "esso-osaka.toml")
    try:
        said = f"measured as a {measure(berthing).kind}"
    except NotAManoeuvreError as error:
        said = "no zig-zag, the propeller is reversed" if "The propeller is reversed" in str(error) else str(error)
    yield Row(
        "esso-osaka berthing 11_07_23", "no zig-zag, the propeller is reversed", said, said.startswith("no zig-zag")
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="fewer phases of the sampling, and no real trials")
    parser.add_argument("--data", type=Path, default=Path(__file__).parents[1].parent / "shared" / "data")
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    rows = [*simulated(3 if asked.short else 20), *holes(), *currents()]
    rows += [] if asked.short else [*distances(60), *abilities(60)]
    absent = "" if asked.short or asked.data.is_dir() else f"The real trials are not at {asked.data}."
    if not asked.short and asked.data.is_dir():
        rows += real(asked.data)
    show("Measured numbers beside the true and the tabulated ones", rows, absent, asked.json)
