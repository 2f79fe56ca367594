"""The speeds and the amplitudes that trials reach, and what is said of a record that goes beyond those of a ship's coefficients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.notices import Notice
from shipid.identification.loading import loading_of
from shipid.parameters.loading import MEASURES
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import beyond, speed_given
from shipid.trials.signals.ship_length import length_notice
from shipid.trials.speed import SpeedBefore, recorded_speed, speed_before_in
from shipid.trials.trial import Trial

#: Share of the samples that an amplitude is not exceeded in: one wild sample is no amplitude that was reached.
_REACHED = 0.995
#: Samples of a mean in which the noise of one does not count: of a speed, and of both headings of which a rate of turn is made.
_MEAN = 7
#: To one side only: the rudder goes less far to the other than this share of the way.
_OTHER_SIDE = 0.2
ONE_SIDED = "one-sided"


def recorded_speeds(trials: Sequence[Trial]) -> tuple[float, float] | None:
    """Return the lowest and the highest forward speed in m/s that trials went through, from the approach to the slowest.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.

    Returns
    -------
    tuple of float or None
        With four digits, as they are written. None where no trial records a speed, or the ship goes astern.
    """
    found: list[float] = []
    for trial in trials:
        before, speed = _before(trial), recorded_speed(_columns(trial))
        if before is None or speed is None:
            continue
        there = speed[np.isfinite(speed)]
        means = np.convolve(there, np.full(_MEAN, 1 / _MEAN), "valid") if there.size > 4 * _MEAN else there
        found += [before.value, *np.quantile(means, [1 - _REACHED, _REACHED])]
    if not found or max(found) < 0:
        return None
    return _written(max(0.0, min(found))), _written(max(found))


def speed_before_of(trials: Sequence[Trial]) -> float | None:
    """Return the mean speed before the manoeuvre of trials in m/s, to which coefficients with a dimension belong.

    A model with such coefficients does not know that the ship loses speed in the manoeuvre: they hold what she does on average in
    manoeuvres that begin at this speed.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.

    Returns
    -------
    float or None
        With four digits, as it is written. None where no trial records a speed, or the ship goes astern.
    """
    found = [before.value for trial in trials if (before := _before(trial)) is not None]
    return _written(float(np.mean(found))) if found and np.mean(found) > 0 else None


def largest_amplitudes(trials: Sequence[Trial]) -> dict[str, float]:
    """Return the largest rudder angle, rate of turn and drift angle of trials, SI, as far as they are recorded.

    The order stands for a rudder angle that is not recorded, and the slope of the heading for the rate of turn.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.

    Returns
    -------
    dict of str to float
        ``rudder``, ``rate`` and ``drift`` with four digits, as they are written.
    """
    found: dict[str, float] = {}
    for trial in trials:
        columns: dict[str, np.ndarray | None] = {
            # Where only the order is logged, it is what the ship was steered with.
            "rudder": next((trial[n] for n in ("delta", "delta_order") if trial.has(n)), None),
            "rate": trial["r"] if trial.has("r") else _slope_of_heading(trial),
        }
        columns["drift"] = np.arctan2(-trial["v"], trial["u"]) if trial.has("u", "v") else None
        for name, column in columns.items():
            sizes = np.abs(column[np.isfinite(column)]) if column is not None else np.zeros(0)
            # A sway of zero all along is none that was seen: a model without one wrote the record.
            if sizes.size and (name != "drift" or sizes.any()):
                found[name] = max(found.get(name, 0.0), float(np.quantile(sizes, _REACHED)))
    return {n: float(np.deg2rad(_written(np.rad2deg(v)))) for n, v in found.items()}


def one_sided_notices(trials: Sequence[Trial]) -> list[Notice]:
    """Return what has to be said of trials in which the ship is turned to one side only.

    Parameters
    ----------
    trials : sequence of Trial
        All that were fitted.
    """
    ends = []
    for trial in trials:
        column = next((trial[n] for n in ("delta", "delta_order") if trial.has(n)), np.zeros(0))
        there = column[np.isfinite(column)]
        ends += [np.quantile(there, [1 - _REACHED, _REACHED])] if there.size else []
    port, starboard = (-min(e[0] for e in ends), max(e[1] for e in ends)) if ends else (0.0, 0.0)
    if min(port, starboard) >= _OTHER_SIDE * max(port, starboard):
        return []
    seen, other = ("starboard", "port") if starboard > port else ("port", "starboard")
    return [
        Notice(
            f"the rudder goes to {seen} only in what was fitted: how the ship turns to {other} is not seen, and a ship that turns unlike to "
            "both sides passes for one with a rudder bias. A zig-zag tells.",
            ONE_SIDED,
        )
    ]


def _columns(trial: Trial) -> dict[str, np.ndarray]:
    return {n: trial[n] for n in trial.table.columns}


def _before(trial: Trial) -> SpeedBefore | None:
    return speed_before_in(_columns(trial))


def _written(value: float) -> float:
    return float(f"{value:.4g}")


def _slope_of_heading(trial: Trial) -> np.ndarray | None:
    """The slope of the heading in rad/s, between means of so many samples that the noise of one does not count."""
    if not trial.has("psi"):
        return None
    there = np.isfinite(trial["psi"])
    t, psi = trial["t"][there], trial["psi"][there]
    if t.size <= 4 * _MEAN:
        return None
    t, psi = (np.convolve(column, np.full(_MEAN, 1 / _MEAN), "valid") for column in (t, psi))
    return np.asarray((psi[_MEAN:] - psi[:-_MEAN]) / (t[_MEAN:] - t[:-_MEAN]))


def beyond_of_record(
    model: Model, ship: ParameterSet | None, trial: Trial, held: Mapping[str, float] | None = None
) -> list[Notice]:
    """Return what has to be said where a record goes beyond the range that a ship's coefficients come from, or is none of a ship so long.

    Parameters
    ----------
    model : Model
        What is run over it.
    ship : ParameterSet or None
        Whose coefficients.
    trial : Trial
        The record.
    held : mapping of str to float, optional
        Inputs that were given, SI: a speed goes before that of the record.

    Returns
    -------
    list of Notice
    """
    if ship is None:
        return []
    before, given = _before(trial), speed_given(held or {})
    reached = largest_amplitudes([trial])
    found = beyond(
        model,
        ship,
        [given] if given is not None else [] if before is None else [before.value],
        reached.get("rudder"),
        rate=reached.get("rate"),
        drift=reached.get("drift"),
        loading={m: v for m in MEASURES if (v := loading_of(trial, m)) is not None},
    )
    unlike = length_notice(trial, ship.particular("L", "m"))
    return found if unlike is None else [*found, unlike]
