"""Which signals are fitted, and which inputs have an unknown constant bias."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.numbers import brief
from shipid.generation.system import generate
from shipid.identification.errors import NoAnswerError, NothingToFitError
from shipid.trials.trial import Trial

#: Signals that are fitted where the trial measures them and the model predicts them.
SIGNALS = ("psi", "r", "u", "v")
#: Signals that are fitted where the sway speed is predicted and not measured.
TRACK = ("x", "y")
#: Signals of a prediction that are shown beside the fitted ones.
SHOWN = (*SIGNALS, *TRACK)
#: Fewer samples show no noise level.
_FEWEST = 30


def is_predicted(model: Model, name: str) -> bool:
    """Return whether a model predicts a quantity: whether it is no input, parameter or constant of it.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        One of its quantities.
    """
    return model[name].quantity.kind in ("state", "derived", "output")


def usual_signals(model: Model, measured: Collection[str]) -> tuple[str, ...]:
    """Return the signals that are fitted unless others are requested.

    Parameters
    ----------
    model : Model
        The model.
    measured : collection of str
        What is measured.

    Returns
    -------
    tuple of str
        Heading, rate of turn, forward and sway speed, and what else is a state of the model, such as a shaft speed, or an output
        with a column of its own, such as a leeway, as far as they are measured and predicted. Where the sway speed is predicted and not measured, the track replaces it, with a
        constant current of its own in each trial.
    """
    predicted = {n for n in model.entries if is_predicted(model, n)}
    found = tuple(n for n in SIGNALS if n in predicted and n in measured)
    # Where a log shows the angle of the rudder, that is what the ship is steered with, and no answer of hers.
    found += tuple(n for n in model.states if n in measured and n not in (*SIGNALS, *TRACK, "delta"))
    # Where the log holds the quantity itself, the output that measures it is what the log shows of it (`shown_by`).
    found += tuple(n for n in model.outputs if n in measured and model[n].quantity.measures not in measured)
    if "v" in predicted and "v" not in found and set(TRACK) <= set(measured):
        found += tuple(n for n in TRACK if n in predicted)
    return found


def fitted_signals(model: Model, trials: Sequence[Trial], wanted: Sequence[str] | None = None) -> tuple[str, ...]:
    """Return the signals that every trial measures and the model predicts.

    A signal of which all trials together hold only a few samples does not show its noise level, and zeros from first to last are
    no measurement, such as the sway speed of a simulated ship that has none: they are fitted on request, or where there is no other.

    Parameters
    ----------
    model : Model
        The model.
    trials : sequence of Trial
        The trials.
    wanted : sequence of str, optional
        Signals that are requested; `usual_signals` by default.

    Raises
    ------
    UnknownNameError
        If a signal requested is none the model predicts.
    NothingToFitError
        If there is none, or a trial does not measure a signal requested.
    """
    predicted = [n for n in model.entries if is_predicted(model, n)]
    for name in wanted or ():
        if name not in predicted:
            raise UnknownNameError(f"signal that model {model.name} predicts called", name, predicted)
        for trial in trials:
            if not trial.has(name):
                raise NothingToFitError(
                    f"the signal '{name}' is to be fitted, and trial {trial.name} does not have it. Its columns: "
                    f"{', '.join(trial.table.columns)}."
                )
    measured = {n for n in predicted if all(t.has(n) for t in trials)}
    found = usual_signals(model, {n for n in measured if _shows_noise(trials, n)}) or usual_signals(model, measured)
    found = found if wanted is None else tuple(dict.fromkeys(wanted))
    if not found:
        each = {t.name: [n for n in usual_signals(model, set(predicted)) if t.has(n)] for t in trials}
        if all(each.values()):
            said = "; ".join(f"{trial} has {', '.join(names)}" for trial, names in each.items())
            raise NothingToFitError(
                f"the trials share no signal that model {model.name} predicts: {said}. Fit trials of the same signals."
            )
        raise NothingToFitError(
            f"no trial measures what model {model.name} predicts. It predicts {', '.join(predicted)}; the first trial has "
            f"{', '.join(trials[0].table.columns)}."
        )
    return found


def _shows_noise(trials: Sequence[Trial], name: str) -> bool:
    """Whether a signal has enough samples, in a trial that is itself that short all of them, and not zeros only."""
    seen = [t[name][np.isfinite(t[name])] for t in trials]
    # A heading or a rate of turn that stands still is refused by `check_answer`.
    moves = name in ("psi", "r") or any(values.any() for values in seen)
    return moves and sum(values.size for values in seen) >= min(_FEWEST, sum(len(t) for t in trials))


def check_answer(trial: Trial, signals: Sequence[str]) -> None:
    """Raise an error if the heading or rate of turn of a trial never changes: the ship did not respond, or the sensor is stuck.

    Parameters
    ----------
    trial : Trial
        The trial.
    signals : sequence of str
        Fitted signals.

    Raises
    ------
    NoAnswerError
        With the column and the value it keeps.
    """
    for name in ("psi", "r"):
        values = trial[name][np.isfinite(trial[name])] if name in signals else np.zeros(0)
        if values.size > 1 and np.ptp(values) == 0:
            raise NoAnswerError(
                f"trial {trial.name}, column '{name}': it stays at {brief(values[0], 6)} {trial.unit(name)} throughout, "
                "while the rudder moves. Check the sensor and the column, or fit other signals (--signals)."
            )


def unknown_biases(model: Model, signals: Sequence[str], rudder_bias: bool = True) -> tuple[str, ...]:
    """Return the inputs whose constant bias is unknown in each trial.

    The rudder; the cruising speed, where a fitted speed or track shows it, or where wind acts on the speed: the ship then does not
    approach at the speed that her propeller would give her; the current, where a fitted track shows it.

    Parameters
    ----------
    model : Model
        The model.
    signals : sequence of str
        Fitted signals.
    rudder_bias : bool
        Whether the rudder has one.
    """
    wanted = ["delta"] if rudder_bias else []
    track = bool(set(TRACK) & set(signals))
    wanted += ["cruise"] if "u" in signals or track or slowed_by_wind(model) else []
    wanted += ["current_north", "current_east"] if track else []
    return tuple(n for n in wanted if n in model.inputs)


def slowed_by_wind(model: Model) -> bool:
    """Return whether the true wind acts on the speed of the ship, so that she approaches at another one than the cruising speed.

    Parameters
    ----------
    model : Model
        The model.
    """
    return "u" in model.states and "wind_speed" in generate(model).inputs_behind(("u",))
