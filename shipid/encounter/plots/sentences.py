"""Plots in logs of sentences: targets that a radar tracks (TTM), and ships that report themselves (AIS)."""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from shipid.encounter.plots.ais import AisReader
from shipid.encounter.plots.column_doubts import two_stamps
from shipid.encounter.plots.plots import Sensor
from shipid.encounter.plots.raw_plots import RawPlots
from shipid.encounter.plots.ship_path import FASTEST, STRAY
from shipid.foundation.notices import Notice
from shipid.trials.errors import EmptyFileError, NonFiniteError
from shipid.trials.logs.nmea.opening import encoding_of
from shipid.trials.logs.nmea.sentences.fields import CARRIED
from shipid.trials.logs.nmea.sentences.lines import DAY, Sentence, split_line, stamp_reader, tag_time
from shipid.trials.logs.tables.opening import opened

#: Metres a unit of TTM's range.
_UNITS = {"K": 1000.0, "N": 1852.0, "S": 1609.344}
#: The sentences that tell where own ship is and heads.
_POSITIONS, _HEADINGS, _COMPASSES = ("GGA", "RMC", "GLL"), ("THS", "HDT"), ("HDG", "HDM")
#: Why a target is left out, in words.
_WHY = {
    "lost": "lost by the radar",
    "no position": "without a range or a bearing",
    "no unit": "in a unit of range other than K, N or S",
    "no reference": "with a bearing that says neither T nor R",
    "no heading": "with a bearing from the bow and no true heading before it (THS, HDT; HDG or HDM with a variation)",
    "broken": "with a field that is no number",
}
_NAN = float("nan")
#: Own ship is where her last fix was, or her next one is, so many of its usual intervals, or s, away.
_INTERVALS, _FRESH = 5.0, 5.0
#: Fixes beside a smaller share of the plots of a radar tell less than plots relative to her.
_HALF = 0.5
#: Radius of the Earth, m.
_EARTH = 6.371e6


@dataclass
class _Found:
    """What has been read."""

    t: list[float] = field(default_factory=list)
    label: list[str] = field(default_factory=list)
    range: list[float] = field(default_factory=list)
    bearing: list[float] = field(default_factory=list)
    lat: list[float] = field(default_factory=list)
    lon: list[float] = field(default_factory=list)
    lost: list[float] = field(default_factory=list)
    own: list[tuple[float, float, float]] = field(default_factory=list)
    fixed: bool = False
    left_out: Counter[str] = field(default_factory=Counter)
    damaged: int = 0
    no_sentence: int = 0
    unused: int = 0
    ais: AisReader = field(default_factory=AisReader)


def holds_plots(file: Path) -> bool:
    """Return whether a log holds sentences with plots.

    Parameters
    ----------
    file : Path
        The file.
    """
    data, _ = opened(file)
    head = data[:2_000_000]
    return b"TTM," in head or b"VDM," in head


