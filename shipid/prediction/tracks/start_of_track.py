"""The states a model starts from in a situation, and how uncertain they are.

A situation says what is measured or estimated: heading, rate of turn, speed. A model may carry another form of it as its state, such
as the dimensionless rate r* = r L/u: the states that nothing says are those with which its quantities are as they were said.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.errors import UsageError
from shipid.generation.simulator import initial_state
from shipid.generation.system import generate
from shipid.parts.rudder_delay import at_rest
from shipid.prediction.situations.situation import Situation

#: Newton's steps, and the largest share of its size a quantity may be off after them.
_STEPS, _CLOSE = 12, 1e-9
#: Quantities a situation says that a model may carry as other states.
_FORMS = ("r", "u", "v")


@functools.lru_cache(maxsize=64)
def _forms(model: Model) -> tuple[tuple[str, ...], tuple[str, ...], CasadiFunction | None]:
    """The derived speeds of a model, the states they follow from, and the function of both with its Jacobians."""
    system = generate(model)
    derived = [n for n in _FORMS if n in model and model[n].quantity.kind == "derived"]
    shown: list[str] = []
    places: list[int] = []
    for name in derived:
        by = np.asarray(ca.DM(ca.jacobian(system.expression([name]), system.x).sparsity(), 1).full(), dtype=bool)[0]
        free = [i for i in np.flatnonzero(by) if system.states[i] not in _FORMS and i not in places]
        if free:
            # One state a quantity: the first that no other quantity has taken.
            shown.append(name)
            places.append(int(free[0]))
    if not shown:
        return (), (), None
    y = system.expression(shown)
    function = ca.Function(
        "forms",
        [system.x, system.u, system.p],
        [ca.densify(e) for e in (y, *(ca.jacobian(y, by) for by in (system.x, system.u, system.p)))],
    )
    return tuple(shown), tuple(system.states[i] for i in places), function


def states_in(
    model: Model, situation: Situation, start: Mapping[str, float], inputs: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, dict[str, dict[str, float]]]:
    """Return the states a model starts from, and how those that are said in another form follow from what is said.

    Parameters
    ----------
    model : Model
        What starts.
    situation : Situation
        What is known.
    start : mapping of str to float
        States that go before those of the situation.
    inputs, p : ndarray
        Inputs and coefficients in the order of the model.

    Returns
    -------
    x0 : ndarray, shape (states,)
    slopes : dict of str to dict of str to float
        Derivative of such a state by each quantity of the situation.

    Raises
    ------
    UsageError
        If no state of the model is what the situation says.
    """
    system, known = generate(model), at_rest(model, {**situation.values, **start})
    x = initial_state(model, known)
    shown, states, function = _forms(model)
    wanted = [(n, s) for n, s in zip(shown, states) if n in known and s not in known]
    if function is None or not wanted:
        return x, {}
    rows = [shown.index(n) for n, _ in wanted]
    columns = [system.states.index(s) for _, s in wanted]
    target = np.array([known[n] for n, _ in wanted])
    for _ in range(_STEPS):
        y, by_x, by_u, by_p = (m.full() for m in function(x, inputs, p))
        off = y[rows, 0] - target
        if not np.isfinite(off).all() or np.abs(off).max() <= _CLOSE * max(1e-3, np.abs(target).max()):
            break
        x[columns] -= np.linalg.lstsq(by_x[np.ix_(rows, columns)], off, rcond=None)[0]
    if not np.isfinite(x).all() or np.abs(off).max() > 1e-6 * max(1e-3, np.abs(target).max()):
        said = ", ".join(n for n, _ in wanted)
        raise UsageError(f"model {model.name} has no state in which its {said} are as the situation says.")
    inverse = np.linalg.pinv(by_x[np.ix_(rows, columns)])
    slopes: dict[str, dict[str, float]] = {s: {} for _, s in wanted}
    for name in situation.uncertain:
        by = np.array([1.0 if n == name else 0.0 for n, _ in wanted])
        for names, table in ((system.states, by_x), (system.inputs, by_u), (system.coefficients, by_p)):
            if name in names and not any(n == name for n, _ in wanted):
                by = by - table[rows, names.index(name)]
        for (_, state), slope in zip(wanted, inverse @ by):
            if slope:
                slopes[state][name] = float(slope)
    return x, slopes


def spread_in(
    model: Model, situation: Situation, slopes: Mapping[str, Mapping[str, float]]
) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Return the uncertain quantities of a model that are no states, the covariance of all, and the noise that drives them.

    Parameters
    ----------
    model : Model
        What starts.
    situation : Situation
        What is known.
    slopes : mapping
        From `states_in`.

    Returns
    -------
    extra : tuple of str
        Coefficients and inputs of the model that the situation is not sure of.
    covariance : ndarray, shape (states + extra, states + extra)
    noise : ndarray, shape (states + extra,)
        Per root second, SI.
    """
    system = generate(model)
    extra = tuple(
        n for n in situation.uncertain if n not in system.states and n in (*system.inputs, *system.coefficients)
    )
    names = (*system.states, *extra)
    carry = np.zeros((len(names), len(situation.uncertain)))
    for i, name in enumerate(names):
        follows = slopes.get(name, {name: 1.0})
        for j, said in enumerate(situation.uncertain):
            carry[i, j] = follows.get(said, 0.0)
    noise = np.array([
        sum((abs(k) * situation.noise.get(n, 0.0) for n, k in slopes.get(name, {name: 1.0}).items()), 0.0)
        for name in names
    ])  # fmt: skip
    return extra, carry @ situation.covariance @ carry.T, noise
