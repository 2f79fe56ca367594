"""The Kalman filter in the loop: the generated filter step as what stands between the instruments and the autopilot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from shipid.autopilot.on_board.sampled_loop import Estimator
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.first_estimate import carried_vector
from shipid.estimation.recursion.layout import total
from shipid.foundation.errors import UsageError


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
        What the first sample shows, SI: where the filter starts.

    Returns
    -------
    Estimator

    Raises
    ------
    UsageError
        If an estimate is none of the filter's states and parameters.
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
    defaults = {n: model[n].number("default") or 0.0 for n in model.inputs}
    first = np.array([given.get(n, sample.get(n, defaults[n])) for n in model.inputs])

    # Noise is what a filter does not know, even where the loop has it under the same name.
    unknown = {s.name for s in design.sources if s.place == "input" and s.name not in shown}

    def advance(carried: Any, seen: Mapping[str, Any], interval: Any) -> tuple[Any, dict[str, Any]]:
        def value(name: str, otherwise: float | None = None) -> Any:
            label = shown.get(name, name)
            if label in seen:
                return seen[label]
            if otherwise is None:
                raise UsageError(f"the loop shows no '{label}', which the filter of model {design.base.name} reads.")
            return otherwise

        control = ca.SX.zeros(total(layout.control))
        inputs = [given.get(n, defaults[n] if n in unknown else value(n, defaults[n])) for n in model.inputs]
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