def plots_of_sentences(file: Path) -> RawPlots:
    """Read the targets of a log of NMEA 0183 sentences: TTM, or AIS where there is no TTM.

    Parameters
    ----------
    file : Path
        The file. Each line may begin with a logger's time stamp or a TAG block; without, the time in TTM counts.

    Returns
    -------
    RawPlots

    Raises
    ------
    EmptyFileError
        If no target has a position.
    NonFiniteError
        If nothing tells the time of the targets.
    MissingExtraError
        If AIS has to be decoded and pyais is not installed.
    """
    data, _ = opened(file)
    found = _Found()
    lines = list(_sentences(data.decode(encoding_of(file), "replace"), found))
    radar = any(s.address.endswith("TTM") for _, s in lines)
    _collect(lines, found, radar)
    if not found.t:
        left = "".join(f" {why}" for why in _left_out(found))
        raise EmptyFileError(
            f"'{file}' holds no target with a position: no TTM with a range, and no AIS position.{left}"
        )
    t = np.array(found.t)
    if not np.isfinite(t).any():
        raise NonFiniteError(
            f"nothing in '{file}' tells the time of its targets. Log each line with a time stamp before it."
        )
    own = np.array(sorted(found.own)).reshape(-1, 3)
    # Over the date line a longitude goes on: half way between 179 E and 179 W is not Greenwich.
    own[:, 2] = np.unwrap(own[:, 2])
    if radar:
        columns = {"range": np.array(found.range), "bearing": np.array(found.bearing)}
    else:
        columns = {"lat": np.array(found.lat), "lon": np.array(found.lon)}
    notes = _left_out(found)
    if len(own):
        known = _known_at(t, own[:, 0])
        if radar and known.mean() < _HALF:
            share = f"{100 * known.mean():.0f} % of the plots"
            notes.append(Notice(f"own ship's fixes stand beside {share} only, and are not used.", "own-ship-unknown"))
        else:
            for k, name in ((1, "own_lat"), (2, "own_lon")):
                columns[name] = np.where(known, np.interp(t, own[:, 0], own[:, k]), np.nan)
    label, place = np.array(found.label), _places(columns)
    period = _repeated(t, label)
    kept = _thinned(t, label, place, period)
    if not radar:
        notes += _jumps(t[kept], label[kept], place[kept])
    columns = {name: values[kept] for name, values in columns.items()}
    looks = _seen_nothing(np.array(found.lost), t[kept], period)
    notes += two_stamps(t)
    sensor = (
        Sensor("radar", range_std=30.0, bearing_std=math.radians(0.5), period=period)
        if radar
        else Sensor("AIS", position_std=10.0, period=period)
    )
    which = np.zeros(len(kept), int), looks, np.zeros(looks.size, int)
    return RawPlots(t[kept], columns, *which, sensors=(sensor,), notes=tuple(notes))


def _left_out(found: _Found) -> list[str]:
    """What became of the rest, a sentence a cause."""
    rest = [f"{n} target{'s' * (n > 1)} {_WHY[cause]} left out." for cause, n in found.left_out.items()]
    if found.damaged:
        rest.append(f"{found.damaged} sentence{'s' * (found.damaged > 1)} with a wrong checksum left out.")
    if found.no_sentence:
        several = "s that are no whole sentences" if found.no_sentence > 1 else " that is no whole sentence"
        rest.append(f"{found.no_sentence} line{several} left out: cut, or with a letter that none holds.")
    if found.unused:
        rest.append(f"AIS is not tracked beside a radar: {found.unused} of its sentences left out.")
    return rest + found.ais.why()


@dataclass
class _TimeOfDay:
    """Times of day in the order of the log, which go on over midnight: each counts as the one nearest to the time before."""

    last: float = _NAN

    def on(self, seconds: float) -> float:
        """Return a time of day as seconds since the first midnight."""
        if math.isfinite(seconds) and math.isfinite(self.last):
            # A wrong time far off goes one way, and the next right one comes back: no day is gained.
            seconds = self.last + (seconds - self.last + DAY / 2) % DAY - DAY / 2
        self.last = seconds if math.isfinite(seconds) else self.last
        return seconds


def _seconds(clock: str) -> float:
    """The time of day that hhmmss.ss says; NaN where it says none."""
    if len(clock) < 6 or not clock[:6].isdigit():
        return _NAN
    hours, minutes, seconds = int(clock[:2]), int(clock[2:4]), float(clock[4:])
    if hours > 23 or minutes > 59 or not 0 <= seconds < 61:  # a leap second
        return _NAN
    return hours * 3600.0 + minutes * 60.0 + seconds


