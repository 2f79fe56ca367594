"""The situation of a ship out of a filter: its estimates with their covariance, at a sample of a record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.online.online_filter import OnlineFilter
from shipid.estimation.records.derived import quantity_along
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.triangles import unpacked
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import moment
from shipid.prediction.situations.situation import Situation


def situation_of(run: FilterRun, at: float | None = None, *, coefficients: bool = True) -> Situation:
    """Return what a filter knows of the ship at a time; nothing later than that is used.

    Parameters
    ----------
    run : FilterRun
        A record and what the filter made of it.
    at : float, optional
        Time in s on the clock of the record; its last sample by default.
    coefficients : bool
        Whether the coefficients that the filter estimates are part of it, with their covariance.

    Returns
    -------
    Situation

    Raises
    ------
    UsageError
        If the record has no sample before that time.
    """
    t = run.t
    k = t.size - 1 if at is None else int(np.searchsorted(t, at + 1e-9, side="right")) - 1
    if k < 0:
        raise UsageError(
            f"the record {run.record} begins at {moment(t[0])} s, later than {moment(at)} s: nothing is known there."
        )
    design = run.design
    inputs = run.control[run.arranged.shown][k, design.layout.control["u"]]
    return _situation(
        design,
        run.x[k],
        run.covariance[k],
        inputs,
        float(t[k]),
        coefficients,
        lambda name: float(run[name][k]),
    )


def situation_now(online: OnlineFilter, *, coefficients: bool = True) -> Situation:
    """Return what a filter that takes one sample at a time knows of the ship after its last sample.

    Parameters
    ----------
    online : OnlineFilter
        The filter; it has had a sample.
    coefficients : bool
        Whether the coefficients that the filter estimates are part of it, with their covariance.

    Returns
    -------
    Situation

    Raises
    ------
    UsageError
        If no sample has come yet.
    """
    if online.stepper is None or online.t is None:
        raise UsageError("a filter without a sample knows nothing of the ship.")
    design, carried, n = online.design, online.design.layout.carried, online.design.layout.n
    z = online.stepper.z
    if design.form == "square-root":
        root = z[carried["P"]].reshape(design.layout.joint, design.layout.joint, order="F")
        covariance = root @ root.T
    else:
        covariance = unpacked(z[carried["P"]][None, :].astype(float), design.layout.joint)[0]
    x, inputs = z[carried["x"]].astype(float), z[carried["u"]].astype(float)
    joint = np.concatenate([x, z[carried["w"]].astype(float)])

    def derived(name: str) -> float:
        values, _ = quantity_along(design, name, joint[None], covariance[None], inputs[None], np.zeros(1))
        return float(values[0])

    return _situation(design, x, covariance[:n, :n], inputs, online.t, coefficients, derived)


def _situation(
    design: FilterDesign,
    x: np.ndarray,
    covariance: np.ndarray,
    inputs: np.ndarray,
    t: float,
    coefficients: bool,
    derived: Callable[[str], float],
) -> Situation:
    """The situation out of an estimate; what the model derives is asked of `derived` by name."""
    by_state = {state: name for name, state in design.parameters.items()}
    names, values, slopes, noise = [], {}, [], {}
    density = {s.name: s.level for s in design.sources if s.place == "state" and s.density}
    for i, state in enumerate(design.model.states):
        name = by_state.get(state, state)
        logarithm = name != state
        value = float(np.exp(x[i])) if logarithm else float(x[i])
        if name in design.parameters and not coefficients:
            continue
        names.append((i, name))
        values[name] = value
        slopes.append(value if logarithm else 1.0)
        if state in density:
            noise[name] = density[state] * slopes[-1]
    values |= {n: float(v) for n, v in zip(design.model.inputs, inputs) if np.isfinite(v) and n not in values}
    for name in ("v", "u", "r"):
        if name not in values and name in design.model:
            values[name] = derived(name)
    kept = np.array([i for i, _ in names])
    scaled = np.array(slopes)
    return Situation(
        values,
        tuple(n for _, n in names),
        covariance[np.ix_(kept, kept)] * np.outer(scaled, scaled),
        noise,
        t,
    )
