"""One sample of a recursive identification, as a generated function ``(carried, control, constants) -> (carried, outputs)``.

The methods differ in their gain only. The recursion also carries the covariance that output and parameters have under that
gain (Joseph's form, which holds for any gain), so that the standard deviations of all methods mean the same.
"""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.layout import places_of, total
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.identification.recursive.methods import Method
from shipid.identification.recursive.regression import StateRegression

#: The pole of the model that is run stays within this: a time constant of ten thousand samples.
LARGEST_POLE = 0.9999
#: Samples of least squares before instruments are used, and of instruments before their model follows the estimate; times the
#: number of parameters. Both wait besides until the gains' variances are this share of their first ones: a straight course
#: holds no information, however long it is.
WARM_UP, SETTLING, KNOWN = 20, 80, 1e-3
#: Share of the newest estimate in the auxiliary model's parameters: small, so that their noise is not that of the sample.
AUXILIARY_SHARE = 0.02
#: Innovations before their size is used as an estimate of the noise, times the number of parameters.
FEW = 10


class RecursionLayout:
    """Where everything stands in the vectors of a recursion.

    Parameters
    ----------
    parameters : int
        How many are estimated.
    inputs, coefficients : int
        How many the model has.

    Attributes
    ----------
    n : int
        Number of parameters.
    carried, control, constants, outputs : dict of str to slice
        What the function of one sample takes and returns.
    """

    def __init__(self, parameters: int, inputs: int, coefficients: int) -> None:
        n, joint = parameters, parameters + 1
        triangle = covariance_form.size(joint)
        self.n = n
        self.carried = places_of(
            y=1,
            theta=n,
            u=inputs,
            P=n * n,
            P_y=1,
            joint=triangle,
            y_aux=1,
            theta_aux=n,
            phase=1,
            waited=1,
            age=1,
            nis=1,
            count=1,
        )
        self.control = places_of(u=inputs, T=1, z=1, there=1)
        self.constants = places_of(p=coefficients, q=joint, q_density=joint, P0=n, r=1, forgetting=1, settles=1)
        self.outputs = places_of(y=1, theta=n, joint=triangle, e=1, S=1, e_aux=1, nis=1, count=1)


def make_recursion(regression: StateRegression, method: Method, layout: RecursionLayout) -> CasadiFunction:
    """Generate the function of one sample.

    Parameters
    ----------
    regression : StateRegression
        The regression that predicts.
    method : Method
        The method, which sets the gain.
    layout : RecursionLayout
        Where everything stands.

    Returns
    -------
    casadi.Function

    Notes
    -----
    The numbers of the equations are those of Passenier (1989). Without a measurement only the model is run.
    """
    before, control, constants = (
        ca.SX.sym(name, total(places))
        for name, places in (
            ("carried", layout.carried),
            ("control", layout.control),
            ("constants", layout.constants),
        )
    )
    n = layout.n
    old = {k: before[s] for k, s in layout.carried.items()}
    u1, T, z, there = (control[layout.control[k]] for k in ("u", "T", "z", "there"))
    p, q_sample, q_density, first, r, forgetting, settles = (constants[s] for s in layout.constants.values())
    # A density enters half before and half after the transition, as in the filter (trapezoidal rule).
    half, added = q_density * T / 2, q_density * T / 2 + q_sample * (T > 0)
    # Without another first estimate the state starts at its first sample, which then gives no innovation.
    begins = settles * there * (old["age"] == 0)
    there = there - begins

    ahead, pole, psi = regression.predict(old["y"], old["theta"], old["u"], u1, p, T)
    e = z - ahead
    transition = ca.vertcat(ca.horzcat(pole, psi.T), ca.horzcat(ca.SX.zeros(n, 1), ca.SX.eye(n)))
    before_step = covariance_form.unpack(old["joint"], n + 1) + ca.diag(half)
    joint = covariance_form.symmetric(transition @ before_step @ transition.T + ca.diag(added))
    spread = joint[0, 0] + r

    weights = ca.reshape(old["P"], n, n) + ca.diag(half[1:])
    y_aux, theta_aux, direction = old["y_aux"], old["theta_aux"], psi
    phase, waited = old["phase"], old["waited"] + there
    if method.instruments:
        known = ca.mmax(ca.diag(weights) / first) < KNOWN
        begin = (phase == 0) * (waited > WARM_UP * n) * known
        follow = (phase == 1) * (waited > SETTLING * n) * known
        phase, waited = phase + begin + follow, ca.if_else(begin, 0.0, waited)
        # The least-squares estimate that starts the auxiliary model is biased: its weight is removed.
        weights = ca.if_else(begin, ca.diag(first), weights)
        y_aux, theta_aux, direction = _instruments(regression, phase, old, psi, u1, p, T)
    along = weights @ direction
    # (4.126): variance of the predicted output, apart from that by its parameters.
    own = pole**2 * (old["P_y"] + half[0]) + added[0] if method.previous_output == "weighted" else half[0] + added[0]
    quadratic = ca.dot(psi, along)
    memory = ca.if_else(T > 0, forgetting, 1.0) if method.forgets else 1.0
    gain, correction = _gains(method, joint, r, own, quadratic, along, memory)
    gain, correction = gain * there, correction * there
    theta = old["theta"] + correction * e
    y = ahead + gain * e
    updated = weights - correction @ (psi.T @ weights)
    updated = ca.if_else(there, updated / memory, weights) + ca.diag(added[1:])
    if not method.instruments:
        updated = covariance_form.symmetric(updated)
    if method.projects:
        theta = _stable(regression, y, theta, updated, old["u"], u1, p, T)
    joint = _updated(joint, ca.vertcat(gain, correction), spread)

    uncertain = (1 - gain) * (own + quadratic)  # (4.131)
    y, y_aux, uncertain = (ca.if_else(begins, new, kept) for new, kept in ((z, y), (z, y_aux), (r, uncertain)))
    settled = ca.diagcat(r, joint[1:, 1:])
    joint = ca.if_else(begins, settled, joint)

    nis = old["nis"] + there * e**2 / spread
    count = old["count"] + there
    following = {
        "y": y,
        "theta": theta,
        "u": u1,
        "P": ca.vec(updated),
        "P_y": uncertain,
        "joint": covariance_form.pack(joint),
        "y_aux": y_aux,
        "theta_aux": theta_aux,
        "phase": phase,
        "waited": waited,
        "age": old["age"] + there + begins,
        "nis": nis,
        "count": count,
    }
    shown = {
        "y": y,
        "theta": theta,
        "joint": covariance_form.pack(joint),
        "e": e,
        "S": spread,
        "e_aux": z - y_aux,
        "nis": nis,
        "count": count,
    }
    results = [
        ca.densify(ca.vertcat(*(ca.SX(values[k]) for k in places)))
        for values, places in ((following, layout.carried), (shown, layout.outputs))
    ]
    return ca.Function("recursion", [before, control, constants], ca.cse(results))


