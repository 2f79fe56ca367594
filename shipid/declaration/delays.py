"""Dead times: inputs that act later than they are given, as a shift of their records.

The response at time t reads an input at ``t - delay``, in a straight line between its samples; before the first sample stands
the first one, behind the last one the last. The derivative by the delay is that by the input times ``-d(input)/dt``, exact.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UsageError


def shifted_rows(
    model: Model, t: np.ndarray, rows: np.ndarray, delays: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the inputs that act at the times of a record, and their derivatives by the delays.

    Parameters
    ----------
    model : Model
        The model.
    t : ndarray, shape (N,)
        Times in s, not falling.
    rows : ndarray, shape (inputs, N)
        Inputs as they are given, SI.
    delays : mapping of str to float
        How much later inputs act, in s, by input; negative where they act earlier.

    Returns
    -------
    acting : ndarray, shape (inputs, N)
        ``u(t - delay)``.
    slopes : ndarray, shape (inputs, N)
        ``d acting / d delay``; zero for an input without a delay.
    """
    acting, slopes = np.array(rows, dtype=float), np.zeros(rows.shape)
    if t.size < 2:
        return acting, slopes
    steps = np.diff(t)
    for name, delay in delays.items():
        i = model.inputs.index(name)
        at = t - delay
        acting[i] = np.interp(at, t, rows[i])
        part = np.clip(np.searchsorted(t, at, side="right") - 1, 0, steps.size - 1)
        rate = np.divide(np.diff(rows[i]), steps, out=np.zeros(steps.size), where=steps > 0)
        slopes[i] = np.where((at < t[0]) | (at > t[-1]), 0.0, -rate[part])
    return acting, slopes


def delays_in(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    """Return how much later inputs of a model act, in s, by input.

    Parameters
    ----------
    model : Model
        The model.
    values : mapping of str to float
        Its coefficients, SI; one that is not named takes its declared start.
    """
    return {x: values.get(n, model[n].number("start") or 0.0) for x, n in model.delays.items()}


def refuse_delay(model: Model, what: str) -> None:
    """Raise an error for a model with a dead time, where what is to be done with it cannot carry one.

    Parameters
    ----------
    model : Model
        The model.
    what : str
        What is to be done, in words.

    Raises
    ------
    UsageError
        If an input of the model has a dead time.
    """
    for late, name in model.delays.items():
        raise UsageError(
            f"model {model.name} has a dead time: '{late}' acts '{name}' later than it is given. {what} cannot carry it. "
            "Choose the model without the dead time, or one with a lag."
        )


def refuse_estimated_delay(model: Model, estimated: Collection[str], what: str) -> None:
    """Raise an error for a dead time that is to be estimated by what cannot.

    Parameters
    ----------
    model : Model
        The model.
    estimated : collection of str
        Coefficients to estimate.
    what : str
        What is to estimate them, in words.

    Raises
    ------
    UsageError
        If a dead time is among them.
    """
    for name in model.delays.values():
        if name in estimated:
            raise UsageError(
                f"{what} does not estimate the dead time '{name}': estimate it by output error (--method output-error), and hold it "
                f"here (--fix '{name}=1 s', or a ship that states it)."
            )
