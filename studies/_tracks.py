"""The six tracks of Passenier (1989), table 6.1, the ship that sails them, and the navigators who steer her.

The print gives the changes of course, the length of the legs and the disturbances; sides, places and the human being are assumed:
sides alternate so that a track stays within 8 miles, every leg is 2.25 miles, the wheel goes over 5 s after it should.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

import numpy as np
from _container import container_ship

import shipid
from shipid import Component, derived, given, state
from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.experiment.tracks import track_experiment
from shipid.models import DeKeizer, PlanarMotion, Wind
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.track_pilot import TrackPilot
from shipid.prediction.following.wheel_over import TrackLeg, heading_on, wheel_over
from shipid.prediction.sailing.simulated_ship import SimulatedShip
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.order import unwrapped
from shipid.prediction.tracks.track_predictor import TrackPredictor

DEG, KNOT, MILE = np.pi / 180, 1852 / 3600, 1852.0
EXPERIMENT = track_experiment()
CHANGES = {n: round(float(np.rad2deg(c)), 6) for n, c in EXPERIMENT.changes.items()}
TRACKS = {n: " ".join(changes) for n, changes in EXPERIMENT.tracks.items()}
CONDITIONS = ("A", "B", "C", "D")
SHIP, LEG, LIMIT, TICK = container_ship(), EXPERIMENT.leg, EXPERIMENT.rudder_limit, EXPERIMENT.interval
CURRENT, WIND = EXPERIMENT.current, EXPERIMENT.wind
#: How often a navigator looks at the leg in s, and how far ahead he aims, in ship lengths.
LOOK, AIM = 60.0, 4.0


class LateSway(Component):
    """Sway that follows the rate of turn a little later, which no predictor here knows."""

    r = given("rad/s", "rate of turn, positive to starboard")
    v_due = derived("m/s", "sway speed of a steady turn")
    v = state("m/s", "sway speed through the water, positive to starboard")
    gamma = shipid.parameter("1", "sway constant", start=0.45, low=-2.0, high=5.0)
    L = shipid.constant("m", "length between perpendiculars")
    u = given("m/s", "forward speed through the water")

    @v_due.equals
    def steady(self):
        """Passenier (1989), eq. (2.60)."""
        return -self.gamma * self.L * self.r

    @v.rate
    def late(self):
        """Assumed: a lag of 0.6 ship lengths."""
        return (self.v_due - self.v) * self.u / (0.6 * self.L)


truth = shipid.join("container-ship", DeKeizer, LateSway, PlanarMotion)


@dataclass(frozen=True)
class Setting:
    """What is assumed of the ship and of the human being.

    Attributes
    ----------
    delay : float
        From the decision to the wheel in s.
    scatter : float
        Standard deviation of the wheel-over distance, as a share of it.
    cubic : float
        Cubic damping of the ship.
    disturbed : bool
        Whether current and wind act.
    wind_known : bool
        Whether the predictor is told the wind (3.79), as it is told the current.
    """

    delay: float = 5.0
    scatter: float = 0.1
    cubic: float = 2.0
    disturbed: bool = True
    wind_known: bool = False


@functools.cache
def pilot_of() -> Autopilot:
    """Return the autopilot, tuned on the printed K* and tau*."""
    return shipid.design_autopilot("de-keizer-minimal", SHIP, design="pole", damping=0.85, rudder_limit="10 deg")


@functools.cache
def coefficients(setting: Setting) -> dict[str, float]:
    """Return the coefficients of the ship that sails."""
    return {"K": 1.6, "tau": 1.7, "alpha1": 1.0, "alpha3": setting.cubic, "K_u": 0.9, "tau_u": 2.5, "gamma": 0.573}


def steered(setting: Setting, x: float, y: float, psi: float) -> SimulatedShip:
    """Return the ship at a place, in the disturbances of the experiment."""
    inputs = {}
    if setting.disturbed:
        inputs = {
            "current_north": CURRENT[0] * np.cos(CURRENT[1]), "current_east": CURRENT[0] * np.sin(CURRENT[1]),
            "wind_speed": WIND[0], "wind_direction": WIND[1],
        }  # fmt: skip
    return SimulatedShip(
        pilot_of(), model=truth, ship=sailing_ship(), start={"x": x, "y": y, "psi": psi}, values=coefficients(setting), inputs=inputs,
        parts=(Wind,) if setting.disturbed else (),
    )  # fmt: skip


@functools.cache
def sailing_ship() -> shipid.ParameterSet:
    """Return the ship with a section for its late sway."""
    known = SHIP
    return replace(known, sections={**known.sections, "late-sway": {"gamma": known.sections["de-keizer"]["gamma"]}})


def legs_of(track: str) -> list[TrackLeg]:
    """Return the legs of a track, the first to the north; the sides of the changes alternate, to starboard first."""
    return EXPERIMENT.legs(track)


@functools.cache
def still_water_turn(change: float, setting: Setting) -> tuple[float, np.ndarray]:
    """Return where the wheel goes over before the waypoint in still water, in m, and the turn of the ship herself."""
    return EXPERIMENT.still_water_turn(change, steered(replace(setting, disturbed=False), 0.0, 0.0, 0.0))


@functools.cache
def reference(track: str, setting: Setting) -> np.ndarray:
    """Return the reference trajectory: legs joined by the ship's own still-water turn with 10 degrees of rudder, shape (N, 2)."""
    return EXPERIMENT.reference(track, lambda: steered(replace(setting, disturbed=False), 0.0, 0.0, 0.0)).line


