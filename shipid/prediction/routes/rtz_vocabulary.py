"""The words of RTZ (IEC 61174, versions 1.0 to 1.2): which of them are read, which limits of a voyage are not, and what is no word of it.

A cross-track limit that is misspelt is no limit to a reader that passes over it, and the track beside it looks safe. So what is not
understood is told.
"""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Iterable, Mapping

from shipid.foundation.notices import Notice


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_LEG = _words(
    "starboardXTD portsideXTD safetyContour safetyDepth geometryType speedMin speedMax "
    "draughtForward draughtAft staticUKC dynamicUKC masthead legReport legInfo legNote1 legNote2"
)
_SCHEDULED = _words(
    "waypointId etd etdWindowBefore etdWindowAfter eta etaWindowBefore etaWindowAfter stay speed "
    "speedWindow windSpeed windDirection currentSpeed currentDirection windLoss waveLoss totalLoss "
    "rpm pitch fuel relFuelSave absFuelSave note"
)
#: The name that a schedule's element has in the standard, and the one that programs for its first version write.
SCHEDULED = ("scheduleElement", "sheduleElement")
#: Attributes of each element, by its path below the route.
_WORDS: dict[str, frozenset[str]] = {
    "": frozenset(("version",)),
    "routeInfo": _words(
        "routeName routeAuthor routeStatus validityPeriodStart validityPeriodStop vesselName vesselMMSI "
        "vesselIMO vesselVoyage vesselDisplacement vesselCargo vesselGM optimizationMethod vesselMaxRoll "
        "vesselMaxWave vesselMaxWind vesselSpeedMax vesselServiceMin vesselServiceMax "
        "routeChangesHistory"
    ),
    "waypoints": frozenset(),
    "waypoints/defaultWaypoint": frozenset(("radius",)),
    "waypoints/defaultWaypoint/leg": _LEG,
    "waypoints/waypoint": frozenset(("id", "revision", "name", "radius")),
    "waypoints/waypoint/position": frozenset(("lat", "lon")),
    "waypoints/waypoint/leg": _LEG,
    "schedules": frozenset(),
    "schedules/schedule": frozenset(("id", "name")),
    **{f"schedules/schedule/{kind}": frozenset() for kind in ("manual", "calculated")},
    **{f"schedules/schedule/{kind}/{e}": _SCHEDULED for kind in ("manual", "calculated") for e in SCHEDULED},
}
#: Words that some programs write with a capital, as examples of the standard have it.
_CAPITALS = {"Note": "note"}
#: What a route states as a limit, and nothing here heeds.
_UNHEEDED = _words("safetyContour safetyDepth speedMin speedMax staticUKC dynamicUKC masthead vesselSpeedMax")
_SHOWN, _LONGEST = 5, 40


class RtzWords:
    """What a file says beside what is read of it, counted."""

    def __init__(self) -> None:
        self.strange: Counter[str] = Counter()
        self.unheeded: Counter[str] = Counter()

    def see(self, at: str, attributes: Iterable[str]) -> bool:
        """Count the words of an element that are not read.

        Parameters
        ----------
        at : str
            Its path below the route.
        attributes : iterable of str
            Names of its attributes; those of another vocabulary have its address before them.

        Returns
        -------
        bool
            Whether RTZ has such an element.
        """
        known = _WORDS.get(at)
        element = at.rpartition("/")[2] or "route"
        if known is None:
            parent = at.rpartition("/")[0]
            inner = [p.rpartition("/")[2] for p in _WORDS if p and p.rpartition("/")[0] == parent]
            self.strange[f"element {_short(element)}{_meant(element, inner)}"] += 1
            return False
        for name in attributes:
            if " " in name or _CAPITALS.get(name, name) in known:
                self.unheeded[name] += name in _UNHEEDED
            else:
                self.strange[f"{_short(name)} of {element}{_meant(name, known)}"] += 1
        return True

    def notices(self) -> list[Notice]:
        """Return what is to be told."""
        told = []
        if self.strange:
            told.append(
                Notice(
                    f"not understood, and left out: {_listed(self.strange)}. RTZ has no such words; a limit among them is not heeded.",
                    "route-not-understood",
                )
            )
        if +self.unheeded:
            told.append(
                Notice(
                    f"limits that the route states and that are not heeded here: {_listed(+self.unheeded)}.",
                    "route-not-heeded",
                )
            )
        return told


def _listed(counts: Mapping[str, int]) -> str:
    shown = [f"{name} ({n} times)" if n > 1 else name for name, n in list(counts.items())[:_SHOWN]]
    return ", ".join(shown) + (f", and {len(counts) - _SHOWN} more" if len(counts) > _SHOWN else "")


def _short(name: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in name[:_LONGEST])


def _meant(name: str, words: Iterable[str]) -> str:
    """The word that is nearest to one that is none, whatever its capitals."""
    by_small = {w.lower(): w for w in words}
    near = difflib.get_close_matches(name[:_LONGEST].lower(), by_small, n=1, cutoff=0.6)
    return f" (is {by_small[near[0]]} meant?)" if near else ""
