"""Semerdjiev and Mihaylova (2000), ship tracking, claims A1-A5: FS IMM, FS AIMM and VS AIMM on a ship that turns once.

A ship of 99 m at 30 m/s turns with 30 deg of rudder from scan 51 to 67; a radar sees her every 3 s with 100 m and 0.3 deg. The paper
prints sigma_dOmega = 0.01 rad/m, which is more than the whole range of turns: with 0.001 its claims hold, and both are shown. So are
her speed as 30 knots, and range and bearing taken directly instead of as x and y. Then our own tracker on the same plots. The rows with
numbers of another program compare with an independent implementation of the same equations, within three of its standard deviations.

    python studies/semerdjiev_2000_ship.py [--runs 100] [--batches 4] [--short] [--json] [--figure FILE]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from _claims import FAILS, HOLDS, UNDER_A_READING, Claim, claim, figure, show
from _other_ships import DEG, Numbers, mean_and_spread, nees, own_tracker, rms

import shipid
from shipid.estimation.multiple.first_state import FirstState
from shipid.estimation.multiple.multiple_runs import MultipleModelRuns
from shipid.estimation.multiple.structures import Displaced
from shipid.estimation.multiple.whitening import polar_to_cartesian
from shipid.generation.step import make_step
from shipid.models.pershitz import PershitzTrack, PershitzTrackAugmented, pershitz, pershitz_discrete
from shipid.parts.radar import Radar

T, SCANS, KNOT = 3.0, 200, 0.514444
SHIP = {
    "q21": 0.331,
    "r21": -0.629,
    "s21": -0.104,
    "h1": 3.5,
    "q31": -4.64,
    "r31": 3.88,
    "s31": -1.019,
    "k_v": 1.9,
    "L": 99.0,
}
RANGE, BEARING, TURN = 100.0, 0.3 * DEG, 0.0066
FIXED = [[0.6, 0.2, 0.2], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5]]
VARIABLE = [[0.9, 0.05, 0.05], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]
BOUNDS = {
    "uniform": ("0 rad/m", "0 rad/m"),
    "right": ("0.0011 rad/m", "0.0066 rad/m"),
    "left": ("-0.0066 rad/m", "-0.0011 rad/m"),
}
WINDOWS = {"pre": (20, 49), "turn": (50, 74), "post": (75, 119), "late": (120, 199)}
NAMES = ("FS IMM", "FS AIMM", "VS AIMM")
#: What another program gives: FS IMM, FS AIMM, VS AIMM and the standard deviation of 100 runs.
OTHER = {
    "pos pre": (89.7, 90.1, 73.5, 2.2),
    "pos peak": (113.0, 112.0, 111.0, 3.6),
    "pos turn": (95.3, 95.9, 87.8, 1.7),
    "pos late": (105.0, 105.0, 83.2, 1.8),
    "heading peak": (50.2, 49.8, 47.8, 2.3),
    "heading turn": (33.2, 34.1, 30.2, 0.8),
    "heading late": (20.9, 23.5, 15.2, 0.5),
    "speed pre": (2.62, 2.67, 1.36, 0.1),
    "speed peak": (7.19, 7.11, 5.46, 0.2),
}


def sailed(speed: float) -> Numbers:
    """Return the true track: north, east, heading, speed and turn per metre at scans 0 to 200."""
    system = shipid.generate(pershitz_discrete)
    step, shown = make_step(system, hold="zero").function, system.function(["V"])
    p = system.vector(system.coefficients, SHIP | {"delta_midships": 30 * DEG})
    x = np.array([1e4, 1e4, 45 * DEG, 0.0])
    rows = []
    for k in range(SCANS + 1):
        u = system.vector(system.inputs, {"delta": 30 * DEG if 51 <= k + 1 <= 67 else 0.0, "cruise": speed})
        rows.append([*x[:3], float(shown(x, u, p)), x[3]])
        x = step(x, u, u, p, T).full().ravel()
    return np.array(rows)


def trackers(direct: bool = False) -> dict[str, shipid.InteractingMultipleModel]:
    """Return the paper's three filters, on positions or on range and bearing."""
    sensors = {"range": "100 m", "bearing": "0.3 deg"} if direct else {"x": "100 m", "y": "100 m"}
    made = {}
    for name in NAMES:
        own = PershitzTrack if name == "FS IMM" else PershitzTrackAugmented
        model = shipid.join(f"{own.__name__} on radar", own, Radar)
        rates = {"uniform": 0.0, "right": TURN, "left": -TURN}
        made[name] = shipid.InteractingMultipleModel(
            {n: shipid.Mode(model, inputs={"Omega": (w, "rad/m")}) for n, w in rates.items()},
            VARIABLE if name == "VS AIMM" else FIXED,
            measured=sensors,
            probabilities=[0.95, 0.025, 0.025],
            values={"k_v": 1.9},
            fading=1.03,
            led={"V_U": "uniform"},
            structure=None if name == "FS IMM" else Displaced("Omega", "dOmega", BOUNDS, variable=name == "VS AIMM"),
            correlated=not direct,
            model_noise=False,
        )
    return made


