"""The avoidance of Song et al. (2018) as a campaign: what a craft knows of three obstacles decides where it goes.

A craft goes from (0, 0) to (6500, -800) among obstacles at (1500, -500), (2000, 500) and (6000, -500), whose domains are circles of
230 m. Its radar sees each of them once a period, with an error anywhere in a circle of 30 m. The same runs, with the same errors, are
made with what each method knows; speeds, turns and the planner are not printed in the paper, and are those of the constants here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from shipid.campaign.campaign import Campaign, Measure
from shipid.encounter.acceleration_prediction import predicted_positions
from shipid.encounter.error_mitigation import INTERVALS, Mitigation, Reading, mitigated_points, straight_points
from shipid.encounter.ship_domain import circle
from shipid.encounter.tracked_motion import TargetTracker
from shipid.encounter.velocity_obstacles import VelocityPlanner

#: From the paper: where things are, m, and how large a domain and an error of the radar are.
START, GOAL = np.array([0.0, 0.0]), np.array([6500.0, -800.0])
OBSTACLES = np.array([[1500.0, -500.0], [2000.0, 500.0], [6000.0, -500.0]])
DOMAIN, ERROR = 230.0, 30.0
#: Not printed: the obstacles make for the straight way of the craft, to within this angle in rad.
AIM = np.deg2rad(60.0)
#: Not printed: speeds of the obstacles in m/s, their largest rate of turn in rad/s, and how long they keep one, in s.
SPEEDS, TURN, KEPT = (3.0, 8.0), np.deg2rad(0.6), 60.0
#: Periods after which a craft that has not arrived is given up.
LONGEST = 130
#: Points that are predicted from, as in the paper's predictions.
RAW_POINTS = 4
#: What a craft may know of the obstacles.
METHODS = ("raw", "decimated", "sampled", "all_scans", "straight", "tracker", "tracker_margin", "truth")
#: How much larger than they are the domains are taken by "tracker_margin", m: two standard deviations of its positions.
MARGIN = 25.0
#: Standard deviation of a coordinate of an error that lies anywhere in the circle.
TRACKER = TargetTracker(ERROR / 2)


@dataclass(frozen=True)
class Case:
    """One set of what the paper leaves open.

    Attributes
    ----------
    name : str
        What it is called.
    period : float
        Of the radar and of the decisions, s.
    speed : float
        Full speed of the craft, m/s.
    every : int
        Scans from one point to the next of those that are predicted from.
    ahead : int
        Steps that are predicted: the velocity of an obstacle is the mean one over them.
    """

    name: str
    period: float
    speed: float
    every: int
    ahead: int = 5


CASES = (Case("T5", 5.0, 23.0, 4), Case("T2", 2.0, 57.0, 5))


def disc(rng: np.random.Generator, shape: tuple[int, ...], radius: float = ERROR) -> np.ndarray:
    """Return errors that lie anywhere in a circle alike.

    Parameters
    ----------
    rng : numpy.random.Generator
        Random numbers.
    shape : tuple of int
        How many.
    radius : float
        m.

    Returns
    -------
    ndarray, shape (*shape, 2)
        m.
    """
    angle, away = rng.uniform(0, 2 * np.pi, shape), radius * np.sqrt(rng.uniform(size=shape))
    return np.stack([away * np.cos(angle), away * np.sin(angle)], axis=-1)


def obstacles(rng: np.random.Generator, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Return how the obstacles move and where they are observed.

    Parameters
    ----------
    rng : numpy.random.Generator
        Of the run.
    case : Case
        What the paper leaves open.

    Returns
    -------
    truth : ndarray, shape (3, before + LONGEST + 1, 4)
        Positions and velocities at every period, `INTERVALS` times `every` of them before the craft starts.
    seen : ndarray, shape (3, before + LONGEST + 1, 2)
        Observed positions.
    """
    count, before = len(OBSTACLES), INTERVALS * case.every
    periods = before + LONGEST + 1
    way = (GOAL - START) / np.hypot(*(GOAL - START))
    across = (OBSTACLES - START) @ np.array([-way[1], way[0]])
    towards = np.arctan2(*(-np.sign(across)[:, None] * np.array([-way[1], way[0]])).T[::-1])
    speed, heading = rng.uniform(*SPEEDS, count), towards + rng.uniform(-AIM, AIM, count)
    legs = int(np.ceil(periods * case.period / KEPT))
    rates = rng.uniform(-TURN, TURN, (count, legs))
    rate = rates[:, (np.arange(periods) * case.period / KEPT).astype(int)]
    course = heading[:, None] + np.cumsum(rate, axis=1) * case.period
    velocity = speed[:, None, None] * np.stack([np.cos(course), np.sin(course)], axis=-1)
    # Between two periods the course is halfway.
    half = course - 0.5 * rate * case.period
    step = speed[:, None, None] * np.stack([np.cos(half), np.sin(half)], axis=-1) * case.period
    position = np.cumsum(step, axis=1)
    position += (OBSTACLES - position[:, before])[:, None, :]
    return np.concatenate([position, velocity], axis=-1), position + disc(rng, (count, periods))


