"""The scale of a ship: its usual speed, and L/U, the time in which it sails its length."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.parameters import ParameterSet
from shipid.trials.trial import Trial


def speed_of(ship: ParameterSet, trials: Sequence[Trial]) -> float:
    """Return the usual speed of the trials in m/s, the ship's own where they record none, 1 where nobody knows it.

    Parameters
    ----------
    ship : ParameterSet
        For its own speed.
    trials : sequence of Trial
        For the recorded one.
    """
    recorded = [float(np.median(t[n])) for t in trials for n in ("u", "U") if t.has(n)]
    speed = float(np.mean(recorded)) if recorded else ship.particular("speed", "m/s")
    return speed if speed and speed > 0 else 1.0


def own_unit_time(trials: Sequence[Trial]) -> float:
    """Return L/U in s, guessed from the rudder's period: zig-zags of ships take 7 to 12 L/U.

    Parameters
    ----------
    trials : sequence of Trial
        Of a ship whose length is unknown; the guess only scales the first search.
    """
    guesses = []
    for trial in trials:
        # The middle of its range: a rudder that lies to one side for more than half of the time has its median there.
        delta = trial["delta"] - np.mean(np.quantile(trial["delta"], [0.05, 0.95]))
        changes = np.flatnonzero(np.diff(np.sign(delta[np.abs(delta) > 0.3 * np.abs(delta).max()])))
        guesses.append(trial.duration / max(1.0, (changes.size + 1) / 2) / 9)
    return float(np.median(guesses))


def unit_time_of(ship: ParameterSet, trials: Sequence[Trial]) -> float:
    """Return L/U of some trials in s, guessed from the rudder where the length is unknown.

    Parameters
    ----------
    ship : ParameterSet
        For length and speed.
    trials : sequence of Trial
        For the recorded speed.
    """
    length = ship.particular("L", "m")
    return length / speed_of(ship, trials) if length else own_unit_time(trials)
