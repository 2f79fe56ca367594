"""Every equation against the same formula written out by hand in plain floats.

The formulas are typed from the papers once more, without the helpers of the declarations, so that a slip in a
helper shows. Agreement is to rounding.
"""

from collections.abc import Callable
from math import atan2, cos, exp, hypot, pi, sin, sqrt

import pytest

import shipid.models as declared
from shipid import Component
from shipid.declaration.component import declared_equations, declared_quantities
from shipid.declaration.model import Evaluation, reads_of
from shipid.parameters.catalogue import known_models, modules

Numbers = dict[str, float]
Case = Callable[[Numbers], Numbers]

# Odd numbers of a likely size, none of them 0 or 1, so that no term vanishes or hides in another.
SHIP: Numbers = {
    "x": 120.0, "y": -35.0, "psi": 0.83, "u": 6.7, "v": -0.41, "r": 0.0117, "w": 2.3e-4, "delta": -0.21, "L": 161.0,
    "cruise": 8.9, "current_north": 0.37, "current_east": -0.22, "r_disturbance": 1.7e-5, "u_disturbance": -2.1e-3,
    "T_s": 3.0, "v_disturbance": 1.3e-3,
}  # fmt: skip


def planar(n: Numbers) -> Numbers:
    return {
        "x": n["u"] * cos(n["psi"]) - n["v"] * sin(n["psi"]) + n["current_north"],
        "y": n["u"] * sin(n["psi"]) + n["v"] * cos(n["psi"]) + n["current_east"],
        "psi": n["r"],
    }


def nomoto(n: Numbers) -> Numbers:
    n |= {"K": 0.07, "tau": 41.0}
    return {"r": (n["K"] * n["delta"] - n["r"]) / n["tau"] + n["r_disturbance"], **planar(n)}


def nomoto_second_order(n: Numbers) -> Numbers:
    n |= {"K": 0.185, "tau1": 118.0, "tau2": 7.8, "tau3": 18.5}
    d = 118.0 * 7.8
    r = n["w"] + 0.185 * 18.5 / d * n["delta"] - 125.8 / d * n["r"] + n["r_disturbance"]
    w = 0.185 / d * n["delta"] - n["r"] / d + 107.3 / d * n["r_disturbance"]
    return {"r": r, "w": w, **planar(n)}


def norrbin(n: Numbers) -> Numbers:
    n |= {"a": 2.9e-4, "b1": 1.1e-3, "b3": 176.0}
    r = 2.9e-4 * n["delta"] - 1.1e-3 * n["r"] - 176.0 * n["r"] ** 3 + n["r_disturbance"]
    return {"r": r, "K": 2.9e-4 / 1.1e-3, "tau": 1 / 1.1e-3, "n3": 176.0 / 1.1e-3, **planar(n)}


def bech(n: Numbers) -> Numbers:
    n |= {"d1": 6.3e-4, "d0": 2.0e-5, "c1": 0.072, "c0": -3.0e-4, "c3": 8.8}
    r = n["w"] + 6.3e-4 * n["delta"] - 0.072 * n["r"] + n["r_disturbance"]
    first = 0.072 + 3.0e-4 * 6.3e-4 / 2.0e-5
    w = 2.0e-5 * n["delta"] + 3.0e-4 * n["r"] - 8.8 * n["r"] ** 3 + first * n["r_disturbance"]
    slow, fast = ((-0.072 + k * sqrt(0.072**2 + 1.2e-3)) / 2 for k in (1, -1))
    published = {"K": 2.0e-5 / -3.0e-4, "tau1": -1 / slow, "tau2": -1 / fast, "tau3": 31.5, "n3": 8.8 / -3.0e-4}
    return {"r": r, "w": w, **published, **planar(n)}


def _de_keizer(n: Numbers, cubic: float, linear: float, loss_cubic: float, sway_cubic: float) -> Numbers:
    n |= {"K": 1.6, "tau": 1.7, "K_u": 0.9, "tau_u": 2.5, "gamma": 0.573}
    u, r, length, u0 = n["u"], n["r"], n["L"], n["cruise"]
    rs, us = r * length / u, (u0 - u) / u0
    # tau* (L/u) r' + (u/L) H = K* (u/L) delta
    yaw = ((u / length) * 1.6 * n["delta"] - (u / length) * (cubic * rs**3 + linear * rs)) / (1.7 * length / u)
    # tau_u* (L/u) du*/dt + H_u = K_u* r*^2, u = U0 (1 - u*)
    loss = (0.9 * rs**2 - us - loss_cubic * us**3) / (2.5 * length / u)
    v = -(sway_cubic * rs**3 + 0.573 * rs) * u
    n["v"] = v
    side = {"way": u, "r_star": rs, "u_star": us, "v": v}
    return {"r": yaw + n["r_disturbance"], "u": -u0 * loss + n["u_disturbance"], **side, **planar(n)}


def de_keizer_minimal(n: Numbers) -> Numbers:
    return _de_keizer(n, 0.0, 1.0, 0.0, 0.0)


def de_keizer(n: Numbers) -> Numbers:
    n |= {"alpha1": -0.6, "alpha3": 2.4}
    return _de_keizer(n, 2.4, -0.6, 0.0, 0.0)


