"""What the features of a chart are: the object classes and attributes of S-57 (IHO, edition 3.1), by number, acronym or word.

GeoJSON has no vocabulary of its own. A feature says what it is in a property: ``OBJL`` (the number of S-57), the name of its class
or layer (``DEPARE``), or the words of OpenSeaMap (``seamark:type``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

from shipid.foundation.aliases import Plain

#: What a chart draws.
Kind = Literal["land", "depth", "contour", "coast", "buoy", "beacon"]
#: Object classes of S-57: number, acronym, what is drawn, and which mark it is.
_CLASSES: tuple[tuple[int, str, Kind, str | None], ...] = (
    (5, "BCNCAR", "beacon", "cardinal"), (6, "BCNISD", "beacon", "isolated"), (7, "BCNLAT", "beacon", "lateral"),
    (8, "BCNSAW", "beacon", "safe"), (9, "BCNSPP", "beacon", "special"), (14, "BOYCAR", "buoy", "cardinal"),
    (15, "BOYINB", "buoy", None), (16, "BOYISD", "buoy", "isolated"), (17, "BOYLAT", "buoy", "lateral"),
    (18, "BOYSAW", "buoy", "safe"), (19, "BOYSPP", "buoy", "special"), (30, "COALNE", "coast", None),
    (42, "DEPARE", "depth", None), (43, "DEPCNT", "contour", None), (46, "DRGARE", "depth", None),
    (71, "LNDARE", "land", None), (122, "SLCONS", "coast", None),
)  # fmt: skip
CLASSES = {acronym: (kind, mark) for _, acronym, kind, mark in _CLASSES}
_NUMBERS = {number: acronym for number, acronym, _, _ in _CLASSES}
#: Words for the same, and those of OpenSeaMap.
_WORDS = {
    "land": "LNDARE", "land_area": "LNDARE", "island": "LNDARE", "depth_area": "DEPARE", "dredged_area": "DRGARE",
    "depth_contour": "DEPCNT", "contour": "DEPCNT", "isobath": "DEPCNT", "coastline": "COALNE", "coast": "COALNE",
    "shoreline": "COALNE", "shoreline_construction": "SLCONS",
    **{f"{what}_{word}": f"{short}{acronym}" for what, short in (("buoy", "BOY"), ("beacon", "BCN")) for word, acronym in (
        ("lateral", "LAT"), ("cardinal", "CAR"), ("isolated_danger", "ISD"), ("safe_water", "SAW"), ("special_purpose", "SPP"))},
    "buoy": "BOYINB", "buoy_installation": "BOYINB",
}  # fmt: skip
_CLASS_KEYS = (
    "objl",
    "objectclass",
    "acronym",
    "layer",
    "class",
    "featuretype",
    "seamarktype",
    "natural",
    "type",
    "kind",
)
_COLOURS = {
    "1": "white", "2": "black", "3": "red", "4": "green", "5": "blue", "6": "yellow", "7": "grey", "8": "brown",
    "9": "amber", "10": "violet", "11": "orange", "12": "magenta", "13": "pink",
}  # fmt: skip
_BUOY_SHAPES = {"1": "conical", "2": "can", "3": "spherical", "4": "pillar", "5": "spar", "6": "barrel", "7": "super-buoy", "8": "ice buoy"}  # fmt: skip
_BEACON_SHAPES = {"1": "stake", "2": "withy", "3": "tower", "4": "lattice", "5": "pile", "6": "cairn", "7": "buoyant"}
#: A mark of a preferred channel is on the side of the main one.
_SIDES = {
    "1": "port", "2": "starboard", "3": "port", "4": "starboard", "port": "port", "starboard": "starboard",
    "preferred_channel_starboard": "port", "preferred_channel_port": "starboard",
}  # fmt: skip
_QUARTERS = {"1": "north", "2": "east", "3": "south", "4": "west", "north": "north", "east": "east", "south": "south", "west": "west"}  # fmt: skip
_LONGEST_TEXT = 100
#: Deeper than this, in m, is no depth.
_DEEPEST = 12_000.0


def short_keys(properties: Mapping[str, Plain]) -> dict[str, Plain]:
    """Return properties by their names in small letters and digits only; the first of equal names counts.

    Parameters
    ----------
    properties : mapping of str to plain values
        Of a feature.
    """
    found: dict[str, Plain] = {}
    for key, value in list(properties.items())[:500]:
        if value is not None and isinstance(value, (str, int, float, list, tuple)):
            found.setdefault("".join(c for c in str(key)[:_LONGEST_TEXT].lower() if c.isalnum()), value)
    return found


def object_class(properties: Mapping[str, Plain]) -> str | None:
    """Return the acronym of a feature's object class; None where none is drawn or stated.

    Parameters
    ----------
    properties : mapping of str to plain values
        As `short_keys` gives them.
    """
    for key in _CLASS_KEYS:
        value = properties.get(key)
        if isinstance(value, (int, float)) and not isinstance(value, bool) and value in _NUMBERS:
            return _NUMBERS[int(value)]
        if isinstance(value, str):
            word = value.strip()[:_LONGEST_TEXT]
            if word.isdigit() and len(word) < 6 and int(word) in _NUMBERS:
                return _NUMBERS[int(word)]
            if word.upper() in CLASSES:
                return word.upper()
            known = _WORDS.get("_".join(word.lower().replace("-", " ").replace("_", " ").split()))
            if known:
                return known
    return None


def class_stated(properties: Mapping[str, Plain]) -> str:
    """Return what a feature calls its class, whether that is drawn or not; empty where it says nothing.

    Parameters
    ----------
    properties : mapping of str to plain values
        As `short_keys` gives them.
    """
    for key in _CLASS_KEYS:
        value = properties.get(key)
        if isinstance(value, (str, int)) and not isinstance(value, bool) and str(value).strip():
            return "".join(c if c.isprintable() else "?" for c in str(value).strip()[:40])
    return ""


def depth_of(properties: Mapping[str, Plain], *names: str) -> float | None:
    """Return the first depth that is stated, in m.

    Parameters
    ----------
    properties : mapping of str to plain values
        As `short_keys` gives them.
    *names : str
        What it may be called.
    """
    for name in names:
        value = properties.get(name)
        try:
            depth = float(value) if isinstance(value, (str, int, float)) and not isinstance(value, bool) else math.nan
        except (ValueError, OverflowError):
            continue
        if abs(depth) <= _DEEPEST:
            return depth
    return None


def mark_of(acronym: str, properties: Mapping[str, Plain]) -> dict[str, Plain]:
    """Return what a buoy or a beacon is, by the names of `Buoy`.

    Parameters
    ----------
    acronym : str
        Its object class.
    properties : mapping of str to plain values
        As `short_keys` gives them.
    """
    structure, mark = CLASSES[acronym]
    # OpenSeaMap puts the class into the key: seamark:buoy_lateral:colour.
    inner = f"seamark{structure}{ {'LAT': 'lateral', 'CAR': 'cardinal', 'ISD': 'isolateddanger', 'SAW': 'safewater', 'SPP': 'specialpurpose'}.get(acronym[3:], '') }"

    def stated(*names: str) -> list[str]:
        for name in (*names, *(inner + n for n in ("category", "colour", "shape") if n in names)):
            value = properties.get(name)
            if value is not None:
                parts = value if isinstance(value, (list, tuple)) else str(value).replace(";", ",").split(",")
                return [str(p).strip().lower()[:_LONGEST_TEXT] for p in parts[:10] if str(p).strip()]
        return []

    category = stated("catlam" if mark == "lateral" else "catcam", "category")
    first = category[0] if category else ""
    shapes = stated("boyshp" if structure == "buoy" else "bcnshp", "shape")
    names = stated_name(properties)
    by_number = _BUOY_SHAPES if structure == "buoy" else _BEACON_SHAPES
    return {
        "kind": _SIDES.get(first) if mark == "lateral" else mark,
        "quarter": _QUARTERS.get(first) if mark == "cardinal" else None,
        "structure": structure,
        "colour": tuple(_COLOURS.get(c, c) for c in stated("colour", "color")),
        "shape": by_number.get(shapes[0], shapes[0]) if shapes else None,
        "name": names,
    }


def stated_name(properties: Mapping[str, Plain]) -> str | None:
    """Return the name of a feature; None where it has none.

    Parameters
    ----------
    properties : mapping of str to plain values
        As `short_keys` gives them.
    """
    for key in ("objnam", "seamarkname", "name"):
        value = properties.get(key)
        if isinstance(value, str) and value.strip():
            return value.strip()[:_LONGEST_TEXT]
    return None