@dataclass
class Navigator:
    """The human being: looks at the leg once a minute, puts the wheel over when he thinks it is time, and reacts late.

    Attributes
    ----------
    condition : {"A", "B", "C"}
        Planned track only; with the ground-speed vector; with the track predictor.
    """

    condition: str
    legs: list[TrackLeg]
    setting: Setting
    predictor: TrackPredictor
    random: np.random.Generator
    leg: int = 0
    turning: bool = False
    crab: float = 0.0
    looked: float = -1e9
    before: tuple[float, float] | None = None
    due: float = np.inf
    scatter: float | None = None
    correction: float = 0.0
    history: list[tuple[float, float]] = field(default_factory=list)

    def steer(self, t: float, situation: Situation) -> tuple[float, float]:
        """Return the heading and the rudder limit he has set."""
        v, leg = situation.values, self.legs[self.leg]
        psi = v["psi"]
        if not self.turning and self.leg + 1 < len(self.legs) and self.due == np.inf and self._wheel_over(situation):
            self.due = t + self.setting.delay
        if t >= self.due:
            self.leg, self.turning, self.due, self.scatter = self.leg + 1, True, np.inf, None
            leg, self.crab, self.correction, self.before = self.legs[self.leg], 0.0, 0.0, None
            if self.condition == "C":
                self.crab = heading_on(leg, situation.current, v["cruise"]) - leg.course
        aim = unwrapped(leg.course, psi)
        if self.turning:
            if self.condition == "C" and t - self.looked >= 20:
                self.looked = t
                track = self.predictor.predict(
                    situation, heading=leg.course + self.crab, rudder_limit=LIMIT, points=200, band="none"
                )
                end = int(np.argmax(np.abs(track.psi - track.psi[-1]) < 2 * DEG))
                off = float(leg.across(track.x[end], track.y[end]))
                self.correction = float(np.clip(-np.arctan2(off, AIM * self.predictor.length), -10 * DEG, 10 * DEG))
            if abs(aim + self.crab - psi) < 5 * DEG:
                self.turning, self.looked, self.correction = False, t, 0.0
        elif t - self.looked >= LOOK:
            self.looked = t
            self._look(situation, leg, t)
        return aim + self.crab + self.correction, LIMIT

    def _wheel_over(self, situation: Situation) -> bool:
        leg, following = self.legs[self.leg], self.legs[self.leg + 1]
        v = situation.values
        left = leg.along(following.x, following.y) - leg.along(v["x"], v["y"])
        if left > 14 * self.predictor.length:
            return False
        if self.condition == "C":
            return wheel_over(self.predictor, situation, following, rudder_limit=LIMIT).distance <= 0
        distance, _ = still_water_turn(abs(following.course - leg.course), self.setting)
        if self.scatter is None:
            self.scatter = float(1 + self.setting.scatter * self.random.standard_normal())
        ratio = np.hypot(*situation.ground_velocity) / v["u"] if self.condition == "B" else 1.0
        return bool(left <= distance * self.scatter * ratio)

    def _look(self, situation: Situation, leg: TrackLeg, t: float) -> None:
        v = situation.values
        across = leg.across(v["x"], v["y"])
        back = -np.arctan2(across, AIM * self.predictor.length)
        if self.condition == "A":
            # How the distance from the leg has changed since he looked last says at what angle he sails to it; half of what is
            # wrong with it goes into the heading, since the ship answers slowly. Without a vector he aims twice as far ahead.
            if self.before is not None:
                angle = (across - self.before[1]) / ((t - self.before[0]) * v["u"])
                wanted = -np.arctan2(across, 2 * AIM * self.predictor.length)
                self.crab = float(np.clip(self.crab + 0.5 * (wanted - angle), -0.4, 0.4))
            self.before = (t, across)
            return
        north, east = situation.ground_velocity
        drift = np.arctan2(east, north) - v["psi"]
        self.crab = float(-np.arctan2(np.sin(drift), np.cos(drift)))
        self.correction = float(back)


def voyage(track: str, condition: str, seed: int, setting: Setting, predictor: TrackPredictor) -> np.ndarray:
    """Sail a track; return time, position, leg and rate of turn every 2 s, shape (N, 5)."""
    legs = legs_of(track)
    current = (CURRENT[0] * np.cos(CURRENT[1]), CURRENT[0] * np.sin(CURRENT[1])) if setting.disturbed else (0.0, 0.0)
    begin = heading_on(legs[0], current, 9.5) if condition != "A" else 0.0
    ship = steered(setting, 0.0, 0.0, begin)
    random = np.random.default_rng([seed, int(track[1])])
    navigator = Navigator(condition, legs, setting, predictor, random)
    pilot = TrackPilot(predictor, PlannedTrack(tuple(legs), reference(track, setting)), rudder_limit=LIMIT)
    rows = []
    while ship.t < 6000:
        now = ship.now
        situation = Situation({
            **{n: now[n] for n in ("x", "y", "psi", "r", "u", "v", "delta")}, "cruise": 9.5,
            "current_north": current[0], "current_east": current[1],
            **({"wind_speed": WIND[0], "wind_direction": WIND[1]} if setting.wind_known else {}),
        })  # fmt: skip
        if condition == "D":
            order = pilot.steer(situation, TICK)
            heading, limit, leg = order.heading, order.rudder_limit, order.leg
        else:
            heading, limit = navigator.steer(ship.t, situation)
            leg = navigator.leg
        rows.append((ship.t, now["x"], now["y"], leg, now["r"]))
        last = legs[-1]
        if leg == len(legs) - 1 and last.along(now["x"], now["y"]) > 0.9 * LEG:
            break
        ship.advance(TICK, heading, limit)
    return np.array(rows)