def de_keizer_asymmetric(n: Numbers) -> Numbers:
    n |= {"alpha0": 0.07, "alpha2": -0.35}
    found = de_keizer(n)
    rs = n["r"] * n["L"] / n["u"]
    # tau* (L/u) r' + (u/L) H: the two even terms of H.
    return found | {"r": found["r"] - (n["u"] / n["L"]) ** 2 / 1.7 * (-0.35 * rs**2 + 0.07)}


def de_keizer_cubic(n: Numbers) -> Numbers:
    n |= {"alpha1": -0.6, "alpha3": 2.4, "beta3": 0.7, "gamma3": 0.31}
    return _de_keizer(n, 2.4, -0.6, 0.7, 0.31)


def gain_scheduled(n: Numbers) -> Numbers:
    n |= {"K_star": 1.6, "tau_star": 1.7, "K_u_star": 0.9, "tau_u_star": 2.5, "gamma_star": 0.573}
    t = n["L"] / n["u"]
    schedule = {"K": 1.6 / t, "tau": 1.7 * t, "K_u": 0.9 * t * t, "tau_u": 2.5 * t, "gamma": 0.573 * n["L"]}
    motion = _de_keizer(dict(n), 0.0, 1.0, 0.0, 0.0)
    return {q: v for q, v in motion.items() if q not in ("r_star", "u_star")} | schedule


def van_leeuwen(n: Numbers) -> Numbers:
    n |= {"r_star": 0.37, "u_star": 0.17, "s_star": 3.3, "gamma": 0.573}
    n |= {"K": 1.6, "tau": 1.7, "K_u": 0.9, "tau_u": 2.5, "alpha1": -0.6, "alpha3": 2.4}
    u = 8.9 * (1 - 0.17)
    pace = u / 161.0
    n |= {"u": u, "r": pace * 0.37}
    n["v"] = -0.573 * 161.0 * n["r"]
    return {
        "r_star": pace * (1.6 * n["delta"] - 2.4 * 0.37**3 + 0.6 * 0.37) / 1.7 + n["r_disturbance"] / pace,
        "u_star": pace * (0.9 * 0.37**2 - 0.17) / 2.5 - n["u_disturbance"] / 8.9,
        "s_star": pace, "way": u, "u": u, "r": n["r"], "v": n["v"], **planar(n),
    }  # fmt: skip


PERSHITZ = {"q21": 0.331, "r21": -0.629, "s21": -0.104, "h1": 3.5, "q31": -4.64, "r31": 3.88, "s31": -1.019}


def pershitz(n: Numbers) -> Numbers:
    n |= PERSHITZ | {"k_v": 1.9, "omega": 0.043, "beta": -0.12}
    pace = 8.9 / 161.0
    ratio = 1 / (1 + 1.9 * 0.043**2 * 161.0**2 / 8.9**2)
    n |= {"r": ratio * 0.043, "u": 8.9 * ratio * cos(-0.12), "v": -8.9 * ratio * sin(-0.12)}
    psi = n["psi"]
    return planar(n) | {
        "omega": -(pace**2) * (-4.64 * -0.12 - 1.019 * n["delta"]) - pace * 3.88 * 0.043 + n["r_disturbance"],
        "beta": -pace * (0.331 * -0.12 + 3.5 * -0.12 * 0.12 - 0.104 * n["delta"]) + 0.629 * 0.043,
        "V": 8.9 * ratio, "u": n["u"], "v": n["v"], "r": n["r"],
        # (1) and (2): the course is psi - beta
        "y": 8.9 * ratio * sin(psi + 0.12) + n["current_east"],
        "x": 8.9 * ratio * cos(psi + 0.12) + n["current_north"],
    }  # fmt: skip


def pershitz_discrete(n: Numbers) -> Numbers:
    n |= PERSHITZ | {"k_v": 1.9, "Omega": 0.0021, "delta": -0.3, "delta_midships": 0.5, "L": 99.0}
    q = 0.331 * 3.88 - 4.64 * 0.629
    s = 0.629 * 1.019 + 3.88 * 0.104
    beta0 = (-q + sqrt(q * q + 4 * 3.5 * 3.88 * s * 0.3)) / (2 * 3.5 * 3.88)
    omega_u = -(-1.019 * -0.3 - 1.0 * -4.64 * beta0) / (3.88 * 99.0)
    p = 0.5 * (0.331 + 3.5 * beta0 + 3.88)
    product = (0.331 + 3.5 * beta0) * 3.88 - 4.64 * 0.629
    tau = (-p + sqrt(p * p - product)) / 99.0
    v = 8.9 / (1 + 1.9 * 0.0021**2 * 99.0**2)
    left = exp(3.0 * v * tau)
    return {
        "beta0": beta0, "beta_settling": beta0, "Omega_U": omega_u, "decay": tau, "V": v, "r": 0.0021 * v,
        "x": 120.0 + 3.0 * v * cos(0.83),
        "y": -35.0 + 3.0 * v * sin(0.83),
        "psi": 0.83 + 3.0 * v * (0.0021 + 0.5 * 3.0 * tau * v * (0.0021 - omega_u) * left),
        "Omega": 0.0021 * left + omega_u * (1 - left),
    }  # fmt: skip


