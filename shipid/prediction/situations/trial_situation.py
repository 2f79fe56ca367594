"""The situation of a ship at an instant of a trial: what the filter of her own model knows of what came before."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.join import join
from shipid.declaration.model import Model
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.sensors import standard_noise
from shipid.parts.wind import Wind
from shipid.prediction.situations.filtered_situation import situation_of
from shipid.prediction.situations.own_ship_filter import own_ship_filter
from shipid.prediction.situations.situation import Situation
from shipid.trials.trial import Trial

#: Samples a filter has to have seen.
_LEAST = 10
#: What a filter may measure, in this order.
_MEASURED: tuple[str, ...] = ("psi", "r", "u", "v", "x", "y")
_WIND = ("wind_speed", "wind_direction")


def situation_in(
    model: Model, ship: ParameterSet, trial: Trial, at: float | None = None, stated: Mapping[str, float] | None = None
) -> tuple[Situation, list[Notice]]:
    """Return what is known of a ship at an instant of a trial; no later sample is used.

    Parameters
    ----------
    model : Model
        The ship.
    ship : ParameterSet
        Her coefficients and particulars.
    trial : Trial
        The record.
    at : float, optional
        Time in s on the clock of the record; its last sample by default.
    stated : mapping of str to float, optional
        Inputs that go before those of the record, SI.

    Returns
    -------
    situation : Situation
    told : list of Notice
        What is not known.

    Raises
    ------
    UsageError
        If the record has too few samples before that time, or no heading.
    """
    before = trial if at is None else _until(trial, at)
    if len(before) < _LEAST:
        raise UsageError(
            f"trial {trial.name} has {len(before)} samples up to {at:g} s, too few for a filter: give a later time."
            if at is not None
            else f"trial {trial.name} has {len(before)} samples, too few for a filter."
        )
    told: list[Notice] = []
    windy = "r_disturbance" in model.inputs and before.has(*_WIND) and ship.find(_with_wind(model), "N_w") is not None
    whole = _with_wind(model) if windy else model
    levels = standard_noise()
    sensors = {
        n: f"{levels[n]} {whole[n].unit}"
        for n in ("psi", "r", "u", "v", "x", "y")
        if n in levels and _seen(before, whole, n)
    }
    if "psi" not in sensors:
        raise UsageError(f"trial {trial.name} holds no heading up to that time, and a prediction begins from one.")
    if not {"x", "y"} <= set(sensors):
        told.append(
            Notice("the record holds no position: the current is not known, and taken as none.", "current-not-known")
        )
    kalman = own_ship_filter(whole, ship, measured=sensors)
    run = kalman.filter(before)
    found = situation_of(run)
    values = {**found.values, **(stated or {})}
    if "u" not in values:
        values["u"] = _last(before, "u")
    return Situation(values, found.uncertain, found.covariance, found.noise, found.t), told


def _until(trial: Trial, at: float) -> Trial:
    t = trial["t"]
    if not t[0] <= at <= t[-1] + 1e-9:
        raise UsageError(f"trial {trial.name} lasts from {t[0]:.5g} to {t[-1]:.5g} s, and {at:g} s is not in it.")
    return trial.window(None, at)


def _with_wind(model: Model) -> Model:
    return join(f"{model.name}-in-wind", model, Wind)


def _seen(trial: Trial, model: Model, name: str) -> bool:
    return name in (*model.states, *model.derived) and trial.has(name)


def _last(trial: Trial, name: str) -> float:
    if not trial.has(name):
        raise UsageError(f"trial {trial.name} holds no forward speed '{name}', by which a track is predicted.")
    values = trial[name]
    return float(values[np.isfinite(values)][-1])
