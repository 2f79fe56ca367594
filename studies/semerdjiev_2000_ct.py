"""Semerdjiev, Mihaylova and Li (2000), coordinated turns, claims B1-B5: FS AIMM, VS AIMM and the adaptive grid (AGIMM).

An aircraft at 300 m/s makes four turns in 400 scans of 1 s; a sensor shows its position to 85 m on each axis. The paper prints
sigma_omega = 0.01 deg/s: with 0.01 rad/s its claims hold and the curves fill the axes of its figures, and both are shown. The smallest
distance on the grid is printed so that it can be read as 2/3, 1/2 or 1/3 of the largest rate: B5 depends on it. Then our own tracker,
with the settings it has on the ship. The rows with numbers of another program compare with an independent implementation of the same
equations, within three of its standard deviations.

    python studies/semerdjiev_2000_ct.py [--runs 100] [--batches 4] [--short] [--json] [--figure FILE]
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from _claims import FAILS, HOLDS, Claim, claim, figure, show
from _other_ships import DEG, Numbers, mean_and_spread, nees, own_tracker

from shipid import InteractingMultipleModel, Mode
from shipid.estimation.multiple.first_state import FirstState
from shipid.estimation.multiple.multiple_runs import MultipleModelRuns
from shipid.estimation.multiple.structures import AdaptiveGrid, Displaced
from shipid.models import constant_velocity_augmented, coordinated_turn, coordinated_turn_augmented

SCANS, SIGMA, FASTEST = 400, 85.0, 5.6
TURNS = ((56, 150, 1.87), (182, 245, -2.8), (285, 314, 5.6), (343, 379, -4.68))
FIXED = [[0.6, 0.3, 0.1], [0.1, 0.8, 0.1], [0.1, 0.3, 0.6]]
VARIABLE = [[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]
SENSORS = {"x": "85 m", "y": "85 m"}
ORDER = ("x", "vx", "y", "vy")
NAMES = ("FS AIMM", "VS AIMM", "AGIMM")
#: What another program gives: FS AIMM, VS AIMM, AGIMM and the largest standard deviation of 100 runs.
OTHER = {
    "position": (52.14, 49.85, 50.88, 0.28),
    "position highest": (75.0, 71.0, 64.0, 3.0),
    "velocity": (22.15, 19.49, 21.99, 0.16),
    "velocity highest": (52.2, 48.2, 43.5, 2.0),
    "NEES": (2.97, 3.19, 3.07, 0.04),
    "NEES highest": (11.5, 15.2, 7.8, 1.0),
    "turn rate": (2.58, 1.41, 1.80, 0.05),
    "turn rate highest": (8.18, 5.61, 5.48, 0.2),
}


def flown() -> tuple[Numbers, Numbers]:
    """Return the true turn rates in rad/s and the states [x, vx, y, vy] of scans 0 to 400."""
    rates = np.zeros(SCANS + 1)
    for first, last, rate in TURNS:
        rates[first : last + 1] = rate * DEG
    truth = np.zeros((SCANS + 1, 4))
    truth[0] = 60e3, -172.0, 40e3, 246.0
    for k in range(1, SCANS + 1):
        x, vx, y, vy = truth[k - 1]
        half, turned = np.sinc(rates[k] / 2 / np.pi), rates[k]
        c, s, ch, sh = np.cos(turned), np.sin(turned), np.cos(turned / 2), np.sin(turned / 2)
        truth[k] = x + half * (ch * vx - sh * vy), c * vx - s * vy, y + half * (sh * vx + ch * vy), s * vx + c * vy
    return rates, truth


def augmented(variable: bool, sigma: str) -> InteractingMultipleModel:
    """Return FS AIMM or VS AIMM."""
    rates = {"left": FASTEST, "straight": 0.0, "right": -FASTEST}
    modes = {
        n: Mode(coordinated_turn_augmented, inputs={"omega": f"{w} deg/s"}, noise={"domega": sigma})
        if w
        else Mode(constant_velocity_augmented, inputs={"omega": "0 deg/s"})
        for n, w in rates.items()
    }
    bounds = {
        "left": ("1.87 deg/s", "5.6 deg/s"),
        "straight": ("0 deg/s", "0 deg/s"),
        "right": ("-5.6 deg/s", "-1.87 deg/s"),
    }
    structure = Displaced("omega", "domega", bounds if variable else None, variable)
    transition = VARIABLE if variable else FIXED
    return InteractingMultipleModel(
        modes, transition, measured=SENSORS, probabilities=[0.1, 0.8, 0.1], structure=structure, model_noise=False
    )


def grid(share: float) -> InteractingMultipleModel:
    """Return AGIMM, with the smallest distance of neighbours as a share of the largest turn rate."""
    modes = {
        n: Mode(coordinated_turn, inputs={"omega": f"{w} deg/s"}, noise=dict.fromkeys(("ax", "ay"), f"{level} m/s^2"))
        for n, w, level in (("left", FASTEST, 2.5), ("straight", 0.0, 1.8), ("right", -FASTEST, 2.5))
    }
    structure = AdaptiveGrid("omega", ("left", "straight", "right"), f"{share * FASTEST} deg/s", f"{FASTEST} deg/s")
    return InteractingMultipleModel(
        modes, VARIABLE, measured=SENSORS, probabilities=[0.1, 0.8, 0.1], structure=structure, model_noise=False
    )


def plots(runs: int, seed: int, truth: Numbers, sigma: float) -> tuple[dict[str, Numbers], FirstState]:
    """Return noisy positions of scans 1 to 400, and the two-point start from scans 0 and 1."""
    z = truth[:, [0, 2]] + SIGMA * np.random.default_rng(seed).standard_normal((runs, SCANS + 1, 2))
    mean = np.zeros((runs, 5))
    mean[:, [0, 2]], mean[:, [1, 3]] = z[:, 1], z[:, 1] - z[:, 0]
    covariance = np.zeros((5, 5))
    covariance[:4, :4] = SIGMA**2 * np.kron(np.eye(2), [[1.0, 1.0], [1.0, 2.0]])
    covariance[4, 4] = sigma**2
    first = FirstState((*ORDER, "domega"), mean, covariance)
    return {"t": np.arange(1.0, SCANS + 1), "x": z[:, 1:, 0], "y": z[:, 1:, 1]}, first


def series(run: MultipleModelRuns, rates: Numbers, truth: Numbers) -> dict[str, Numbers]:
    """Return the measures of the paper at each scan: errors per coordinate, truth less estimate."""
    at = [run.states.index(n) for n in ORDER]
    error = truth[1:] - run.x[..., at]
    position, velocity = error[..., [0, 2]], error[..., [1, 3]]
    found = {
        "position": np.sqrt((position**2).mean(axis=(0, 2))),
        "velocity": np.sqrt((velocity**2).mean(axis=(0, 2))),
        "position mean": position.mean(axis=(0, 2)),
        "velocity mean": velocity.mean(axis=(0, 2)),
        "NEES": nees(error, run.covariance[..., at, :][..., at]).mean(axis=0),
    }
    if run.parameter.shape[-1]:
        rate = (run.probabilities * run.parameter).sum(axis=-1) / DEG
        found["turn rate"] = np.sqrt(((rate - rates[1:] / DEG) ** 2).mean(axis=0))
    return found


def measures(found: dict[str, Numbers], rates: Numbers) -> dict[str, float]:
    """Return means and highest values from scan 20 on, and means over legs 15 scans after each change."""
    numbers = {}
    k = np.arange(1, SCANS + 1)
    turning = rates[1:] != 0
    changes = np.flatnonzero(np.diff(rates != 0))
    settled = np.array([all(not 0 <= i - c < 15 for c in changes) for i in range(SCANS)]) & (k >= 20)
    for name, values in found.items():
        numbers[name], numbers[f"{name} highest"] = float(values[19:].mean()), float(np.abs(values[19:]).max())
    for name in ("position", "NEES"):
        numbers[f"{name} straight"] = float(found[name][settled & ~turning].mean())
        numbers[f"{name} turn"] = float(found[name][settled & turning].mean())
        numbers[f"{name} transition"] = float(found[name][~settled & (k >= 20)].mean())
    return numbers


def compared(made: dict[str, InteractingMultipleModel], runs: int, batches: int, sigma: float = 0.01) -> dict[str, Any]:
    """Return mean and spread of all numbers, by filter."""
    rates, truth = flown()
    rows: dict[str, list[dict[str, float]]] = {n: [] for n in made}
    for batch in range(batches):
        record, first = plots(runs, batch, truth, sigma)
        for name, tracker in made.items():
            covariances = np.eye(2) * SIGMA**2 if tracker.design.settings.correlated else None
            run = tracker.filter_runs(record, covariances=covariances, first=first)
            rows[name].append(measures(series(run, rates, truth), rates))
    return {n: mean_and_spread(r) for n, r in rows.items()}


def papers(sigma: str = "0.01 rad/s") -> dict[str, InteractingMultipleModel]:
    """Return the three filters of the paper."""
    return {"FS AIMM": augmented(False, sigma), "VS AIMM": augmented(True, sigma), "AGIMM": grid(2 / 3)}


def unpromised(what: str, published: str, ours: str, holds: bool, spread: str = "") -> Claim:
    """Return a row that tells what another reading gives."""
    return Claim(what, published, ours, spread, HOLDS if holds else FAILS, promised=False)


def judged(runs: int, batches: int) -> tuple[list[Claim], dict[str, Any]]:
    """All claims of the paper."""
    settled = compared(papers() | {"AGIMM 1/2": grid(1 / 2), "AGIMM 1/3": grid(1 / 3)}, runs, batches)
    printed = compared({n: f for n, f in papers("0.01 deg/s").items() if n != "AGIMM"}, runs, batches, 0.01 * DEG)
    fs, vs, ag = (settled[n] for n in NAMES)
    reading = "sigma_omega = 0.01 rad/s; the table of the paper says deg/s"
    positions = [f["position"][0] for f in (fs, vs, ag)]

    def three(name: str, digits: int = 3) -> str:
        return " | ".join(f"{f[name][0]:.{digits}g}" for f in (fs, vs, ag))

    def two(name: str) -> str:
        return " | ".join(f"{printed[n][name][0]:.3g}" for n in ("FS AIMM", "VS AIMM"))

    rows = [
        claim(
            "B1 the three perform closely: position RMSE per axis [m]",
            "very close",
            three("position", 4),
            max(positions) / min(positions) < 1.06,
            f"{fs['position'][1]:.2f}",
        ),
        claim(
            "B2 the variable ones are more mobile, AGIMM most: largest mean error of position [m]",
            "FS > VS > AGIMM",
            three("position mean highest"),
            fs["position mean highest"][0] > vs["position mean highest"][0] > ag["position mean highest"][0],
            f"{fs['position mean highest'][1]:.1f}",
            reading,
        ),
        claim(
            "B2 highest RMSE of velocity per axis [m/s]",
            "FS > VS > AGIMM",
            three("velocity highest"),
            fs["velocity highest"][0] > vs["velocity highest"][0] > ag["velocity highest"][0],
            f"{fs['velocity highest'][1]:.1f}",
            reading,
        ),
        claim(
            "B3 the variable ones are similar, slightly better than FS: velocity RMSE [m/s]",
            "FS largest",
            three("velocity"),
            fs["velocity"][0] > max(vs["velocity"][0], ag["velocity"][0])
            and fs["position"][0] > max(vs["position"][0], ag["position"][0]),
            f"{fs['velocity'][1]:.2f}",
            reading,
        ),
        claim(
            "B4 VS AIMM estimates the turn rate best: RMSE [deg/s]",
            "VS least",
            three("turn rate"),
            vs["turn rate"][0] < min(fs["turn rate"][0], ag["turn rate"][0]),
            f"{vs['turn rate'][1]:.2f}",
            reading,
        ),
        claim(
            "B5 FS AIMM is more consistent than VS AIMM: highest NEES",
            "FS less than VS",
            three("NEES highest"),
            fs["NEES highest"][0] < vs["NEES highest"][0],
            f"{vs['NEES highest'][1]:.1f}",
            reading,
        ),
        claim(
            "B5 and than AGIMM: highest NEES with a distance of 2/3, 1/2, 1/3 of the largest rate",
            f"more than {fs['NEES highest'][0]:.1f}",
            " | ".join(f"{settled[n]['NEES highest'][0]:.1f}" for n in ("AGIMM", "AGIMM 1/2", "AGIMM 1/3")),
            settled["AGIMM 1/2"]["NEES highest"][0] > fs["NEES highest"][0],
            f"{settled['AGIMM 1/2']['NEES highest'][1]:.1f}",
            "the smallest distance on the grid is half of the largest rate or less",
        ),
        unpromised(
            "as printed, sigma_omega in deg/s: velocity RMSE, FS and VS",
            "FS larger",
            two("velocity"),
            printed["FS AIMM"]["velocity"][0] > printed["VS AIMM"]["velocity"][0],
        ),
        unpromised(
            "as printed: turn rate RMSE, FS and VS, AGIMM " + f"{ag['turn rate'][0]:.2f}",
            "VS least",
            two("turn rate"),
            printed["VS AIMM"]["turn rate"][0] < printed["FS AIMM"]["turn rate"][0],
        ),
        unpromised(
            "as printed: highest NEES, FS and VS",
            "FS less",
            two("NEES highest"),
            printed["FS AIMM"]["NEES highest"][0] < printed["VS AIMM"]["NEES highest"][0],
        ),
    ]
    for what, (*theirs, spread) in OTHER.items():
        ours = [f[what] for f in (fs, vs, ag)]
        rows.append(
            unpromised(
                f"other program: {what}, {', '.join(NAMES)}",
                " | ".join(f"{t:g}" for t in theirs) + f" ± {3 * spread:.2g}",
                " | ".join(f"{o[0]:.4g}" for o in ours),
                all(abs(o[0] - t) <= 3 * spread for o, t in zip(ours, theirs)),
                f"{max(o[1] for o in ours):.2g}",
            )
        )
    return rows, settled


def ours_beside(runs: int, batches: int, theirs: dict[str, Any]) -> list[Claim]:
    """Our tracker on the same plots: legs, turns, and whether its covariance is right."""
    found = compared({"ours": own_tracker(SENSORS)}, runs, batches)["ours"]
    three = [theirs[n] for n in NAMES]
    vs = theirs["VS AIMM"]
    rows = [
        claim(
            f"beyond: our tracker, position RMSE per axis, {leg}",
            f"less than {least:.1f} m, the best of theirs"
            if leg == "straight"
            else f"{1.05 * vs[f'position {leg}'][0]:.1f} m or less",
            f"{found[f'position {leg}'][0]:.1f} m",
            found[f"position {leg}"][0] < (least if leg == "straight" else 1.05 * vs[f"position {leg}"][0]),
            f"{found[f'position {leg}'][1]:.2f}",
        )
        for leg, least in (
            ("straight", min(f["position straight"][0] for f in three)),
            ("turn", 0.0),
            ("transition", 0.0),
        )
    ]
    mean = {leg: found[f"NEES {leg}"][0] for leg in ("straight", "turn", "transition")}
    return [
        *rows,
        claim(
            "beyond: NEES on the legs, 4 degrees of freedom",
            "2 to 8",
            f"straight {mean['straight']:.1f}, turn {mean['turn']:.1f}",
            all(2 <= mean[n] <= 8 for n in ("straight", "turn")),
        ),
        unpromised(
            "beyond: NEES within 15 scans of a change",
            f"2 to 8; VS AIMM {vs['NEES transition'][0]:.1f}",
            f"{mean['transition']:.1f}",
            2 <= mean["transition"] <= 8,
        ),
        unpromised(
            "beyond: highest position RMSE",
            f"VS AIMM {vs['position highest'][0]:.0f} m",
            f"{found['position highest'][0]:.0f} m",
            found["position highest"][0] <= 1.05 * vs["position highest"][0],
            f"{found['position highest'][1]:.0f}",
        ),
    ]


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

    def draw(axes: Any) -> None:
        rates, truth = flown()
        record, first = plots(given.runs, 0, truth, 0.01)
        k = np.arange(1, SCANS + 1)
        for name, tracker in papers().items():
            run = tracker.filter_runs(record, first=first)
            found = series(run, rates, truth)
            for axis, what in zip(
                axes, ("position mean", "velocity mean", "position", "velocity", "turn rate", "NEES")
            ):
                axis.plot(k[1:], found[what][1:], label=name, linewidth=0.8)
                axis.set_ylabel(what)
            mean = run.parameter.mean(axis=0) / DEG
            axes[6 + NAMES.index(name)].plot(k, mean, linewidth=0.8)
            axes[6 + NAMES.index(name)].plot(k, rates[1:] / DEG, "k", linewidth=0.4)
            axes[6 + NAMES.index(name)].set_ylabel(f"{name} [deg/s]")
        axes[0].legend(loc="upper right", fontsize=6)
        axes[8].set_xlabel("scan")

    figure(given.figure, 9, draw)
    show(
        "Semerdjiev, Mihaylova and Li (2000): tracking coordinated turns",
        rows + ours_beside(given.runs, batches, settled),
        given.json,
    )


if __name__ == "__main__":
    main()
