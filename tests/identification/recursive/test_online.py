"""Time stamps that cannot be right are treated alike in a record, online, and in a filter."""

import json

import numpy as np
import pytest

from shipid.estimation.errors import SavedStateError
from shipid.estimation.online.saving import checksum_of
from shipid.generation.simulator import UnstatedInputError
from shipid.identification.recursive.identifier import RecursiveIdentifier
from shipid.identification.recursive.methods import METHODS


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


@pytest.mark.parametrize("method", sorted(set(METHODS) - {"ekf"}))
def test_saved_recursions(trial, tmp_path, method):
    """Restored to the bit; one that was cut, made zero or edited is one clear error."""
    columns = {n: trial[n][:40] for n in ("t", "r", "u", "delta")} | {"cruise": np.full(40, 9.5)}
    rows = [{n: float(c[k]) for n, c in columns.items()} for k in range(40)]
    made = RecursiveIdentifier("yaw-filter", "soesterberg", measured={"r": "0.02 deg/s"}, method=method)
    online, path = made.start(), tmp_path / "state.json"
    for row in rows[:30]:
        online.update(row)
    online.save(path)
    again, state = made.restore(path), json.loads(path.read_text())
    for row in rows[30:]:
        assert np.array_equal(again.update(row).theta, online.update(row).theta)
    text = path.read_text()
    zero = [(0.0).hex()] * len(state["carried"])
    for change, words in (
        ({"carried": zero}, "'P' is no covariance"),
        ({"carried": zero[1:]}, "'carried' is not a list of"),
        ({"carried": ["nan", *state["carried"][1:]]}, "'carried' holds a number that cannot be right"),
        ({"carried": ["0x1p+5000", *state["carried"][1:]]}, "too large"),
        ({"clock": 3}, "'clock' is not the state of a clock"),
    ):
        edited = state | change
        path.write_text(json.dumps(edited | {"checksum": checksum_of(edited)}))
        with pytest.raises(SavedStateError, match=words):
            made.restore(path)
    for end in range(0, len(text), 101):
        path.write_text(text[:end])
        with pytest.raises(SavedStateError, match="is not the saved state of a recursion"):
            made.restore(path)
