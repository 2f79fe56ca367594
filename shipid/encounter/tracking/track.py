"""Track the targets of a log: ``track`` runs a tracker over its plots and says what each confirmed track is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.encounter.closest_approach import ClosestApproach, closest_approach
from shipid.encounter.plots.plots import Plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.filters.alpha_beta import FuzzySettings
from shipid.encounter.tracking.filters.alpha_beta_filters import AlphaBetaFilters
from shipid.encounter.tracking.filters.target_filters import TargetFilters
from shipid.encounter.tracking.filters.trackers import motion_of
from shipid.encounter.tracking.remarks.contradictions import contradictions
from shipid.encounter.tracking.remarks.own_echoes import without_own_ship
from shipid.encounter.tracking.remarks.silences import silences
from shipid.encounter.tracking.remarks.two_clocks import two_clocks
from shipid.encounter.tracking.scatter import tracked
from shipid.encounter.tracking.scoring import score_tracks
from shipid.encounter.tracking.target_track import Status, TargetTrack
from shipid.encounter.tracking.tracker import Standing, Tracker, TrackerSettings
from shipid.encounter.tracking.tracking import Tracking
from shipid.foundation.notices import Notice
from shipid.parameters.parameter_set import ParameterSet

#: How long after its last position own ship's path is carried on, s.
_AFTER = 10.0
#: A latency that is known worse than this is worth a word, s.
_POORLY = 0.5


def track(
    detections: Detections | Plots,
    tracker: str = "imm",
    *,
    ship: ParameterSet | None = None,
    settings: TrackerSettings | None = None,
    fuzzy: FuzzySettings | None = None,
) -> Tracking:
    """Track the targets of a log.

    Parameters
    ----------
    detections : Detections or Plots
        What the sensors saw; with own ship and the truth, where they are known.
    tracker : str
        One of `shipid.encounter.tracking.filters.trackers.NAMES`.
    ship : ParameterSet, optional
        A ship whose length says how sharply targets turn.
    settings : TrackerSettings, optional
        What decides on tracks.
    fuzzy : FuzzySettings, optional
        The bank of ``alpha-beta``.

    Returns
    -------
    Tracking

    Raises
    ------
    UnknownNameError
        If there is no such tracker.
    EncounterRequestError
        If a setting cannot be meant.
    """
    found = detections if isinstance(detections, Detections) else Detections("plots", detections)
    plots, rules = found.plots, settings or TrackerSettings()
    filters: TargetFilters | AlphaBetaFilters
    if tracker == "alpha-beta":
        filters = AlphaBetaFilters.none(fuzzy or FuzzySettings())
    else:
        filters = TargetFilters.none(motion_of(tracker, ship))
    labels = filters.labels
    engine, standings, scatter = tracked(filters, plots, rules)
    plots = replace(plots, sensors=engine.sensors)
    tracks, own_echo = without_own_ship(_tracks(standings, rules, found), found)
    score = score_tracks(tracks, plots, found.truth, found.own) if found.truth else None
    return Tracking(
        found.name,
        tracker,
        labels,
        tracks,
        plots,
        {s.name: (late.value, late.std) for s, late in zip(plots.sensors, engine.latency)},
        found.own,
        found.relative,
        found.truth,
        score,
        (
            *_warnings(found, tracks, engine),
            *own_echo,
            *scatter,
            *two_clocks(tracks, plots),
            *silences(tracks, plots, rules.patience),
            *_widened(tracks),
            *(contradictions(score) if score else ()),
        ),
    )


def _tracks(standings: list[Standing], rules: TrackerSettings, found: Detections) -> list[TargetTrack]:
    """Gather what the scans say of each confirmed track."""
    rows: dict[int, list[tuple[Standing, int]]] = {}
    for standing in standings:
        for i in np.flatnonzero(standing.confirmed):
            rows.setdefault(int(standing.number[i]), []).append((standing, int(i)))
    tracks = []
    for number, seen in sorted(rows.items()):
        existence = np.array([s.existence[i] for s, i in seen])
        held = existence > rules.lost
        status: Status = "ended" if seen[-1][0] is not standings[-1] else "held" if held[-1] else "lost"
        t, x = np.array([s.t for s, _ in seen]), np.array([s.x[i] for s, i in seen])
        P = np.array([s.P[i] for s, i in seen])
        widening = np.array([s.widening[i] for s, i in seen])
        tracks.append(
            TargetTrack(
                number,
                t,
                x,
                P,
                widening,
                np.array([s.mu[i] for s, i in seen]),
                np.array([s.turn_rate[i] for s, i in seen]),
                existence,
                held,
                status,
                _approach(x[-1], P[-1], float(t[-1]), found.own, found.relative) if status == "held" else None,
            )
        )
    return tracks


def _approach(x: np.ndarray, P: np.ndarray, t: float, own: ShipPath | None, relative: bool) -> ClosestApproach | None:
    """To own ship on her present motion; of relative positions own ship lies at the origin."""
    if relative:
        return closest_approach(x, covariance=P)
    motion = _own_motion(own, t)
    return None if motion is None else closest_approach(x, motion, covariance=P)


def _own_motion(own: ShipPath | None, t: float) -> np.ndarray | None:
    """Own ship's position and velocity; from her last positions where the path ends a little before."""
    return own.motion(t) if own is not None and own.t[0] <= t <= own.t[-1] + _AFTER else None


