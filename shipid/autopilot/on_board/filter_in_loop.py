"""The Kalman filter in the loop: the generated step of the filter between the instruments and the autopilot."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from shipid.autopilot.on_board.sampled_loop import Estimator
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.first_estimate import carried_vector
from shipid.estimation.recursion.layout import total
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import UsageError
from shipid.generation.simulator import input_rows


def estimator_of(
    kalman: ExtendedKalmanFilter,
    shown: Mapping[str, str],
    estimates: Mapping[str, str],
    sample: Mapping[str, float],
) -> Estimator:
    """Return a filter as the estimator of a sampled loop (`shipid.autopilot.on_board.sampled_loop.make_sampled_loop`).

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter. Made with ``switchable=True`` it takes ``adapting`` as an input of the loop: 1 where parameters adapt.
    shown : mapping of str to str
        For each sensor and each input of the filter, the name under which the loop shows it; the same name where it is not
        given. An input that nothing shows takes its declared default, and so does one that is noise to the filter.
    estimates : mapping of str to str
        For each input of the autopilot, the state or derived quantity of the filter that it gets.
    sample : mapping of str to float
        The first sample, SI, from which the filter starts.

    Returns
    -------
    Estimator

    Raises
    ------
    UsageError
        If an estimate is none of the filter's states and parameters, or the loop does not show what the filter reads.
    UnstatedInputError
        If an input of the filter has no first value.
    """
    design, given = kalman.design, kalman.design.instruments.inputs
    model, layout = design.model, design.layout
    states = {n: model.states.index(kalman.parameters.get(n, n)) for n in (*model.states, *kalman.parameters)
              if kalman.parameters.get(n, n) in model.states}  # fmt: skip
    for wanted, name in estimates.items():
        if name not in states:
            raise UsageError(
                f"'{wanted}' is to be '{name}', which the filter of model {design.base.name} does not estimate. It "
                f"estimates {', '.join(states)}."
            )
    logs = {n for n, s in kalman.parameters.items() if s != n}
    step, constants = design.step(), ca.DM(design.constants)
    # Before the first sample the rudder is amidships.
    first = input_rows(model, {"delta": 0.0, **sample, **given}, 1)[:, 0]

    # Noise is unknown to a filter, even where the loop has it under the same name.
    noises = [s.name for s in design.sources if s.place == "input" and s.name not in shown]
    stated = {**{n: model[n].number("default") or 0.0 for n in noises}, **given}

    def advance(
        carried: Expression, seen: Mapping[str, Expression], interval: Expression
    ) -> tuple[Expression, dict[str, Expression]]:
        def value(name: str, otherwise: float | None = None) -> Expression:
            label = shown.get(name, name)
            if label in seen:
                return seen[label]
            if otherwise is None:
                raise UsageError(f"the loop shows no '{label}', which the filter of model {design.base.name} reads.")
            return otherwise

        control = ca.SX.zeros(total(layout.control))
        inputs = [stated[n] if n in stated else value(n, model[n].number("default")) for n in model.inputs]
        control[layout.control["u"]] = ca.vertcat(*inputs)
        control[layout.control["T"]] = interval
        control[layout.control["z"]] = ca.vertcat(*(value(n) for n in kalman.measured))
        control[layout.control["there"]] = 1.0
        control[layout.control["scale"]] = 1.0
        if design.switchable:
            control[layout.control["adapting"]] = seen["adapting"]
        following, out = step(carried, control, constants)
        x = out[layout.brief["x"]]
        found = {}
        for wanted, name in estimates.items():
            estimate = x[states[name]]
            found[wanted] = ca.exp(estimate) if name in logs else estimate
        return following, found

    # A sample at which no time has passed and nothing is shown: noise that sensors share with the states has its variance then.
    still = np.zeros(total(layout.control))
    still[layout.control["u"]], still[layout.control["scale"]] = first, 1.0
    start, _ = step(carried_vector(design, sample, first), still, constants)
    return Estimator(
        np.nan_to_num(start.full().ravel(), posinf=1e30), advance, ("adapting",) if design.switchable else ()
    )