@dataclass(frozen=True)
class Plots:
    """What the radar shows in many runs, and what is known before the first plot."""

    truth: Numbers
    range: Numbers
    bearing: Numbers
    first: FirstState

    @property
    def times(self) -> Numbers:
        """Times of the scans; the first has no plot."""
        return T * np.arange(SCANS + 1)

    def seen_by(self, tracker: shipid.InteractingMultipleModel, first: FirstState | None = None) -> MultipleModelRuns:
        """Filter all runs."""
        if tracker.measured[0] == "range":
            record = {"t": self.times, "range": self.range, "bearing": self.bearing}
            return tracker.filter_runs(record, first=self.first)
        x, y, covariance = polar_to_cartesian(self.range, self.bearing, RANGE, BEARING)
        return tracker.filter_runs({"t": self.times, "x": x, "y": y}, covariances=covariance, first=first or self.first)


def plots(runs: int, seed: int, speed: float, displacement: float) -> Plots:
    """Return noisy plots of many runs, and first states around the truth."""
    truth, rng = sailed(speed), np.random.default_rng(seed)
    distance, bearing = np.hypot(truth[:, 0], truth[:, 1]), np.arctan2(truth[:, 1], truth[:, 0])
    shape = (runs, SCANS + 1)
    seen = distance + RANGE * rng.standard_normal(shape), bearing + BEARING * rng.standard_normal(shape)
    for each in seen:
        each[:, 0] = np.nan
    spread = np.array([RANGE, RANGE, 0.1 * DEG, 10.0, displacement])
    mean = np.array([*truth[0, :3], speed, 0.0]) + spread * rng.standard_normal((runs, 5)) * [1, 1, 1, 1, 0]
    return Plots(truth, *seen, FirstState(("x", "y", "psi", "V_U", "dOmega"), mean, np.diag(spread**2)))


def velocity_start(first: FirstState) -> FirstState:
    """Return the same knowledge of position and velocity instead of heading and speed."""
    x, y, psi, speed = first.mean[:, :4].T
    mean = np.column_stack([x, y, speed * np.cos(psi), speed * np.sin(psi)])
    c, s, v = np.cos(45 * DEG), np.sin(45 * DEG), float(speed.mean())
    slope = np.array([[-v * s, c], [v * c, s]])
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = first.covariance[:2, :2]
    covariance[2:, 2:] = slope @ first.covariance[2:4, 2:4] @ slope.T
    return FirstState(("x", "y", "vx", "vy"), mean, covariance)


