"""What is settled before the search: the model, what of it is known, what is to be found and within which bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import prime_factor
from shipid.declaration.units import to_si
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.identification.errors import TrialTooShortError
from shipid.identification.problem.scale import own_unit_time, speed_of
from shipid.identification.search.least_squares import Box, box_of
from shipid.parameters.catalogue import find_model, find_ship, whole_ship
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.trials.trial import Trial


@dataclass(frozen=True)
class Setting:
    """What is known before the search.

    Attributes
    ----------
    model : Model
        What is fitted; published coefficients that are held have taken the place of declared ones.
    ship : ParameterSet
        As given.
    known : dict of str to float
        Values of coefficients and particulars, SI.
    estimated : tuple of str
        Coefficients to estimate.
    length, speed : float
        L in m and U in m/s.
    notes : tuple of str
        What the reader has to know.
    """

    model: Model
    ship: ParameterSet
    known: dict[str, float]
    estimated: tuple[str, ...]
    length: float
    speed: float
    notes: tuple[str, ...]

    @property
    def unit_time(self) -> float:
        """L/U in s."""
        return self.length / self.speed


def settle(
    model: Model | str | Any,
    trials: Sequence[Trial],
    ship: ParameterSet | str | None,
    estimate: Sequence[str] | None,
    fixed: dict[str, str | float],
) -> Setting:
    """Settle what is fitted, and what is known of it.

    Parameters
    ----------
    model, trials, ship, estimate, fixed
        See `shipid.identification.identify.identify`.
    """
    whole = find_model(model) if isinstance(model, str) else model if isinstance(model, Model) else whole_ship(model)
    given = find_ship(ship) if isinstance(ship, str) else ship or ParameterSet("unnamed")
    held = {n: to_si(v, whole[n].unit, f"'{n}' ({whole[n].quantity.meaning})") for n, v in fixed.items()}
    for name in held:
        if whole[name].quantity.kind not in ("parameter", "constant", "derived"):
            kind = "input" if whole[name].quantity.kind == "given" else whole[name].quantity.kind
            raise UsageError(f"'{name}' is no coefficient of model {whole.name} but its {kind}; it cannot be fixed.")
    published = [n for n in held if whole[n].quantity.kind == "derived"]
    whole = whole.impose(published) if published else whole

    speed = speed_of(given, trials)
    known = given.values(whole, speed=speed) | held
    length = known.get("L", given.particular("L", "m"))
    if length is not None and not length > 0:
        raise ParameterSetError(f"the length L of ship {given.name} is {length:g} m; a ship is longer than that.")
    if length is None:
        length = speed * own_unit_time(trials)
    estimated = _estimated(whole, estimate, held)
    notes = []
    for name in whole.parameters:
        start = whole[name].number("start")
        if name not in known and start is not None and name not in estimated:
            known[name] = start * (prime_factor(whole[name].unit, length, speed) if whole[name].quantity.prime else 1.0)
            notes.append(f"{name} was held at its declared start, {known[name]:.4g}, which is assumed.")
    lacking = missing_values(whole, {**known, **dict.fromkeys(estimated, 0.0)}, f"ship {given.name}")
    if lacking:
        raise lacking
    return Setting(whole, given, known, estimated, length, speed, tuple(notes))


def _estimated(model: Model, wanted: Sequence[str] | None, held: Mapping[str, float]) -> tuple[str, ...]:
    if wanted is None:
        chosen = [n for n in model.parameters if model[n].quantity.estimated and n not in held]
    else:
        chosen = []
        for name in wanted:
            partner = name if name in model.parameters else model.partner(name) if name in model else None
            if partner is None:
                raise UnknownNameError(f"parameter of model {model.name} to estimate called", name, model.parameters)
            if partner in held:
                raise UsageError(f"'{name}' is to be estimated and is fixed as well; choose one.")
            chosen.append(partner)
    if not chosen:
        raise UsageError(f"nothing is left to estimate in model {model.name}: every parameter is fixed.")
    return tuple(n for n in model.parameters if n in chosen)


def search_box(setting: Setting) -> Box:
    """Return bounds and first values of the coefficients to estimate.

    Parameters
    ----------
    setting : Setting
        What is known.
    """
    bounds = {}
    for name in setting.estimated:
        entry = setting.model[name]
        scale = prime_factor(entry.unit, setting.length, setting.speed) if entry.quantity.prime else 1.0
        low, high = (entry.number(a) for a in ("low", "high"))
        declared = entry.number("start")
        low = -np.inf if low is None else low * scale
        high = np.inf if high is None else high * scale
        start = setting.known.get(name, scale if declared is None else declared * scale)
        # A value from the ship's own set is believed over a declared bound.
        bounds[name] = (start, min(low, start), max(high, start))
    return box_of(bounds)


def check_length(setting: Setting, trials: Sequence[Trial]) -> None:
    """Refuse a trial that ends before the ship has answered its rudder.

    Parameters
    ----------
    setting : Setting
        What is known.
    trials : sequence of Trial
        The trials.

    Raises
    ------
    TrialTooShortError
        With both times.
    """
    constants = [n for n in ("tau", "tau1") if n in setting.model.parameters and setting.model[n].unit == "s"]
    slowest = max((abs(setting.known[n]) for n in constants if n in setting.known), default=0.0)
    needed = max(setting.unit_time, slowest)
    why = (
        "the ship's time constant" if slowest > setting.unit_time else "the time L/U in which the ship sails its length"
    )
    for trial in trials:
        if trial.duration < needed:
            raise TrialTooShortError(
                f"trial {trial.name} lasts {trial.duration:.3g} s, and {why} is {needed:.3g} s: it ends before the ship has "
                "answered its rudder. Give a longer trial, or a wider window."
            )