def _gains(
    method: Method,
    joint: Expression,
    r: Expression,
    own: Expression,
    quadratic: Expression,
    along: Expression,
    memory: Expression,
) -> tuple[Expression, Expression]:
    """K_y and K_theta: the one line in which the methods differ.

    `own` is the variance of the predicted output apart from its parameters, `quadratic` what those add, `along` the
    covariance of parameters and predicted output.
    """
    if method.previous_output == "optimal":
        both = joint[:, 0] / (joint[0, 0] + r)  # (4.115)
        return both[0], both[1:]
    variance = own + quadratic
    gain = {"measured": 1.0, "predicted": 0.0, "weighted": variance / (variance + r)}[method.previous_output]
    # (4.74) leaves out the uncertainty of the output, (4.130) counts it.
    return ca.SX(gain), along / (memory * (r if method.separate else own + r) + quadratic)


def _updated(joint: Expression, gains: Expression, spread: Expression) -> Expression:
    """Joseph's form for one measurement of the first unknown: the covariance after an update with any gain."""
    column = joint[:, 0]
    return covariance_form.symmetric(joint - gains @ column.T - column @ gains.T + (gains * spread) @ gains.T)


def _instruments(
    regression: StateRegression,
    phase: Expression,
    old: dict[str, Expression],
    psi: Expression,
    u1: Expression,
    p: Expression,
    T: Expression,
) -> tuple[Expression, Expression, Expression]:
    """The auxiliary model's output and parameters, and the direction in which the parameters are corrected.

    First it has the parameters of least squares. It keeps them while the estimates along its output, scattered at the beginning,
    settle, and follows those slowly then.
    """
    share = ca.if_else(phase == 0, 1.0, ca.if_else(phase == 1, 0.0, AUXILIARY_SHARE))
    theta = old["theta_aux"] + share * (old["theta"] - old["theta_aux"])
    theta = _stable(regression, old["y_aux"], theta, ca.SX.eye(theta.shape[0]), old["u"], u1, p, T)
    y_aux, _, clean = regression.predict(old["y_aux"], theta, old["u"], u1, p, T)
    return y_aux, theta, ca.if_else(phase == 0, psi, clean)


def _stable(
    regression: StateRegression,
    y: Expression,
    theta: Expression,
    metric: Expression,
    u0: Expression,
    u1: Expression,
    p: Expression,
    T: Expression,
) -> Expression:
    """Project parameters on those of a stable model, in the metric of their covariance; exact where the pole is linear."""
    symbols = [
        ca.SX.sym("y"),
        ca.SX.sym("theta", theta.shape[0]),
        *(ca.SX.sym("s", a.shape[0]) for a in (u0, u1, p, T)),
    ]
    pole = regression.predict(*symbols)[1]
    limits = ca.Function("limits", symbols, [pole, ca.densify(ca.jacobian(pole, symbols[1]).T)])
    pole, slope = limits(y, theta, u0, u1, p, T)
    beyond = pole - ca.fmax(ca.fmin(pole, LARGEST_POLE), -LARGEST_POLE)
    along = metric @ slope
    # Where no parameter changes the pole no projection is needed.
    power = ca.dot(slope, along)
    share = ca.if_else((T > 0) * (power > 0), beyond / ca.if_else(power > 0, power, 1.0), 0.0)
    return theta - along * share
