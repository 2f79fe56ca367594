"""One cycle of a multiple-model filter as a generated function: interaction, prediction, update, mode probabilities, combination.

Blom and Bar-Shalom (1988); Bar-Shalom, Li and Kirubarajan (2001), section 11.6.6 for the interacting filter and 11.6.4 for the
generalised pseudo-Bayesian filter of first order. Where no time passes between two scans no mode changes, and only the update is made.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.multiple.cycle.layout import CycleLayout
from shipid.estimation.multiple.cycle.maps import ModeMap
from shipid.estimation.multiple.cycle.mixing import merged
from shipid.estimation.multiple.cycle.moves import Moves
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.layout import part, total
from shipid.estimation.recursion.step import make_prediction
from shipid.foundation.aliases import CasadiFunction, Expression

#: How the estimates of the modes are merged before a prediction.
Merging = Literal["interacting", "pseudo-bayesian"]
#: No mode is less probable than this, so that each can become probable again.
LEAST = 1e-100


@dataclass(frozen=True, eq=False)
class CycleSettings:
    """What a cycle does besides the equations of its modes.

    Attributes
    ----------
    maps : mapping
        States of one mode out of another, by the numbers of both.
    merging : {"interacting", "pseudo-bayesian"}
        Whether each mode starts from a mixture of its own, or all from the combined estimate.
    fading : float
        Factor on the covariance before each prediction (the fudge factor of the papers).
    led : mapping of str to int
        States that the other modes take from one mode after each scan, and which mode that is.
    moves : Moves or None
        How the modes' parameter moves.
    correlated : bool
        Whether the errors of sensors are correlated.
    """

    maps: Mapping[tuple[int, int], ModeMap]
    merging: Merging
    fading: float
    led: Mapping[str, int]
    moves: Moves | None
    correlated: bool


@dataclass(eq=False)
class _ModeNow:
    """A mode while a cycle is written down."""

    design: FilterDesign
    x: Expression
    P: Expression
    u0: Expression
    u1: Expression
    p: Expression
    q: Expression

    @property
    def wraps(self) -> list[bool]:
        """Which of its states are angles that wrap."""
        return [self.design.model[s].quantity.wraps for s in self.design.model.states]


def make_cycle(designs: Sequence[FilterDesign], settings: CycleSettings, full: bool = False) -> CasadiFunction:
    """Generate the cycle ``(carried, control, constants) -> (carried, outputs)``; `CycleLayout` says what stands where.

    Parameters
    ----------
    designs : sequence of FilterDesign
        The modes.
    settings : CycleSettings
        What the cycle does.
    full : bool
        Whether the estimates of each mode are returned as well.

    Returns
    -------
    casadi.Function
    """
    layout = CycleLayout(designs, settings.moves is not None, settings.correlated)
    carried, control, constants = (
        ca.SX.sym(n, total(p))
        for n, p in (("carried", layout.carried), ("control", layout.control), ("constants", layout.constants))
    )
    old = {n: part(carried, p) for n, p in layout.carried.items()}
    new = {n: part(control, p) for n, p in layout.control.items()}
    fixed = {n: part(constants, p) for n, p in layout.constants.items()}
    modes = [
        _ModeNow(
            d,
            old[f"x{j}"] + 0,
            covariance_form.unpack(old[f"P{j}"], layout.sizes[j]),
            old[f"u{j}"] + 0,
            new[f"u{j}"] + 0,
            fixed[f"p{j}"],
            fixed[f"q{j}"],
        )
        for j, d in enumerate(designs)
    ]
    moving, theta = new["T"] > 0, old["theta"]
    if settings.moves is not None:
        theta = settings.moves.move([m.x for m in modes], old["mu"], theta, moving)
        for j, mode in enumerate(modes):
            at = mode.design.system.inputs.index(settings.moves.parameter)
            mode.u0[at] = mode.u1[at] = theta[j]
    ahead = _interact(modes, old["mu"], ca.reshape(new["transition"], layout.modes, layout.modes), new["T"], settings)
    likelihoods, shown, spreads = [], [], []
    for mode in modes:
        _predict(mode, new["T"], settings.fading, moving)
        ll, predicted, spread = _update(mode, new, settings.correlated)
        likelihoods.append(ll)
        shown.append(predicted)
        spreads.append(spread)
    mu, ll = _probabilities(ahead, likelihoods)
    x, P = _combined(modes, mu, new["T"], settings.maps)
    for name, leader in settings.led.items():
        _lead(name, leader, modes, x, mu)
    estimates = [m.x for m in modes] + [covariance_form.pack(m.P) for m in modes]
    following = ca.vertcat(mu, theta, *estimates, *(new[f"u{j}"] for j in range(layout.modes)))
    after = theta if settings.moves is None else settings.moves.shown([m.x for m in modes], theta)
    outputs = [x, covariance_form.pack(P), mu, after, ll]
    if full:
        outputs += [ahead, *estimates, *shown, *spreads]
    following, out = ca.cse([ca.densify(following), ca.densify(ca.vertcat(*outputs))])
    return ca.Function("cycle", [carried, control, constants], [following, out])


def _interact(
    modes: list[_ModeNow], mu: Expression, transition: Expression, T: Expression, settings: CycleSettings
) -> Expression:
    """Merge the estimates before the prediction, in place; return the predicted mode probabilities."""
    count = len(modes)
    ahead = [ca.fmax(sum(transition[j, i] * mu[i] for i in range(count)), LEAST) for j in range(count)]
    before = [(m.x, m.P) for m in modes]
    for j, mode in enumerate(modes):
        # The matrix arrives row by row, and CasADi reads column by column: entry [j, i] leads from i to j.
        if settings.merging == "interacting":
            weights = [transition[j, i] * mu[i] / ahead[j] for i in range(count)]
        else:
            weights = [ca.if_else(T > 0, mu[i], float(i == j)) for i in range(count)]
        parts = [
            settings.maps[i, j](*before[i], modes[i].u0, modes[i].p, T) if i != j else before[j] for i in range(count)
        ]
        mode.x, mode.P = merged(weights, parts, before[j][0], mode.wraps)
    return ca.vertcat(*ahead)


def _predict(mode: _ModeNow, T: Expression, fading: float, moving: Expression) -> None:
    design, layout = mode.design, mode.design.layout
    predict = make_prediction(design.equations, layout, covariance_form)
    before = mode.P if fading == 1 else mode.P * ca.if_else(moving, fading, 1.0)
    x, packed = predict(
        mode.x, covariance_form.pack(before), mode.u0, mode.u1, T, mode.p, mode.q, ca.SX.ones(layout.sources)
    )
    mode.x, mode.P = x, covariance_form.unpack(packed, layout.n)


def _update(
    mode: _ModeNow, new: Mapping[str, Expression], correlated: bool
) -> tuple[Expression, Expression, Expression]:
    """Update a mode by all sensors; return its log-likelihood, the predicted sample and its covariance without sensor noise."""
    e = mode.design.equations
    sensors, wraps = len(e.measured), mode.design.step_settings.wraps
    reading = ca.Function("reading", [e.joint, e.u1, e.T, e.p], [e.shown, e.sensitivity])
    shown, slope = reading(mode.x, mode.u1, new["T"], mode.p)
    doubled = ca.Function(
        "doubled",
        [e.u1, e.T, e.p, e.levels, e.scale],
        [ca.vertcat(*(e.sensor_variance(i, ca.SX.zeros(sensors)) for i in range(sensors)))],
    )(mode.u1, new["T"], mode.p, mode.q, ca.SX.ones(e.scale.shape[0]))
    innovations = ca.vertcat(*(e.innovation(i, new["z"], shown, bool(wraps[i])) for i in range(sensors)))
    spread = covariance_form.symmetric(slope @ mode.P @ slope.T + ca.diag(doubled))
    rows: Expression = slope
    if correlated:
        whitening: Expression = ca.SX(ca.DM.eye(sensors))
        pairs = ((i, k) for i in range(sensors) for k in range(i))
        for at, (i, k) in enumerate(pairs):
            whitening[i, k] = new["whitening"][at]
        innovations, rows = whitening @ innovations, whitening @ slope
    correction, scatter, squares = ca.SX.zeros(mode.x.shape[0]), ca.SX(1), ca.SX(0)
    for i in range(sensors):
        counts, row = new["there"][i], rows[i, :]
        off = innovations[i] - row @ correction
        gain, mode.P, variance = covariance_form.updated(mode.P, row, new["variance"][i] + doubled[i], counts)
        correction = correction + gain * off
        scatter = scatter * (1 + counts * (2 * np.pi * variance - 1))
        squares = squares + counts * off**2 / variance
    mode.x = mode.x + correction
    return -0.5 * (ca.log(scatter) + squares), shown, covariance_form.pack(spread)


def _probabilities(ahead: Expression, likelihoods: list[Expression]) -> tuple[Expression, Expression]:
    """Return the mode probabilities after a scan, and the logarithm of its likelihood."""
    best = likelihoods[0]
    for one in likelihoods[1:]:
        best = ca.fmax(best, one)
    raw = [ahead[j] * ca.exp(one - best) if len(likelihoods) > 1 else ahead[j] for j, one in enumerate(likelihoods)]
    whole = sum(raw)
    return ca.vertcat(*(ca.fmax(r / whole, LEAST) for r in raw)), best + ca.log(whole)


def _combined(
    modes: list[_ModeNow], mu: Expression, T: Expression, maps: Mapping[tuple[int, int], ModeMap]
) -> tuple[Expression, Expression]:
    """Return mean and covariance of the mixture of all modes, in the states of the first."""
    parts = [(modes[0].x, modes[0].P)]
    parts += [maps[i, 0](m.x, m.P, m.u1, m.p, T) for i, m in enumerate(modes) if i]
    x, P = merged([mu[i] for i in range(len(modes))], parts, modes[0].x, modes[0].wraps)
    return x + 0, P


def _lead(name: str, leader: int, modes: list[_ModeNow], x: Expression, mu: Expression) -> None:
    """Take a state of all modes from one of them, and that of the combined estimate where this mode is probable; in place.

    Semerdjiev and Mihaylova (2000), section 4.3 (hard logic).
    """
    leading = modes[leader].x[modes[leader].design.model.states.index(name)]
    states = modes[0].design.model.states
    if name in states:
        at = states.index(name)
        x[at] = ca.if_else(mu[leader] > 0.5, leading, x[at])
    for mode in modes:
        if name in mode.design.model.states:
            mode.x[mode.design.model.states.index(name)] = leading
