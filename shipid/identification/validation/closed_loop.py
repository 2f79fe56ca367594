"""A zig-zag repeated by its own helmsman: the rudder is reversed when the model, not the ship, reaches the heading.

With the recorded rudder (open loop) a model that turns a little too fast swings on until the recorded reversal, and every
swing adds to the error. In closed loop each swing is its own, as on another day with the same orders. Up to the first
execute the rudder is the recorded one; after it the helmsman is reduced to what the record shows of him: the angle he
holds, the heading at which he reverses, and the rate of his rudder.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.generation.loop import Loop, make_loop
from shipid.generation.step import make_step
from shipid.generation.system import generate
from shipid.parts.rudder_delay import LateRudder, recorded_rudder
from shipid.trials.filling import interpolated
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.measuring.rudder.executes import first_execute, leaves
from shipid.trials.measuring.rudder.steering import rate_of, steering_of
from shipid.trials.measuring.zigzags.swings import overshoots_of
from shipid.trials.signals import series
from shipid.trials.signals.channel import channel_of
from shipid.trials.signals.plates import plates, regular
from shipid.trials.trial import Trial

#: Reversals that are followed.
MOST = 10
#: How far beyond the record the last swing is followed, in shares of its duration.
_BEYOND = 0.3
_NEVER = 1e9


@dataclass(frozen=True, eq=False)
class ZigzagHelmsman:
    """The helmsman of a recorded zig-zag: angles held, headings of reversal, rudder rate; SI.

    Attributes
    ----------
    begin : float
        Time of the first execute.
    side : int
        Side of the first plate: 1 for starboard.
    angles : ndarray, shape (reversals + 1,)
        Rudder angle of each plate.
    headings : ndarray, shape (reversals,)
        Heading at which the rudder sets out for the next plate.
    rate : float
        Rate of the rudder.
    delay : float
        From there to where the execute is read.
    """

    begin: float
    side: int
    angles: np.ndarray
    headings: np.ndarray
    rate: float
    delay: float


def helmsman_of(trial: Trial, measured: ZigZag) -> ZigzagHelmsman | None:
    """Return the helmsman of a zig-zag, or None where the rudder, or the heading at a reversal, was not recorded.

    Parameters
    ----------
    trial : Trial
        The record.
    measured : ZigZag
        The same, measured.
    """
    if not trial.has("delta", "psi") or not measured.executes:
        return None
    steering, heading = steering_of(trial, "order", "delta"), channel_of(trial, "psi")
    t, delta = steering.channel.t, steering.channel.y
    held = regular(plates(delta))[: MOST + 1]
    reversals = min(len(held) - 1, len(measured.executes))
    if reversals < 1:
        return None
    held = held[: reversals + 1]
    steering = rate_of(steering, held)
    left = [leaves(steering, plate).time for plate in held[:-1]]
    start = first_execute(steering, held[0])
    begin = start[0].time if start is not None and start[0].time < left[0] else float(t[held[0].first])
    if not np.isfinite(interpolated(heading.t, heading.y, np.array(left))).all():
        return None  # the heading has a hole where the rudder set out
    half = 0.03 * float(np.median(np.diff([begin, *left])))
    rates = []
    for one, two in pairwise(held):
        # From 70 % of one angle to 70 % of the other, where the ramp is straight.
        y = two.side * delta[one.first : two.last]
        when = t[one.first : two.last]
        last = np.flatnonzero(y <= -0.7 * abs(one.angle))
        late = series.crossing(when[last[-1] :], y[last[-1] :], 0.7 * abs(two.angle)) if last.size else None
        if late is not None:
            early = float(when[last[-1]])
            rates.append(0.7 * (abs(one.angle) + abs(two.angle)) / max(late - early, 0.1 * trial.sampling))
    delays = [e - when for e, when in zip(measured.executes[:reversals], left) if e is not None]
    return ZigzagHelmsman(
        begin,
        held[0].side,
        np.array([plate.angle for plate in held]),
        np.array([series.value_at(heading.t, heading.y, when, half, 1) for when in left]),
        float(np.median(rates)) if rates else _NEVER,
        float(np.median(delays)) if delays else 0.0,
    )


@dataclass(frozen=True)
class Swings:
    """What a zig-zag in closed loop gives.

    Attributes
    ----------
    overshoots : tuple of float or None
        In rad, one a reversal; None where one is not reached, or the model does not sail the zig-zag.
    reversals : tuple of float
        Times in s at which the execute is read.
    """

    overshoots: tuple[float | None, ...]
    reversals: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class ZigzagSimulator:
    """A model under such a helmsman, prepared for one record.

    Attributes
    ----------
    helmsman : ZigzagHelmsman
        Who steers.
    t : ndarray, shape (N,)
        The clock of the simulation.
    controls : ndarray, shape (N, controls)
        Inputs now and at the next sample, recorded rudder, interval, and whether the helmsman steers.
    loop : Loop
        Ship, rudder and helmsman over the whole clock.
    order : ndarray of int, shape (inputs,)
        Where each input of the loop stands among those of the model.
    late : bool
        Whether the rudder acts behind a dead time, which has states of its own.
    """

    helmsman: ZigzagHelmsman
    t: np.ndarray
    controls: np.ndarray
    loop: Loop
    order: np.ndarray
    late: bool = False

    def __call__(self, x0: np.ndarray, p: np.ndarray, bias: np.ndarray) -> Swings:
        """Return the overshoots and the times of the reversals.

        Parameters
        ----------
        x0 : ndarray, shape (states,)
            Initial states.
        p : ndarray, shape (coefficients,)
            Coefficients of the model.
        bias : ndarray, shape (inputs,)
            Bias of each input.

        Returns
        -------
        Swings
        """
        h, count = self.helmsman, len(self.helmsman.headings)
        signs = np.sign(h.angles[:-1])
        limits = np.full(MOST, _NEVER)
        limits[:count] = signs * h.headings
        angles = np.full(MOST + 1, h.angles[-1])
        angles[: count + 1] = h.angles
        given = np.concatenate([p, bias[self.order], limits, angles, [h.rate]])
        rudder = self.controls[0, -3]
        z0 = np.concatenate([x0, [rudder, 0.0, 0.0] if self.late else [], [rudder, 0.0]])
        psi, reversals, margin = self.loop(z0, self.controls, given)[1].T
        if not np.isfinite(psi).all() or not (margin >= 0).all():
            return Swings((None,) * count, ())
        done = int(reversals.max())
        when = [float(self.t[np.argmax(reversals >= k + 1)]) + h.delay for k in range(done)]
        found = overshoots_of(self.t, psi, [w for w in when if w < self.t[-1]], side=h.side)
        return Swings((*found, *(None,) * (count - len(found)))[:count], tuple(when[:count]))


def zigzag_simulator(
    model: Model, trial: Trial, inputs: np.ndarray, helmsman: ZigzagHelmsman, unit_time: float
) -> ZigzagSimulator | None:
    """Prepare a model for a zig-zag in closed loop.

    Parameters
    ----------
    model : Model
        A ship model that reads the rudder angle.
    trial : Trial
        The record.
    inputs : ndarray, shape (inputs, samples)
        Inputs of the model at the samples.
    helmsman : ZigzagHelmsman
        Who steers.
    unit_time : float
        L/U in s, for the clock.

    Returns
    -------
    ZigzagSimulator or None
        None where the model does not read the rudder angle.
    """
    if "delta" not in model.inputs or "psi" not in model:
        return None
    t = trial["t"]
    # Fine enough that the heading at a reversal is met; a record of hours keeps its own clock.
    step = min(trial.sampling, max(0.01 * unit_time, trial.duration / 20_000))
    clock = np.arange(t[0], t[-1] + _BEYOND * trial.duration, step)
    rows = np.array([np.interp(clock, t, row) for row in inputs])
    recorded = rows[model.inputs.index("delta")]
    late = "delta" in model.delays
    whole = join(model.name, model, LateRudder) if late else model
    order = np.array([model.inputs.index("delta" if n == recorded_rudder(whole) else n) for n in whole.inputs])
    rows = rows[order]
    controls = np.vstack([rows, np.hstack([rows[:, 1:], rows[:, -1:]]), recorded, np.full(clock.size, step), clock])
    controls[-1] = clock >= helmsman.begin
    return ZigzagSimulator(helmsman, clock, np.ascontiguousarray(controls.T), _steered(whole), order, late)


@functools.lru_cache(maxsize=32)
def _steered(model: Model) -> Loop:
    """Ship, rudder and helmsman: ``(z, controls, given) -> (z_next, heading, reversals and least margin)`` at every sample."""
    system = generate(model)
    step = make_step(system, hold="linear")
    rudder, reversals = ca.SX.sym("rudder"), ca.SX.sym("reversals")
    now, then = ca.SX.sym("u0", system.u.shape[0]), ca.SX.sym("u1", system.u.shape[0])
    recorded, interval, engaged = ca.SX.sym("recorded"), ca.SX.sym("T"), ca.SX.sym("engaged")
    bias = ca.SX.sym("bias", system.u.shape[0])
    limits, angles, rate = ca.SX.sym("limits", MOST), ca.SX.sym("angles", MOST + 1), ca.SX.sym("rate")

    held = sum(ca.if_else(reversals == k, angles[k], 0.0) for k in range(MOST + 1))
    limit = sum(ca.if_else(reversals == k, limits[k], 0.0) for k in range(MOST))
    limit = ca.if_else(reversals >= MOST, _NEVER, limit)
    at = model.inputs.index(recorded_rudder(model))
    moved = rudder + ca.fmin(ca.fmax(held - rudder, -rate * interval), rate * interval)
    following = ca.if_else(engaged > 0, moved, then[at])
    first, second = now + 0, then + 0
    first[at], second[at] = ca.if_else(engaged > 0, rudder, recorded), following
    x_next = step.function(system.x, first + bias, second + bias, system.p, interval)
    margins = system.expression(model.guards)
    margin = ca.mmin(margins) if model.guards else ca.SX(1.0)
    heading = ca.Function("heading", [system.x, system.u, system.p], [system.expression(["psi"]), margin])
    (psi, kept), (psi_next, _) = (heading(x, u + bias, system.p) for x, u in ((system.x, first), (x_next, second)))
    reverse = ca.logic_and(engaged > 0, ca.sign(held) * psi_next >= limit)
    return make_loop(
        ca.Function(
            "steered",
            [
                ca.vertcat(system.x, rudder, reversals),
                ca.vertcat(now, then, recorded, interval, engaged),
                ca.vertcat(system.p, bias, limits, angles, rate),
            ],
            [
                ca.densify(ca.vertcat(x_next, following, reversals + ca.if_else(reverse, 1.0, 0.0))),
                ca.densify(ca.vertcat(psi, reversals, kept)),
            ],
        )
    )
