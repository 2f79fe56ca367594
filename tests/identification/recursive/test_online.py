"""Time stamps that cannot be right are treated alike in a record, online, and in a filter."""

import numpy as np
import pytest

from shipid.generation.simulator import UnstatedInputError
from shipid.identification.recursive.identifier import RecursiveIdentifier


@pytest.mark.parametrize(
    ("case", "lost"), [("one behind", 1), ("one ahead", 1), ("set back", 2), ("set ahead", 2), ("not a number", 1)]
)
def test_a_clock_that_is_wrong(trial, case, lost):
    columns = {n: trial[n][:200].copy() for n in ("t", "r", "u", "delta")}
    columns["cruise"] = np.full(200, 9.5)
    change = {
        "one behind": (slice(90, 91), -20.0),
        "one ahead": (slice(90, 91), 5000.0),
        "set back": (slice(90, None), -3600.0),
        "set ahead": (slice(90, None), 1e5),
        "not a number": (slice(90, 91), np.nan),
    }
    where, by = change[case]
    columns["t"][where] += by
    made = RecursiveIdentifier("yaw-filter", "soesterberg", measured={"r": "0.02 deg/s"})
    result, online = made.identify(columns), made.start()
    estimates = [online.update({n: c[k] for n, c in columns.items()}) for k in range(200)]
    kept = [e for e in estimates if not e.refused]
    assert online.refused == result.arranged.back == lost == 200 - len(kept)
    assert np.array([e.theta for e in kept]) == pytest.approx(result.theta, rel=1e-12)
    assert online.t == columns["t"][-1]


def test_nothing_has_begun_before_a_sample_that_is_whole(trial):
    online = RecursiveIdentifier("yaw-filter", "soesterberg", measured={"r": "0.02 deg/s"}).start()
    with pytest.raises(UnstatedInputError, match=r"reads 'delta'.*that the first sample does not record"):
        online.update({"t": 100.0, "r": 0.0, "u": 9.5})
    assert online.t is None and online.estimate is None
    assert online.update({"t": 0.0, "r": 0.0, "u": 9.5, "delta": 0.0}).t == 0.0
