"""A prediction as a result: the track, what it began from, and where the ship is at each stage of her turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.declaration.vocabulary import compass, shown, shown_estimate
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.result import DrawnResult, ResultEntry
from shipid.prediction.charts.chart import Chart
from shipid.prediction.following.wheel_over import WheelOver
from shipid.prediction.routes.route_turn import RouteTurn
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.order import unwrapped
from shipid.prediction.tracks.predicted_track import PredictedTrack

if TYPE_CHECKING:
    import pandas as pd

#: The stages of a turn in degrees of heading; and of a straight track, in ship lengths.
_STAGES, _LENGTHS = (10, 30, 60, 90, 120, 150, 180, 270, 360), (2, 5, 10, 15, 20)
#: A ship is on her new heading when she is so near to it, in degrees.
_ON_HEADING = 1.0
#: Sine of the angle between heading and course over the ground that is told: it turns what ahead means.
_BESIDE = np.sin(np.deg2rad(2.0))


@dataclass(frozen=True, repr=False)
class Stage(ResultEntry):
    """Where the ship is when she has turned so far; SI.

    Attributes
    ----------
    what : str
        The stage in words.
    t, s : float
        Time and distance sailed since the order.
    ahead, aside : float
        Position from where she was, ahead and to starboard of her course over the ground then, in m.
    heading, speed : float
        Then.
    half_width : float or None
        Of the 95 % band across the track, in m.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "t": "s",
        "s": "m",
        "ahead": "m",
        "aside": "m",
        "heading": "rad",
        "speed": "m/s",
        "half_width": "m",
    }

    what: str
    t: float
    s: float
    ahead: float
    aside: float
    heading: float
    speed: float
    half_width: float | None

    @property
    def band_words(self) -> str:
        """The half width of the band in whole metres, at least one."""
        if self.half_width is None:
            return "not known"
        return f"± {self.half_width:.0f}" if self.half_width >= 0.5 else "below ± 1"


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(DrawnResult):
    """A predicted track and what it began from; made by `predict_track`.

    Attributes
    ----------
    ship, model : str
        Whose track, and by which model.
    situation : Situation
        What was known of the ship.
    track : PredictedTrack
        Where she goes.
    origin : str
        Where the situation comes from, in words.
    units : mapping of str to str
        Of the values of the situation, SI.
    wheel_over : WheelOver or None
        Where the turn onto a planned leg begins, where one was given.
    warnings : tuple of Notice
        What limits it.
    turn : RouteTurn or None
        The next turn of a route, where one was given.
    chart : Chart or None
        What is drawn below the track.
    """

    ship: str
    model: str
    situation: Situation
    track: PredictedTrack
    origin: str
    units: Mapping[str, str] = field(default_factory=dict)
    wheel_over: WheelOver | None = None
    warnings: Sequence[Notice] = ()
    turn: RouteTurn | None = None
    chart: Chart | None = None

    @property
    def current_words(self) -> str | None:
        """The current with its uncertainty; one that may as well be none has no direction. None where none is known."""
        (north, east), std = self.situation.current, self.situation.current_std
        speed = float(np.hypot(north, east))
        if not speed:
            return None
        said = f"current {shown(speed, 'u', digits=3) if std is None else shown_estimate(speed, std, 'u')}"
        if std is not None and speed < 2 * std:
            return f"{said}, direction not known"
        return f"{said} to {compass(np.arctan2(east, north), 0)} deg"

    @property
    def surrounding_words(self) -> list[str]:
        """Current and wind, and which way ahead is where a current or a drift sets the ship beside her heading."""
        known = self.situation.values
        said = [] if self.current_words is None else [self.current_words]
        speed = known.get("wind_speed")
        if speed:
            said.append(
                f"wind {shown(speed, 'u', digits=3)} from {compass(known.get('wind_direction', 0.0) + np.pi, 0)} deg"
            )
        if abs(np.sin(self.course - known["psi"])) > _BESIDE:
            said.append(f"ahead and aside are told along the course over the ground, {compass(self.course)} deg")
        return said

    @property
    def course(self) -> float:
        """The course over the ground at the beginning in rad."""
        north, east = self.situation.ground_velocity
        return float(np.arctan2(east, north))

    @property
    def stages(self) -> list[Stage]:
        """The stages of the turn, or of the distance where the ship hardly turns; the end of the track last."""
        track = self.track
        change = np.rad2deg(track.psi - track.psi[0])
        # To the side of the order: a ship that still turned to the other side goes on there for a while.
        turned = change * (np.sign(change[-1]) or 1.0)
        found: list[tuple[str, int]] = []
        if turned.max() >= _STAGES[0]:
            wanted = track.order.heading
            final = np.inf if wanted is None else abs(np.rad2deg(_end_of(track) - track.psi[0]))
            found += [
                (f"turned {angle} deg", int(np.argmax(turned >= angle)))
                for angle in _STAGES
                if turned.max() >= angle and angle < final - _ON_HEADING
            ]
            if wanted is not None:
                left = np.abs(np.rad2deg(track.psi - _end_of(track)))
                settled = _last_stretch(left <= _ON_HEADING)
                if settled is not None:
                    found.append(("on the new heading", settled))
        else:
            found += [
                (f"{n} ship lengths", int(np.searchsorted(track.s_star, n))) for n in _LENGTHS if track.s_star[-1] > n
            ]
        found.append(("end of the track", track.s.size - 1))
        found.sort(key=lambda stage: stage[1])
        course, width = self.course, track.half_width
        stages = []
        for what, k in found:
            away = track.x[k] - track.x[0], track.y[k] - track.y[0]
            stages.append(
                Stage(
                    what,
                    float(track.t[k]),
                    float(track.s[k]),
                    float(away[0] * np.cos(course) + away[1] * np.sin(course)),
                    float(-away[0] * np.sin(course) + away[1] * np.cos(course)),
                    float(track.psi[k]),
                    float(track.u[k]),
                    None if width is None else float(width[k]),
                )
            )
        return stages

    def to_frame(self) -> pd.DataFrame:
        """Return the track as a pandas table, one row a node."""
        return self.track.to_frame()

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, SI, free of NaN."""
        known = self.situation
        return {
            "ship": self.ship,
            "model": self.model,
            "origin": self.origin,
            "situation": {
                "t": _plain(known.t, "s"),
                **{n: _plain(v, self.units.get(n, ""), known.told_std(n)) for n, v in known.values.items()},
            },
            "stages": [
                {
                    "what": s.what,
                    "t": _plain(s.t, "s"),
                    "s": _plain(s.s, "m"),
                    "ahead": _plain(s.ahead, "m"),
                    "aside": _plain(s.aside, "m"),
                    "heading": _plain(s.heading, "rad"),
                    "speed": _plain(s.speed, "m/s"),
                    "half_width_95": None if s.half_width is None else _plain(s.half_width, "m"),
                }
                for s in self.stages
            ],
            "current": _plain_current(known),
            "past_predictions": None if known.past is None else known.past.to_dict(),
            "wheel_over": None if self.wheel_over is None else self.wheel_over.to_dict(),
            "route": None if self.turn is None else self.turn.to_dict(),
            "chart": None if self.chart is None else self.chart.name,
            "prediction": self.track.to_dict(),
            "warnings": plain_notices(self.warnings),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        begin = [("heading", "psi"), ("forward speed", "u"), ("rate of turn", "r")]
        said = [f"{what} {self.situation.told_in_words(n)}" for what, n in begin if n in self.situation.values]
        lines = [
            f"predicted track of {self.ship} ({self.model}): {self.track.order}",
            f"  from {self.origin}: {', '.join(said)}",
        ]
        lines += [f"  {line}" for line in self.surrounding_words]
        if self.wheel_over is not None:
            lines.append(f"  {_wheel_over_words(self.wheel_over)}")
        if self.turn is not None:
            lines += [f"  {line}" for line in self.turn.words]
        heads = ("", "t [s]", "ahead [m]", "aside [m]", "heading [deg]", "speed [m/s]", "95 % band [m]")
        rows = [heads] + [
            (
                s.what, f"{s.t:.0f}", f"{s.ahead:.0f}", f"{s.aside:.0f}", compass(s.heading),
                f"{s.speed:.2f}", s.band_words,
            )
            for s in self.stages
        ]  # fmt: skip
        widths = [max(len(r[i]) for r in rows) for i in range(len(heads))]
        lines += [
            "  " + "  ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(r, widths)))
            for r in rows
        ]
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings)])


def _plain(value: float, unit: str, std: float = 0.0) -> dict[str, Plain]:
    known: dict[str, Plain] = {"value": float(value), "unit": unit}
    return known | ({"std": std} if std else {})


def _end_of(track: PredictedTrack) -> float:
    """The ordered heading as it continues the ship's own."""
    assert track.order.heading is not None
    return unwrapped(track.order.heading, float(track.psi[0]))


def _last_stretch(good: np.ndarray) -> int | None:
    """Where the stretch of True at the end begins; None where there is none."""
    if not good[-1]:
        return None
    bad = np.flatnonzero(~good)
    return int(bad[-1] + 1) if bad.size else 0


def _wheel_over_words(found: WheelOver) -> str:
    heading = f"{compass(found.heading)} deg"
    if found.due:
        return f"wheel-over to {heading}: passed by {-found.distance:.0f} m"
    soon = ": warning, less than a minute" if found.warning else ""
    return f"wheel-over to {heading} in {found.time:.0f} s, {found.distance:.0f} m ahead{soon}"


def _plain_current(known: Situation) -> dict[str, Plain]:
    return {
        name: {"value": value, "unit": "m/s", "std": known.current_std}
        for name, value in zip(("north", "east"), known.current)
    }