def pershitz_track(n: Numbers) -> Numbers:
    n |= {"Omega": -0.0066, "V_U": 14.0, "mean_length": 69.0, "k_v": 1.9}
    v = 14.0 / (1 + 1.9 * 0.0066**2 * 69.0**2)
    heading = {"psi": 0.83 - 3.0 * v * 0.0066}
    return {"V": v, "V_U": v, "x": 120.0 + 3.0 * v * cos(0.83), "y": -35.0 + 3.0 * v * sin(0.83), **heading}


def pershitz_track_augmented(n: Numbers) -> Numbers:
    n |= {"dOmega": 0.0013}
    same = pershitz_track(n)
    return same | {"psi": 0.83 + 3.0 * same["V"] * (-0.0066 + 0.0013), "dOmega": 0.0013}


def davidson_schiff(n: Numbers) -> Numbers:
    n |= {"m": 8e-3, "I_z": 4e-4, "x_G": -0.023, "Y_vdot": -7.5e-3, "Y_rdot": -9.4e-5, "N_vdot": 4.6e-5}
    n |= {"N_rdot": -4.4e-4, "Y_v": -0.0116, "Y_r": 0.003, "Y_delta": 0.0028, "N_v": -0.0026, "N_r": -0.0018}
    n |= {"N_delta": -0.0014}
    v, r, rudder = -0.41 / 6.7, 0.0117 * 161.0 / 6.7, 0.21
    force = -0.0116 * v + (0.003 - 0.008) * r + 0.0028 * rudder
    moment = -0.0026 * v + (-0.0018 + 0.008 * 0.023) * r - 0.0014 * rudder
    # [a b; c d] (v', r') = (force, moment), by Cramer's rule
    a, b = 0.008 + 0.0075, -0.008 * 0.023 + 9.4e-5
    c, d = -0.008 * 0.023 - 4.6e-5, 4e-4 + 4.4e-4
    determinant = a * d - b * c
    sway = (d * force - b * moment) / determinant * 6.7**2 / 161.0
    yaw = (a * moment - c * force) / determinant * (6.7 / 161.0) ** 2
    return {"v": sway, "r": yaw + n["r_disturbance"], "Y": force, "N": moment, **planar(n)}


def _bech_surge(n: Numbers, m: float) -> Numbers:
    n |= {"w": -0.31, "B1": 1.01, "B0": 1.27, "A1": 2.87, "A0": -0.48, "A3": 8.8, "X0": 0.069, "X_rr": 0.83}
    n |= {"gamma": 0.471, "r_disturbance": 1.7e-5}
    u, r, length, u0 = 6.7, 0.0117, 161.0, 8.9
    rs = 0.0117 * 161.0 / 6.7
    # Accelerations by the rudder, whose force goes by u^(2-m) U0^m.
    rudder = u ** (2 - m) * u0**m * n["delta"]
    yaw = u * u / length**2 * -0.31 + 1.01 * rudder / length**2 - 2.87 * u / length * r + 1.7e-5
    first = 2.87 + 0.48 * 1.01 / 1.27
    memory = 1.27 * rudder / (u * length) + u / length * (0.48 * rs - 8.8 * rs**3) + first * 1.7e-5 * length / u
    surge = 0.069 / length * (u0 * u0 - u * u) - 0.83 * length * r * r - 2.1e-3
    n["v"] = -0.471 * length * r
    return {"r": yaw, "w": memory, "u": surge, "way": u, "r_star": rs, "v": n["v"], **planar(n)}


def bech_surge(n: Numbers) -> Numbers:
    return _bech_surge(n, 0.0)


def bech_slipstream(n: Numbers) -> Numbers:
    n |= {"m": 0.56}
    return _bech_surge(n, 0.56)


def cross_flow(n: Numbers) -> Numbers:
    n |= {"q21": 0.51, "r21": -0.44, "s21": -0.16, "q31": -4.2, "r31": 2.1, "s31": -1.18, "c_y": 4.0, "c_z": 33.0}
    n |= {"X0": 0.027, "X_vr": 1.67, "m": 1.01, "v": -1.9, "delta_lagged": -0.16, "t_delta": 1.3, "delta_p": -0.02}
    n |= {"w_0": 0.0, "k_T": 0.8, "k_delta": 0.77}
    u, v, r, length, u0 = 6.7, -1.9, 0.0117, 161.0, 8.9
    # A full drag, from -2.8 at the stern to -0.96 at the bow: w |w| = -(v + xi L r)^2, integrated.
    sway_drag = -(v * v + (length * r) ** 2 / 12)
    yaw_drag = -v * length * r / 6
    rudder = u**0.99 * u0**1.01 * (-0.16 - 0.02 * (u0 - u) / u)
    beta, rs = -v / u, length * r / u
    sway = u * u / length * (0.51 * beta - 0.44 * rs) - 0.16 * rudder / length - 4.0 / length * sway_drag
    yaw = (u / length) ** 2 * (4.2 * beta - 2.1 * rs) + 1.18 * rudder / length**2 - 33.0 / length**2 * yaw_drag
    surge = 0.027 / length * (u0 * u0 + 0.8 * u0 * (u0 - u) - u * u) + n["u_disturbance"]
    surge += 1.67 * v * r + 0.77 * -0.16 * rudder * -0.16 / length
    lag = (n["delta"] + 0.16) / 1.3
    moved = {"v": sway + n["v_disturbance"], "r": yaw + n["r_disturbance"]}
    return {**moved, "u": surge, "delta_lagged": lag, "way": u, **planar(n)}


