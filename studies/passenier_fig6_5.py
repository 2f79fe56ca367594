"""Passenier (1989), figure 6.5, claim P16: from badly chosen reference parameters the course changer becomes well adjusted, in wind.

python studies/passenier_fig6_5.py [--seeds 8] [--json]
"""

from __future__ import annotations

import numpy as np
from _claims import FAILS, UNDER_A_READING, Claim, options, show
from _course_changer import Case, over_seeds

WIND = 10.0
READING = (
    f"Reading: as for figure 6.4, with a wind of {WIND:g} m/s (not printed) that blows to 120 degrees and asks for one to three degrees "
    "of rudder; the offset is estimated throughout, the coefficients only during course changes, as printed. The limits are those of "
    "the calm; the overshoot in wind holds what the wind adds."
)


def main() -> None:
    title = (
        f"Figure 6.5: the course-changing controller with the yaw filter, 60 degree course changes, wind {WIND:g} m/s"
    )
    chosen = options(title, seeds=8)
    wind = over_seeds(Case(wind=WIND), chosen.seeds)
    without = over_seeds(Case(wind=WIND, compensating=False), chosen.seeds)
    known = over_seeds(Case(wind=WIND, known=True), chosen.seeds)

    def row(what: str, asked: str, values: np.ndarray, good: bool, unit: str = "", promised: bool = True) -> Claim:
        spread = f"{values.min():.2g} to {values.max():.2g}"
        verdict = UNDER_A_READING if good else FAILS
        return Claim(f"P16 {what}", asked, f"{np.median(values):.3g}{unit}", spread, verdict, READING, promised)

    J, over = wind["J_r"], wind["overshoot"]
    rows = [
        row("J_r, first change: badly adjusted", "large", J[:, 0], bool((J[:, 0] > 0.1).all())),
        row("J_r, second change, compensated", "below 0.005", J[:, 1], bool(np.median(J[:, 1]) < 0.005)),
        row("J_r, changes 3 to 7", "below 0.002", J[:, 2:], bool((J[:, 2:] < 0.002).all())),
        row("J_r, second change, no compensation", "far above", without["J_r"][:, 1], bool((without["J_r"][:, 1] > 10 * J[:, 1]).all())),
        row("J_r, changes 3 to 7, the reference known", "the same", known["J_r"][:, 2:], bool(np.median(J[:, 2:]) < 1.5 * np.median(known["J_r"][:, 2:]))),
        row("overshoot, first change", "about 12 deg", over[:, 0], bool(np.median(over[:, 0]) > 7), " deg"),
        row("overshoot, changes 2 to 7", "below 1.5 deg", over[:, 1:], bool((over[:, 1:] < 1.5).all()), " deg"),
        row("overshoot, changes 2 to 7, as in calm", "below 0.5 deg", over[:, 1:], bool((over[:, 1:] < 0.5).all()), " deg", promised=False),
        row("overshoot, changes 2 to 7, the reference known", "the same", known["overshoot"][:, 1:],
            bool(abs(np.median(over[:, 2:]) - np.median(known["overshoot"][:, 2:])) < 0.5), " deg"),
        row("K_R* at the end, of K* = 1.6", "near it", wind["K_R"][:, -1], bool((wind["K_R"][:, -1] > 1.4).all())),
    ]  # fmt: skip
    extra = ", ".join(f"{v:.2g}" for v in np.median(wind["extra"], axis=0))
    notes = (
        f"{chosen.seeds} voyages. Rudder against wind and difference, rms over each change: {extra} deg; what is left at the end is "
        "that against the wind."
    )
    show(title, rows, chosen.json, notes)


if __name__ == "__main__":
    main()
