"""How long a prediction takes: one track of 600 steps, its band, a fan of 61 headings, and a band by 200 samples.

python studies/bench_prediction.py [--json]
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from _table import Row, show

import shipid
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

#: What is not quite known when the prediction begins, with its standard deviation, SI.
UNCERTAIN = {"x": 10.0, "y": 10.0, "psi": 0.01, "r": 2e-4, "u": 0.1, "K": 0.05, "tau": 0.05, "current_north": 0.1}


def milliseconds(work: Callable[[], object], times: int) -> float:
    """Return the median time of a call in ms, after one that compiles."""
    work()
    taken = []
    for _ in range(times):
        begin = time.perf_counter()
        work()
        taken.append(time.perf_counter() - begin)
    return float(1e3 * np.median(taken))


if __name__ == "__main__":
    predictor = TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg"))
    values = {"psi": 0.0, "u": 9.5, "K": 1.6, "tau": 1.7, "current_north": 1.0}
    known = Situation(values, tuple(UNCERTAIN), np.diag(np.square(list(UNCERTAIN.values()))), {"r": 3e-5})
    headings = list(np.linspace(-2.0, 2.0, 61))
    found = (
        (
            "a track of 600 steps",
            1.0,
            milliseconds(lambda: predictor.predict(known, heading="120 deg", band="none"), 100),
        ),
        (
            "the same with its band by derivatives",
            5.0,
            milliseconds(lambda: predictor.predict(known, heading="120 deg"), 50),
        ),
        ("a fan of 61 headings", 20.0, milliseconds(lambda: predictor.fan(known, headings), 10)),
        (
            "a band by 200 samples",
            50.0,
            milliseconds(lambda: predictor.predict(known, heading="120 deg", band="samples"), 10),
        ),
    )
    show(
        "Time of predictions",
        [Row(what, f"{asked:g} ms or less", f"{ms:.2f} ms", ms <= asked) for what, asked, ms in found],
    )
