"""The trackers by name: which modes a target may be in, and how they are treated."""

from __future__ import annotations

import math
from typing import Literal, get_args

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.tracking.filters.motion import Motion, TargetMode
from shipid.foundation.errors import UnknownNameError
from shipid.parameters.catalogue import find_model
from shipid.parameters.parameter_set import ParameterSet

#: The trackers.
TrackerName = Literal["imm", "cv", "fs-aimm", "vs-aimm", "agimm", "alpha-beta"]
NAMES: tuple[str, ...] = get_args(TrackerName)
#: Density of the acceleration noise on a straight course and in a manoeuvre, m/s^1.5, and how long a manoeuvre lasts, s. On the
#: real detections of `studies/real_tracking.py` the tracks hardly depend on them.
_STEADY, _MANOEUVRE, _LASTS = 0.14, 0.55, 20.0
#: Sharpest turn of a ship of unknown size, rad/s: 6 deg/s is that of a boat of 12 m.
_SHARPEST = math.radians(6.0)
#: Steady turning diameter in ship lengths that a ship is taken to have at full rudder; the criterion of MSC.137(76) is a
#: tactical diameter of five lengths or less, and most ships have three to four.
_DIAMETER = 3.5


def motion_of(name: str, ship: ParameterSet | None = None) -> Motion:
    """Return the modes of a tracker.

    Parameters
    ----------
    name : str
        One of `NAMES` without ``alpha-beta``: ``imm`` has two modes, steady and manoeuvring; ``cv`` the first alone; the others
        three, straight and turning to either side, with an estimated part of the turn (fixed structure), turns that adjust
        themselves (variable structure), or a grid of turns that follows the mode probabilities (adaptive grid).
    ship : ParameterSet, optional
        The target's ship: her length says how sharply she turns, at any speed.

    Returns
    -------
    Motion

    Raises
    ------
    UnknownNameError
        If there is no such tracker.
    EncounterRequestError
        If the ship's length is not known, or the tracker has no turns for a ship to know.
    """
    if name not in NAMES or name == "alpha-beta":
        raise UnknownNameError("tracker", name, NAMES)
    if name in ("imm", "cv"):
        if ship is not None:
            raise EncounterRequestError(
                f"tracker {name} has no mode that turns, so that a ship does not help it. Leave the ship out, or take fs-aimm, "
                "vs-aimm or agimm."
            )
        modes = (
            TargetMode("steady", acceleration=_STEADY),
            TargetMode("manoeuvring", acceleration=_MANOEUVRE, stays=_LASTS),
        )
        return Motion(
            find_model("coordinated-turn-augmented"),
            modes if name == "imm" else (TargetMode("steady", acceleration=0.22),),
        )
    sharpest, model = _SHARPEST, "coordinated-turn-augmented"
    if ship is not None:
        length = ship.particular("L", "m")
        if length is None:
            raise EncounterRequestError(f"ship {ship.name} has no length L, which says how sharply she turns.")
        sharpest, model = 2 / (_DIAMETER * length), "coordinated-circle-augmented"
    low, spread = sharpest / 3, sharpest / 5
    structure = {"fs-aimm": "fixed", "vs-aimm": "variable", "agimm": "grid"}[name]
    # The grid has no estimated part: its turns themselves move.
    turn, more = (0.6 * sharpest, 0.0 if structure == "grid" else spread)
    bounds = (-sharpest, -low), (0.0, 0.0), (low, sharpest)
    if structure == "grid":
        bounds = (-sharpest, -sharpest), (0.0, 0.0), (sharpest, sharpest)
    port, straight, starboard = (
        TargetMode(label, at, _STEADY, *ends, more=wide, stays=lasts)
        for label, at, ends, wide, lasts in (
            ("port", -turn, bounds[0], more, _LASTS),
            ("straight", 0.0, bounds[1], 0.0, 60.0),
            ("starboard", turn, bounds[2], more, _LASTS),
        )
    )
    return Motion(find_model(model), (port, straight, starboard), structure)
