"""A dead band in the heading does not spare the rudder in waves: why `design_autopilot` has no mode for keeping a course.

    python studies/course_keeping.py [--json]

Van Amerongen (1982) keeps a course with a dead band: a smaller heading error asks for no rudder, and the rate of turn is still
damped. The rows compare it with the plain law, in waves without wind from eight directions.
"""

from __future__ import annotations

import numpy as np
from _table import Row, show

import shipid
from shipid.autopilot.course_changes.course_measures import CourseMeasures, read_measures, settings_of
from shipid.autopilot.course_changes.run_course_changes import clock_of
from shipid.autopilot.course_changes.weather import CALM, Weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import coefficients_of
from shipid.autopilot.design.control_law import CourseController, Measured
from shipid.declaration.quantity import constant
from shipid.generation.ensemble import make_ensemble
from shipid.parts.waves import Waves

SEA = Weather(wind=0.0, wave_frequency=0.6, wave_heading=float(np.deg2rad(0.2)), current=0.0)
BANDS = (0.3, 1.0)
SHIPS = (("de-keizer", "soesterberg"), ("norrbin", "kvlcc2"), ("nomoto", "zeefakkel"))


class CourseKeeper(CourseController):
    """A course kept with a dead band."""

    dead_band = constant("rad", "heading error that asks for no rudder", default="1 deg")

    def law(self):
        """Passenier (1989), eq. (3.45), of the part of the heading error beyond the band."""
        error = self.psi_order - self.psi_seen
        beyond = error - np.minimum(np.maximum(error, -self.dead_band), self.dead_band)
        return self.gain_Kp * beyond - self.gain_Kd * self.r_seen


def kept(pilot: Autopilot, band: float) -> tuple[float, float, float]:
    """Rms heading error and rms rudder in degrees, and rudder travel in degrees a second, over eight directions."""
    parts = (pilot.model, pilot.actuator, Measured, CourseKeeper, pilot.schedule.component, CourseMeasures, Waves)
    model, speed, runs = shipid.join("course-keeping", *parts), pilot.own_speed, 8
    intervals, count = clock_of(pilot, model, np.full(runs, speed), 90.0)
    begin, changes = np.full(runs, 20.0 / pilot.pace(speed)), np.zeros(runs)
    values = coefficients_of(pilot, model, speed) | SEA.values(pilot, model) | settings_of(changes, begin)
    inputs = {**CALM, **SEA.inputs(np.arange(runs) * np.pi / 4), "u": speed, "cruise": speed, "psi_order": 0.0}
    noise = SEA.noise(count, intervals, 0)[None]
    end = make_ensemble(model, ("wave_noise",)).run(
        runs, values | {"dead_band": np.deg2rad(band)}, inputs, {"u": speed}, intervals, count, noise
    )
    found = read_measures(end, np.full(runs, speed), changes, intervals * count, begin)
    return tuple(float(np.rad2deg(np.mean(v))) for v in (found.rms_error, found.rms_rudder, found.travel))


def main() -> None:
    rows = []
    for model, ship in SHIPS:
        pilot = shipid.design_autopilot(model, ship, design="pole")
        error, rudder, travel = kept(pilot, 0.0)
        for band in BANDS:
            wider, less, shorter = kept(pilot, band)
            what = f"{ship}, dead band of {band:g} deg: rudder travel over that without; error {error:.2f} to {wider:.2f} deg"
            rows.append(
                Row(what, "above 0.9", f"{shorter / travel:.3f}, rms {less / rudder:.3f}", shorter > 0.9 * travel)
            )
    show(
        "A course kept with a dead band in waves",
        rows,
        "The rudder follows the rate of turn by the waves, which no band takes out.",
    )


if __name__ == "__main__":
    main()