def known(method: str, case: Case, truth: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Return what a method knows of the obstacles at every period of the craft; nothing in it looks ahead.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    case : Case
        What the paper leaves open.
    truth : ndarray, shape (..., periods, 4)
        How they move.
    seen : ndarray, shape (..., periods, 2)
        Where they are observed.

    Returns
    -------
    ndarray, shape (..., LONGEST + 1, 4)
        Positions and velocities, m and m/s.
    """
    before = INTERVALS * case.every
    if method == "truth":
        return truth[..., before:, :]
    if method.startswith("tracker"):
        return TRACKER.motions(seen, case.period)[..., before:, :4]
    windows = np.swapaxes(sliding_window_view(seen, before + 1, axis=-2), -1, -2)
    apart, limit = case.every, None
    if method == "raw":
        points, apart = windows[..., -RAW_POINTS:, :], 1
    elif method == "decimated":
        points = windows[..., :: case.every, :]
    elif method == "straight":
        points = straight_points(windows, case.every)
    else:
        reading: Reading = "sampled" if method == "sampled" else "all scans"
        points, limit = mitigated_points(windows, case.every, Mitigation(reading, radius=ERROR)), 1.0
    ahead = predicted_positions(points, case.ahead, limit)[..., -1, :] - points[..., -1, :]
    return np.concatenate([points[..., -1, :], ahead / (case.ahead * apart * case.period)], axis=-1)


def sail(case: Case, truth: np.ndarray, believed: np.ndarray, margin: float = 0.0) -> dict[str, np.ndarray]:
    """Let craft go to the goal by what they know.

    Parameters
    ----------
    case : Case
        What the paper leaves open.
    truth, believed : ndarray, shape (runs, n, periods, 4)
        How the obstacles move, and what is known of them, from the start of the craft on.
    margin : float
        How much larger than they are the domains are taken, m.

    Returns
    -------
    dict of str to ndarray
        ``entries``, periods inside a domain; ``periods``, to the goal, NaN where it is not reached; ``turned``, sum of the changes of heading in rad;
        ``track``, positions, shape (runs, LONGEST + 1, 2), NaN after the arrival.
    """
    planner = VelocityPlanner(circle(DOMAIN + margin), case.speed)
    runs = len(truth)
    position = np.repeat(START[None], runs, axis=0)
    heading = np.full(runs, np.arctan2(*(GOAL - START)[::-1]))
    entries, turned, periods = np.zeros(runs), np.zeros(runs), np.full(runs, np.nan)
    track = np.full((runs, LONGEST + 1, 2), np.nan)
    track[:, 0] = START
    sailing = np.ones(runs, bool)
    for k in range(LONGEST):
        left = np.flatnonzero(sailing)
        if not left.size:
            break
        new, speed, _ = planner.choose(position[left], heading[left], GOAL, believed[left, :, k], case.period)
        turned[left] += np.abs(new - heading[left])
        heading[left] = new
        position[left] += case.period * speed[:, None] * np.stack([np.cos(new), np.sin(new)], axis=-1)
        track[left, k + 1] = position[left]
        apart = np.hypot(*np.moveaxis(truth[left, :, k + 1, :2] - position[left, None], -1, 0))
        entries[left] += (apart < DOMAIN).any(axis=1)
        there = np.hypot(*np.moveaxis(GOAL - position[left], -1, 0)) < case.speed * case.period
        periods[left[there]] = k + 1
        sailing[left[there]] = False
    return {"entries": entries, "periods": periods, "turned": turned, "track": track}


def runs_of(case: Case, methods: Sequence[str] = METHODS) -> Mapping[str, Measure]:
    """Return the measures of a case.

    Parameters
    ----------
    case : Case
        What the paper leaves open.
    methods : sequence of str
        What is compared.
    """
    found: dict[str, Measure] = {}
    for method in methods:
        what = f"{method.replace('_', ' ')}, {case.name}"
        found[f"entries_{method}"] = Measure("count", "1", f"periods in a domain: {what}")
        found[f"entered_{method}"] = Measure("event", "1", f"share of runs that entered a domain: {what}")
        found[f"periods_{method}"] = Measure("value", "1", f"periods to the goal: {what}")
        found[f"turned_{method}"] = Measure("value", "rad", f"changes of heading: {what}")
    return found


def sailed(
    case: Case, generators: Sequence[np.random.Generator], methods: Sequence[str] = METHODS
) -> dict[str, np.ndarray]:
    """Return the measures of a batch of runs of a case.

    Parameters
    ----------
    case : Case
        What the paper leaves open.
    generators : sequence of numpy.random.Generator
        One a run.
    methods : sequence of str
        What is compared.
    """
    drawn = [obstacles(rng, case) for rng in generators]
    truth, seen = np.stack([d[0] for d in drawn]), np.stack([d[1] for d in drawn])
    before = INTERVALS * case.every
    found: dict[str, np.ndarray] = {}
    for method in methods:
        margin = MARGIN if method.endswith("margin") else 0.0
        by = sail(case, truth[..., before:, :], known(method, case, truth, seen), margin)
        found[f"entries_{method}"] = by["entries"]
        found[f"entered_{method}"] = (by["entries"] > 0).astype(float)
        found[f"periods_{method}"], found[f"turned_{method}"] = by["periods"], by["turned"]
    return found


def _slow_radar(generators: Sequence[np.random.Generator]) -> dict[str, np.ndarray]:
    return sailed(CASES[0], generators)


def _fast_radar(generators: Sequence[np.random.Generator]) -> dict[str, np.ndarray]:
    return sailed(CASES[1], generators)


slow_radar = Campaign("song-2018", None, runs_of(CASES[0]), runs=_slow_radar, batch=20)
fast_radar = Campaign("song-2018-fast-radar", None, runs_of(CASES[1]), runs=_fast_radar, batch=20)