def _widened(tracks: list[TargetTrack]) -> list[Notice]:
    """Which tracks at last are wider than their filter says."""
    wide = [one for one in tracks if one.widening[-1] > 1]
    if not wide:
        return []
    most = float(np.sqrt(max(one.widening[-1] for one in wide)))
    numbers = ", ".join(str(one.number) for one in wide)
    return [
        Notice(
            f"the plots of track{'s' * (len(wide) > 1)} {numbers} lie off to one side again and again, or farther than their accuracy "
            f"allows: the standard deviations are widened, up to {most:.1f} times.",
            "covariance-widened",
            tracks=[one.number for one in wide],
            factor=most,
        )
    ]


def _warnings(found: Detections, tracks: list[TargetTrack], engine: Tracker) -> tuple[Notice, ...]:
    warnings = list(found.plots.notes)
    if not tracks:
        count, scans = len(found.plots), len(found.plots.scans)
        warnings.append(
            Notice(
                f"no track was confirmed: {count} plot{'s' * (count != 1)} in {scans} scan{'s' * (scans != 1)} do not show a "
                f"target {engine.settings.plots_to_confirm} times with near certainty.",
                "no-track",
            )
        )
    if found.own is None and not found.relative:
        warnings.append(
            Notice("own ship is not known, so that the closest approach is not; give her path.", "own-ship-unknown")
        )
    last = found.plots.span[1]
    if found.own is not None and not found.relative and tracks and _own_motion(found.own, last) is None:
        warnings.append(
            Notice(
                f"own ship's path has no motion at the last scan ({last:.0f} s; it runs from {found.own.t[0]:.0f} to "
                f"{found.own.t[-1]:.0f} s), so that the closest approach is not known.",
                "own-ship-unknown",
            )
        )
    if found.relative:
        warnings.append(
            Notice(
                "own ship's path is not known: positions and velocities are relative to her, and the closest approach holds "
                "while she keeps course and speed.",
                "relative-motion",
            )
        )
    for sensor, late in zip(found.plots.sensors, engine.latency):
        if sensor.latency_std and late.std > _POORLY:
            warnings.append(
                Notice(
                    f"the latency of sensor {sensor.name} is {late.value:.1f} s with a standard deviation of {late.std:.1f} s: "
                    "one sensor alone, or targets that hardly move, do not show it.",
                    "latency-not-known",
                )
            )
    return tuple(warnings)
