"""Grinyak and Trofimov: a bank of alpha-beta filters whose memory a fuzzy detector of manoeuvres chooses.

A vessel sails straight on, turns half round with a radius of 300 m and sails straight on again, at 10 and at 20 m/s. The
paper prints the memories in use: the longest on a straight course, m = 5 at 10 m/s and m = 3 at 20 m/s in the turn. It prints
neither the scan interval nor the error of a plot, nor the slope and the centre of the membership functions, nor J: here
3 s, 5 m, a = 8, c = 2.5 and J = 10. The steady lag of memory k in a turn of radius R is (v^2/R) tau^2 (1 - alpha_k)/beta_k, and
both printed memories need c sigma/tau^2 between 1.33 and 1.67 m/s^2; the settings give 1.39.

    python studies/grinyak_fuzzy.py [--runs 100] [--short] [--json] [--figure FILE]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from _claims import Claim, claim, figure, show

from shipid.encounter.tracking.filters.alpha_beta import FuzzySettings, advance, chosen_memory, gains, rule_shares

INTERVAL, SIGMA, RADIUS = 3.0, 5.0, 300.0
SETTINGS = FuzzySettings(longest=10, slope=8.0, centre=2.5)
STRAIGHT = 60
READING = "scan interval 3 s, error of a plot 5 m each way, a = 8, c = 2.5, J = 10: c sigma/tau^2 = 1.39 m/s^2"
#: What these settings have to give: error in m on the straight course and in the turn, by speed.
NOTED = {10.0: (3.43, 11.6), 20.0: (3.43, 11.4)}


@dataclass(frozen=True)
class Runs:
    """What one speed gave.

    Attributes
    ----------
    memory : ndarray, shape (runs, scans)
        Before it is rounded.
    errors : ndarray, shape (runs, scans)
        Of the chosen estimate, m.
    fixed : ndarray, shape (runs, scans, J - 1)
        Of each filter of the bank, m.
    straight, turn : ndarray of bool, shape (scans,)
        Where each leg has settled.
    begins, ends : int
        First scan in the turn and after it.
    """

    memory: np.ndarray
    errors: np.ndarray
    fixed: np.ndarray
    straight: np.ndarray
    turn: np.ndarray
    begins: int
    ends: int


def truth(speed: float) -> tuple[np.ndarray, int, int]:
    """Return the positions at each scan, and the scans at which the turn begins and is over."""
    rate = speed / RADIUS
    turning = np.pi / rate
    t = INTERVAL * np.arange(2 * STRAIGHT + int(np.ceil(turning / INTERVAL)))
    begin = INTERVAL * STRAIGHT
    angle = rate * np.clip(t - begin, 0, turning)
    before, after = np.minimum(t, begin), np.maximum(t - begin - turning, 0)
    x = speed * (before - after) + RADIUS * np.sin(angle)
    return np.stack([x, RADIUS * (1 - np.cos(angle))], axis=1), STRAIGHT, STRAIGHT + int(np.ceil(turning / INTERVAL))


def sail(speed: float, runs: int, chance: np.random.Generator) -> Runs:
    """Run the bank over noisy plots."""
    path, begins, ends = truth(speed)
    z = path + SIGMA * chance.standard_normal((runs, *path.shape))
    x = np.zeros((runs, SETTINGS.memories.size, 4))
    x[..., :2] = z[:, None, 0]
    memory = np.full((runs, len(path)), 2.0)
    errors, fixed = np.zeros((runs, len(path))), np.zeros((runs, len(path), SETTINGS.memories.size))
    interval, sigma = np.full(runs, INTERVAL), np.full(runs, SIGMA)
    for k in range(1, len(path)):
        x, residual = advance(x, z[:, k], np.full(runs, k), interval, SETTINGS)
        memory[:, k] = chosen_memory(rule_shares(residual, sigma, SETTINGS), SETTINGS)
        fixed[:, k] = np.hypot(*np.moveaxis(x[..., :2] - path[k], -1, 0))
        errors[:, k] = fixed[np.arange(runs), k, np.rint(memory[:, k]).astype(int) - 2]
    scans = np.arange(len(path))
    straight = (scans >= 2 * SETTINGS.longest) & (scans < begins)
    turn = (
        (scans >= begins + SETTINGS.longest) & (scans < ends) if speed < 15 else (scans >= begins + 6) & (scans < ends)
    )
    return Runs(memory, errors, fixed, straight, turn, begins, ends)


def rms(values: np.ndarray) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def rows_of(speed: float, found: Runs, printed: int) -> list[Claim]:
    """Return the claims at one speed."""
    memory = found.memory.mean(axis=0)
    straight, turn = float(found.memory[:, found.straight].mean()), float(found.memory[:, found.turn].mean())
    spread = float(found.memory[:, found.turn].mean(axis=1).std(ddof=1))
    down = int(np.argmax(memory[found.begins :] <= printed + 0.5))
    back = int(np.argmax(memory[found.ends :] > SETTINGS.longest - 0.5))
    ours = rms(found.errors[:, found.straight]), rms(found.errors[:, found.turn])
    fixed = {
        j: (rms(found.fixed[:, found.straight, j - 2]), rms(found.fixed[:, found.turn, j - 2])) for j in (2, 3, 5, 10)
    }
    each = [rms(run[found.straight]) for run in found.errors]
    at = f"at {speed:.0f} m/s"
    noted = NOTED[speed]
    return [
        claim(f"D1 the longest memory on a straight course, {at}", "m = J = 10", f"m = {straight:.2f}", straight > 9.5, reading=READING),
        claim(f"D2 the memory in the turn, {at}", f"m = {printed}", f"m = {turn:.2f}", round(turn) == printed, f"± {spread:.2f} a run", READING),
        claim(f"D3 it responds quickly, {at}", "quickly", f"{down} scans to the memory of the turn, {back} back", down <= 8, reading=READING),
        claim(f"error on the straight course, {at}", f"{noted[0]:.2f} m, asked", f"{ours[0]:.2f} m", abs(ours[0] - noted[0]) < 0.15, f"± {np.std(each):.2f} m a run", READING),
        claim(f"error in the turn, {at}", f"{noted[1]:.1f} m, asked", f"{ours[1]:.1f} m", abs(ours[1] - noted[1]) < 1.0, "", READING),
        claim(
            f"better than the longest memory in the turn, {at}", "asked: 3 times or more", f"{fixed[10][1] / ours[1]:.1f} times",
            fixed[10][1] > 3 * ours[1], "fixed memories 2, 3, 5, 10: " + ", ".join(f"{fixed[j][1]:.1f}" for j in (2, 3, 5, 10)) + " m", READING,
        ),
    ]  # fmt: skip


def draw(axes: Any, found: dict[float, Runs]) -> None:
    """Draw the memory and the error over the scans, one column of the paper above the other."""
    for k, (speed, runs) in enumerate(found.items()):
        t = INTERVAL * np.arange(runs.memory.shape[1])
        axes[2 * k].plot(t, runs.memory.mean(axis=0), color="#2f7fc4", linewidth=1.2)
        axes[2 * k].set_ylabel(f"m, {speed:.0f} m/s")
        axes[2 * k + 1].plot(t, np.sqrt((runs.errors**2).mean(axis=0)), color="#d9700a", linewidth=1.2)
        axes[2 * k + 1].set_ylabel("error [m]")
        for axis in axes[2 * k : 2 * k + 2]:
            axis.axvspan(INTERVAL * runs.begins, INTERVAL * runs.ends, color="#7d8590", alpha=0.2, linewidth=0)
    axes[-1].set_xlabel("time [s]")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100, help="noise runs (default 100)")
    parser.add_argument("--short", action="store_true", help="the same with 40 runs")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="write the figure to this file, as SVG")
    given = parser.parse_args()
    chance = np.random.default_rng(1)
    found = {speed: sail(speed, 40 if given.short else given.runs, chance) for speed in (10.0, 20.0)}
    rows = [row for (speed, runs), printed in zip(found.items(), (5, 3)) for row in rows_of(speed, runs, printed)]
    alpha, beta = gains(np.array([2, 10]))
    figure(given.figure, 4, lambda axes: draw(axes, found))
    show(
        "Grinyak and Trofimov, multi-model tracking with a fuzzy manoeuvre detector",
        rows,
        given.json,
        "The gains printed are those of a straight line fitted to k + 1 plots; the paper's own condition beta = alpha^2/(2 - alpha) holds "
        f"for k = 1 only: it would ask for {alpha[0] ** 2 / (2 - alpha[0]):.3f} where {beta[0]:.3f} is listed at k = 2, "
        f"and {alpha[1] ** 2 / (2 - alpha[1]):.4f} for {beta[1]:.4f} at k = 10.\n"
        "The bank is no better in the turn than the best filter of a fixed short memory, which is worse on the straight course.",
    )


if __name__ == "__main__":
    main()
