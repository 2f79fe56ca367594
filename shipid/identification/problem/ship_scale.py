"""The scale of a ship in her trials: her usual speed U, and her length L or an estimate of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.scale import Scale
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.speed import speed_before_in
from shipid.trials.trial import Trial


def usual_speed(ship: ParameterSet, trials: Sequence[Trial]) -> float:
    """Return the usual speed of the trials in m/s, the ship's own where they record none, 1 where neither is known.

    Parameters
    ----------
    ship : ParameterSet
        For its own speed.
    trials : sequence of Trial
        For the recorded one.
    """
    recorded = [float(np.nanmedian(t[n])) for t in trials for n in ("u", "U") if t.has(n) and np.isfinite(t[n]).any()]
    speed = float(np.mean(recorded)) if recorded else ship.particular("speed", "m/s")
    return speed if speed and speed > 0 else 1.0


def guessed_unit_time(trials: Sequence[Trial]) -> float:
    """Return L/U in s, estimated from the rudder's period: zig-zags of ships have periods of 7 to 12 L/U.

    Parameters
    ----------
    trials : sequence of Trial
        Of a ship whose length is unknown; the estimate only scales the first search.
    """
    guesses = []
    for trial in trials:
        # The middle of its range: a rudder that lies to one side for more than half of the time has its median there.
        for moved in _moved(trial):
            delta = moved - np.mean(np.quantile(moved, [0.05, 0.95]))
            changes = np.flatnonzero(np.diff(np.sign(delta[np.abs(delta) > 0.3 * np.abs(delta).max()])))
            guesses.append(trial.duration / max(1.0, (changes.size + 1) / 2) / 9)
    return float(np.median(guesses))


def _moved(trial: Trial) -> list[np.ndarray]:
    """The rudder of a trial, or its order; of a ship without one everything in the log that moves."""
    columns = {n: trial[n][np.isfinite(trial[n])] for n in trial.table.columns if n != "t"}
    moving = {n: values for n, values in columns.items() if values.size and np.ptp(values) > 0}
    rudder = [moving[n] for n in ("delta", "delta_order") if n in moving][:1]
    return rudder or list(moving.values())


def scale_of(ship: ParameterSet, trials: Sequence[Trial], length: float | None = None) -> Scale:
    """Return length and usual speed, the length estimated from the rudder's period where it is unknown.

    Parameters
    ----------
    ship : ParameterSet
        For length and speed.
    trials : sequence of Trial
        For the recorded speed.
    length : float, optional
        L in m, where it is known from elsewhere; that of the ship by default.

    Returns
    -------
    Scale
    """
    speed = usual_speed(ship, trials)
    length = length or ship.particular("L", "m")
    return Scale(length or speed * guessed_unit_time(trials), speed)


def scale_before(ship: ParameterSet, trial: Trial) -> Scale:
    """Return length and the speed before the manoeuvre of one trial: a ship in a hard turn has lost most of it in most of the record.

    Parameters
    ----------
    ship : ParameterSet
        For length and speed.
    trial : Trial
        For the recorded speed.

    Returns
    -------
    Scale
        That of `scale_of` where the trial records no speed ahead.
    """
    usual = scale_of(ship, [trial])
    before = speed_before_in({n: trial[n] for n in trial.table.columns}, usual.unit_time)
    return usual if before is None or not before.value > 0 else Scale(usual.length, before.value)
