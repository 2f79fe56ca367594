"""Judging a design: every number of the report, worked out in a few batches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from shipid.autopilot.course_changes.run_course_changes import Sailed, clock_of, sail, scaled_draws
from shipid.autopilot.course_changes.sea_filter import ABOVE, WIDTH
from shipid.autopilot.course_changes.weather import yardstick
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.plant import linear_plant
from shipid.autopilot.judgement.judgement import LIMITS, CourseChange, Judgement, Robustness
from shipid.autopilot.judgement.margins import Margins, disk_margins, loop_polynomials, margins_at, notched
from shipid.generation.record import make_record
from shipid.generation.system import generate
from shipid.parameters.draws import Drawn, draw_coefficients

#: Course changes sailed at the slowest, the ship's own and the fastest speed.
CHANGES = (5.0, 10.0, 20.0, 45.0, 60.0, 90.0, 120.0)
#: The course change sailed by every draw of the ship.
SAMPLE_CHANGE = 60.0
#: Directions the weather goes to, from the course, in degrees; in words of where it comes from.
_FROM = {0.0: "astern", 45.0: "the port quarter", 90.0: "port", 135.0: "the port bow", 180.0: "ahead",
         225.0: "the starboard bow", 270.0: "starboard", 315.0: "the starboard quarter"}  # fmt: skip
#: Weather is measured after this many L/u.
_BEGUN = 45.0
#: Histories kept for the figure, and samples of each.
_SHOWN, _POINTS = 24, 400
#: Over and under reading of the log, and how much slower a slow steering machine is.
_LOG, _SLOW = (0.9, 1.1), 0.5


def judge(pilot: Autopilot, samples: int, seed: int, progress: Callable[[str], Any] | None = None) -> Judgement:
    """Judge a design; see `Autopilot.judge`.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    samples : int
        Draws of the ship's coefficients.
    seed : int
        Of the draws and of the waves.
    progress : callable, optional
        Called with a line of text before each part.
    """
    tell = progress or (lambda _: None)
    speeds = pilot.speeds
    middles = 0.5 * (speeds[:-1] + speeds[1:])
    margins, between, robust, warnings = [], [], [], list(pilot.warnings)
    cloud: Mapping[str, np.ndarray] = {}
    for j in range(len(pilot.ships)):
        tell("margins")
        margins.append(_margins(pilot, speeds, j))
        between.append(_margins(pilot, middles, j) if middles.size else ())
        tell("robustness")
        drawn = draw_coefficients(pilot.model, pilot.ships[j], max(samples, 1), seed)
        one, histories = _robustness(pilot, drawn if samples and drawn.names else None, drawn.source, j)
        robust.append(one)
        cloud = cloud or histories
        warnings += _about(pilot, one, j)
    tell("course changes")
    steps = _steps(pilot)
    tell("wind and waves")
    weather = yardstick(pilot.length, pilot.service_speed)
    weathered, words = _weathered(pilot, seed)
    lost = sorted({abs(s.change_deg) for s in steps if s.lost})
    if lost:
        warnings.append(
            f"lost: the model runs away in course changes of {', '.join(f'{c:.3g}' for c in lost)} deg; with this rudder limit "
            "they are outside what it describes."
        )
    return Judgement(
        pilot, tuple(margins), tuple(between), tuple(robust), steps, weathered, weather.to_dict(), cloud,
        tuple(dict.fromkeys(warnings + words)),
    )  # fmt: skip


def _margins(pilot: Autopilot, speeds: np.ndarray, condition: int) -> tuple[Margins, ...]:
    plants = pilot.plants(speeds, condition, steered=True)
    return tuple(
        margins_at(plants.at(i), pilot.gains(float(v), condition), float(v), pilot.pace(float(v)))
        for i, v in enumerate(speeds)
    )


def _disks(
    pilot: Autopilot, condition: int, drawn: Drawn | None, changed: Mapping[str, float], log: float = 1.0
) -> np.ndarray:
    """Disk margins, shape (speeds, draws): of the ship as it is where nothing is drawn."""
    model, speeds = pilot.steered_ship, pilot.speeds
    system, count = generate(model), 1 if drawn is None else len(drawn.values)
    columns = []
    for speed in speeds:
        known = {n: np.full(count, v) for n, v in pilot.values(model, float(speed), condition).items()}
        known |= {} if drawn is None else scaled_draws(drawn, known)
        known |= {n: np.full(count, v) for n, v in changed.items() if n in known}
        columns.append(np.stack([known[n] for n in system.coefficients]))
    plant = linear_plant(model, np.repeat(speeds, count), np.concatenate(columns, axis=1), "delta_order")
    table = {n: np.repeat(v, count) for n, v in pilot.schedule.at(log * speeds, condition).items()}
    numerator, denominator = loop_polynomials(plant, table)
    return disk_margins(numerator, denominator, np.repeat(speeds / pilot.length, count)).reshape(len(speeds), count)


def _robustness(
    pilot: Autopilot, drawn: Drawn | None, source: str, condition: int
) -> tuple[Robustness, dict[str, np.ndarray]]:
    disks = _disks(pilot, condition, drawn, {})
    own = _disks(pilot, condition, None, {}).min()
    change = float(np.deg2rad(SAMPLE_CHANGE))
    speed = float(np.clip(pilot.service_speed, pilot.speeds[0], pilot.speeds[-1]))
    nominal = sail(pilot, [speed], [change], condition=condition)
    runs = nominal if drawn is None else sail(
        pilot, np.full(len(drawn.values), speed), np.full(len(drawn.values), change), condition=condition, drawn=drawn
    )  # fmt: skip
    worst = np.unravel_index(int(disks.argmin()), disks.shape)
    slow = {"delta_rate": _SLOW * pilot.limits["delta_rate"]}
    lag = {"tau_delta": pilot.values(pilot.steered_ship, speed, condition)["tau_delta"] / _SLOW} if (
        "tau_delta" in pilot.steered_ship.constants
    ) else {}  # fmt: skip
    variants = {"as designed": _variant(float(own), nominal)}
    if lag:
        slowly = sail(pilot, [speed], [change], condition=condition, values=slow | lag)
        variants["steering machine of half the rate and twice the lag"] = _variant(
            float(_disks(pilot, condition, None, lag).min()), slowly
        )
    variants["sea filter on"] = _filtered(pilot, condition, speed, change)
    for log in _LOG:
        off = sail(pilot, [speed], [change], condition=condition, values={"log_scale": log})
        variants[f"log reads {abs(log - 1):.0%} too {'low' if log < 1 else 'high'}"] = _variant(
            float(_disks(pilot, condition, None, {}, log).min()), off
        )
    found = Robustness(
        samples=0 if drawn is None else disks.shape[1],
        source=source,
        disk_worst=float(disks.min()),
        disk_low=float(np.quantile(disks.min(axis=0), 0.05)),
        speed_worst=float(pilot.speeds[worst[0]]),
        unstable=int((disks.min(axis=0) <= 0).sum()),
        disk_by_speed=tuple(disks.min(axis=1).tolist()),
        overshoot_deg=_spread(np.rad2deg(nominal.overshoot), np.rad2deg(runs.overshoot)),
        settling_s=_spread(nominal.settling, runs.settling),
        sample_change_deg=SAMPLE_CHANGE,
        variants=variants,
    )
    return found, histories(pilot, [speed], [change], condition, drawn)


def _filtered(pilot: Autopilot, condition: int, speed: float, change: float) -> dict[str, float | None]:
    """The loop with the notch of the sea filter at the frequency of the waves, the ship at rest among them."""
    waves = yardstick(pilot.length, pilot.service_speed).wave_frequency
    frequency = np.array([max(waves, ABOVE * pilot.natural_frequency(float(v))) for v in pilot.speeds])
    plants = pilot.plants(pilot.speeds, condition, steered=True)
    loop = loop_polynomials(plants, pilot.schedule.at(pilot.speeds, condition))
    disks = disk_margins(*notched(*loop, frequency, WIDTH), pilot.speeds / pilot.length)
    own = {"sea_frequency": max(waves, ABOVE * pilot.natural_frequency(speed))}
    return _variant(float(disks.min()), sail(pilot, [speed], [change], condition=condition, values=own, filtered=True))


def _variant(disk: float, sailed: Sailed) -> dict[str, float | None]:
    return {
        "disk": disk,
        "overshoot_deg": _plain(np.rad2deg(sailed.overshoot[0])),
        "settling_s": _plain(sailed.settling[0]),
    }


def _spread(own: np.ndarray, drawn: np.ndarray) -> tuple[float | None, ...]:
    """Of the ship as it is, the median and the 95 % quantile of the draws; a run that is lost counts as without end."""
    ordered = np.where(np.isfinite(drawn), drawn, np.inf)
    return tuple(_plain(v) for v in (own[0], *np.quantile(ordered, (0.5, 0.95), method="higher")))


def histories(
    pilot: Autopilot,
    speeds: list[float],
    changes: list[float],
    condition: int = 0,
    drawn: Drawn | None = None,
) -> dict[str, np.ndarray]:
    """Return heading and rudder against time for course changes in calm, or for some draws of the first one.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speeds, changes : list of float
        In m/s and rad.
    condition : int
        Which load condition.
    drawn : Drawn, optional
        Draws of the ship; some of them are sailed, after the ship as it is.

    Returns
    -------
    dict of str to ndarray
        ``t``, ``psi``, ``delta``, each of shape (runs, n).
    """
    model = pilot.closed_loop
    record = make_record(model, ("psi", "delta"), hold="zero")
    system = record.system
    if drawn is not None:
        count = min(_SHOWN, len(drawn.values))
        speeds, changes = speeds * (count + 1), changes * (count + 1)
    intervals, count = clock_of(pilot, model, np.asarray(speeds))
    found: dict[str, list[np.ndarray]] = {"t": [], "psi": [], "delta": []}
    for k, (speed, change) in enumerate(zip(speeds, changes)):
        known = {n: np.array([v]) for n, v in pilot.values(model, speed, condition).items()}
        if drawn is not None and k:
            one = Drawn(drawn.names, drawn.nominal, drawn.values[k - 1 : k], drawn.source)
            known |= scaled_draws(one, known)
        flat = {n: float(v[0]) for n, v in known.items()}
        given = {"u": speed, "cruise": speed, "psi_order": change, "loading": float(condition)}
        inputs = np.array([[given.get(n, model[n].number("default") or 0.0)] for n in system.inputs])
        start = np.array([speed if n == "u" else model[n].number("start") or 0.0 for n in system.states])
        steps = np.full(count, intervals[k])
        p = system.vector(system.coefficients, flat)
        y, _ = record(start, np.broadcast_to(inputs, (len(inputs), count)), steps, p)
        every = max(1, count // _POINTS)
        found["t"].append(np.arange(count)[::every] * intervals[k])
        found["psi"].append(y[0, ::every])
        found["delta"].append(y[1, ::every])
    return {n: np.array(rows) for n, rows in found.items()}


def _steps(pilot: Autopilot) -> tuple[CourseChange, ...]:
    own = float(np.clip(pilot.service_speed, pilot.speeds[0], pilot.speeds[-1]))
    speeds = sorted({float(pilot.speeds[0]), own, float(pilot.speeds[-1])})
    found: list[CourseChange] = []
    for j in range(len(pilot.ships)):
        grid = [(v, c) for v in speeds for c in CHANGES]
        sailed = sail(pilot, [v for v, _ in grid], np.deg2rad([c for _, c in grid]), condition=j)
        words = "calm" if len(pilot.ships) == 1 else f"calm, {pilot.conditions[j]}"
        found += [_change(sailed, i, words) for i in range(len(grid))]
    return tuple(found)


def _weathered(pilot: Autopilot, seed: int) -> tuple[tuple[CourseChange, ...], list[str]]:
    speed = float(np.clip(pilot.service_speed, pilot.speeds[0], pilot.speeds[-1]))
    weather = yardstick(pilot.length, pilot.service_speed)
    directions = np.array(list(_FROM))
    words = []
    if "r_disturbance" not in pilot.model.inputs:
        words.append(f"no wind: model {pilot.model.name} reads no 'r_disturbance', so wind does not act on it here.")
    elif pilot.ship.find(pilot.loop(*weather.components(pilot.model)), "N_w") is None:
        words.append(
            f"assumed: ship {pilot.ship.name} states no wind coefficients; those of a ship of its length are taken, and what is "
            "said of wind is of that size and no more."
        )
    kept, raw = (
        sail(
            pilot, np.full(8, speed), np.zeros(8), weather=weather, headings=np.deg2rad(directions), measured_from=_BEGUN,
            lengths=2 * _BEGUN, seed=seed, filtered=filtered,
        )
        for filtered in (True, False)
    )  # fmt: skip
    turned = sail(
        pilot, np.full(8, speed), np.full(8, np.deg2rad(SAMPLE_CHANGE)), weather=weather,
        headings=np.deg2rad(directions), seed=seed, filtered=True,
    )  # fmt: skip
    found = []
    for sailed, filtered in ((kept, True), (raw, False), (turned, True)):
        found += [_change(sailed, i, f"weather from {w}", filtered) for i, w in enumerate(_FROM.values())]
    return tuple(found), words


def _change(sailed: Sailed, i: int, weather: str, filtered: bool = False) -> CourseChange:
    return CourseChange(
        speed=float(sailed.speed[i]),
        change_deg=round(float(np.rad2deg(sailed.change[i])), 9),
        weather=weather,
        overshoot_deg=_plain(np.rad2deg(sailed.overshoot[i])),
        settling_s=_plain(sailed.settling[i]) if "calm" in weather else None,
        rms_error_deg=_plain(np.rad2deg(sailed.rms_error[i])),
        mean_error_deg=_plain(np.rad2deg(sailed.mean_error[i])),
        rms_rudder_deg=_plain(np.rad2deg(sailed.rms_rudder[i])),
        reversals=_plain(sailed.reversals[i]),
        cross_track_m=_plain(sailed.cross_track[i]),
        sea_filter=filtered,
        lost=not np.isfinite(sailed.overshoot[i]),
    )


def _about(pilot: Autopilot, robust: Robustness, condition: int) -> list[str]:
    found, ship = [], pilot.conditions[condition]
    if not robust.samples:
        found.append(f"no uncertainty: {robust.source}, so the robustness of the design is not known.")
    if robust.unstable:
        found.append(
            f"unstable draws: with {robust.unstable} of {robust.samples} draws of ship {ship} the loop is unstable. The trials do "
            "not determine this ship well enough for this design."
        )
    if robust.disk_worst < LIMITS["disk margin"]:
        over = "over the uncertainty of the ship" if robust.samples else "of the design"
        found.append(
            f"disk margin: the least {over} is {robust.disk_worst:.2g} at {robust.speed_worst:.3g} m/s, below "
            f"{LIMITS['disk margin']:g}."
        )
    return found


def _plain(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
