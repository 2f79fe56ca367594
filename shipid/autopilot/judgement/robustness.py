"""Robustness of a design to changes of the ship, its steering machine or its log."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChanges
from shipid.autopilot.course_changes.run_course_changes import course_histories, run_course_changes, scaled_draws
from shipid.autopilot.course_changes.sea_filter import ABOVE, LAG, WIDTH
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import coefficients_of, heading_frequency, linear_ship, steered_ship
from shipid.autopilot.design.plant import linear_plant
from shipid.autopilot.judgement.judgement import SAMPLE_CHANGE
from shipid.autopilot.judgement.margins import disk_margins, loop_polynomials, sea_filtered
from shipid.autopilot.judgement.robust_margins import Robustness
from shipid.declaration.vocabulary import to_display
from shipid.foundation.numbers import percent
from shipid.foundation.statistics import plain
from shipid.generation.system import generate
from shipid.parameters.draws import Drawn

#: Draws whose histories are kept.
_SHOWN = 24
#: Over and under reading of the log, and how much slower a slow steering machine is.
_LOG, _SLOW = (0.9, 1.1), 0.5


def _disks(
    pilot: Autopilot, condition: int, drawn: Drawn | None, changed: Mapping[str, float], log: float = 1.0
) -> np.ndarray:
    """Disk margins, shape (speeds, draws): of the ship as it is where nothing is drawn."""
    model, speeds = steered_ship(pilot), pilot.speeds
    system, count = generate(model), 1 if drawn is None else len(drawn.values)
    columns = []
    for speed in speeds:
        known = {n: np.full(count, v) for n, v in coefficients_of(pilot, model, float(speed), condition).items()}
        known |= {} if drawn is None else scaled_draws(drawn, known)
        known |= {n: np.full(count, v) for n, v in changed.items() if n in known}
        columns.append(np.stack([known[n] for n in system.coefficients]))
    plant = linear_plant(model, np.repeat(speeds, count), np.concatenate(columns, axis=1), "delta_order")
    table = {n: np.repeat(v, count) for n, v in pilot.schedule.at(log * speeds, condition).items()}
    numerator, denominator = loop_polynomials(plant, table)
    return disk_margins(numerator, denominator, np.repeat(speeds / pilot.length, count)).reshape(len(speeds), count)


def robustness_of(
    pilot: Autopilot, drawn: Drawn | None, source: str, condition: int, wave_frequency: float
) -> tuple[Robustness, dict[str, np.ndarray]]:
    """Return the margins of the design for ships that differ from that of the design, and histories of some of them.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    drawn : Drawn or None
        Ships drawn from the uncertainty.
    source : str
        Their source in words, or why there are none.
    condition : int
        Which load condition.
    wave_frequency : float
        Of the sea in rad/s, which the sea filter is set to.

    Returns
    -------
    robustness : Robustness
    histories : dict of str to ndarray, shape (runs, n)
        ``t``, ``psi`` and ``delta`` of the sample course change: of the ship as it is, then of some of the draws, SI.
    """
    disks = _disks(pilot, condition, drawn, {})
    own = _disks(pilot, condition, None, {}).min()
    change, steered = float(np.deg2rad(SAMPLE_CHANGE)), steered_ship(pilot)
    speed = pilot.own_speed
    nominal = run_course_changes(pilot, [speed], [change], condition=condition)
    runs = nominal if drawn is None else run_course_changes(
        pilot, np.full(len(drawn.values), speed), np.full(len(drawn.values), change), condition=condition, drawn=drawn
    )  # fmt: skip
    worst = np.unravel_index(int(disks.argmin()), disks.shape)
    slow = {"delta_rate": _SLOW * pilot.limits["delta_rate"]}
    lag = {"tau_delta": coefficients_of(pilot, steered, speed, condition)["tau_delta"] / _SLOW} if (
        "tau_delta" in steered.constants
    ) else {}  # fmt: skip
    variants = {"as designed": _variant(float(own), nominal)}
    if lag:
        slowly = run_course_changes(pilot, [speed], [change], condition=condition, values=slow | lag)
        variants["steering machine of half the rate and twice the lag"] = _variant(
            float(_disks(pilot, condition, None, lag).min()), slowly
        )
    variants["sea filter on"] = _filtered(pilot, condition, speed, change, wave_frequency)
    for log in _LOG:
        off = run_course_changes(pilot, [speed], [change], condition=condition, values={"log_scale": log})
        variants[f"log reads {percent(abs(log - 1))} too {'low' if log < 1 else 'high'}"] = _variant(
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
        overshoot_deg=_spread(to_display(nominal.overshoot, "psi"), to_display(runs.overshoot, "psi")),
        settling_s=_spread(nominal.settling, runs.settling),
        sample_change_deg=SAMPLE_CHANGE,
        variants=variants,
    )
    shown = course_histories(pilot, [speed], [change], condition)
    if drawn is not None:
        count = min(_SHOWN, len(drawn.values))
        others = course_histories(pilot, [speed] * count, [change] * count, condition, drawn)
        shown = {n: np.concatenate([shown[n], others[n]]) for n in shown}
    return found, shown


def _filtered(pilot: Autopilot, condition: int, speed: float, change: float, waves: float) -> dict[str, float | None]:
    """The loop with the sea filter at the frequency of the waves, the ship at rest among them."""
    natural = np.array([heading_frequency(pilot, float(v)) for v in (*pilot.speeds, speed)])
    notch = np.maximum(waves, ABOVE * natural)
    corner = LAG * natural
    plants = linear_ship(pilot, pilot.speeds, condition, steered=True)
    loop = loop_polynomials(plants, pilot.schedule.at(pilot.speeds, condition))
    disks = disk_margins(*sea_filtered(*loop, notch[:-1], WIDTH, corner[:-1]), pilot.speeds / pilot.length)
    own = {"sea_frequency": float(notch[-1]), "sea_lag": float(corner[-1])}
    return _variant(
        float(disks.min()), run_course_changes(pilot, [speed], [change], condition=condition, values=own, filtered=True)
    )


def _variant(disk: float, run: CourseChanges) -> dict[str, float | None]:
    return {
        "disk": disk,
        "overshoot_deg": plain(to_display(float(run.overshoot[0]), "psi")),
        "settling_s": plain(run.settling[0]),
    }


def _spread(own: np.ndarray, drawn: np.ndarray) -> tuple[float | None, ...]:
    """Of the ship as it is, the median and the 95 % quantile of the draws; a run that diverged counts as infinite."""
    ordered = np.where(np.isfinite(drawn), drawn, np.inf)
    return tuple(plain(v) for v in (own[0], *np.quantile(ordered, (0.5, 0.95), method="higher")))