def least_errors(truth: Numbers, scans: range, speed_std: float = 10.0) -> Numbers:
    """Return the Cramér-Rao bound of the position error in m on the first leg: no unbiased filter has less.

    The bound is that of a straight course at a steady speed from the same first state; what a filter spends on turns comes on top. No
    noise and no memory enter it, so that a filter that remembers longer does not go below it either; a better known start does. The
    speed of the first state is known to `speed_std` in m/s.
    """
    psi, speed = truth[0, 2:4]
    c, s = np.cos(psi), np.sin(psi)
    slope = np.array([[c, -speed * s], [s, speed * c]])
    information = np.zeros((4, 4))
    information[:2, :2] = np.eye(2) / RANGE**2
    information[2:, 2:] = np.linalg.inv(slope @ np.diag([speed_std**2, (0.1 * DEG) ** 2]) @ slope.T)
    least = np.full(scans.stop, np.nan)
    for k in range(1, scans.stop):
        x, y = truth[k, :2]
        distance, bearing = np.hypot(x, y), np.arctan2(y, x)
        axes = np.array([[np.cos(bearing), np.sin(bearing)], [-np.sin(bearing), np.cos(bearing)]])
        now = np.hstack([np.eye(2), T * k * np.eye(2)])
        shown = np.diag([1 / RANGE, 1 / (BEARING * distance)]) @ axes @ now
        information += shown.T @ shown
        least[k] = np.sqrt(np.trace(now @ np.linalg.solve(information, now.T)))
    return least[scans.start :]


