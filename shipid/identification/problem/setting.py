"""The setting of a search: the model, its known values, the coefficients to estimate and their bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import factor, to_si
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.foundation.numbers import brief
from shipid.identification.errors import TrialTooShortError
from shipid.identification.loading import reference_loading
from shipid.identification.problem.box import Box, box_of
from shipid.identification.problem.dead_time import DEAD_TIME, usual_delay
from shipid.identification.problem.ship_scale import scale_of, usual_speed
from shipid.parameters.catalogue import delayed, model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.trials.speed import check_way
from shipid.trials.trial import Trial


@dataclass(frozen=True)
class Setting:
    """The model and its known values before the search.

    Attributes
    ----------
    model : Model
        The fitted model; published coefficients that are held have taken the place of declared ones.
    ship : ParameterSet
        As given.
    known : dict of str to float
        Values of coefficients and particulars, SI.
    estimated : tuple of str
        Coefficients to estimate.
    scale : Scale
        Length and usual speed of the ship.
    notes : tuple of str
        Notes for the reader.
    guesses : mapping of str to float
        Where the search starts for coefficients of which the trials themselves give a first idea, SI: a dead time.
    """

    model: Model
    ship: ParameterSet
    known: dict[str, float]
    estimated: tuple[str, ...]
    scale: Scale
    notes: tuple[str, ...]
    guesses: Mapping[str, float] = field(default_factory=dict)

    @property
    def fixed(self) -> dict[str, float]:
        """Values that are held, SI, by name."""
        return {n: v for n, v in self.known.items() if n not in self.estimated}

    @property
    def stated(self) -> dict[str, tuple[float, float | None]]:
        """What is known of the coefficients to estimate before the trials: value and standard deviation, SI, by name.

        The ship's value; where it has none, that of a declaration that states its spread. None for a standard deviation that
        nothing states.
        """
        found: dict[str, tuple[float, float | None]] = {}
        for name in self.estimated:
            entry, held = self.model[name], self.ship.find(self.model, name)
            start, spread = self.scale.start_of(entry), entry.number("spread")
            if name in self.known:
                std = None if held is None or not held.std else held.std * factor(held.unit, entry.unit)
                found[name] = self.known[name], std
            elif start is not None and spread is not None:
                found[name] = start, spread * self.scale.factor_of(entry)
        return found


def settle(
    model: Model | type[Component] | str,
    trials: Sequence[Trial],
    ship: ParameterSet | str | None,
    estimate: Sequence[str] | None,
    fixed: Mapping[str, str | float],
) -> Setting:
    """Return the setting: the fitted model and its known values.

    Parameters
    ----------
    model, trials, ship, estimate, fixed
        See `shipid.identification.identify.identify`.

    Returns
    -------
    Setting

    Raises
    ------
    UsageError
        If a name is to be held that is no coefficient, is estimated as well, or nothing is left to estimate.
    ParameterSetError
        If the length is not greater than zero, or the ship lacks a value the model needs.
    UnknownNameError
        For a model, a ship or a coefficient that does not exist.
    """
    whole, given = model_of(model), ship_of(ship)
    if DEAD_TIME in {*(estimate or ()), *fixed}:
        whole = delayed(whole)
    held = {n: to_si(v, whole[n].given_unit, f"'{n}' ({whole[n].quantity.meaning})") for n, v in fixed.items()}
    for name in held:
        if whole[name].quantity.kind not in ("parameter", "constant", "derived"):
            kind = "input" if whole[name].quantity.kind == "given" else whole[name].quantity.kind
            raise UsageError(f"'{name}' is no coefficient of model {whole.name} but its {kind}; it cannot be fixed.")
    published = [n for n in held if whole[n].quantity.kind == "derived"]
    whole = whole.impose(published) if published else whole

    known = reference_loading(whole, trials) | given.values(whole, speed=usual_speed(given, trials)) | held
    length = known.get("L", given.particular("L", "m"))
    if length is not None and not length > 0:
        raise ParameterSetError(f"the length L that is held is {length:g} m; it must be greater than zero.")
    scale = scale_of(given, trials, length)
    estimated = estimated_parameters(whole, estimate, held)
    notes = []
    for name in whole.parameters:
        start = scale.start_of(whole[name])
        if name not in known and start is not None and name not in estimated:
            known[name] = start
            notes.append(f"{name} was held at its declared start, {brief(start, 4)}, which is assumed.")
    lacking = missing_values(whole, {**known, **dict.fromkeys(estimated, 0.0)}, f"ship {given.name}")
    if lacking:
        raise lacking
    guesses = {n: seconds for n in whole.delays.values() if (seconds := usual_delay(trials)) is not None}
    return Setting(whole, given, known, estimated, scale, tuple(notes), guesses)


def estimated_parameters(
    model: Model, wanted: Sequence[str] | None = None, held: Mapping[str, float] | None = None
) -> tuple[str, ...]:
    """Return the parameters to estimate, in the order of the model.

    Parameters
    ----------
    model : Model
        The model.
    wanted : sequence of str, optional
        Parameters, or published coefficients that replace them; by default all that the model declares as estimated.
    held : mapping of str to float, optional
        Coefficients that are not estimated.

    Raises
    ------
    UnknownNameError
        If a wanted one is no parameter and replaces none.
    UsageError
        If a wanted one is held, or nothing is left.
    """
    held = held or {}
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
        if held:
            raise UsageError(f"model {model.name} has no parameter left to estimate: every parameter is fixed.")
        raise UsageError(f"no parameter of model {model.name} is estimated: name one of its parameters.")
    return tuple(n for n in model.parameters if n in chosen)


def search_box(setting: Setting) -> Box:
    """Return bounds and first values of the coefficients to estimate.

    Parameters
    ----------
    setting : Setting
        What is known.
    """
    starts = {}
    for name in setting.estimated:
        entry = setting.model[name]
        declared = setting.scale.start_of(entry)
        first = setting.scale.factor_of(entry) if declared is None else declared
        starts[name] = setting.known.get(name, setting.guesses.get(name, first))
    stated = setting.stated
    spread = {}
    for name in starts:
        std = stated[name][1] if name in stated else np.inf
        spread[name] = np.nan if std is None else std
    return box_around(setting.model, setting.scale, starts, spread)


def box_around(
    model: Model, scale: Scale, values: Mapping[str, float], spread: Mapping[str, float] | None = None
) -> Box:
    """Return the declared bounds of parameters, widened to hold the given values.

    Parameters
    ----------
    model : Model
        The model.
    scale : Scale
        Length and speed, for bounds in the prime system.
    values : mapping of str to float
        Values of the parameters, SI.
    spread : mapping of str to float, optional
        Their standard deviations, see `shipid.identification.problem.box.Box`.
    """
    bounds = {}
    for name, value in values.items():
        low, high = scale.bounds_of(model[name])
        bounds[name] = (value, min(low, value), max(high, value))
    return box_of(bounds, spread)


def check_length(setting: Setting, trials: Sequence[Trial]) -> None:
    """Raise an error for a trial that ends before the ship has responded to its rudder.

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
    NotAheadError
        If the ship goes astern, and the model is scaled with its speed.
    """
    slowest, unit_time = time_constant(setting.model, setting.known), setting.scale.unit_time
    needed = max(unit_time, slowest)
    why = "the ship's time constant" if slowest > unit_time else "the time L/U in which the ship sails its length"
    for trial in trials:
        if setting.model.guards:
            # A mean speed near zero would make the time L/U too long, and the message wrong.
            check_way({n: trial[n] for n in ("t", "u") if n == "t" or trial.has(n)}, trial.name, setting.model.name)
        if trial.duration < needed:
            raise TrialTooShortError(
                f"trial {trial.name} lasts {brief(trial.duration, 3)} s, and {why} is {brief(needed, 3)} s: it ends before the ship has "
                "responded to its rudder. Give a longer trial, or a wider window."
            )


def time_constant(model: Model, known: Mapping[str, float]) -> float:
    """Return the largest known time constant of a ship in s, zero where none is known.

    Parameters
    ----------
    model : Model
        The model.
    known : mapping of str to float
        Values of its coefficients, SI.
    """
    names = [n for n in ("tau", "tau1") if n in model.parameters and model[n].unit == "s" and n in known]
    return max((abs(known[n]) for n in names), default=0.0)