def cross_flow_wind(n: Numbers) -> Numbers:
    blown = wind_moment(n, sway=-1.9) | wind_forces(n, sway=-1.9)
    n |= {name: blown[name] for name in ("r_disturbance", "u_disturbance", "v_disturbance")}
    return cross_flow(n) | blown


def cubic(n: Numbers) -> Numbers:
    n |= {"a": 1.21, "b1": 0.56, "b3": 2.25, "gamma": 0.46}
    u, r, length = 6.7, 0.0117, 161.0
    # Dimensionless: d(rs)/ds = a delta - b1 rs - b3 rs^3, and r' = (u/L)^2 of it.
    rs = r * length / u
    yaw = (u / length) ** 2 * (1.21 * n["delta"] - 0.56 * rs - 2.25 * rs**3)
    n["v"] = -0.46 * length * r
    return {"r": yaw + n["r_disturbance"], "way": u, "v": n["v"], **planar(n)}


def wave_level(n: Numbers) -> Numbers:
    n |= {"slow": 0.004, "slower": -0.001, "power": 3e-6, "age": 61.0, "r_expected": 0.0021}
    n |= {"wave_time": 2.7, "wave_frequency": 0.7, "wave_memory": 190.0, "wave_margin": 2.5}
    once = n["r"] - 0.0021 - 0.004
    fast, kept = once + 0.001, (0.7 * 2.7) ** 2 / (1 + (0.7 * 2.7) ** 2)
    power = (fast**2 - 3e-6) / (61.0 - 5 * 2.7)
    rms = sqrt(3e-6) / kept
    shown = {"fast": fast, "wave_rms": rms, "sigma_w": 2.5 * rms}
    return {"slow": once / 2.7, "slower": fast / 2.7, "power": power, "age": 1.0, **shown}


def cubic_wind(n: Numbers) -> Numbers:
    blown = wind_moment(n, sway=-0.46 * 161.0 * 0.0117)
    n["r_disturbance"] = blown["r_disturbance"]
    return cubic(n) | blown


def wind_moment(n: Numbers, sway: float = -0.41) -> Numbers:
    seen = wind(n, sway)
    n |= {"N_w1": -2e-7}
    levered = -2e-7 * seen["wind_relative"] ** 2 * sin(seen["wind_angle"])
    return _relative(seen) | {"r_disturbance": seen["r_disturbance"] + levered}


def wind_push(n: Numbers, sway: float = -0.41) -> Numbers:
    seen = wind(n, sway)
    return _relative(seen) | {"u_disturbance": seen["u_disturbance"]}


def wind_forces(n: Numbers, sway: float = -0.41) -> Numbers:
    return wind_push(n, sway) | lateral_wind(n, sway)


def _relative(seen: Numbers) -> Numbers:
    return {k: v for k, v in seen.items() if k.startswith("wind_")}


def de_keizer_lag(n: Numbers) -> Numbers:
    n |= {"alpha1": -0.6, "alpha3": 2.4, "t_delta": 0.93, "delta_lagged": -0.16}
    order, n["delta"] = n["delta"], n["delta_lagged"]
    yaw_and_surge = _de_keizer(n, 2.4, -0.6, 0.0, 0.0)
    n["delta"] = order
    return yaw_and_surge | {"delta_lagged": (order + 0.16) / 0.93}


def cubic_lag(n: Numbers) -> Numbers:
    order, n["delta"] = n["delta"], -0.16
    yaw = cubic(n)
    n |= {"t_delta": 0.93, "delta_lagged": -0.16, "delta": order}
    return yaw | {"delta_lagged": (order + 0.16) / 0.93}


def bech_slipstream_lag(n: Numbers) -> Numbers:
    order, n["delta"] = n["delta"], -0.16
    yaw_and_surge = bech_slipstream(n)
    n |= {"t_delta": 0.93, "delta_lagged": -0.16, "delta": order}
    return yaw_and_surge | {"delta_lagged": (order + 0.16) / 0.93}


def cubic_sway(n: Numbers) -> Numbers:
    n |= {"gamma": 0.5, "gamma3": 0.31, "r_star": 0.37}
    return {"v": -n["u"] * (0.31 * 0.37**3 + 0.5 * 0.37)}


def actuator_lag(n: Numbers) -> Numbers:
    n |= {"t_delta": 0.93, "delta_lagged": -0.16}
    return {"delta_lagged": (n["delta"] + 0.16) / 0.93}


def speed_scaled(n: Numbers) -> Numbers:
    return {"way": n["u"], "way_kept": n["u"] - 0.05 * n["cruise"]}


def loss_of_speed(n: Numbers) -> Numbers:
    n |= {"K_u": 3900.0, "tau_u": 55.0, "beta3": 0.13, "loss": 0.9}
    rate = (3900.0 * n["r"] ** 2 - 0.9 - 0.13 * 0.9**3) / 55.0 - n["u_disturbance"]
    return {"loss": rate, "u": 8.9 - 0.9}