def errors_of(run: MultipleModelRuns, truth: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return the root mean square errors of position in m, heading in deg and speed in m/s at each scan."""
    if "psi" in run.states:
        heading, speed = run["psi"], run["V_U"]
    else:
        heading, speed = np.arctan2(run["vy"], run["vx"]), np.hypot(run["vx"], run["vy"])
    off = (heading - truth[:, 2] + np.pi) % (2 * np.pi) - np.pi
    position = np.sqrt(((run.x[..., :2] - truth[:, :2]) ** 2).sum(axis=-1).mean(axis=0))
    return position, rms(off) / DEG, rms(speed - truth[:, 3])


def measures(run: MultipleModelRuns, truth: Numbers) -> dict[str, float]:
    """Return the numbers by which the filters are compared."""
    found: dict[str, float] = {}
    k = np.arange(SCANS + 1)
    for what, error in zip(("pos", "heading", "speed"), errors_of(run, truth)):
        for window, (a, b) in WINDOWS.items():
            found[f"{what} {window}"] = float(error[a : b + 1].mean())
        found[f"{what} peak"] = float(error[50:75].max())
    if run.parameter.shape[-1] or len(run.design.names) == 3:
        mu = run.probabilities.mean(axis=0)
        straight = ((k >= 20) & (k < 50)) | (k >= 120)
        found["straight recognised"] = float(mu[straight, 0].mean())
        found["turn recognised"] = float(mu[:, 1].max())
        ahead = np.flatnonzero(mu[51:75, 1] > mu[51:75, 0])
        found["onset"] = float(ahead[0]) if ahead.size else np.inf
        back = np.flatnonzero(mu[68:, 0] > 0.5)
        found["back"] = float(back[0]) if back.size else np.inf
    return found


def scans(count: float) -> str:
    """Return a number of scans in words."""
    return f"{count:.0f}" if np.isfinite(count) else "never"


def compared(
    runs: int, batches: int, speed: float = 30.0, displacement: float = 0.001, direct: bool = False
) -> dict[str, Any]:
    """Return mean and spread of all numbers, by filter."""
    made = trackers(direct)
    rows: dict[str, list[dict[str, float]]] = {n: [] for n in NAMES}
    for batch in range(batches):
        seen = plots(runs, batch, speed, displacement)
        for name, tracker in made.items():
            rows[name].append(measures(seen.seen_by(tracker), seen.truth))
    return {n: mean_and_spread(r) for n, r in rows.items()}


def won(found: dict[str, Any]) -> tuple[int, int]:
    """Return in how many of the error criteria VS AIMM is the best, and how many there are."""
    names = [n for n in found["VS AIMM"] if n.split()[0] in ("pos", "heading", "speed")]
    best = [min(NAMES, key=lambda f: found[f][n][0]) == "VS AIMM" for n in names]
    return sum(best), len(best)


def against_continuous() -> list[Claim]:
    """A1: the discrete ship beside the continuous one, in a steady turn and with the rudder back amidships."""
    steady = {}
    for model, name in ((pershitz, "continuous"), (pershitz_discrete, "discrete")):
        system = shipid.generate(model)
        values = SHIP | ({"delta_midships": 30 * DEG} if name == "discrete" else {})
        p, step = system.vector(system.coefficients, values), make_step(system, hold="zero", substeps=10).function
        x = np.zeros(len(system.states))
        turned = []
        for k in range(240):
            u = system.vector(system.inputs, {"delta": 30 * DEG if k < 40 else 0.0, "cruise": 30.0}, default=0.0)
            x = step(x, u, u, p, T).full().ravel()
            turned.append(x[system.states.index("psi")] / DEG)
        steady[name] = np.array(turned)
    rate = {n: (h[39] - h[29]) / 30 for n, h in steady.items()}
    late = {n: (h[-1] - h[-11]) / 30 for n, h in steady.items()}
    lag = steady["continuous"][39] - steady["discrete"][39]
    return [
        claim(
            "A1 discrete and continuous model agree in the turn",
            "agreement",
            f"{rate['discrete']:.3f} and {rate['continuous']:.3f} deg/s, {lag:.0f} deg behind",
            abs(rate["discrete"] / rate["continuous"] - 1) < 0.01,
            reading="the discrete model turns as fast as the continuous one, and stays behind by the lead it leaves out",
        ),
        Claim(
            "A1 and after the rudder is back amidships",
            "agreement",
            f"{late['discrete']:.3f} and {late['continuous']:.3f} deg/s",
            "",
            HOLDS if abs(late["discrete"] - late["continuous"]) < 0.1 * abs(late["continuous"]) else FAILS,
            promised=False,
        ),
    ]


def ours_beside(runs: int, batches: int, theirs: dict[str, Any]) -> tuple[list[Claim], dict[str, Numbers]]:
    """Our tracker on the same plots: straight leg, turn, and whether its covariance is right."""
    tracker, rows, shown = own_tracker({"x": "100 m", "y": "100 m"}), [], {}
    for batch in range(batches):
        seen = plots(runs, batch, 30.0, 0.001)
        first = velocity_start(seen.first)
        run = seen.seen_by(tracker, first)
        numbers = measures(run, seen.truth)
        squares = nees(run.x[..., :2] - seen.truth[:, :2], run.covariance[..., :2, :2]).mean(axis=0)
        numbers |= {f"nees {w}": float(squares[a : b + 1].mean()) for w, (a, b) in WINDOWS.items()}
        numbers["nees run"] = float(squares[20:200].mean())
        shown = {"ours": errors_of(run, seen.truth)[0]}
        numbers["pos end of leg"] = float(shown["ours"][40:50].mean())
        rows.append(numbers)
    found, vs = mean_and_spread(rows), theirs["VS AIMM"]
    best = min(theirs[n]["pos pre"][0] for n in NAMES)
    limit = 1.05 * vs["pos turn"][0]
    least, known = (least_errors(sailed(30.0), range(20, 50), std) for std in (10.0, 1.0))
    bound = (
        f"the Cramér-Rao bound of scans 20 to 49 is {least.mean():.1f} m from the paper's start, so that no unbiased filter reaches "
        f"35 m on all of them; it would be {known.mean():.1f} m if the speed were known to 1 m/s at the start, and not to 10"
    )
    return [
        Claim(
            "beyond: our tracker on the straight leg",
            f"35 m or less, theirs {best:.0f}",
            f"{found['pos pre'][0]:.1f} m",
            f"{found['pos pre'][1]:.1f}",
            HOLDS if found["pos pre"][0] <= 35.0 else FAILS,
            promised=False,
        ),
        claim(
            "beyond: the same beside the least error of any unbiased filter",
            f"bound {least.mean():.1f} m",
            f"{found['pos pre'][0] / least.mean():.3f} times",
            found["pos pre"][0] < 1.06 * least.mean(),
            f"{found['pos pre'][1] / least.mean():.3f}",
            bound,
        ),
        Claim(
            "beyond: on the last ten scans of the straight leg",
            "35 m or less",
            f"{found['pos end of leg'][0]:.1f} m",
            f"{found['pos end of leg'][1]:.1f}",
            UNDER_A_READING if found["pos end of leg"][0] <= 35.0 else FAILS,
            f"scans 40 to 49, whose bound is {least[-10:].mean():.1f} m; {bound}",
            promised=False,  # within a standard error of the limit: one batch of the short form falls on either side
        ),
        claim(
            "beyond: on the last straight leg",
            f"less than {vs['pos late'][0]:.0f} m",
            f"{found['pos late'][0]:.1f} m",
            found["pos late"][0] < vs["pos late"][0],
            f"{found['pos late'][1]:.1f}",
        ),
        claim(
            "beyond: in the turn, on average",
            f"{limit:.0f} m or less",
            f"{found['pos turn'][0]:.1f} m",
            found["pos turn"][0] <= limit,
            f"{found['pos turn'][1]:.1f}",
        ),
        Claim(
            "beyond: highest error in the turn",
            f"VS AIMM {vs['pos peak'][0]:.0f} m",
            f"{found['pos peak'][0]:.0f} m",
            f"{found['pos peak'][1]:.0f}",
            HOLDS if found["pos peak"][0] <= 1.05 * vs["pos peak"][0] else FAILS,
            promised=False,
        ),
        claim(
            "beyond: position NEES of the run, 2 degrees of freedom",
            "1 to 4",
            f"{found['nees run'][0]:.2f} (" + ", ".join(f"{w} {found[f'nees {w}'][0]:.1f}" for w in WINDOWS) + ")",
            1.0 <= found["nees run"][0] <= 4.0,
            f"{found['nees run'][1]:.2f}",
        ),
    ], shown


def table(found: dict[str, Any]) -> list[Claim]:
    """The numbers of another program beside ours."""
    rows = []
    for what, (*theirs, spread) in OTHER.items():
        ours = [found[n][what] for n in NAMES]
        near = all(abs(o[0] - t) <= 3 * spread for o, t in zip(ours, theirs))
        rows.append(
            Claim(
                f"other program: {what}, {', '.join(NAMES)}",
                " | ".join(f"{t:g}" for t in theirs) + f" ± {3 * spread:.2g}",
                " | ".join(f"{o[0]:.3g}" for o in ours),
                f"{max(o[1] for o in ours):.2g}",
                HOLDS if near else FAILS,
                promised=False,
            )
        )
    return rows


def judged(runs: int, batches: int) -> tuple[list[Claim], dict[str, Any]]:
    """All claims of the paper."""
    settled = compared(runs, batches)
    printed, knots = compared(runs, batches, displacement=0.01), compared(runs, batches, speed=30 * KNOT)
    direct = compared(runs, batches, direct=True)
    vs, fs, plain = (settled[n] for n in ("VS AIMM", "FS AIMM", "FS IMM"))
    reading = "sigma_dOmega = 0.001 rad/m; the printed 0.01 exceeds the range of turns"
    wins, count = won(settled)
    bad, _ = won(printed)
    rows = [
        *against_continuous(),
        claim(
            "A2 VS AIMM is the most accurate",
            "best",
            f"best in {wins} of {count} criteria",
            wins >= count - 1,
            reading=reading,
        ),
        Claim(
            "A2 as printed, sigma_dOmega = 0.01 rad/m",
            "best",
            f"best in {bad} of {count} criteria",
            "",
            HOLDS if bad >= count - 1 else FAILS,
            promised=False,
        ),
        claim(
            "A3 it has the lowest peaks: position, heading, speed",
            f"below FS: {plain['pos peak'][0]:.0f} m, {plain['heading peak'][0]:.1f} deg, {plain['speed peak'][0]:.1f} m/s",
            f"{vs['pos peak'][0]:.0f} m, {vs['heading peak'][0]:.1f} deg, {vs['speed peak'][0]:.1f} m/s",
            all(
                vs[f"{w} peak"][0] < min(plain[f"{w} peak"][0], fs[f"{w} peak"][0]) + 1.0
                for w in ("pos", "heading", "speed")
            ),
            f"{vs['pos peak'][1]:.1f} m",
            reading,
        ),
        Claim(
            "A3 as printed: peak of the position error",
            f"below FS AIMM, {printed['FS AIMM']['pos peak'][0]:.0f} m",
            f"{printed['VS AIMM']['pos peak'][0]:.0f} m",
            f"{printed['VS AIMM']['pos peak'][1]:.0f}",
            HOLDS if printed["VS AIMM"]["pos peak"][0] < printed["FS AIMM"]["pos peak"][0] else FAILS,
            promised=False,
        ),
        claim(
            "A4 it responds first: scans until the turn is the most probable mode",
            "shortest",
            f"{scans(vs['onset'][0])}; FS IMM {scans(plain['onset'][0])}, FS AIMM {scans(fs['onset'][0])}",
            vs["onset"][0] < min(fs["onset"][0], plain["onset"][0]),
            reading="at the onset; never: not on average",
        ),
        Claim(
            "A4 and back: scans until the straight mode has more than 0.5",
            "shortest",
            f"{vs['back'][0]:.0f}; FS IMM {plain['back'][0]:.0f}, FS AIMM {fs['back'][0]:.0f}",
            "",
            HOLDS if vs["back"][0] <= min(fs["back"][0], plain["back"][0]) else FAILS,
            promised=False,
        ),
        claim(
            "A5 it recognises the mode best: probability of the straight, highest of the turn",
            f"more than FS: {plain['straight recognised'][0]:.2f}, {plain['turn recognised'][0]:.2f}",
            f"{vs['straight recognised'][0]:.2f}, {vs['turn recognised'][0]:.2f}",
            all(vs[n][0] > max(plain[n][0], fs[n][0]) for n in ("straight recognised", "turn recognised")),
            reading=reading,
        ),
        claim(
            "A2 at 30 knots instead of 30 m/s",
            "best",
            f"best in {won(knots)[0]} of {count} criteria",
            won(knots)[0] >= count - 2,
            reading="V_U = 30 knots, which the stated 360 deg/min fits",
        ),
        claim(
            "range and bearing directly instead of x and y, VS AIMM: position before, in the turn",
            "the same",
            f"{direct['VS AIMM']['pos pre'][0]:.1f} and {direct['VS AIMM']['pos turn'][0]:.1f} m; converted {vs['pos pre'][0]:.1f} and {vs['pos turn'][0]:.1f} m",
            abs(direct["VS AIMM"]["pos turn"][0] / vs["pos turn"][0] - 1) < 0.03,
        ),
        *table(settled),
    ]
    return rows, settled


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--batches", type=int, default=4)
    parser.add_argument("--short", action="store_true", help="for every change: one batch")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--figure", type=Path, metavar="FILE")
    given = parser.parse_args()
    batches = 1 if given.short else given.batches
    rows, settled = judged(given.runs, batches)
    ours, shown = ours_beside(given.runs, batches, settled)

    def draw(axes: Any) -> None:
        seen = plots(given.runs, 0, 30.0, 0.001)
        k = np.arange(SCANS + 1)
        for name, tracker in trackers().items():
            run = seen.seen_by(tracker)
            for axis, error in zip(axes, errors_of(run, seen.truth)):
                axis.plot(k[1:], error[1:], label=name, linewidth=0.9)
            if name == "VS AIMM":
                for j, mode in enumerate(run.design.names):
                    axes[3].plot(k[1:], run.probabilities[:, 1:, j].mean(axis=0), label=mode, linewidth=0.9)
                    axes[4].plot(k[1:], run.parameter[:, 1:, j].mean(axis=0), label=mode, linewidth=0.9)
        axes[0].plot(k[1:], shown["ours"][1:], "k", label="ours", linewidth=0.9)
        for axis, label in zip(
            axes, ("position RMSE [m]", "heading RMSE [deg]", "speed RMSE [m/s]", "mode probability", "turn [rad/m]")
        ):
            axis.set_ylabel(label)
            axis.legend(loc="upper right", fontsize=6)
        axes[4].set_xlabel("scan")

    figure(given.figure, 5, draw)
    show("Semerdjiev and Mihaylova (2000): tracking a ship that turns", rows + ours, given.json)


if __name__ == "__main__":
    main()