def _sentences(text: str, found: _Found) -> Iterator[tuple[float, Sentence]]:
    """Each whole sentence with the time its logger gave it; a time of day goes on over midnight. Damaged ones are counted."""
    read, day = stamp_reader("auto"), _TimeOfDay()
    for line in io.StringIO(text):
        sentence = split_line(line.rstrip("\r\n"))
        if sentence is None:
            found.no_sentence += ("$" in line or "!" in line) and "," in line
            continue
        if not sentence.whole:
            found.damaged += 1
            continue
        stamp = tag_time(sentence.front)[0] or read(sentence.front)
        at = _NAN
        if stamp is not None:
            at = stamp.time if stamp.dated else day.on(stamp.time)
        yield at, sentence


def _collect(lines: list[tuple[float, Sentence]], found: _Found, radar: bool) -> None:
    heading, magnetic, variation, utc = _NAN, _NAN, _NAN, _NAN
    day = _TimeOfDay()
    for at, sentence in lines:
        fields = sentence.text.split(",")
        kind = sentence.address[-3:]
        try:
            if kind in CARRIED:
                names, take = CARRIED[kind]
                known = dict(zip(names, take(fields)))
                if kind in _HEADINGS:
                    heading = known["heading"] if math.isfinite(known["heading"]) else heading
                if kind in _COMPASSES and math.isfinite(known["heading"]):
                    magnetic = known["heading"]
                if math.isfinite(known.get("variation", _NAN)):
                    variation = known["variation"]
                if math.isfinite(known.get("utc", _NAN)):
                    utc = day.on(known["utc"])
                if kind in _POSITIONS:
                    when = at if math.isfinite(at) else utc
                    if math.isfinite(when + known["lat"] + known["lon"]):
                        if not found.fixed:
                            # Her own AIS repeats the fixes of her receiver, later and coarser.
                            found.own, found.fixed = [], True
                        found.own.append((when, math.radians(known["lat"]), math.radians(known["lon"])))
            elif kind == "TTM":
                # A gyro goes before a compass.
                _take_ttm(fields, at, utc, heading if math.isfinite(heading) else magnetic + variation, day, found)
            elif kind == "VDM" and radar:
                found.unused += 1
            elif kind in ("VDO", "VDM"):
                _take_ais(fields, sentence, at if math.isfinite(at) else utc, found)
        except (ValueError, IndexError):
            found.left_out["broken"] += 1


def _take_ttm(fields: list[str], at: float, utc: float, heading: float, day: _TimeOfDay, found: _Found) -> None:
    """Number, range, bearing and whose; unit, status, time."""
    fields = fields + [""] * (16 - len(fields))
    said = day.on(_seconds(fields[14]))
    when = next((w for w in (at, said, utc) if math.isfinite(w)), _NAN)
    unit = _UNITS.get(fields[10])
    range_, angle = (float(fields[k]) if fields[k] else _NAN for k in (2, 3))
    # From north, or from the bow; where it does not say, nobody knows.
    start = {"T": 0.0, "R": heading}.get(fields[4])
    cause = None
    if fields[12] == "L":
        cause = "lost"
        found.lost.append(when)
    elif not math.isfinite(range_) or not -180.0 <= angle <= 360.0:
        cause = "no position"
    elif unit is None:
        cause = "no unit"
    elif start is None:
        cause = "no reference"
    elif not math.isfinite(start):
        cause = "no heading"
    if cause is not None or unit is None or start is None:
        found.left_out[cause or "broken"] += 1
        return
    found.t.append(when)
    found.label.append(fields[1])
    found.range.append(range_ * unit)
    found.bearing.append(math.radians(angle + start))


def _take_ais(fields: list[str], sentence: Sentence, when: float, found: _Found) -> None:
    """A ship that reports herself: another one, or own ship."""
    report = found.ais.take(fields, sentence)
    if report is None:
        return
    if not report.own:
        found.t.append(when)
        found.label.append(report.label)
        found.lat.append(report.lat)
        found.lon.append(report.lon)
    elif not found.fixed and math.isfinite(when):
        found.own.append((when, report.lat, report.lon))


def _repeated(t: np.ndarray, label: np.ndarray) -> float | None:
    """The usual time after which a target comes again, s."""
    steps = [np.diff(np.sort(t[label == name])) for name in np.unique(label)]
    together = np.concatenate(steps) if steps else np.zeros(0)
    together = together[together > 0]
    return float(np.median(together)) if together.size else None


