"""What the columns of a log of plots can hardly mean: times far from all others, bearings in degrees; times of day go on over midnight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.encounter.plots.raw_plots import RawPlots, midnights
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief

#: Turns that no bearing counts.
_TURNS = 2.5
#: So many bearings that differ by more than this, rad, show what they go round.
_SOME, _SPREAD = 20, 0.002
#: A wrong clock: plots so far from all others in time, within so short a time, s, and this share of all plots at most.
_FAR, _BRIEF, _FEW = 3600.0, 5.0, 0.05
#: Columns that say which sensor saw a plot; more values than these are something else.
_SENSORS, _MOST_SENSORS = ("sensor", "sensor_id", "sensorid", "sensor id"), 20
#: Ranges that are all shorter, m, are hardly those of a radar; ranges with nothing between two of this ratio are in two units.
_SHORT, _APART, _MILE = 30.0, 30.0, 1852.0
#: Positions so far from where most lie, m, were never received together; as long as they are few, they are left out.
_UNHEARD, _MINORITY = 1e6, 1 / 3
#: Radius of the Earth, m.
_EARTH = 6.371e6
#: A bearing that is farther beyond a turn than this, in turns, stands for none, where none lies between.
_FAR_BEYOND = 1.1
#: Two clocks are so far apart, s, and the times of a log go back from one to the other so often, at least.
_TO_AND_FRO, _TWICE = 60.0, 3
#: Beyond a pole or a whole turn by no more than this is rounding, rad.
_ROUNDING = 1e-6


def doubts(log: Mapping[str, np.ndarray], columns: Mapping[str, np.ndarray], sensors: int = 0) -> list[Notice]:
    """Return what was put right, and what the columns can hardly mean.

    Parameters
    ----------
    log : mapping of str to ndarray, shape (N,)
        All columns as the log has them; ``t`` in s.
    columns : mapping of str to ndarray
        Those of the plots, SI.
    sensors : int
        How many a format file tells apart.
    """
    found = []
    if midnights(log["t"]).any():
        found.append(Notice("the clock passes midnight.", "clock-midnight"))
    named = next((v for n, v in log.items() if n.lower() in _SENSORS), np.zeros(0))
    several = np.unique(named[np.isfinite(named)]).size
    if sensors < 2 and 1 < several <= _MOST_SENSORS:
        found.append(
            Notice(
                f"the log names {several} sensors, and all plots are taken as those of one: [sensors] in a format file (--format) tells them apart.",
                "several-sensors",
            )
        )
    bearings = columns.get("bearing", np.zeros(0))
    most = float(np.abs(bearings[np.isfinite(bearings)]).max(initial=0.0)) / (2 * np.pi)
    if most > _TURNS:
        found.append(
            Notice(
                f"bearings reach {most:.0f} turns: their column says rad, and may hold degrees.",
                "bearing-unit",
                serious=True,
            )
        )
    known = bearings[np.isfinite(bearings)]
    # 2 pi degrees: a target that moves, or several, hardly stay so near to north, and never to the west of it.
    if known.size >= _SOME and known.min() >= 0 and known.max() < np.deg2rad(2 * np.pi) and np.ptp(known) > _SPREAD:
        found.append(
            Notice(
                f"all bearings lie from 0 to {np.rad2deg(known.max()):.1f} deg: their column says deg, and may hold rad.",
                "bearing-unit",
            )
        )
    return found + _range_unit(columns.get("range", np.zeros(0)))


def _range_unit(ranges: np.ndarray) -> list[Notice]:
    """Ranges that are hardly metres, all of them or some."""
    known = np.sort(ranges[np.isfinite(ranges) & (ranges > 0)])
    if known.size < _SOME:
        return []
    if known[-1] < _SHORT:
        return [
            Notice(
                f"all ranges lie below {brief(known[-1], 3)} m: their column may hold nautical miles or kilometres. Write its unit in the header.",
                "range-unit",
                serious=True,
            )
        ]
    k = int(np.diff(np.log(known)).argmax()) + 1
    near, far = known[:k], known[k:]
    likely = [name for name, unit in (("kilometres", 1e3), ("nautical miles", _MILE)) if _within(unit * near, far)]
    if min(near.size, far.size) < _SOME // 2 or far[0] < _APART * near[-1] or near[-1] > _SHORT or not likely:
        return []
    return [
        Notice(
            f"{near.size} ranges lie below {brief(near[-1], 3)} m, and all others beyond {far[0]:.0f} m: the column may mix metres and "
            f"{' or '.join(likely)}. Write all in one unit, or each sensor in a log of its own.",
            "range-unit",
            count=int(near.size),
        )
    ]


def _within(values: np.ndarray, others: np.ndarray) -> bool:
    """Whether values lie about where others do."""
    return bool(values[-1] > others[0] / 3 and values[0] < 3 * others[-1])


def two_stamps(t: np.ndarray) -> list[Notice]:
    """Return a notice where the times of a log go to and fro between two spells that do not overlap: two clocks in one log.

    Parameters
    ----------
    t : ndarray, shape (N,)
        In the order of the log, s.
    """
    known = t[np.isfinite(t)]
    if known.size < _SOME:
        return []
    rising = np.sort(known)
    k = int(np.diff(rising).argmax())
    apart, late = float(rising[k + 1] - rising[k]), known > rising[k]
    back = int((late[:-1] & ~late[1:]).sum())
    if apart < _TO_AND_FRO or back < _TWICE:
        return []
    return [
        Notice(
            f"the times go back {back} times by more than {apart:.0f} s: two clocks in one log, by which one ship is two tracks. Put the "
            "clocks right, or make a log of each.",
            "two-clocks",
            serious=True,
            seconds=apart,
        )
    ]


def bearings_possible(raw: RawPlots) -> RawPlots:
    """Return plots without the bearings that stand for none, such as 511 or 999.9 deg, beside bearings within a turn.

    Parameters
    ----------
    raw : RawPlots
        As the log has them, bearings not yet counted from north.
    """
    columns, notes = dict(raw.columns), list(raw.notes)
    for name in ("bearing", "relative_bearing"):
        turns = np.abs(columns.get(name, np.zeros(0))) / (2 * np.pi)
        beyond = turns > 1 + _ROUNDING
        # Bearings that are counted on beyond a turn go there step by step.
        if (
            not beyond.any()
            or beyond.sum() > _MINORITY * np.isfinite(turns).sum()
            or (turns[beyond] < _FAR_BEYOND).any()
        ):
            continue
        columns[name] = np.where(beyond, np.nan, columns[name])
        told = f"{_many(beyond, 'plot')} with a bearing of {360 * turns[beyond].min():.0f} deg or more left out: it stands for none."
        notes.append(Notice(told, "bearings-impossible", count=int(beyond.sum())))
    return replace(raw, columns=columns, notes=tuple(notes))


def possible(raw: RawPlots) -> RawPlots:
    """Return plots without those that cannot be: beyond the poles, or put far from all others by a clock that was wrong for a moment.

    Parameters
    ----------
    raw : RawPlots
        As the log has them.
    """
    columns, notes = dict(raw.columns), list(raw.notes)
    for lat, lon in (("lat", "lon"), ("own_lat", "own_lon")):
        if lat not in columns or lon not in columns:
            continue
        # 91 and 181 deg stand for none in AIS; longitudes may count to 360 deg.
        off = (np.abs(columns[lat]) > np.pi / 2 + _ROUNDING) | (np.abs(columns[lon]) > 2 * np.pi + _ROUNDING)
        columns[lat] = np.where(off, np.nan, columns[lat])
        if off.any():
            what = _many(off, "position") + (" of own ship" if lat == "own_lat" else "")
            told = (
                f"{what} with a latitude above 90 deg or a longitude above 360 deg left out: 91 and 181 stand for none."
            )
            notes.append(Notice(told, "positions-impossible", count=int(off.sum())))
    if "lat" in columns and "lon" in columns:
        notes += _left_far(columns)
    below = columns.get("range", np.zeros(0)) < 0
    if below.any():
        columns["range"] = np.where(below, np.nan, columns["range"])
        notes.append(
            Notice(
                f"{_many(below, 'plot')} with a range below zero left out.", "ranges-negative", count=int(below.sum())
            )
        )
    far = _strays(raw.t)
    if far.any():
        told = f"{_many(far, 'plot')} stamped an hour or more away from all others left out: a wrong clock."
        notes.append(Notice(told, "plots-far-in-time", count=int(far.sum())))
    return replace(raw, t=np.where(far, np.nan, raw.t), columns=columns, notes=tuple(notes))


def _left_far(columns: dict[str, np.ndarray]) -> list[Notice]:
    """Leave out positions on another coast than most, or than own ship's; tell it where they are too many for a fault."""
    at = ("own_lat", "own_lon") if np.isfinite(columns.get("own_lat", np.nan)).any() else ("lat", "lon")
    centre = [float(np.nanmedian(columns[name])) if np.isfinite(columns[name]).any() else np.nan for name in at]
    lat, lon = columns["lat"], columns["lon"]
    far = _away(lat, lon, centre) > _UNHEARD
    if not far.any():
        return []
    turned = far & (_away(lon, lat, centre) < _UNHEARD)
    why = "latitude and longitude exchanged" if turned.any() else "wrong positions"
    what = f"{_many(far, 'position')} more than {_UNHEARD / 1000:.0f} km from {'own ship' if at[0] == 'own_lat' else 'most others'}"
    if at[0] == "lat" and far.sum() > _MINORITY * np.isfinite(lat).sum():
        return [
            Notice(
                f"{what}: {why}, or ships of a whole ocean. No flat chart holds them all.",
                "positions-far",
                serious=True,
            )
        ]
    columns["lat"], columns["lon"] = np.where(far, np.nan, lat), np.where(far, np.nan, lon)
    return [Notice(f"{what} left out: {why}.", "positions-far", serious=bool(turned.any()), count=int(far.sum()))]


def _away(lat: np.ndarray, lon: np.ndarray, centre: list[float]) -> np.ndarray:
    """Distance along the Earth, m."""
    half = np.sin((lat - centre[0]) / 2) ** 2 + np.cos(lat) * np.cos(centre[0]) * np.sin((lon - centre[1]) / 2) ** 2
    return np.asarray(2 * _EARTH * np.arcsin(np.sqrt(np.clip(half, 0.0, 1.0))))


def _many(which: np.ndarray, what: str) -> str:
    count = int(which.sum())
    return f"{count} {what}{'s' * (count > 1)}"


def _strays(t: np.ndarray) -> np.ndarray:
    """Which times a wrong clock may have stamped, shape (N,)."""
    far = np.zeros(t.size, bool)
    order = np.argsort(t, kind="stable")[: np.isfinite(t).sum()]
    for group in np.split(order, np.flatnonzero(np.diff(t[order]) > _FAR) + 1):
        far[group] = np.ptp(t[group]) <= _BRIEF if group.size else False
    return far if far.sum() <= _FEW * order.size else np.zeros(t.size, bool)
