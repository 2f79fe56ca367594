"""The own ship as the filter of her model knows her, sample by sample; a lost sensor does not stop it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, TypeAlias

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.own_ship.gate_watch import REFUSED, GateWatch
from shipid.bridge.own_ship.remembered import Remembered
from shipid.bridge.own_ship.sensors import Sensors
from shipid.bridge.shown.plain_values import number
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.online.online_estimate import OnlineEstimate
from shipid.estimation.online.online_filter import OnlineFilter
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.generation.simulator import UnstatedInputError
from shipid.identification.problem.prior import INDEPENDENT
from shipid.prediction.situations.filtered_situation import situation_now
from shipid.prediction.situations.fix_errors import (
    CURRENT,
    MOVE_REMEMBERED,
    TURN_REMEMBERED,
    CurrentMoves,
    FixErrors,
    widened_current,
)
from shipid.prediction.situations.own_ship_filter import own_ship_filter
from shipid.prediction.situations.situation import Situation

#: How the filter does.
Health: TypeAlias = Literal["starting", "well", "doubtful", "diverged", "lost"]
#: The coefficients that adapt, where the model has them.
_ADAPTS = ("K", "tau")
#: For so many seconds the filter starts.
_STARTING = 20.0
#: After it has diverged the filter says so for this long, in s.
_AFTERMATH = 60.0
#: The cruising speed follows the speed with this time constant in L/U while the ship goes straight, with r L/u below this.
_CRUISE, _STRAIGHT = 12.5, 0.0125
#: The coefficients adapt while r L/u is larger than this, as Passenier (1989) lets them in manoeuvres only.
_TURNING = 0.05
#: Relative standard deviations up to which a coefficient is determined, and weakly determined.
_DETERMINED, _WEAKLY = 0.1, 0.3
#: A position that moves so many standard deviations of a fix, and a ship length, farther than the ship sails has jumped.
_JUMP = 10.0
#: Fixes are taken so many seconds apart, as in Passenier (1989), section 5.4: the errors of fixes that come faster are the same ones.
_FIXES_APART = 2.0
#: Names of coefficients as they are printed.
_GREEK = {"tau": "τ", "alpha": "α", "gamma": "γ", "beta": "β"}


class OwnShip:
    """The own ship's state and surroundings, estimated.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the ship and her model, which has a position and a heading.

    Attributes
    ----------
    sensors : Sensors
        What is heard of her.
    message : str
        What there is to say of the filter.
    diverged_by : str
        Why it began anew the last time.
    remembered : Remembered
        The voyage so far.
    """

    def __init__(self, pilot: Autopilot) -> None:
        model = pilot.model
        adapts = [n for n in _ADAPTS if n in model.parameters]
        self._kalman = own_ship_filter(model, pilot.ship, estimated=adapts, switchable=bool(adapts))
        self._levels = dict(zip(self._kalman.design.measured, self._kalman.design.r.tolist()))
        self._fixes: tuple[FixErrors, CurrentMoves] | None = None
        #: The largest rate of turn of late, |r| L/u, and when it was.
        self._turned = 0.0, 0.0
        self._adapts = bool(adapts)
        self._pilot = pilot
        self.sensors, self.remembered = Sensors(), Remembered(pilot.length)
        self.message = self.diverged_by = ""
        self._online: OnlineFilter | None = None
        self._first: dict[str, float] = {}
        self._estimate: OnlineEstimate | None = None
        self._situation: Situation | None = None
        self._began = self._diverged = self._fixed = -math.inf
        self._jump, self._placed = (-math.inf, 0.0), False
        self._t = 0.0
        self._logged = False
        self._gate = GateWatch()
        self._cruise: float | None = None

    @property
    def length(self) -> float:
        """Length of the ship in m."""
        return self._pilot.length

    @property
    def situation(self) -> Situation | None:
        """What is known of her; None before the filter has begun, or where she makes no way ahead."""
        return self._situation

    @property
    def placed(self) -> bool:
        """Whether a fix was ever heard: before the first one her place is reckoned from nowhere."""
        return self.sensors.value("x") is not None

    @property
    def jumped(self) -> float | None:
        """How far the position has jumped in m, for a minute after it; None where it has not."""
        when, how_far = self._jump
        return how_far if self._t - when < _AFTERMATH else None

    def take(self, t: float, values: Mapping[str, float]) -> None:
        """Take what was heard up to a time, also where that is nothing.

        Parameters
        ----------
        t : float
            In s on the bridge's clock, later than the time before.
        values : mapping of str to float
            By the names of a trial's columns, SI.
        """
        step, self._t = t - self._t, t
        if not all(math.isfinite(values.get(n, math.nan)) for n in ("x", "y")):
            # Half a fix is none.
            values = {n: v for n, v in values.items() if n not in ("x", "y")}
        self.sensors.take(t, values)
        sample = self._sample(values)
        if self._online is None:
            self._first |= sample
            if not self._begin(t):
                return
        else:
            self._update(t, sample)
        self._look(step)

    def _sample(self, values: Mapping[str, float]) -> dict[str, float]:
        """What the filter takes of what was heard."""
        sample = {n: float(v) for n, v in values.items() if math.isfinite(v)}
        heard = self.sensors.value
        if "delta_order" in sample and heard("delta") is None:
            sample["delta"] = sample["delta_order"]
        if "u" not in sample and "SOG" in sample and heard("u") is None:
            sample["u"] = sample["SOG"]
        # Beside a speed over the ground nothing shows a current.
        self._logged = heard("u") is not None
        if "u" in sample and not sample["u"] > 0 and self._online is None:
            del sample["u"]
        if self._online is not None and {"x", "y"} & set(sample):
            if self._t - self._fixed < _FIXES_APART - 1e-6:
                sample = {n: v for n, v in sample.items() if n not in ("x", "y")}
            else:
                self._fixed = self._t
        if self._cruise is not None:
            sample["cruise"] = self._cruise
        return sample

    def _begin(self, t: float) -> bool:
        """Begin the filter once all that it needs was heard; return whether it has begun."""
        still = any(self.sensors.value(n) is not None for n in ("u", "SOG"))
        needed = {"psi": "heading", "u": "way ahead" if still else "speed", "delta": "rudder angle"}
        lacking = [label for name, label in needed.items() if name not in self._first]
        if lacking:
            self.message = f"waiting for the {' and the '.join(lacking)}"
            return False
        self._online = self._kalman.start()
        self._cruise = self._first["u"]
        try:
            self._update(t, {**self._first, "cruise": self._cruise})
        except UnstatedInputError as error:
            self._online, self.message = None, str(error)
            return False
        self._began, self.message = t, ""
        return True

    def _update(self, t: float, sample: Mapping[str, float]) -> None:
        assert self._online is not None
        try:
            estimate = self._online.update({"t": t, **sample}, adapt=not self._adapts or self._turns)
        except FilterDivergedError as error:
            self._restart(t, str(error))
            return
        if self._gate.refuses_the_heading(t, estimate):
            why = f"for {REFUSED:.0f} s the heading that is heard was not what follows from the one before; it is believed from here on"
            self._restart(t, why)
            return
        if not estimate.refused:
            before, self._estimate = self._situation, estimate
            self._situation = self._known()
            self._watch_for_a_jump(before, t, sample)
            self._fix(t, sample)
            if self._situation is not None and self.health == "well":
                self.remembered.add(self._situation)

    def _watch_for_a_jump(self, before: Situation | None, t: float, sample: Mapping[str, float]) -> None:
        """Notice a position that moves farther than the ship can: the filter has come to believe in fixes that lie elsewhere."""
        known = self._situation
        if known is None or not {"x", "y"} <= set(sample):
            return
        placed, self._placed = self._placed, True
        if before is None or not placed or "x" not in self._levels:
            return
        sailed = [v * (known.t - before.t) for v in before.ground_velocity]
        moved = math.hypot(*(known.values[n] - before.values[n] - d for n, d in zip(("x", "y"), sailed)))
        if moved > self.length + _JUMP * self._levels["x"]:
            self._jump = t, moved
            self.remembered.forget()  # what was predicted before begins elsewhere

    def _fix(self, t: float, sample: Mapping[str, float]) -> None:
        """Hold a fix against the estimate, and the current as unsure as the fixes are."""
        known = self._situation
        if known is None or not {"x", "y"} <= set(self._levels):
            return
        unit_time = self._pilot.length / known.values["u"]
        if self._fixes is None:
            self._fixes = FixErrors(INDEPENDENT * unit_time), CurrentMoves(MOVE_REMEMBERED * unit_time)
            self._turned = 0.0, t
        errors, moves = self._fixes
        most, since = self._turned
        now = abs(known.values.get("r", 0.0)) * unit_time
        if now >= most or t - since > TURN_REMEMBERED * unit_time:
            self._turned = now, t
        if "x" in sample and "y" in sample:
            # A receiver that has jumped may err again, but how far it was off says nothing of how far it will be.
            off = [(sample[n] - known.values[n]) / self._levels[n] for n in ("x", "y")]
            errors.add(t, *np.clip(off, -_JUMP, _JUMP))
        moved = moves.add(known) if set(CURRENT) <= set(known.uncertain) else 0.0
        self._situation = widened_current(known, errors.squares, self._turned[0], moved)

    @property
    def _turns(self) -> bool:
        """Whether she turns fast enough to tell what her coefficients are: on a straight course an estimate only drifts."""
        known = self._situation
        if known is None:
            return False
        return abs(known.values.get("r", 0.0)) * self._pilot.length > _TURNING * known.values["u"]

    def _restart(self, t: float, why: str) -> None:
        self._online, self._situation, self._estimate = None, None, None
        self._first, self._fixes, self._placed = {}, None, False
        self.remembered.forget()
        self._gate.begin_anew()
        self._diverged, self.message, self.diverged_by = t, why, why

    def _known(self) -> Situation | None:
        assert self._online is not None
        try:
            return situation_now(self._online)
        except UsageError as error:
            self.message = str(error)
            return None

    def _look(self, step: float) -> None:
        """Follow the cruising speed, and the share of samples that are beyond the gate."""
        if self._estimate is None:
            return
        self._gate.look(self._t, self._estimate)
        known = self._situation
        if known is None or self._cruise is None:
            return
        unit_time = self._pilot.length / known.values["u"]
        if "u" in self.sensors.lost or abs(known.values.get("r", 0.0)) * unit_time > _STRAIGHT:
            return
        self._cruise += min(step / (_CRUISE * unit_time), 1.0) * (known.values["u"] - self._cruise)

    @property
    def rejected(self) -> float:
        """Share of the recent samples that is beyond the gate."""
        return self._gate.rejected

    @property
    def starting(self) -> bool:
        """Whether the filter has begun a moment ago: a rate of turn read once or twice passes for a moment as of ten degrees of rudder."""
        return self._t - self._began < _STARTING

    @property
    def health(self) -> Health:
        """How the filter does."""
        if self._t - self._diverged < _AFTERMATH:
            return "diverged"
        if self._online is None:
            return "starting"
        if "psi" in self.sensors.lost:
            return "lost"
        if self.starting:
            return "starting"
        return "doubtful" if self._gate.many or self._situation is None else "well"

    def value(self, name: str) -> float | None:
        """Return an estimate, SI; None where there is none.

        Parameters
        ----------
        name : str
            A quantity of the situation.
        """
        return None if self._situation is None else self._situation.values.get(name)

    def to_dict(self) -> dict[str, Plain]:
        """Return what the page shows as the own ship, SI."""
        known, lost = self._situation, self.sensors.lost
        found: dict[str, float | None] = dict.fromkeys(("x", "y", "psi", "r", "u", "v", "stw", "sog", "cog"))
        if known is not None:
            found |= {n: known.values.get(n) for n in ("x", "y", "psi", "r", "u", "v")}
            north, east = known.ground_velocity
            found["stw"] = math.hypot(known.values["u"], known.values.get("v", 0.0))
            found["sog"], found["cog"] = math.hypot(north, east), math.atan2(east, north) % (2 * math.pi)
        delta, order = self.sensors.fresh("delta"), self.sensors.fresh("delta_order")
        places = {"x": "x", "y": "x", "psi": "psi", "r": "r", "u": "u", "stw": "u", "sog": "x", "cog": "x"}
        estimated = [n for n, sensor in places.items() if sensor in lost]
        return {
            **{n: number(v, 7) for n, v in found.items()},
            "delta": number(delta, 6),
            "delta_order": number(order, 6),
            "age": number(self.sensors.youngest, 4),
            "estimated": [*estimated, "v"] if self.sensors.fresh("v") is None else estimated,
        }

    def flow(self) -> dict[str, Plain]:
        """Return the current as it is estimated and the wind as it is measured, SI."""
        known, current = self._situation, None
        if known is not None and self._logged and "current_north" in known.values:
            north, east = known.current
            current = {
                "speed": number(math.hypot(north, east), 5),
                "direction_to": number(math.atan2(east, north) % (2 * math.pi), 5),
                "sd": number(known.current_std, 3),
            }
        return {"current": current, "wind": self._wind()}

    def _wind(self) -> dict[str, Plain] | None:
        """The true wind: as it is measured, or by the relative one and the ship's velocity over the ground."""
        speed, to = self.sensors.fresh("wind_speed"), self.sensors.fresh("wind_direction")
        measured = speed is not None and to is not None
        if not measured:
            relative, angle = self.sensors.fresh("wind_speed_relative"), self.sensors.fresh("wind_direction_relative")
            known = self._situation
            if relative is None or angle is None or known is None:
                return None
            north, east = known.ground_velocity
            blows = angle + known.values["psi"]
            north, east = north + relative * math.cos(blows), east + relative * math.sin(blows)
            speed, to = math.hypot(north, east), math.atan2(east, north)
        assert speed is not None and to is not None
        return {
            "speed": number(speed, 4),
            "direction_from": number((to + math.pi) % (2 * math.pi), 5),
            "measured": measured,
        }

    def adaptation(self) -> list[Plain]:
        """Return the coefficients that adapt, with their standard deviations."""
        if self._estimate is None:
            return []
        model = self._pilot.model
        return [
            {
                "name": name,
                "label": label_of(name, model[name].unit),
                "value": number(self._estimate[name], 5),
                "sd": number(self._estimate.std_of(name), 3),
                "unit": model[name].unit,
                "standing": standing_of(self._estimate[name], self._estimate.std_of(name)),
            }
            for name in self._kalman.parameters
        ]


def label_of(name: str, unit: str) -> str:
    """Return a coefficient's name as it is printed: with a star where it has no dimension.

    Parameters
    ----------
    name, unit : str
        Of the coefficient.
    """
    head = next((g for g in _GREEK if name.startswith(g)), None)
    printed = name if head is None else _GREEK[head] + name[len(head) :]
    return f"{printed}*" if unit == "1" else printed


def standing_of(value: float, std: float) -> str:
    """Return how well a coefficient is known, in a word or two.

    Parameters
    ----------
    value, std : float
        The estimate and its standard deviation.
    """
    share = std / max(abs(value), 1e-12)
    return "determined" if share <= _DETERMINED else "weakly determined" if share <= _WEAKLY else "not determined"
