"""Tracks as a result: where each target is and was, how sure that is, and how close she comes to own ship."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import compass
from shipid.encounter.closest_approach import ClosestApproach
from shipid.encounter.plots.plots import Plots
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.scoring import TrackingScore
from shipid.encounter.tracking.target_track import COLUMNS, TargetTrack
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import fixed
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Tracking(DrawnResult):
    """The tracks of a log; made by `track`.

    Attributes
    ----------
    name : str
        Of the log.
    tracker : str
        Which tracker.
    modes : tuple of str
        Labels along the mode probabilities.
    tracks : sequence of TargetTrack
        The confirmed ones, by number.
    plots : Plots
        What they were made from.
    latency : mapping of str to (float, float)
        Latency of each sensor and its standard deviation, s.
    own : ShipPath or None
        Own ship.
    relative : bool
        Whether positions and velocities are relative to own ship.
    truth : tuple of ShipPath
        The true tracks, where they are known.
    score : TrackingScore or None
        How the tracks compare with them.
    warnings : tuple of Notice
        What limits the result.
    """

    name: str
    tracker: str
    modes: tuple[str, ...]
    tracks: Sequence[TargetTrack]
    plots: Plots
    latency: Mapping[str, tuple[float, float]]
    own: ShipPath | None = None
    relative: bool = False
    truth: tuple[ShipPath, ...] = ()
    score: TrackingScore | None = None
    warnings: tuple[Notice, ...] = ()

    def to_frame(self) -> pd.DataFrame:
        """Return the tracks as a pandas table, one row a track and scan, SI; ``attrs["units"]`` holds the units."""
        import pandas as pd

        parts = [
            one.to_frame().assign(**{f"mode_{label}": one.mu[:, k] for k, label in enumerate(self.modes)})
            for one in self.tracks
        ]
        empty = pd.DataFrame({name: np.zeros(0) for name in [*COLUMNS, *(f"mode_{m}" for m in self.modes)]})
        frame = pd.concat(parts, ignore_index=True) if parts else empty
        frame.attrs["units"] = {**COLUMNS, **{f"mode_{m}": "1" for m in self.modes}}
        return frame

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, free of NaN: each track as it stands at its end."""
        first, last = self.plots.span
        return {
            "name": self.name,
            "tracker": self.tracker,
            "modes": list(self.modes),
            "plots": len(self.plots),
            "scans": len(self.plots.scans),
            "span": {"value": last - first, "unit": "s"},
            "frame": self.plots.frame,
            "relative": self.relative,
            "latency": {name: {"value": value, "unit": "s", "std": std} for name, (value, std) in self.latency.items()},
            "tracks": [self._plain(one) for one in self.tracks],
            "score": None if self.score is None else self.score.to_dict(),
            "warnings": plain_notices(self.warnings),
        }

    def _plain(self, one: TargetTrack) -> dict[str, Plain]:
        spread = np.sqrt(np.maximum(np.diagonal(one.P[-1]), 0.0))
        values = (*one.x[-1], one.speed[-1], one.course[-1], one.turn_rate[-1])
        names = ("x", "y", "vx", "vy", "SOG", "COG", "turn_rate")
        known: dict[str, Plain] = {n: {"value": float(v), "unit": COLUMNS[n]} for n, v in zip(names, values)}
        for name, std in zip(names, (*spread, one.speed_std[-1], one.course_std[-1])):
            known[name]["std"] = float(std)
        return {
            "number": one.number,
            "status": one.status,
            "first": {"value": float(one.t[0]), "unit": "s"},
            "last": {"value": float(one.t[-1]), "unit": "s"},
            "existence": float(one.existence[-1]),
            "moves": bool(one.moves[-1]),
            "widening": float(one.widening[-1]),
            "state": known,
            "mode_probabilities": dict(zip(self.modes, map(float, one.mu[-1]))),
            "closest_approach": None if one.approach is None else _plain_approach(one.approach),
        }

    @property
    def nearest_words(self) -> str:
        """Which track that is held comes nearest to own ship, or lies nearest where none comes nearer, in words."""
        near = [(o.number, o.approach) for o in self.tracks if o.status == "held" and o.approach is not None]
        closing = [(n, a) for n, a in near if a.motion == "closing"]
        if closing:
            number, first = min(closing, key=lambda pair: pair[1].nearest)
            ends = first.nearest_interval
            between = "" if ends is None else f", between {fixed(ends[0], 0)} and {fixed(ends[1], 0)} m with 95 %"
            return (
                f"track {number} comes nearest to own ship: {fixed(first.nearest, 0)} m within the next hour{between}"
            )
        if near:
            number, first = min(near, key=lambda pair: pair[1].range)
            surely = "surely " if any(a.motion == "unsure" for _, a in near) else ""
            return f"no track that is held {surely}comes nearer to own ship; track {number} is the nearest, at {fixed(first.range, 0)} m"
        return "the closest approach is not known"

    def text(self) -> str:
        """Return the result in lines of text."""
        first, last = self.plots.span
        held = sum(one.status == "held" for one in self.tracks)
        lines = [
            f"tracks of {self.name} ({self.tracker}): {len(self.tracks)} confirmed, {held} held at the end; "
            f"{_many(len(self.plots), 'plot')} in {_many(len(self.plots.scans), 'scan')}, {last - first:.0f} s"
        ]
        if self.tracks:
            ends = "relative to own ship" if self.relative else f"from {self.plots.frame}"
            what = "positions and speeds" if self.relative else "positions in m,"
            lines.append(f"  {what} {ends}, at the end of each track")
            heads = ("track", "status", "from [s]", "to [s]", "north [m]", "east [m]", "± [m]", "speed [m/s]", "± [m/s]", "course [deg]", "CPA [m]", "CPA 95 % [m]", "TCPA [s]")  # fmt: skip
            rows = [heads, *(self._row(one) for one in self.tracks)]
            widths = [max(len(r[i]) for r in rows) for i in range(len(heads))]
            lines += ["  " + "  ".join(c.rjust(w) for c, w in zip(r, widths)) for r in rows]
        if any(one.approach is not None for one in self.tracks):
            lines.append(f"  {self.nearest_words}")
        if self.score is not None:
            lines += [f"  {line}" for line in self.score.text().splitlines()]
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings)])

    def _row(self, one: TargetTrack) -> tuple[str, ...]:
        near = one.approach
        cpa = (
            ("not known", "", "")
            if near is None
            else (
                "not known" if near.motion == "unsure" else f"{near.cpa:.0f}",
                _ends(near.cpa_interval),
                f"{near.tcpa:.0f}" if np.isfinite(near.tcpa) else near.motion,
            )
        )
        spread = float(np.sqrt(max(one.P[-1, 0, 0] + one.P[-1, 1, 1], 0.0)))
        # What may lie still has no course.
        course = compass(one.course[-1], 0) if one.moves[-1] else "none"
        return (
            str(one.number), one.status, f"{one.t[0]:.0f}", f"{one.t[-1]:.0f}", f"{one.x[-1, 0]:.0f}", f"{one.x[-1, 1]:.0f}",
            f"{spread:.0f}", f"{one.speed[-1]:.1f}", f"{one.speed_std[-1]:.1f}", course, *cpa,
        )  # fmt: skip


def _ends(interval: tuple[float, float] | None) -> str:
    return "" if interval is None else f"{interval[0]:.0f} to {interval[1]:.0f}"


def _many(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"


def _plain_approach(near: ClosestApproach) -> dict[str, Plain]:
    """The closest approach with units; what is not known is null."""

    def known(value: float, unit: str, std: float | None, interval: tuple[float, float] | None) -> dict[str, Plain]:
        ends = None if interval is None else [float(end) for end in interval]
        return {"value": plain(value), "unit": unit, "std": std, "interval_95": ends}

    return {
        "motion": near.motion,
        "range": {"value": near.range, "unit": "m"},
        "relative_speed": {"value": near.relative_speed, "unit": "m/s"},
        "cpa": known(near.cpa, "m", near.cpa_std, near.cpa_interval),
        "tcpa": known(near.tcpa, "s", near.tcpa_std, near.tcpa_interval),
        "nearest": known(near.nearest, "m", None, near.nearest_interval),
    }