#: Coefficients of a ship of no model, each of the size of KVLCC2's.
HULL: Numbers = {
    "R_0": 0.021, "X_vv": -0.043, "X_vr": 0.0023, "X_rr": 0.0117, "X_vvvv": 0.75, "Y_v": -0.33, "Y_r": 0.087, "Y_vvv": -1.5,
    "Y_vvr": 0.36, "Y_vrr": -0.41, "Y_rrr": 0.0083, "N_v": -0.141, "N_r": -0.051, "N_vvv": -0.033, "N_vvr": -0.28,
    "N_vrr": 0.053, "N_rrr": -0.0127,
}  # fmt: skip
STERN: Numbers = {
    "t_P": 0.21, "w_P0": 0.37, "x_P": -0.47, "C_1": 2.1, "C_2_port": 1.55, "C_2_starboard": 1.13, "k_0": 0.29, "k_1": -0.27,
    "k_2": -0.14, "f_alpha": 2.7, "t_R": 0.38, "a_H": 0.31, "x_H": -0.46, "x_R": -0.49, "l_R": -0.72, "gamma_port": 0.63,
    "gamma_starboard": 0.39, "epsilon": 1.07, "kappa": 0.52,
}  # fmt: skip
SIZES: Numbers = {"T": 9.7, "nabla": 31000.0, "x_G": 2.3, "k_G": 0.24, "D_P": 5.9, "H_R": 7.1, "A_R": 27.0}


def _mmg(n: Numbers, depth: dict[str, float], shaft: float | None) -> Numbers:
    """The printed forces in N and N m, with a density that drops out, J and K_T; then the printed equations of motion.

    The drift is from port (v is negative) at midship; abaft it the turn to starboard makes it larger.
    """
    n |= HULL | STERN | SIZES | {"m_x": 0.021, "m_y": 0.22, "J_z": 0.012}
    rho, length, d, u, v, r = 1025.0, n["L"], n["T"], n["u"], n["v"], n["r"]
    at = {k: n[k] * depth.get(k, 1.0) for k in ("R_0", "Y_v", "Y_r", "N_v", "N_r", "N_vvr", "N_vrr", "m_y", "J_z")}
    speed, drift = hypot(u, v), atan2(-v, u)
    vp, rp = v / speed, r * length / speed
    force, turn = rho / 2 * length * d * speed**2, rho / 2 * length**2 * d * speed**2
    x_h = force * (-at["R_0"] - 0.043 * vp**2 + 0.0023 * vp * rp + 0.0117 * rp**2 + 0.75 * vp**4)
    y_h = at["Y_v"] * vp + at["Y_r"] * rp - 1.5 * vp**3 + 0.36 * vp**2 * rp - 0.41 * vp * rp**2 + 0.0083 * rp**3
    n_h = (
        at["N_v"] * vp
        + at["N_r"] * rp
        - 0.033 * vp**3
        + at["N_vvr"] * vp**2 * rp
        + at["N_vrr"] * vp * rp**2
        - 0.0127 * rp**3
    )
    if shaft is None:  # thrust and resistance at the cruising speed: a quadratic in n
        inflow = n["cruise"] * 0.63
        rest = -0.14 * inflow**2 * 5.9**2 - at["R_0"] * n["cruise"] ** 2 * length * d / 2 / 0.79
        b = -0.27 * inflow * 5.9**3
        shaft = (-b + sqrt(b**2 - 4 * 0.29 * 5.9**4 * rest)) / (2 * 0.29 * 5.9**4)
    n["n"] = shaft
    drift_p, drift_r = drift + 0.47 * rp, drift + 0.72 * rp
    assert drift_p > 0 and drift_r > 0
    left = 0.63 * (1 + (1 - exp(-2.1 * drift_p)) * 0.55)
    j = u * left / (shaft * 5.9)
    k_t = 0.29 - 0.27 * j - 0.14 * j**2
    x_p = 0.79 * rho * shaft**2 * 5.9**4 * k_t
    eta = 5.9 / 7.1
    stream = eta * (1 + 0.52 * (sqrt(1 + 8 * k_t / (pi * j**2)) - 1)) ** 2 + 1 - eta
    u_r, v_r = 1.07 * u * left * sqrt(stream), speed * 0.63 * drift_r
    f_n = rho / 2 * 27.0 * 2.7 * (u_r**2 + v_r**2) * sin(n["delta"] - atan2(v_r, u_r))
    x_r = -0.62 * f_n * sin(n["delta"])
    y_r = -1.31 * f_n * cos(n["delta"])
    n_r = -(-0.49 - 0.31 * 0.46) * length * f_n * cos(n["delta"])
    unit = rho / 2 * length**2 * d
    m, m_x, m_y = rho * 31000.0, 0.021 * unit, at["m_y"] * unit
    inertia = m * ((0.24 * length) ** 2 + 2.3**2) + at["J_z"] * unit * length**2
    surge = (x_h + x_p + x_r + (m + 0.22 * unit) * v * r + 2.3 * m * r**2) / (m + m_x)
    # The two rows of sway and yaw by Cramer's rule.
    a, b, c = m + m_y, 2.3 * m, inertia
    side, moment = force * y_h + y_r - (m + m_x) * u * r, turn * n_h + n_r - 2.3 * m * u * r
    sway, yaw = (c * side - b * moment) / (a * c - b**2), (a * moment - b * side) / (a * c - b**2)
    forces = {
        "X_H": x_h / unit, "Y_H": force * y_h / unit, "N_H": turn * n_h / unit / length**2, "X_P": x_p / unit,
        "F_N": f_n / unit, "X_R": x_r / unit, "Y_R": y_r / unit, "N_R": n_r / unit / length**2,
    }  # fmt: skip
    return {
        "u": surge + n["u_disturbance"], "v": sway + n["v_disturbance"], "r": yaw + n["r_disturbance"], **forces,
        "V": speed, "drift": drift, "wake_left": left, "slipstream": k_t * (shaft * 5.9) ** 2, "way": u,
        "turns_ahead": shaft, "moves_ahead": u, "way_kept": u - 0.05 * n["cruise"],
        **{f"{k}_at_depth": value for k, value in at.items()}, **planar(n),
    }  # fmt: skip


