"""Passenier (1989), fig. 6.3 and claim P13: how fast the yaw filter finds the coefficients, by the criterion J_p.

The yaw filter against the two schemes of model-reference adaptation, which see the rate of turn only, on a 20/20 zig-zag of the
Zeefakkel in waves, 300 s. J_p is (6.1), the integral over the manoeuvre of the squared relative errors of
K* and tau*. The thesis shows curves and prints no number; the ship's coefficients for De Keizer's model are assumed.

    python studies/passenier_fig6_3.py [--runs 60] [--json] [--figure FILE]
"""

from __future__ import annotations

from typing import Any

import numpy as np
from _claims import Claim, claim, figure, options, show
from _voyage import DEG, Columns, filtered, measured, sail, settled

import shipid

BEGIN = 20.0
TRUTH = {"K": 1.2, "tau": 0.9}
UNDER_A_READING = (
    "Zeefakkel with the assumed K* 1.2, tau* 0.9; sampled every 0.4 s; waves taken three times as strong, and counted twice as "
    "in the thesis; first K* = tau* = 0.5, standard deviations of 1/tau* and K*/tau* 1, for all"
)
SCHEMES = {"parallel MRAS": "mras-parallel", "series-parallel MRAS": "series-parallel"}
WAVES = (0.3, 0.8)


def yaw_filter(wave: float, **more: Any) -> shipid.ExtendedKalmanFilter:
    """Return the yaw filter for a rate of turn by waves, in deg/s."""
    return shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        "zeefakkel",
        measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"},
        noise={"wave_noise": f"{3 * wave} deg/s"},
        **more,
    )


def coefficients(kalman: shipid.ExtendedKalmanFilter, records: list[Columns]) -> dict[str, np.ndarray]:
    """Return K* and tau* of every run, shape (runs, samples)."""
    x, states = filtered(kalman, records), kalman.model.states
    a, b1 = x[:, :, states.index("a")], x[:, :, states.index("b1")]
    return {"K": a / b1, "tau": 1 / b1}


def adapted(method: str, wave: float, records: list[Columns]) -> dict[str, np.ndarray]:
    """Return K* and tau* of every run by model-reference adaptation, shape (runs, samples)."""
    scheme = shipid.RecursiveIdentifier(
        "yaw-filter",
        "zeefakkel",
        method=method,
        measured={"r": f"{wave} deg/s"},
        start={"a": "1", "b1": "2"},
        initial={"a": "1", "b1": "1"},
    )
    results = scheme.identify_all(records)
    return {n: np.array([r[n] for r in results]) for n in TRUTH}


def off(found: dict[str, np.ndarray]) -> np.ndarray:
    """The integrand of J_p, shape (runs, samples)."""
    return sum((found[n] / TRUTH[n] - 1) ** 2 for n in TRUTH)  # type: ignore[return-value]


def main() -> None:
    chosen = options(__doc__ or "", 60)
    truth = sail("zeefakkel", 20, 320, 0.4, begin=BEGIN, speeds=[(0.0, 4.63)])
    t, late = truth["t"], truth["t"] >= BEGIN
    rows: list[Claim] = []
    curves: dict[str, np.ndarray] = {}
    remarks = []
    for wave in WAVES:
        records = measured(truth, chosen.runs, {"psi": 0.1 * DEG, "r": 0.01 * DEG}, wave * DEG, seed=6)
        found = coefficients(yaw_filter(wave, shared_noise=False), records)
        integral = np.trapezoid(off(found)[:, late], t[late], axis=1)
        good = (abs(found["K"] / TRUTH["K"] - 1) < 0.1) & (abs(found["tau"] / TRUTH["tau"] - 1) < 0.1)
        took = settled(t, good) - BEGIN
        never = int(np.isnan(took).sum())
        median = float(np.median(np.where(np.isnan(took), np.inf, took)))
        low, high = np.quantile(integral, [0.1, 0.9])
        rows += [
            claim(
                f"P13 yaw filter, waves {wave} deg/s: both within 10 % for good",
                "no number printed; median below 150 s",
                f"{median:.0f} s, never in {never} of {chosen.runs}",
                median < 150,
                reading=UNDER_A_READING,
            ),
            claim(
                f"P13 yaw filter, waves {wave} deg/s: J_p",
                "no number printed; below 30 s",
                f"{np.median(integral):.1f} s",
                float(np.median(integral)) < 30,
                f"80 % of runs {low:.1f} to {high:.1f}",
                UNDER_A_READING,
            ),
        ]
        curves[f"yaw filter, waves {wave} deg/s"] = np.median(off(found), axis=0)
        for name, method in SCHEMES.items():
            other = adapted(method, wave, records)
            theirs = np.trapezoid(off(other)[:, late], t[late], axis=1)
            share = float(np.mean(integral < theirs))
            rows.append(
                claim(
                    f"P13 J_p of the yaw filter below that of the {name}, waves {wave} deg/s",
                    "below (fig. 6.3)" if "-" not in name else "not shown",
                    f"{np.median(integral):.1f} against {np.median(theirs):.1f} s; lower in {100 * share:.0f} % of runs",
                    float(np.median(integral)) < float(np.median(theirs)) and share > 0.5,
                    f"ends at {other['K'][:, -1].mean():.2f} ± {other['K'][:, -1].std():.2f}, "
                    f"{other['tau'][:, -1].mean():.2f} ± {other['tau'][:, -1].std():.2f}",
                    UNDER_A_READING,
                )
            )
            curves[f"{name}, waves {wave} deg/s"] = np.median(off(other), axis=0)
        exact = np.trapezoid(off(coefficients(yaw_filter(wave), records))[:, late], t[late], axis=1)
        remarks.append(f"{np.median(exact):.0f} s at {wave} deg/s")
    notes = (
        "With the wave noise carried exactly instead of counted twice, waves taken three times as strong are too strong: the\n"
        f"median J_p is then {', '.join(remarks)}, since 1/tau* passes near zero on the way."
    )

    def draw(axes: Any) -> None:
        axes[0].plot(t, truth["r"] / DEG, label="rate of turn [deg/s]")
        for name, values in curves.items():
            axes[1].semilogy(t[late], values[late], label=name, linewidth=0.9)
        for axis in axes:
            axis.legend(fontsize=7)
        axes[1].set(xlabel="time [s]", ylabel="integrand of J_p")

    figure(chosen.figure, 2, draw)
    show("Passenier (1989), fig. 6.3: the yaw filter on a 20/20 zig-zag of the Zeefakkel", rows, chosen.json, notes)


if __name__ == "__main__":
    main()
