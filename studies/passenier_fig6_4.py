"""Passenier (1989), figure 6.4, claim P15: direct compensation makes the ship follow the reference, and dies as that adapts.

python studies/passenier_fig6_4.py [--seeds 8] [--json]
"""

from __future__ import annotations

import numpy as np
from _claims import FAILS, UNDER_A_READING, Claim, options, show
from _course_changer import Case, over_seeds

READING = (
    "Reading: the print gives no true coefficients and no tuning; K* = 1.6, tau* = 1.7, Kp = 1, damping ratio 0.85, waves of 0.1 "
    "deg/s and a reference that follows in 300 s of manoeuvring are taken. J_r is (6.2) over each course change, in ship lengths; "
    "the print's compensation starts at 250 s, here after the first course change at 350 s. K_d is clipped at zero."
)


def span(values: np.ndarray, digits: int = 2) -> str:
    return f"{values.min():.{digits}g} to {values.max():.{digits}g}"


def main() -> None:
    title = "Figure 6.4: direct compensation with the yaw filter, 60 degree course changes, calm but for waves"
    chosen = options(title, seeds=8)
    with_it = over_seeds(Case(), chosen.seeds)
    without = over_seeds(Case(compensating=False), chosen.seeds)
    never = over_seeds(Case(share=0.0), chosen.seeds)
    J, J0 = with_it["J_r"], without["J_r"]
    over, extra = with_it["overshoot"], with_it["extra"]

    def row(what: str, asked: str, values: np.ndarray, good: bool, digits: int = 2, unit: str = "") -> Claim:
        median = f"{np.median(values):.{digits}g}{unit}"
        return Claim(f"P15 {what}", asked, median, span(values, digits), (UNDER_A_READING if good else FAILS), READING)

    rows = [
        row("J_r, first change, not compensated", "about 0.28", J[:, 0], 0.24 < np.median(J[:, 0]) < 0.32, 3),
        row("J_r, second change, compensated", "below 0.005", J[:, 1], bool((J[:, 1] < 0.005).all())),
        row("J_r, changes 3 to 7", "below 0.002", J[:, 2:], bool((J[:, 2:] < 0.002).all())),
        row("J_r, second change, no compensation", "far above", J0[:, 1], bool((J0[:, 1] > 20 * J[:, 1]).all())),
        row("overshoot, first change", "about 12 deg", over[:, 0], 10 < np.median(over[:, 0]) < 14, 3, " deg"),
        row("overshoot, changes 2 to 7", "below 0.5 deg", over[:, 1:], bool((over[:, 1:] < 0.5).all()), 2, " deg"),
        row(
            "extra rudder, rms, change 2 to change 7",
            "dies",
            extra[:, -1] / extra[:, 1],
            bool((np.diff(np.median(extra[:, 1:], axis=0)) < 0).all() and (extra[:, -1] < 0.15 * extra[:, 1]).all()),
            2,
            " of the first",
        ),
        row("K_R* at the end, of K* = 1.6", "near it", with_it["K_R"][:, -1], bool((with_it["K_R"][:, -1] > 1.4).all()), 3),
        row("reference that never adapts: J_r", "below 0.002", never["J_r"][:, 1:], bool((never["J_r"][:, 1:] < 0.002).all())),
        row("reference that never adapts: extra rudder", "stays", never["extra"][:, -1], bool((never["extra"][:, -1] > 6).all()), 2, " deg"),
    ]  # fmt: skip
    means = ", ".join(f"{v:.2g}" for v in np.median(extra[:, 1:], axis=0))
    uncompensated = ", ".join(f"{v:.2g}" for v in np.median(J0, axis=0))
    notes = f"{chosen.seeds} voyages. Extra rudder of changes 2 to 7, rms: {means} deg. J_r without compensation: {uncompensated}."
    show(title, rows, chosen.json, notes)


if __name__ == "__main__":
    main()
