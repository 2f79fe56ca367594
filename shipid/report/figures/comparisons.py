"""A trial beside what one model or several predict: heading with the rudder, and the track."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from shipid.criteria.criteria import Criterion, CriterionSide
from shipid.foundation.numbers import brief
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures.runaway import good_samples
from shipid.report.figures.svg import (
    BLUE,
    GOLD,
    GREEN,
    MUTED,
    ORANGE,
    PURPLE,
    RED,
    WIDTH,
    Drawing,
    legend,
    panel_title,
    thin,
    with_gaps,
)
from shipid.trials.filling import interpolated, usual_interval
from shipid.trials.measuring.track import smooth_track, track
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from shipid.foundation.aliases import Plain

_COLOURS = (ORANGE, GREEN, PURPLE, GOLD)
_DASHES = ("--", "-.", ":", (0, (6, 1.5, 1, 1.5, 1, 1.5)))
#: A ship that turns further than this, in rad, has her rudder below her heading.
_FAR = np.deg2rad(120.0)
#: Height of a track over its width, at most and at least.
_TALLEST, _FLATTEST = 0.8, 0.5
#: A track so many times as long as it is wide, as that of a zig-zag, is a line in equal scales: it is stretched across.
_SLIM = 4.0
#: Positions are averaged over no more than this to both sides in s, but over five samples at least, where there are so many.
_CALM, _FEW = 10.0, 11
#: About the most marks of positions as logged, and the share of an axis by which they have to lie beside the line to be shown.
_MARKS, _SEEN = 250, 0.003


def heading_drawing(comparisons: Mapping[str, Comparison]) -> Drawing | None:
    """Return heading, measured and predicted, with the rudder on one axis; None where no heading was measured.

    Parameters
    ----------
    comparisons : mapping of str to Comparison
        The same trial beside each prediction, by what the prediction is called.
    """
    first = next(iter(comparisons.values()))
    trial = first.trial
    if not trial.has("psi") or not np.isfinite(trial["psi"]).any():
        return None
    t, psi = trial["t"], trial["psi"]
    start = float(psi[np.isfinite(psi)][0])

    # On one axis as in every zig-zag; below the heading where that turns so far that the rudder would be a flat line.
    apart = bool(np.nanmax(np.abs(psi - start)) > _FAR)

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1]) if apart else [figure.subplots()]
        ax, below = axes[0], axes[-1]
        for name, label, style in (("delta_order", "rudder order", ":"), ("delta", "rudder", "-")):
            if trial.has(name):
                _line(below, t, np.degrees(trial[name]), label, color=MUTED, linewidth=1.0, linestyle=style)
        _line(ax, t, np.degrees(psi - start), "measured", color=BLUE, linewidth=2.4, alpha=0.6)
        for k, (label, c) in enumerate(comparisons.items()):
            if "psi" in c.predicted:
                n = good_samples(c)
                look: dict[str, Plain] = {"color": _COLOURS[k % 4], "linestyle": _DASHES[k % 4], "linewidth": 1.4}
                _line(ax, t[:n], np.degrees(c.predicted["psi"][:n] - start), label, **look)
        for one in axes:
            one.axhline(0, color=MUTED, linewidth=0.6)
            one.margins(x=0.01)
        both = "heading from its start, to starboard" if apart else "heading from its start, and rudder, to starboard"
        ax.set_title(panel_title(both, "deg"), loc="left", fontsize=9, pad=3)
        if apart:
            below.set_title(panel_title("rudder, to starboard", "deg"), loc="left", fontsize=9, pad=3)
        below.set_xlabel("time [s]")
        legend(figure, axes)

    words = f"Heading measured and predicted by {', '.join(comparisons)}" if len(comparisons) > 1 else "Heading"
    return Drawing(draw, (WIDTH, 3.1), f"{words}, with the rudder, trial {trial.name}")


def track_drawing(comparisons: Mapping[str, Comparison]) -> tuple[Drawing | None, str]:
    """Return the measured and the predicted tracks, north up, and what has to be said of them; None where there is none.

    Scales are equal but where the track is long and slim, as that of a zig-zag.

    Parameters
    ----------
    comparisons : mapping of str to Comparison
        See `heading_drawing`.
    """
    trial = next(iter(comparisons.values())).trial
    measured = _measured_track(trial)
    lines: list[tuple[str, np.ndarray, np.ndarray]] = []
    if measured is not None:
        lines.append(("measured", measured.north, measured.east))
    for label, c in comparisons.items():
        n = good_samples(c)
        if n > 1 and "x" in c.predicted and "y" in c.predicted:
            north, east = c.predicted["x"][:n], c.predicted["y"][:n]
            if measured is not None and measured.source != "positions":
                north, east = north - north[0], east - east[0]
            lines.append((label, north, east))
    if not lines:
        return None, ""
    across, along = _span([east for _, _, east in lines]), _span([north for _, north, _ in lines])
    wide, tall = across[1] - across[0], along[1] - along[0]
    slim = max(wide / tall, tall / wide) > _SLIM
    flat = _FLATTEST if wide > tall else _TALLEST
    scales = "equal scales"
    if slim:
        stretched, by = ("north", wide * flat / tall) if wide > tall else ("east", tall / (wide * flat))
        scales = f"{stretched} stretched {brief(by, 2)} times"
    else:
        across, along = _widen(across, tall / _TALLEST), _widen(along, _FLATTEST * wide)
    note = f"Track, north up, {scales}."
    if measured is not None:
        over = f", averaged over {brief(measured.averaged, 2)}\u00a0s" if measured.averaged else ""
        note += f" Measured track from {measured.source}{over}."

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        predicted = 0
        if measured is not None and measured.fixes is not None:
            ax.plot(
                measured.fixes[1],
                measured.fixes[0],
                ".",
                color=MUTED,
                markersize=1.4,
                alpha=0.6,
                label="position fixes",
            )
        for label, north, east in lines:
            kept = np.union1d(thin(east, 300), thin(north, 300))
            if label == "measured":
                look: dict[str, Plain] = {"color": BLUE, "linewidth": 2.4, "alpha": 0.6}
            else:
                look = {"color": _COLOURS[predicted % 4], "linestyle": _DASHES[predicted % 4], "linewidth": 1.4}
                predicted += 1
            ax.plot(east[kept], north[kept], label=label, **look)
        begin = int(np.argmax(np.isfinite(lines[0][1])))
        ax.plot(lines[0][2][begin], lines[0][1][begin], "o", color="black", markersize=4, label="start")
        ax.set_aspect("auto" if slim else "equal", adjustable="box")
        ax.set_xlim(*across)
        ax.set_ylim(*along)
        ax.set_xlabel("east [m]")
        ax.set_title("north [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=5)
        legend(figure, [ax])

    shape = flat if slim else (along[1] - along[0]) / (across[1] - across[0])
    return Drawing(draw, (WIDTH, 0.95 + 4.05 * shape), f"Track, north up, trial {trial.name}"), note


def limits_drawing(rows: Sequence[Criterion]) -> Drawing | None:
    """Return the quantities with a limit, each as a share of it, to both sides and with their bands; None where none has a value.

    Parameters
    ----------
    rows : sequence of Criterion
        The quantities.
    """
    shown = [r for r in rows if r.limit and (r.starboard.value is not None or r.port.value is not None)]
    if not shown:
        return None

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        sides: list[tuple[str, str, str, list[tuple[float, CriterionSide, float]]]] = [
            ("to starboard", GREEN, "o", [(k, r.starboard, r.limit or 1.0) for k, r in enumerate(shown)]),
            ("to port", ORANGE, "s", [(k + 0.2, r.port, r.limit or 1.0) for k, r in enumerate(shown)]),
        ]
        for label, colour, mark, found in sides:
            points = [(100 * s.value / limit, y) for y, s, limit in found if s.value is not None]
            if points:
                ax.plot(*zip(*points), mark, color=colour, markersize=5, label=label)
            for y, side, limit in found:
                if side.band95 is not None:
                    ax.plot([100 * end / limit for end in side.band95], [y, y], "-", color=colour, linewidth=1.6)
        ax.axvline(100, color=RED, linewidth=1.1, linestyle=(0, (2, 2)), label="limit")
        for k, row in enumerate(shown):
            ax.text(1.5, k - 0.32, row.meaning, fontsize=9, va="center")
        ax.set_yticks([])
        ax.set_ylim(len(shown) - 0.5, -0.65)
        ax.set_xlim(0, max(110.0, 1.05 * ax.get_xlim()[1]))
        ax.set_xlabel("share of the limit [%]")
        legend(figure, [ax])

    return Drawing(draw, (WIDTH, 1.0 + 0.46 * len(shown)), "Each quantity as a share of its limit")


def _line(ax: Axes, t: np.ndarray, y: np.ndarray, label: str, **look: Plain) -> None:
    x, values = with_gaps(t, y)
    if x.size:
        kept = thin(values)
        ax.plot(x[kept], values[kept], label=label, **look)


@dataclass(frozen=True, eq=False)
class _MeasuredTrack:
    """North and east [m], NaN where the line breaks; where they come from; the time over which positions are averaged [s], or 0; and
    the positions as logged, evenly thinned, where they do not lie on the line.
    """

    north: np.ndarray
    east: np.ndarray
    source: str
    averaged: float = 0.0
    fixes: tuple[np.ndarray, np.ndarray] | None = None


def _measured_track(trial: Trial) -> _MeasuredTrack | None:
    """The positions, averaged over some samples where there are enough; without any the track from speed and heading."""
    if not (trial.has("x", "y") and (both := np.isfinite(trial["x"] + trial["y"])).any()):
        reckoned = track(_between_samples(trial))
        return None if reckoned is None else _MeasuredTrack(*reckoned)
    t, north, east = (trial[n][both] for n in ("t", "x", "y"))
    half = _averaged(t)
    calm = smooth_track(trial, t, half) if half else None
    if calm is None or not np.isfinite(calm[0] + calm[1]).any():
        return _MeasuredTrack(with_gaps(t, north)[1], with_gaps(t, east)[1], "positions")
    return _MeasuredTrack(*calm, "positions", 2 * half, _beside((north, east), calm))


def _averaged(t: np.ndarray) -> float:
    """Half the time over which positions are averaged in a figure, in s: no ship turns in it so far that it is seen. 0 of few."""
    if t.size < _FEW:
        return 0.0
    every = usual_interval(t)
    return max(2.5 * every, min(_CALM, max(5 * every, 0.01 * float(np.ptp(t)))))


def _beside(
    logged: tuple[np.ndarray, np.ndarray], calm: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray] | None:
    """The positions as logged, evenly thinned; None where they lie on the line."""
    good = np.isfinite(calm[0] + calm[1])
    apart = [np.abs(one - line)[good] for one, line in zip(logged, calm)]
    if all(np.quantile(one, 0.9) < _SEEN * max(np.ptp(line[good]), 1.0) for one, line in zip(apart, calm)):
        return None
    kept = slice(None, None, 1 + logged[0].size // _MARKS)
    return logged[0][kept], logged[1][kept]


def _between_samples(trial: Trial) -> Trial:
    """A trial with straight lines over the short holes of its signals, without the signals that have long ones."""
    if not trial.table.isna().to_numpy().any():
        return trial
    filled = {n: interpolated(trial["t"], trial[n]) for n in trial.table.columns if n != "t"}
    whole = np.isfinite(filled["psi"]) if "psi" in filled else np.ones(len(trial), dtype=bool)
    # Before the first heading and behind the last one there is no track.
    inside = slice(int(np.argmax(whole)), len(trial) - int(np.argmax(whole[::-1])))
    table = trial.table.assign(**filled).iloc[inside].reset_index(drop=True)
    return replace(trial, table=table.dropna(axis="columns"))


def _span(values: list[np.ndarray]) -> tuple[float, float]:
    """Range of an axis: what was measured, and no more than one and a half of its spans beyond it."""
    first = values[0][np.isfinite(values[0])]
    reach = max(float(np.ptp(first)), 1.0)
    every = np.concatenate([v[np.isfinite(v)] for v in values])
    low = max(float(every.min()), float(first.min()) - 1.5 * reach)
    high = min(float(every.max()), float(first.max()) + 1.5 * reach)
    pad = 0.05 * max(high - low, 1.0)
    return low - pad, high + pad


def _widen(limits: tuple[float, float], least: float) -> tuple[float, float]:
    short = max(0.0, least - (limits[1] - limits[0])) / 2
    return limits[0] - short, limits[1] + short