def _seen_nothing(lost: np.ndarray, t: np.ndarray, period: float | None) -> np.ndarray:
    """Times at which the radar said that a target is lost, and saw no other one: once in the usual time, s."""
    lost = np.sort(lost[np.isfinite(lost)])
    if not lost.size or period is None or not period > 0:
        return np.zeros(0)
    _, first = np.unique(np.floor((lost - lost[0]) / period), return_index=True)
    known = np.sort(t[np.isfinite(t)])
    after = np.searchsorted(known, lost[first]).clip(1, max(known.size - 1, 1))
    away = np.minimum(
        np.abs(lost[first] - known[after - 1]), np.abs(lost[first] - known[after.clip(0, known.size - 1)])
    )
    return np.asarray(lost[first][away > 0.5 * period])


def _known_at(t: np.ndarray, fixes: np.ndarray) -> np.ndarray:
    """Whether a fix is near in time, of shape (N,): between fixes that lie far apart, and before and after them all, nobody knows."""
    usual = float(np.median(np.diff(fixes))) if fixes.size > 1 else 0.0
    after = np.searchsorted(fixes, t).clip(1, max(fixes.size - 1, 1))
    away = np.minimum(np.abs(t - fixes[after - 1]), np.abs(t - fixes[after.clip(0, fixes.size - 1)]))
    return np.asarray((fixes[0] <= t) & (t <= fixes[-1]) & (away <= max(_INTERVALS * usual, _FRESH)))


def _places(columns: dict[str, np.ndarray]) -> np.ndarray:
    """Where plots lie, nearly, of shape (N, 2), m: to tell one place from another."""
    if "range" in columns:
        return np.stack(
            [columns["range"] * np.cos(columns["bearing"]), columns["range"] * np.sin(columns["bearing"])], axis=1
        )
    lat, lon = columns["lat"], columns["lon"]
    # One side of the date line is near the other.
    lon = (lon - lon[:1] + np.pi) % (2 * np.pi)
    return np.asarray(_EARTH * np.stack([lat, lon * np.cos(lat)], axis=1))


def _thinned(t: np.ndarray, label: np.ndarray, place: np.ndarray, period: float | None) -> np.ndarray:
    """The rows that are kept: of what a target reports within half the usual time, the first; two ships of one number are two."""
    recent: dict[str, list[int]] = {}
    kept = []
    for row in np.argsort(t, kind="stable").tolist():
        near = [k for k in recent.get(label[row], []) if period is not None and t[row] - t[k] < 0.5 * period]
        if not any(math.dist(place[row], place[k]) < STRAY + FASTEST * (t[row] - t[k]) for k in near):
            near.append(row)
            kept.append(row)
        recent[label[row]] = near
    return np.array(kept, int)


def _jumps(t: np.ndarray, label: np.ndarray, place: np.ndarray) -> list[Notice]:
    """Which ships report themselves from places that none of them sails between."""
    order = np.lexsort((t, label))
    away, since = np.hypot(*np.diff(place[order], axis=0).T), np.diff(t[order])
    far = (label[order][1:] == label[order][:-1]) & (away > STRAY) & (away > FASTEST * since)
    who, count = np.unique(label[order][1:][far], return_counts=True)
    if not who.size:
        return []
    names = ", ".join(f"{who[k]} ({count[k]} times)" for k in np.argsort(-count, kind="stable")[:3])
    more = f" and {who.size - 3} more" if who.size > 3 else ""
    return [
        Notice(
            f"ships that jump, by up to {away[far].max() / 1000:.1f} km, by their MMSI: {names}{more}. Wrong positions, or several ships with "
            "one number: tracks are made of positions, not of numbers, so that each place may be a track.",
            "ais-jumps",
            count=int(far.sum()),
        )
    ]