def mmg(n: Numbers) -> Numbers:
    found = _mmg(n, {}, None)
    return found | {"n": n["n"]}


def mmg_revolutions(n: Numbers) -> Numbers:
    return _mmg(n, {}, 1.73)


def mmg_shallow(n: Numbers) -> Numbers:
    n |= {"depth": 14.0, "B": 27.0}
    h, angle, k = 9.7 / 14.0, pi * 9.7 / 14.0 / 2, 2 * 9.7 / 161.0
    wide, full = 27.0 / 9.7, 1.4 * 31000.0 / (161.0**2 * 9.7)
    a23, a17, a07 = (k / (h / 2 + (angle * cos(angle) / sin(angle)) ** q) for q in (2.3, 1.7, 0.7))
    under = (14.0 / 9.7 - 1) ** 0.82
    depth = {
        "R_0": 1 + 0.388 * h**2, "Y_v": (pi / 2 * a23 + full) / (pi / 2 * k + full), "Y_r": a07 / k, "N_v": a17 / k,
        "N_vvr": 1 + 6 * h**2.5, "N_vrr": 1 + 6 * h**2.5, "N_r": (0.54 * a07 - a07**2) / (0.54 * k - k**2), "m_y": (under + 0.413 + 0.032 * wide + 0.0129 * wide**2) / under,
        "J_z": (under + 0.413 + 0.0192 * wide + 0.00554 * wide**2) / under,
    }  # fmt: skip
    found = _mmg(n, depth, None)
    return found | {"n": n["n"], "deep_enough": 14.0 - 1.2 * 9.7}


def uniform_current(n: Numbers) -> Numbers:
    n |= {"current_speed": 1.3, "current_direction": 2.2}
    return {"current_north": 1.3 * cos(2.2), "current_east": 1.3 * sin(2.2)}


def wind(n: Numbers, sway: float = -0.41) -> Numbers:
    n |= {"wind_speed": 12.0, "wind_direction": 2.9, "N_w": 3e-7, "F_w": 4e-7}
    # The vectors over the ground axes first, turned into the ship afterwards.
    north = 12.0 * cos(2.9) - (6.7 * cos(0.83) - sway * sin(0.83)) - 0.37
    east = 12.0 * sin(2.9) - (6.7 * sin(0.83) + sway * cos(0.83)) + 0.22
    speed, angle = hypot(north, east), atan2(east, north) - 0.83 + 2 * pi  # back into -pi..pi
    return {
        "wind_relative": speed, "wind_angle": angle, "wind_ahead": speed * cos(angle),
        "wind_aside": speed * sin(angle), "r_disturbance": 3e-7 * sin(2 * angle) * speed**2,
        "u_disturbance": 4e-7 * 161.0 * cos(angle) * speed**2,
    }  # fmt: skip


def lateral_wind(n: Numbers, sway: float = -0.41) -> Numbers:
    seen = wind(n, sway)
    n |= {"Y_w": 5e-7}
    side = 5e-7 * 161.0 * seen["wind_relative"] ** 2 * sin(seen["wind_angle"])
    return _relative(seen) | {"v_disturbance": side}


def wind_harmonics(n: Numbers) -> Numbers:
    seen = wind(n)
    along = {"a_x0": 1e-4, "a_x1": 4e-4, "a_x2": -7e-5, "a_x3": 5e-5}
    across, turning = {"b_y1": 9e-4, "b_y2": 1e-4, "b_y3": -2e-4}, {"b_n1": 3e-4, "b_n2": -6e-4, "b_n3": 8e-5}
    n |= along | across | turning
    angle, square = seen["wind_angle"], seen["wind_relative"] ** 2
    x = sum(a * cos(k * angle) for k, a in enumerate(along.values()))
    y = sum(b * sin(k * angle) for k, b in enumerate(across.values(), 1))
    m = sum(b * sin(k * angle) for k, b in enumerate(turning.values(), 1))
    pushes = {
        "u_disturbance": x * square / 161.0,
        "v_disturbance": y * square / 161.0,
        "r_disturbance": m * square / 161.0**2,
    }
    return _relative(seen) | pushes


def leeway(n: Numbers) -> Numbers:
    n |= {"wind_speed": 12.0, "wind_direction": 2.9, "k_w": 0.003}
    north, east = 12.0 * cos(2.9) - 6.7 * cos(0.83) - 0.37, 12.0 * sin(2.9) - 6.7 * sin(0.83) + 0.22
    return {"v_leeway": 0.003 * hypot(north, east) ** 2 * sin(atan2(east, north) - 0.83) / 6.7}


