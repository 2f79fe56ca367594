"""The classical plots of manoeuvring trials: the zig-zag with its overshoots, the turning circle with its dimensions, the spiral."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.report.figures.hull import outline
from shipid.report.figures.svg import BLUE, GREEN, MUTED, ORANGE, PAPER, WIDTH, legend, svg, thin, with_gaps
from shipid.trials.measuring.pull_out import PullOut
from shipid.trials.measuring.results.measures import Measures
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.measuring.spiral import MeasuredSpiral
from shipid.trials.measuring.track import smooth_track, track, turning_width
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEADING, _RUDDER, _MARK = BLUE, ORANGE, GREEN
#: Time between two ticks of a track in s: the first that gives no more than a dozen.
_TICKS = (10.0, 30.0, 60.0, 120.0, 300.0, 600.0)
_TEXT = 8.0
#: Points of the path of a turning circle; about the most marks of positions as logged, and the share of the figure by which they
#: have to lie beside the path to be shown.
_PATH, _FIXES, _SEEN = 400, 250, 0.003


def manoeuvre_figure(measures: Measures, record: Trial, length: float | None, key: str) -> Markup | None:
    """Return the plot that belongs to a manoeuvre as SVG, or None where the record does not hold what it shows.

    Parameters
    ----------
    measures : Measures
        Its numbers.
    record : Trial
        The part of the log it was measured in.
    length : float or None
        Ship length in m, for the outline of the ship.
    key : str
        Put before every id, so that several figures can stand in one page.
    """
    if isinstance(measures, ZigZag):
        return _zigzag(measures, record, key)
    if isinstance(measures, TurningCircle):
        return _circle(measures, record, length, key)
    if isinstance(measures, MeasuredSpiral):
        return _spiral(measures, key)
    return _pull_out(measures, record, key) if isinstance(measures, PullOut) and record.has("psi") else None


def _line(ax: Axes, t: np.ndarray, y: np.ndarray, label: str, **look: Plain) -> None:
    x, values = with_gaps(t, y)
    kept = thin(values)
    ax.plot(x[kept], values[kept], label=label, **look)


def _zigzag(zigzag: ZigZag, record: Trial, key: str) -> Markup | None:
    begin, course = zigzag.first_execute, zigzag.course
    if begin is None or course is None:
        return None
    t = record["t"] - begin
    heading = np.degrees(record["psi"] - course)
    # The record holds the ends of its neighbours too.
    moments = [e - begin for e in zigzag.executes or () if e is not None]
    last = moments[-1] if moments else float(t[-1])
    ends = max(float(t[0]), -0.1 * last), min(float(t[-1]), last + (last / max(len(moments), 1)))

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        _line(ax, t, heading, "heading", color=_HEADING, linewidth=1.5)
        for name, label, style in (("delta_order", "rudder order", ":"), ("delta", "rudder", "-")):
            if record.has(name):
                _line(ax, t, np.degrees(record[name]), label, color=_RUDDER, linewidth=1.1, linestyle=style)
        rows = zip(
            zigzag.executes or (), zigzag.execute_headings or (), zigzag.extreme_headings or (),
            zigzag.overshoots or (), zigzag.times_to_check_yaw or (),
        )  # fmt: skip
        for execute, at, extreme, overshoot, check in rows:
            if execute is None or at is None or extreme is None or overshoot is None or check is None:
                continue
            when = execute - begin
            low, high = np.degrees(at), np.degrees(extreme)
            ax.plot([when, when + check], [low, low], color=_MARK, linewidth=0.7, linestyle=(0, (3, 2)))
            arrow = {"arrowstyle": "<->", "color": _MARK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
            ax.annotate("", (when + check, high), (when + check, low), arrowprops=arrow)
            ax.text(
                when + check, high + np.sign(high) * 1.0, f"{np.degrees(overshoot):.1f}°", color=_MARK, fontsize=_TEXT,
                ha="center", va="bottom" if high > 0 else "top",
            )  # fmt: skip
        ax.axhline(0, color=MUTED, linewidth=0.6)
        ax.margins(x=0.01, y=0.12)
        if last > 0:
            pad = 0.01 * (ends[1] - ends[0])
            ax.set_xlim(ends[0] - pad, ends[1] + pad)
        ax.set_title("heading from the initial course, and rudder, to starboard [deg]", loc="left", fontsize=9, pad=3)
        ax.set_xlabel("time since the first execute [s]")
        legend(figure, [ax])

    return svg(draw, (WIDTH, 3.0), key, f"{zigzag.title}: heading and rudder against time, the overshoots marked")


def _circle(circle: TurningCircle, record: Trial, length: float | None, key: str) -> Markup | None:
    found = track(record)
    begin, course = circle.first_execute, circle.course
    if found is None or begin is None or course is None:
        return None
    t, psi = record["t"], record["psi"]
    there = np.isfinite(found[0]) & np.isfinite(found[1])
    if there.sum() < 10:
        return None
    side = 1.0 if circle.side == "starboard" else -1.0
    quarters = [None if q is None else begin + q for q in circle.times or ()]
    reached = [q for q in quarters if q is not None]
    known = np.isfinite(psi)
    heading = np.interp(t, t[known], psi[known]) - course
    # What is sailed after the turn, to the next manoeuvre, would make a small circle of it.
    last = float(t[int(np.argmax(side * heading))])
    if reached:
        last = min(last, reached[-1] + (reached[-1] - begin) / len(reached))
    if last <= begin:  # the heading never turns to the side of the circle: there is nothing to draw
        return None
    # The path is that of the numbers: averaged over the same time, broken where the record has a hole.
    moments = np.linspace(max(begin - 0.15 * (last - begin), t[there][0]), min(last, t[there][-1]), _PATH)
    quarter_moments = np.array([begin, *reached])
    every = next((e for e in _TICKS if (moments[-1] - begin) / e <= 12), _TICKS[-1])
    ticks = np.arange(0.0, moments[-1] - begin, every) + begin
    half = turning_width(float(np.median(np.diff(t[known]))), last - begin)
    places = smooth_track(record, np.concatenate([[begin], moments, ticks, quarter_moments]), half)
    if places is None or not np.isfinite([places[0][0], places[1][0]]).all():
        return None
    origin = places[0][0], places[1][0]
    along, across = _from_execute(places[0], places[1], origin, course)
    path, marks, ships = (
        (along[a:b], across[a:b])
        for a, b in itertools.pairwise(np.cumsum([1, len(moments), len(ticks), len(quarter_moments)]))
    )
    size = float(np.hypot(np.ptp(path[0][np.isfinite(path[0])]), np.ptp(path[1][np.isfinite(path[1])])))
    rows = np.flatnonzero(there & (t >= moments[0]) & (t <= moments[-1]))
    fixes = _from_execute(found[0][rows], found[1][rows], origin, course)
    apart = np.hypot(*(seen - np.interp(t[rows], moments, line) for seen, line in zip(fixes, path)))
    # What lies on the line is not seen, and a track reckoned from speed and heading has no fixes.
    scattered = found[2] == "positions" and np.nanquantile(apart, 0.9) > _SEEN * size
    thinned = slice(None, None, 1 + len(rows) // _FIXES)
    hull = length if length is not None else 0.08 * size

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        ax.plot(path[1], path[0], color=_HEADING, linewidth=1.2, label="track")
        ax.plot(marks[1], marks[0], "o", color=_HEADING, markersize=3.0, label=f"every {every:g} s")
        if scattered:
            ax.plot(
                fixes[1][thinned],
                fixes[0][thinned],
                ".",
                color=MUTED,
                markersize=1.4,
                alpha=0.6,
                zorder=1,
                label="position fixes",
            )
        for k, when in enumerate(quarter_moments):
            x, y = outline(hull, float(np.interp(when, t, heading)))
            label = "_" if k else "ship" if length is not None else "ship, not to scale"
            ax.plot(y + ships[1][k], x + ships[0][k], color=MUTED, linewidth=0.9, label=label)
        _dimensions(ax, circle, side, 0.05 * size)
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel("to starboard of the initial course [m]")
        ax.set_title("along the initial course, from the execute [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=6)
        ax.margins(0.08)
        if circle.advance is not None:
            # Room for the dimension line of the transfer and its words above the track.
            ax.plot([0], [circle.advance + 0.22 * size], alpha=0.0)
        legend(figure, [ax])

    return svg(draw, (WIDTH, 4.9), key, f"{circle.title}: the track with advance, transfer and tactical diameter")


def _from_execute(
    north: np.ndarray, east: np.ndarray, origin: tuple[float, float], course: float
) -> tuple[np.ndarray, np.ndarray]:
    """Places along the initial course and across it to starboard [m]."""
    c, s = np.cos(course), np.sin(course)
    north, east = north - origin[0], east - origin[1]
    return c * north + s * east, c * east - s * north


def _dimensions(ax: Axes, circle: TurningCircle, side: float, off: float) -> None:
    """Advance, transfer and tactical diameter over the ground as dimension lines."""
    arrow = {"arrowstyle": "<->", "color": _MARK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
    thin_line: dict[str, Plain] = {"color": _MARK, "linewidth": 0.6, "linestyle": (0, (3, 2))}
    behind = {"facecolor": PAPER, "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
    words: dict[str, Plain] = {"color": _MARK, "fontsize": _TEXT, "bbox": behind, "zorder": 3}
    advance, transfer, diameter = circle.advance, circle.transfer, circle.tactical_diameter
    if advance is not None and transfer is not None:
        x = -side * 2 * off
        ax.annotate("", (x, advance), (x, 0), arrowprops=arrow)
        ax.plot([x, side * transfer], [advance, advance], **thin_line)
        ax.plot([x, 0], [0, 0], **thin_line)
        ax.text(
            x - side * 0.4 * off, 0.5 * advance, f"advance {circle.told('advance', advance, 'm')} m", rotation=90, va="center",
            ha="right" if side > 0 else "left", **words,
        )  # fmt: skip
        ax.annotate("", (side * transfer, advance + 1.5 * off), (0, advance + 1.5 * off), arrowprops=arrow)
        ax.text(
            0.5 * side * transfer,
            advance + 1.9 * off,
            f"transfer {circle.told('transfer', transfer, 'm')} m",
            ha="center",
            va="bottom",
            **words,
        )
    if diameter is not None:
        y = -2 * off
        ax.annotate("", (side * diameter, y), (0, y), arrowprops=arrow)
        ax.plot([side * diameter, side * diameter], [y, 0.25 * (advance or 0.0)], **thin_line)
        ax.text(
            0.5 * side * diameter,
            y - 0.4 * off,
            f"tactical diameter {circle.told('tactical_diameter', diameter, 'm')} m",
            ha="center",
            va="top",
            **words,
        )


def _spiral(spiral: MeasuredSpiral, key: str) -> Markup | None:
    pairs = [(d, r) for d, r in zip(spiral.rudders or (), spiral.rates or ()) if d is not None and r is not None]
    if len(pairs) < 2:
        return None
    rudder, rate = np.array(pairs).T

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        ax.axhline(0, color=MUTED, linewidth=0.6)
        ax.axvline(0, color=MUTED, linewidth=0.6)
        ax.plot(np.degrees(rudder), to_display(rate, "r"), "o-", color=_HEADING, markersize=3.5, linewidth=1.0)
        ax.set_title("steady rate of turn, to starboard [deg/s]", loc="left", fontsize=9, pad=3)
        ax.set_xlabel("rudder, to starboard [deg]")

    return svg(draw, (WIDTH, 3.2), key, f"{spiral.title}: rate of turn against rudder, in the order of the stages")


def _pull_out(pull: PullOut, record: Trial, key: str) -> Markup | None:
    begin = pull.first_execute if pull.first_execute is not None else float(record["t"][0])
    t = record["t"] - begin
    rate = record["r"] if record.has("r") else np.gradient(record["psi"], record["t"])

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        ax.axhline(0, color=MUTED, linewidth=0.6)
        _line(ax, t, np.asarray(to_display(rate, "r")), "rate of turn", color=_HEADING, linewidth=1.4)
        ax.set_title("rate of turn, to starboard [deg/s]", loc="left", fontsize=9, pad=3)
        ax.set_xlabel("time since the rudder was put amidships [s]")

    return svg(draw, (WIDTH, 2.6), key, f"{pull.title}: rate of turn against time")
