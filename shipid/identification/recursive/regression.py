"""The regression of a declared model: one state, predicted over one sampling interval, and its exact derivatives.

A model is suitable where the equation of the state is linear in the chosen parameters. That is found by differentiating,
as is the regressor: the factors of the parameters are the derivatives by them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from shipid.declaration.joining.augment import augment
from shipid.declaration.model import Entry, Model
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.foundation.errors import UnknownNameError
from shipid.generation.linearisation import COORDINATES
from shipid.generation.step import make_step
from shipid.generation.system import System, generate
from shipid.identification.recursive.errors import NonlinearParameterError, NoRegressionError


@dataclass(frozen=True, eq=False)
class StateRegression:
    """One state of a model over one sampling interval.

    Attributes
    ----------
    model : Model
        The whole model.
    output : str
        The state.
    names : tuple of str
        The parameters.
    system : System
        The equation of the state: the parameters are states of it, and the other states its inputs.
    needed : tuple of str
        Inputs it reads.
    coefficients : tuple of str
        Coefficients it reads besides `names`.
    predict : casadi.Function
        ``(y, theta, u0, u1, p, T) -> (y at the end of the interval, its derivative by y, and by theta)``.
    integration : str
        How it was integrated.
    """

    model: Model
    output: str
    names: tuple[str, ...]
    system: System
    needed: tuple[str, ...]
    coefficients: tuple[str, ...]
    predict: CasadiFunction
    integration: str


def make_regression(
    model: Model,
    output: str | None = None,
    estimate: Sequence[str] | None = None,
    *,
    linear: bool = True,
    integration: str = "rk4",
    hold: str = "linear",
) -> StateRegression:
    """Derive the regression of one state.

    Parameters
    ----------
    model : Model
        A joined model.
    output : str, optional
        The state that is measured; by default the one whose equation has the parameters.
    estimate : sequence of str, optional
        The parameters; by default all that the model declares as estimated and the equation of the state reads.
    linear : bool
        Whether to refuse parameters that enter nonlinearly.
    integration, hold : str
        See `shipid.generation.step.make_step`. Over a Runge-Kutta step the prediction is linear in the parameters to the
        first order of the sampling interval; the regressor is its exact derivative. ``"euler"`` makes it linear exactly.

    Returns
    -------
    StateRegression

    Raises
    ------
    NonlinearParameterError
        If a parameter enters nonlinearly.
    NoRegressionError
        If the choice leaves no equation, or more than one.
    UnknownNameError
        If a name is no state or no parameter.
    """
    for name in estimate or ():
        if name not in model.parameters:
            raise UnknownNameError(f"parameter of model {model.name} to estimate called", name, model.parameters)
    if output is not None and output not in model.states:
        raise UnknownNameError(f"state of model {model.name} to regress called", output, model.states)
    output = output or _moved(model, estimate)
    alone = _alone(model, output)
    reads = _coefficients_of(alone, output)
    names = tuple(
        dict.fromkeys(estimate or (n for n in model.parameters if model[n].quantity.estimated and n in reads))
    )
    _check_choice(model, output, names, reads)
    if linear:
        _check_linear(model, output, names, generate(alone))
    system = generate(augment(alone, names, log=()))
    return StateRegression(
        model,
        output,
        names,
        system,
        system.inputs_behind([output]),
        tuple(n for n in reads if n not in names),
        _predictor(system, output, names, integration, hold),
        f"{integration}, {hold}",
    )


def _alone(model: Model, output: str) -> Model:
    """The model in which every other state is an input, taken from the record."""
    system = generate(model)

    def role(entry: Entry) -> Entry:
        if entry.quantity.kind != "state" or entry.name == output:
            return entry
        row = system.states.index(entry.name)
        # A state that only noise drives stays at its first value, unless the record holds it.
        still = row not in system.nexts and system.rates[row].is_zero()
        default = (entry.number("start") or 0.0) if still else None
        return Entry(replace(entry.quantity, kind="given", default=default), entry.owner)

    return replace(model, entries={n: role(e) for n, e in model.entries.items()})


def _equation(system: System, output: str) -> Expression:
    row = system.states.index(output)
    return system.nexts.get(row, system.rates[row])


def _coefficients_of(alone: Model, output: str) -> tuple[str, ...]:
    system = generate(alone)
    read = ca.which_depends(_equation(system, output), system.p, 1, False) if system.p.shape[0] else []
    return tuple(n for n, used in zip(system.coefficients, read) if used)


def _moved(model: Model, estimate: Sequence[str] | None) -> str:
    """The one state whose equation has the parameters."""
    wanted = set(estimate or (n for n in model.parameters if model[n].quantity.estimated))
    moved = [s for s in model.states if wanted & set(_coefficients_of(_alone(model, s), s))]
    # Position and heading are integrals of other states; they are regressed only on request.
    own = [s for s in moved if s not in COORDINATES] or moved
    if len(own) != 1:
        found = f"the parameters move {', '.join(own)}" if own else "no state is moved by the parameters"
        raise NoRegressionError(
            f"model {model.name}: {found}, and a regression is of one state. Say which is measured, as in "
            f"measured={{'{(own or list(model.states) or ['r'])[0]}': ...}}."
        )
    return own[0]


def _check_choice(model: Model, output: str, names: tuple[str, ...], reads: tuple[str, ...]) -> None:
    if not names:
        raise NoRegressionError(
            f"model {model.name}: the equation of '{output}' reads no parameter that is to be estimated. "
            f"It reads {', '.join(reads) or 'none'}; the model has {', '.join(model.parameters) or 'none'}."
        )
    for name in names:
        if name not in reads:
            raise NoRegressionError(
                f"model {model.name}: '{name}' does not enter the equation of '{output}', which reads {', '.join(reads)}."
            )


def _check_linear(model: Model, output: str, names: tuple[str, ...], system: System) -> None:
    places = [system.coefficients.index(n) for n in names]
    equation = _equation(system, output)
    slope = ca.jacobian(equation, system.p)
    curvature = ca.jacobian(slope[:, places], system.p)[:, places]
    if curvature.nnz() == 0:
        return
    function = ca.Function("curvature", [system.x, system.u, system.p, system.T], [curvature])
    bent = np.zeros((len(names), len(names)), dtype=bool)
    # A derivative that is zero everywhere may be in the sparsity pattern: it is evaluated at points.
    for seed in range(3):
        point = [np.random.default_rng([seed, i]).uniform(0.5, 1.5, function.size_in(i)) for i in range(4)]
        bent |= np.abs(np.nan_to_num(function(*point).full(), nan=1.0)) > 1e-12
    if bent.any():
        i = int(np.argmax(bent.sum(axis=1)))
        partners = [names[j] for j in np.flatnonzero(bent[i]) if j != i]
        how = f" together with {' and '.join(partners)}" if partners else ""
        place = model[output].equation
        where = f" ({place.place})" if place is not None else ""
        raise NonlinearParameterError(
            f"model {model.name}: '{names[i]}' enters the equation of '{output}'{where} nonlinearly{how}, so no regression is "
            "linear in it. Take a model whose parameters are the factors themselves (1/tau and K/tau for K and tau), leave "
            f"'{names[i]}' at the ship's value (estimate=...), or take the method 'ekf', which linearises."
        )


def _predictor(system: System, output: str, names: tuple[str, ...], integration: str, hold: str) -> CasadiFunction:
    y, theta = ca.SX.sym("y"), ca.SX.sym("theta", len(names))
    places = {output: y, **{n: theta[i] for i, n in enumerate(names)}}
    u0, u1 = (ca.SX.sym(n, system.u.shape[0]) for n in ("u0", "u1"))
    row = system.states.index(output)
    step = make_step(system, integration, hold).function
    ahead = step(ca.vertcat(*(places[s] for s in system.states)), u0, u1, system.p, system.T)[row]
    by_y, by_theta = ca.jacobian(ahead, y), ca.jacobian(ahead, theta).T
    if row in system.nexts:
        # A sampled state changes when its step is run; with no time between two samples it is not run.
        moves = system.T > 0
        ahead, by_y = ca.if_else(moves, ahead, y), ca.if_else(moves, by_y, 1.0)
        by_theta = ca.if_else(moves, by_theta, ca.SX.zeros(by_theta.shape))
    return ca.Function(
        "predict",
        [y, theta, u0, u1, system.p, system.T],
        [ca.densify(e) for e in (ahead, by_y, by_theta)],
        ["y", "theta", "u0", "u1", "p", "T"],
        ["ahead", "by_y", "by_theta"],
    )