def sway_in_wind(n: Numbers) -> Numbers:
    n |= {"gamma": 0.46}
    return leeway(n) | {"v": leeway(n)["v_leeway"] - 0.46 * 161.0 * 0.0117}


def waves(n: Numbers) -> Numbers:
    n |= {"psi_wave": 0.011, "r_wave": -0.004, "wave_noise": 0.0007, "wave_direction": 1.9, "wave_damping": 0.15}
    n |= {"wave_frequency": 0.8, "g": 9.81}
    omega = 0.8 - 0.8**2 * 6.7 * cos(1.9 - 0.83) / 9.81
    # Slower than the waves themselves: the noise falls, so that the variance of the heading is that at rest.
    shaped = 0.0007 * (omega / 0.8) ** 1.5 - 2 * 0.15 * omega * -0.004 - omega**2 * 0.011
    return {"encounter": omega, "psi_wave": -0.004, "r_wave": shaped}


def coloured_waves(n: Numbers) -> Numbers:
    n |= {"v_f": 0.002, "wave_noise": -0.0035, "T_s": 0.4, "wave_time": 3.0}
    b = 0.4 / 3.0
    return {"v_f": (1 - b) * 0.002 - b * 0.0035, "r_wave": -0.0035 - 0.002, "psi_wave": 0.4 / b * 0.002}


def steering_machine(n: Numbers) -> Numbers:
    n |= {"delta_order": -0.22, "delta": -0.21, "delta_max": 0.6, "delta_rate": 0.04, "tau_delta": 0.5}
    return {"delta": (-0.22 + 0.21) / 0.5}


def compass(n: Numbers) -> Numbers:
    n |= {"psi_wave": 0.011}
    return {"compass": 0.83 + 0.011}


def gyro(n: Numbers) -> Numbers:
    n |= {"r_wave": 0.002}
    return {"gyro": 0.0117 + 0.002}


def log(n: Numbers) -> Numbers:
    return {"log": n["u"]}


def position_sensor(n: Numbers) -> Numbers:
    return {"fix_north": n["x"], "fix_east": n["y"]}


def adaptive_yaw(n: Numbers) -> Numbers:
    n |= {"a": 0.95, "b1": 0.61, "v_f": 0.002, "wave_noise": -0.0035, "T_s": 0.4, "wave_time": 3.0}
    r = 0.95 * (6.7 / 161) ** 2 * n["delta"] - 0.61 * 6.7 / 161 * n["r"] + n["r_disturbance"]
    waves = {"v_f": 0.002 + 0.4 / 3 * (-0.0035 - 0.002), "r_wave": -0.0055}
    kept = {"r_disturbance": 0.0, "psi": n["r"], "way": 6.7, "K": 0.95 / 0.61, "tau": 1 / 0.61}
    return {"r": r, "gyro": 0.0117 - 0.0055, **kept, **waves}


def yaw_filter(n: Numbers) -> Numbers:
    return {**adaptive_yaw(n), "psi_wave": 3.0 * 0.002, "compass": 0.83 + 0.006}


def yaw_filter_seven(n: Numbers) -> Numbers:
    n |= {"psi_wave": 0.011}
    return {**adaptive_yaw(n), "psi_wave": 0.011 - 0.4 * 0.002 - 0.4 * 0.0035, "compass": 0.83 + 0.011}


def position_filter(n: Numbers) -> Numbers:
    n |= {"gamma": 0.57}
    n["v"] = v = -0.57 * 161 * 0.0117
    moved = {k: value for k, value in planar(n).items() if k != "psi"}
    kept = {"u": 0.0, "current_north": 0.0, "current_east": 0.0}
    return {**moved, **kept, "v": v, "log": 6.7, "fix_north": 120.0, "fix_east": -35.0}


def own_ship_filter(n: Numbers) -> Numbers:
    return {**position_filter(n), **yaw_filter_seven(n)}


def moving_point(n: Numbers, a: float, extra: Numbers) -> Numbers:
    """A point that turns by an angle within an interval, the accelerations held over it."""
    n |= {"vx": 5.3, "vy": -2.7, "ax": 0.11, "ay": -0.07, "omega": 0.013, "domega": -0.004}
    t, vx, vy = n["T_s"], n["vx"], n["vy"]
    way = (t, 0.0) if a == 0 else (t * sin(a) / a, t * (1 - cos(a)) / a)
    return {
        "x": n["x"] + way[0] * vx - way[1] * vy + t**2 / 2 * n["ax"],
        "y": n["y"] + way[1] * vx + way[0] * vy + t**2 / 2 * n["ay"],
        "vx": cos(a) * vx - sin(a) * vy + t * n["ax"],
        "vy": sin(a) * vx + cos(a) * vy + t * n["ay"],
        "SOG": hypot(vx, vy),
        "COG": atan2(vy, vx),
        **extra,
    }


def coordinated_circle(n: Numbers) -> Numbers:
    n |= {"curvature": 2.1e-3, "dcurvature": -4.0e-4}
    rate = (2.1e-3 - 4.0e-4) * hypot(5.3, -2.7)
    return moving_point(n, 3.0 * rate, {"omega": rate, "dcurvature": -4.0e-4})


