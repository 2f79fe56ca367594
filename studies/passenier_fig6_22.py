"""Passenier (1989), fig. 6.22, section 6.3.5: a whole track sailed by an expert with the predictor, with a current and an evasive action.

The container ship sails track T1 of table 6.1 at 19 knots in wind. At the third change of course a current of 2.5 knots to the south-west
sets in; on the leg before the last change she evades by 40 degrees with 40 degrees of rudder, and comes back onto the track. The expert is
simulated as the navigator with the predictor of the tracking experiment, without reaction delay (studies/_tracks.py); he knows her as the
filter of her own model does, from instruments with fixes of 10 m. Track, current and evasion are assumed; the print has no numbers.

The way back: the trial heading is 30 degrees to the leg, and the rudder goes over when the predicted turn ends on it.

    python studies/passenier_fig6_22.py [--json] [--figure FILE]
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from _claims import HOLDS, Claim, claim, figure, options, show
from _tracks import CURRENT, LEG, LIMIT, SHIP, TICK, Navigator, Setting, legs_of, pilot_of, reference, steered
from passenier_table6_4 import identified

from shipid.prediction.following.planned_track import distance_from
from shipid.prediction.following.wheel_over import TrackLeg, wheel_over
from shipid.prediction.situations.own_ship_filter import own_ship_filter
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.order import unwrapped
from shipid.prediction.tracks.track_predictor import TrackPredictor

DEG = np.pi / 180
TRACK, SPEED = "T1", 9.5
SETTING = Setting(delay=0.0, scatter=0.0)
#: The current sets in at this change, and the evasion is on the leg after this one, when so much of it is behind her, in m.
THIRD, BEFORE_LAST, BEGIN = 3, 4, 0.25 * LEG
#: The evasion: so far off the course, with so much rudder, until she is so far off the leg in m; and back at such an angle.
EVADE, HARD, AWAY, BACK = 40 * DEG, 40 * DEG, 100.0, 30 * DEG
NOISE = {"psi": 0.2 * DEG, "r": 0.02 * DEG, "u": 0.1, "x": 10.0, "y": 10.0}
COLUMNS = ("t", "x", "y", "leg", "psi", "aim", "r", "delta", "current_north", "current_east", "evading")
Phase = Literal["before", "away", "back", "turning", "done"]


@dataclass
class Evasion:
    """The evasive action, and the way back onto the leg."""

    leg: TrackLeg
    predictor: TrackPredictor
    phase: Phase = "before"

    def steer(self, known: Situation) -> tuple[float, float] | None:
        """Return heading and rudder limit; None where the navigator sails the track."""
        v = known.values
        across = float(self.leg.across(v["x"], v["y"]))
        if self.phase == "before" and float(self.leg.along(v["x"], v["y"])) > BEGIN:
            self.phase = "away"
        if self.phase == "away" and across > AWAY:
            self.phase = "back"
        if self.phase == "back":
            north, east = known.ground_velocity
            nearing = np.sin(np.arctan2(east, north) - self.leg.course) < -np.sin(5 * DEG)
            if nearing and wheel_over(self.predictor, known, self.leg, rudder_limit=LIMIT).due:
                self.phase = "done"
        if self.phase in ("before", "done"):
            return None
        aim = self.leg.course + (EVADE if self.phase == "away" else -BACK)
        return unwrapped(aim, v["psi"]), HARD


@functools.cache
def voyage() -> np.ndarray:
    """Sail the track; return a row every 2 s, see `COLUMNS`."""
    legs = legs_of(TRACK)
    predictor = TrackPredictor(pilot_of(), model="first-order", values=identified())
    calm = replace(SETTING, disturbed=True)
    ship = steered(calm, 0.0, 0.0, 0.0)
    drift = {n: ship.inputs[n] for n in ("current_north", "current_east")}
    ship.inputs |= dict.fromkeys(drift, 0.0)
    navigator = Navigator("C", legs, calm, predictor, np.random.default_rng(0))
    evasion = Evasion(legs[BEFORE_LAST], predictor)
    ship.set("delta_max", HARD)
    # The coefficients of his filter are those of the predictor's identification; what they miss is in its yaw disturbance.
    kalman = own_ship_filter("de-keizer", SHIP, values=identified()).start()
    random, rows = np.random.default_rng(622), []
    while ship.t < 6000:
        now = ship.now
        seen = {n: now[n] + s * random.standard_normal() for n, s in NOISE.items()}
        found = kalman.update({"t": ship.t, **seen, "delta": now["delta"], "cruise": SPEED})
        known = Situation({
            **{n: found[n] for n in ("x", "y", "psi", "r", "u", "current_north", "current_east")},
            "v": -0.573 * SHIP.particular("L", "m") * found["r"], "delta": now["delta"], "cruise": SPEED,
        })  # fmt: skip
        if navigator.leg >= THIRD:
            ship.inputs |= drift
        order = None
        if (
            navigator.leg == BEFORE_LAST
            and evasion.phase != "done"
            and (evasion.phase != "before" or not navigator.turning)
        ):
            order = evasion.steer(known)
            # The last turn of the evasion is one onto the leg, which the navigator watches as any other.
            navigator.turning |= evasion.phase == "done"
        heading, limit = navigator.steer(ship.t, known) if order is None else order
        rows.append((
            ship.t, now["x"], now["y"], navigator.leg, now["psi"], heading, now["r"], now["delta"],
            found["current_north"], found["current_east"], float(order is not None),
        ))  # fmt: skip
        last = legs[-1]
        if navigator.leg == len(legs) - 1 and last.along(now["x"], now["y"]) > 0.9 * LEG:
            break
        ship.advance(TICK, heading, limit)
    return np.array(rows)


def rows_of() -> list[Claim]:
    """What is told of the trial, and what came out."""
    table = dict(zip(COLUMNS, voyage().T))
    off = distance_from(reference(TRACK, SETTING), table["x"], table["y"])
    leg, evading = table["leg"], table["evading"] > 0
    back = off[leg == BEFORE_LAST][-1]
    strong = float(np.hypot(*(CURRENT[0] * np.array([np.cos(CURRENT[1]), np.sin(CURRENT[1])]))))
    ends = (leg == BEFORE_LAST) & ~evading & (table["t"] < table["t"][evading][0])
    error = float(np.hypot(
        table["current_north"][ends][-1] - CURRENT[0] * np.cos(CURRENT[1]), table["current_east"][ends][-1] - CURRENT[0] * np.sin(CURRENT[1])
    ))  # fmt: skip
    calm = off[leg < THIRD]
    later = off[(leg >= THIRD) & ~evading & ~((leg == BEFORE_LAST) & (table["t"] > table["t"][evading][0]))]
    done = bool(leg[-1] == len(legs_of(TRACK)) - 1)
    return [
        claim("the whole track is sailed", "fig. 6.22.b", f"{int(leg[-1])} of {len(legs_of(TRACK)) - 1} changes", done),
        Claim("RMS before the third change, m", "", f"{np.sqrt((calm**2).mean()):.0f}", "", HOLDS, promised=False),
        Claim("RMS in the current, without the evasion, m", "", f"{np.sqrt((later**2).mean()):.0f}", "", HOLDS, promised=False),
        claim(
            "P17 the estimated current, before the evasion", f"{strong:.2f} m/s", f"off by {error:.2f} m/s", error <= 0.3 * strong,
            reading="found in the time of one leg",
        ),
        claim(
            "rudder of the evasion; how far she leaves the track", "40 deg; no number",
            f"{np.abs(np.rad2deg(table['delta'][evading])).max():.0f} deg; {off[evading].max():.0f} m",
            np.abs(np.rad2deg(table["delta"][evading])).max() > 35,
        ),
        claim(
            "back on the track when the last change begins", "fig. 6.22.b; 50 m (0.2 L) or less", f"{back:.0f} m", back <= 50
        ),
    ]  # fmt: skip


def draw(axes: Any) -> None:
    """Draw the signals, and the track beside its reference."""
    table = dict(zip(COLUMNS, voyage().T))
    signals, place = axes
    signals.plot(table["t"], np.rad2deg(table["aim"] - table["psi"]), "k", lw=0.6, label="course error [deg]")
    signals.plot(table["t"], 60 * np.rad2deg(table["r"]), "k--", lw=0.8, label="rate of turn [deg/min]")
    signals.plot(table["t"], np.rad2deg(table["delta"]), "k:", lw=0.8, label="rudder [deg]")
    signals.set_xlabel("t [s]")
    signals.legend()
    line = reference(TRACK, SETTING)
    place.plot(line[:, 1], line[:, 0], "k", lw=0.5, label="reference")
    place.plot(table["y"], table["x"], "k--", lw=0.9, label="sailed")
    place.set_aspect("equal")
    place.set_xlabel("east [m]")
    place.set_ylabel("north [m]")
    place.legend()


if __name__ == "__main__":
    chosen = options(__doc__ or "")
    figure(chosen.figure, 2, draw)
    show(f"Passenier (1989), fig. 6.22: track {TRACK} sailed with the predictor", rows_of(), chosen.json)
