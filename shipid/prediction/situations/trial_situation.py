"""The situation of a ship at an instant of a trial: what the filter of her own model knows of what came before."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

import numpy as np

from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import shown
from shipid.estimation.by_record import filter_by_record
from shipid.estimation.records.run import FilterRun
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import moment
from shipid.identification.problem.prior import INDEPENDENT
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.sensors import standard_noise
from shipid.parts.wind import Wind
from shipid.prediction.situations.filtered_situation import situation_of
from shipid.prediction.situations.fix_errors import (
    CURRENT,
    MOVE_REMEMBERED,
    TURN_REMEMBERED,
    moved_of_late,
    stretch_squares,
    widened_current,
)
from shipid.prediction.situations.own_ship_filter import DISTURBANCES, own_ship_filter
from shipid.prediction.situations.past import APART, Past
from shipid.prediction.situations.situation import Situation
from shipid.trials.trial import Trial

#: Samples a filter has to have seen.
_LEAST = 10
#: What a filter may measure, in this order.
_MEASURED: tuple[str, ...] = ("psi", "r", "u", "v", "x", "y")
#: What an order is, or takes the place of.
_STEERED = ("delta", "delta_order", "psi_order", "r_order", "cruise")
_WIND = ("wind_speed", "wind_direction")
#: The wind is averaged over the last so many L/U.
_WIND_MEAN = 3.0
#: A record with more samples than this in one L/U is read at every second or third: none of it is faster than the ship.
_FINEST = 40
#: Past instants from which the voyage since is predicted, at most.
_MOST = 40


def logged_inputs(
    model: Model, trial: Trial, at: float | None = None, stated: Collection[str] = ()
) -> tuple[dict[str, float], list[Notice]]:
    """Return the inputs that a prediction from a record holds at what the record says last, such as a shaft speed.

    Parameters
    ----------
    model : Model
        The ship.
    trial : Trial
        The record.
    at : float, optional
        Time in s on its clock; its last sample by default.
    stated : collection of str
        Inputs that are stated otherwise.

    Returns
    -------
    held : dict of str to float
        By input, SI: those of the model without a default that the record holds, its motion and its rudder left out.
    told : list of Notice
        At what they are held.
    """
    held, told = {}, []
    for name in model.inputs:
        moved = name in (*_MEASURED, *_STEERED, *stated) or model[name].number("default") is not None
        if moved or not trial.has(name):
            continue
        seen = trial[name][trial["t"] <= (np.inf if at is None else at)]
        seen = seen[np.isfinite(seen)]
        if not seen.size:
            continue
        held[name] = float(seen[-1])
        last, least, most = (shown(float(v), name, model[name].unit) for v in (seen[-1], seen.min(), seen.max()))
        varied = (
            ""
            if least == most
            else f"; before that it went from {least} to {most}, and the filter takes it as it is now"
        )
        told.append(Notice(f"{name} stays at {last}, as it was logged last{varied}.", "input-as-logged", quantity=name))
    return held, told


def known_before(
    model: Model, ship: ParameterSet, trial: Trial, at: float | None = None, stated: Mapping[str, float] | None = None
) -> tuple[Situation, list[Notice], Past]:
    """Return what is known of a ship at an instant of a trial, and what was known at instants before it.

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
    past : Past
        Instants apart by `APART`, and the voyage as it was estimated; none where the record has no rudder angle.

    Raises
    ------
    UsageError
        If the record has too few samples before that time, or no heading.
    """
    seen = len(trial) if at is None else _seen_until(trial, at)
    if seen < _LEAST:
        raise UsageError(
            f"trial {trial.name} has {seen} samples up to {moment(at)} s, too few for a filter: give a later time."
            if at is not None
            else f"trial {trial.name} has {seen} samples, too few for a filter."
        )
    before = trial if at is None else trial.window(None, at)
    before = _coarser(before, ship)
    told: list[Notice] = []
    windy = "r_disturbance" in model.inputs and before.has(*_WIND) and ship.find(_with_wind(model), "N_w") is not None
    whole = _with_wind(model) if windy else model
    levels: Mapping[str, float] = standard_noise()
    sensors: dict[str, Amount | None] = {}
    for name in _MEASURED:
        if name in levels and _seen(before, whole, name):
            sensors[name] = f"{levels[name]} {whole[name].unit}"
    if "psi" not in sensors:
        raise UsageError(f"trial {trial.name} holds no heading up to that time, and a prediction begins from one.")
    if not {"x", "y"} <= set(sensors):
        told.append(
            Notice("the record holds no position: the current is not known, and taken as none.", "current-not-known")
        )
    kalman = own_ship_filter(whole, ship, measured=sensors)
    # What drives current and disturbance is chosen for a ship of her size; all other levels come from the record.
    kept = [f"noise:{s.name}" for s in kalman.design.sources if not s.assumed]
    # A bias of the rudder angle is in the estimated yaw acceleration, which goes on while she is predicted; one that is added to
    # the record's rudder alone would end with it.
    if any(n in kalman.model.states for n in DISTURBANCES):
        kept.append("bias:delta")
    run, _ = filter_by_record(kalman, before, kept)
    told += run.warnings

    def known(at: float) -> Situation:
        found, seen = situation_of(run, at), before.window(None, at)
        values = {**found.values, **_mean_wind(seen, whole, found.values, ship), **(stated or {})}
        if "u" not in values:
            values["u"] = _last(seen, "u")
        squares, turning = _fix_squares(run, seen, ship, values["u"]), _turning(run, at, ship, values["u"])
        return widened_current(replace(found, values=values), squares, turning, _moved(run, at, ship, values["u"]))

    now = known(float(run.t[-1]))
    return now, told, _past(run, before, now, ship, known)


def _fix_squares(run: FilterRun, seen: Trial, ship: ParameterSet, speed: float) -> np.ndarray:
    """How far the errors of the fixes last, up to a time; none without a position or a length."""
    length, levels = ship.particular("L", "m"), dict(zip(run.design.measured, run.design.r))
    if not ({"x", "y"} <= set(levels) and length is not None and speed > 0):
        return np.zeros(0)
    off = np.stack([(seen[n] - np.interp(seen["t"], run.t, run[n])) / levels[n] for n in ("x", "y")], axis=1)
    there = np.isfinite(off).all(axis=1)
    return stretch_squares(seen["t"][there], off[there], INDEPENDENT * length / speed)


def _moved(run: FilterRun, at: float, ship: ParameterSet, speed: float) -> float:
    """By how much the estimated current has moved of late, in m/s."""
    length, states = ship.particular("L", "m"), run.design.model.states
    if not set(CURRENT) <= set(states) or length is None or not speed > 0:
        return 0.0
    late = np.flatnonzero((run.t <= at + 1e-9) & (run.t >= at - MOVE_REMEMBERED * length / speed))
    columns = [states.index(n) for n in CURRENT]
    drift = {s.name: s.level**2 for s in run.design.sources if s.place == "state" and s.density}
    variance = run.covariance[late][:, columns, columns]
    return moved_of_late(run.t[late], run.x[late][:, columns], variance, np.array([drift.get(n, 0.0) for n in CURRENT]))


def _turning(run: FilterRun, at: float, ship: ParameterSet, speed: float) -> float:
    """The largest rate of turn of late, |r| L/u."""
    length = ship.particular("L", "m")
    if "r" not in run.design.model or length is None or not speed > 0:
        return 0.0
    late = (run.t <= at) & (run.t >= at - TURN_REMEMBERED * length / speed)
    return float(np.abs(run["r"][late]).max(initial=0.0) * length / speed)


def _past(
    run: FilterRun, trial: Trial, now: Situation, ship: ParameterSet, known: Callable[[float], Situation]
) -> Past:
    """What was known before, and the voyage since."""
    length = ship.particular("L", "m")
    columns = {n: np.asarray(run[n]) for n in ("x", "y", "psi")}
    columns["u"] = np.asarray(run["u"]) if "u" in run.design.model else np.full(run.t.size, now.values["u"])
    instants: list[float] = []
    if trial.has("delta") and length is not None:
        apart = APART * length / now.values["u"]
        # The filter has had a step or two of them to begin.
        instants = [now.t - k * apart for k in range(1, _MOST + 1) if now.t - k * apart > run.t[0] + 2 * apart]
    there = np.isfinite(trial["delta"]) if trial.has("delta") else np.zeros(len(trial), dtype=bool)
    delta = np.interp(run.t, trial["t"][there], trial["delta"][there]) if there.any() else np.zeros(run.t.size)
    sailing = [t for t in instants if np.interp(t, run.t, columns["u"]) > 0 and there.any()]
    return Past(tuple(known(t) for t in sailing), run.t, **columns, delta=delta)


def _mean_wind(trial: Trial, model: Model, values: Mapping[str, float], ship: ParameterSet) -> dict[str, float]:
    """The wind to go on with: the mean of the last few L/U, since what an anemometer shows at one instant is a gust."""
    length = ship.particular("L", "m")
    if not (set(_WIND) <= set(model.inputs) and trial.has(*_WIND)) or length is None or not values.get("u", 0.0) > 0:
        return {}
    t, speed, to = trial["t"], trial["wind_speed"], trial["wind_direction"]
    kept = (t >= t[-1] - _WIND_MEAN * length / values["u"]) & np.isfinite(speed) & np.isfinite(to)
    if not kept.any():
        return {}
    north, east = float((speed * np.cos(to))[kept].mean()), float((speed * np.sin(to))[kept].mean())
    return {"wind_speed": float(np.hypot(north, east)), "wind_direction": float(np.arctan2(east, north))}


def _seen_until(trial: Trial, at: float) -> int:
    """How many samples a trial has up to an instant of it."""
    t = trial["t"]
    if not t[0] <= at <= t[-1] + 1e-9:
        raise UsageError(
            f"trial {trial.name} lasts from {moment(t[0])} to {moment(t[-1])} s, and {moment(at)} s is not in it."
        )
    return int(np.searchsorted(t, at + 1e-9, side="right"))


def _coarser(trial: Trial, ship: ParameterSet) -> Trial:
    """The record with fewer samples, the last one kept, where it is finer than a filter needs and every row is full."""
    length, speed = ship.particular("L", "m"), ship.particular("speed", "m/s")
    if length is None or speed is None or bool(trial.table.isna().to_numpy().any()):
        return trial
    step = int(length / speed / (_FINEST * trial.sampling))
    if step < 2:
        return trial
    rows = slice((len(trial) - 1) % step, None, step)
    return replace(trial, table=trial.table.iloc[rows].reset_index(drop=True))


def _with_wind(model: Model) -> Model:
    return join(f"{model.name}-in-wind", model, Wind)


def _seen(trial: Trial, model: Model, name: str) -> bool:
    return name in (*model.states, *model.derived) and trial.has(name)


def _last(trial: Trial, name: str) -> float:
    if not trial.has(name):
        raise UsageError(f"trial {trial.name} holds no forward speed '{name}', by which a track is predicted.")
    values = trial[name]
    return float(values[np.isfinite(values)][-1])