MODELS: dict[str, Case] = {
    "constant-velocity": lambda n: moving_point(n, 0.0, {}),
    "constant-velocity-augmented": lambda n: moving_point(n, 0.0, {"domega": -0.004}),
    "coordinated-turn": lambda n: moving_point(n, 3.0 * 0.013, {}),
    "coordinated-turn-augmented": lambda n: moving_point(n, 3.0 * (0.013 - 0.004), {"domega": -0.004}),
    "turning-at-unknown-rate": lambda n: moving_point(n, 3.0 * 0.013, {"omega": 0.013}),
    "coordinated-circle-augmented": coordinated_circle,
    "nomoto": nomoto, "nomoto-second-order": nomoto_second_order, "norrbin": norrbin, "bech": bech,
    "de-keizer": de_keizer, "de-keizer-minimal": de_keizer_minimal, "de-keizer-cubic": de_keizer_cubic, "de-keizer-asymmetric": de_keizer_asymmetric,
    "gain-scheduled": gain_scheduled, "van-leeuwen": van_leeuwen, "pershitz": pershitz,
    "pershitz-discrete": pershitz_discrete, "pershitz-track": pershitz_track,
    "pershitz-track-augmented": pershitz_track_augmented, "davidson-schiff": davidson_schiff,
    "bech-surge": bech_surge, "bech-slipstream": bech_slipstream, "cross-flow": cross_flow, "cubic": cubic,
    "cubic-wind": cubic_wind, "cross-flow-wind": cross_flow_wind, "de-keizer-lag": de_keizer_lag,
    "cubic-lag": cubic_lag, "bech-slipstream-lag": bech_slipstream_lag,
    "yaw-filter": yaw_filter, "yaw-filter-seven": yaw_filter_seven, "position-filter": position_filter,
    "own-ship-filter": own_ship_filter,
    "mmg": mmg, "mmg-revolutions": mmg_revolutions, "mmg-shallow": mmg_shallow,
}  # fmt: skip
PARTS: dict[str, Case] = {
    "SpeedScaled": speed_scaled, "ActuatorLag": actuator_lag,
    "CubicSway": cubic_sway, "LossOfSpeed": loss_of_speed, "UniformCurrent": uniform_current, "Wind": wind,
    "WindMoment": wind_moment, "WindPush": wind_push, "WindForces": wind_forces, "LateralWind": lateral_wind, "WindHarmonics": wind_harmonics, "Leeway": leeway,
    "VanLeeuwenSwayInWind": sway_in_wind,
    "Waves": waves, "ColouredWaves": coloured_waves, "SteeringMachine": steering_machine, "Compass": compass,
    "WaveLevel": wave_level, "Gyro": gyro, "Log": log, "PositionSensor": position_sensor,
}  # fmt: skip


def _agree(got: Numbers, wanted: Numbers) -> None:
    assert got.keys() == wanted.keys()
    for name, value in wanted.items():
        assert got[name] == pytest.approx(value, rel=1e-12, abs=1e-15), name


@pytest.mark.parametrize("name", MODELS)
def test_model_agrees_with_the_formulas_by_hand(name: str, evaluate: Callable[..., Numbers]) -> None:
    values = dict(SHIP)
    wanted = MODELS[name](values)
    model = known_models()[name]
    if "way_kept" in model.guards:
        wanted["way_kept"] = (wanted["u"] if "u" in model.derived else values["u"]) - 0.05 * values["cruise"]
    inside = {n: v for n, v in values.items() if n not in model.derived}
    _agree(evaluate(model, inside), wanted)


@pytest.mark.parametrize("name", PARTS)
def test_component_agrees_with_the_formulas_by_hand(name: str, evaluate: Callable[..., Numbers]) -> None:
    values = dict(SHIP)
    wanted = PARTS[name](values)
    part = getattr(declared, name)
    inside = {n: v for n, v in values.items() if n not in wanted or declared_quantities(part)[n].kind == "state"}
    _agree(evaluate(part, inside), wanted)


def test_no_model_and_no_component_is_left_out() -> None:
    assert known_models().keys() == MODELS.keys()
    classes = {c for m in modules() for c in vars(m).values() if isinstance(c, type) and issubclass(c, Component)}
    joined = {c for m in known_models().values() for c in m.components}
    stating = {c for c in classes - joined if any(e.kind != "instead" for e in declared_equations(c).values())}
    assert {c.__name__ for c in stating} <= PARTS.keys()


@pytest.mark.parametrize("name", ["norrbin", "bech", "yaw-filter"])
def test_published_coefficients_give_the_regular_ones_back(name: str) -> None:
    """Regular to published by the equations, and back by what stands instead."""
    from shipid.parameters.parameter_set import resolve

    values = dict(SHIP)
    MODELS[name](values)
    model = known_models()[name]
    evaluation = Evaluation(model, {n: values[n] for n in model.parameters})
    read = {n for p in model.parameters for n in reads_of(model, model[p])}
    published = {n: float(evaluation[n]) for n in model.derived if n in read}
    back = {n: v for n, v in resolve(model, published).items() if n in model.parameters}
    assert back == pytest.approx({n: values[n] for n in model.parameters}, rel=1e-12)
