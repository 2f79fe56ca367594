"""Studies of the tests: at module level, as a process of its own has to find them."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np

from shipid.campaign.campaign import Campaign, Measure

MEASURES = {
    "miss": Measure("error", "m", "distance from the middle"),
    "course": Measure("error", "rad", "over three scans"),
    "nees": Measure("nees", "1", "of two numbers", degrees=2),
    "hit": Measure("event", "1", "whether it was near"),
    "share": Measure("probability"),
    "time": Measure("value", "s"),
    "word": Measure("text"),
}


def throw(rng: np.random.Generator) -> dict:
    two = rng.normal(size=2)
    miss = 0.5 + 2.0 * two[0]
    return {
        "miss": miss,
        "course": np.arange(3.0) + rng.normal(size=3),
        "nees": float(two @ two),
        "hit": abs(miss) < 1.0,
        "share": rng.uniform(),
        "time": np.nan if rng.uniform() < 0.1 else rng.exponential(3.0),
        "word": "left" if two[1] < 0 else "right",
    }


darts = Campaign("darts", throw, MEASURES, batch=20)


def slow(rng: np.random.Generator) -> dict:
    time.sleep(0.02)
    return {"miss": rng.normal()}


slow_darts = Campaign("slow darts", slow, {"miss": Measure("error", "m")}, batch=5)


def dying(rng: np.random.Generator) -> dict:
    """The first process that comes here dies, once."""
    mark = Path(os.environ["SHIPID_TEST_MARK"])
    value = float(rng.normal())
    if value > 0.8 and not mark.exists():
        mark.touch()
        os._exit(9)
    return {"miss": value}


dying_darts = Campaign("dying darts", dying, {"miss": Measure("error", "m")}, batch=5, engine="processes")


def failing(rng: np.random.Generator) -> dict:
    value = rng.uniform()
    if value > 0.95:
        raise ValueError("off the board")
    return {"miss": value}
