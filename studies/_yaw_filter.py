"""An extended Kalman filter of the yaw for the closed-loop studies: Passenier (1989), section 5.3, six states.

The states are 1/tau*, K*/tau*, the yaw acceleration by wind, the rate of turn, the coloured waves and the heading; heading and
rate are taken one after the other, in Joseph's form, since the adaptation of the coefficients can be switched off.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from shipid.autopilot.sampled import Estimator

NAMES = ("b1", "a", "d", "r", "v_f", "psi")


def yaw_filter(
    length: float,
    start: dict[str, float],
    deviations: dict[str, float],
    walk: dict[str, float],
    *,
    waves: float,
    gyro: float,
    compass: float,
    colour: float = 3.0,
) -> Estimator:
    """The filter as an estimator of a sampled loop; its switch is ``adapting``.

    `start` and `deviations` hold the first estimates and their standard deviations, `walk` the standard deviation of the
    noise of each state in one sample; `waves` that of the white noise behind the rate by waves, `gyro` and `compass` those of
    the instruments, all SI.
    """
    n = len(NAMES)
    first = np.array([start.get(k, 0.0) for k in NAMES])
    spread = np.diag([deviations[k] ** 2 for k in NAMES])
    upper = np.triu_indices(n)

    def unpack(packed: Any) -> Any:
        P = ca.SX(n, n)
        for k, (i, j) in enumerate(zip(*upper)):
            P[i, j] = P[j, i] = packed[k]
        return P

    def advance(carried: Any, shown: Any, T: Any) -> tuple[Any, dict[str, Any]]:
        x, P, now = ca.SX.sym("x", n), unpack(carried[n:]), carried[:n]
        pace = shown["u_shown"] / length
        rudder = 0.5 * (shown["delta_before"] + shown["delta"])
        b1, a, d, r, v_f, psi = (x[i] for i in range(n))
        share = T / colour
        predicted = ca.vertcat(
            b1, a, d,
            r + T * (-pace * b1 * r + pace**2 * a * rudder + d),
            v_f - share * v_f,
            psi + T * r,
        )  # fmt: skip
        F, predicted = ca.substitute([ca.jacobian(predicted, x), predicted], [x], [now])
        Q = ca.diag(ca.vertcat(*(walk.get(k, 0.0) ** 2 for k in NAMES)))
        noise = ca.SX.zeros(n)
        noise[4] = share
        P = F @ P @ F.T + Q + waves**2 * noise @ noise.T
        x = predicted
        adapting = ca.vertcat(shown["adapting"], shown["adapting"], ca.SX.ones(n - 2))
        # z_r = r - v_f + w, z_psi = psi + tau_f v_f.
        rows = (ca.horzcat(0, 0, 0, 1, -1, 0), ca.horzcat(0, 0, 0, 0, colour, 1))
        for row, level, z in (
            (rows[0], waves**2 + gyro**2, shown["r_shown"]),
            (rows[1], compass**2, shown["psi_shown"]),
        ):
            innovation = z - row @ x
            gain = (P @ row.T) / (row @ P @ row.T + level) * adapting
            I_KH = ca.SX.eye(n) - gain @ row
            x = x + gain * innovation
            P = I_KH @ P @ I_KH.T + level * gain @ gain.T
        # A yaw that is not damped, or not steered, is no estimate of this ship.
        x = ca.vertcat(ca.fmax(x[0], 0.05), ca.fmax(x[1], 0.05), x[2:])
        packed = ca.vertcat(*(P[int(i), int(j)] for i, j in zip(*upper)))
        estimates = {"b1_hat": x[0], "a_hat": x[1], "d_hat": x[2], "r_hat": x[3], "psi_hat": x[5]}
        return ca.vertcat(x, packed), estimates

    return Estimator(np.concatenate([first, spread[upper]]), advance, ("adapting",))
