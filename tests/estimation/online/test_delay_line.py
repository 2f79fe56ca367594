"""A filter of single samples keeps a late rudder for its dead time: the same as the filter of the whole record."""

import json
from typing import Any

import numpy as np
import pytest

import shipid
from shipid.estimation.errors import SavedStateError
from shipid.estimation.online.delay_line import DelayLine
from shipid.estimation.online.saving import checksum_of
from shipid.foundation.errors import UsageError
from shipid.parameters.replaced import with_values

MODEL = "nomoto-delay"


@pytest.fixture(scope="module")
def kalman() -> Any:
    ship = with_values(shipid.find_ship("soesterberg"), {"delay": "5.3 s"}, [shipid.find_model(MODEL)])
    return shipid.ExtendedKalmanFilter(MODEL, ship, measured={"psi": "0.2 deg", "r": "0.02 deg/s"}, estimated=["K"])


@pytest.fixture(scope="module")
def record() -> dict[str, np.ndarray]:
    """With a gap that is bridged in several steps, and samples without a rudder."""
    t = np.arange(120) * 1.0
    t[70:] += 25.0
    delta = np.deg2rad(10.0) * np.sign(np.sin(t / 15.0))
    psi = np.cumsum(np.deg2rad(0.3) * np.sin(t / 15.0))
    return {"t": t, "psi": psi, "r": np.gradient(psi, t), "delta": delta, "u": np.full(t.size, 9.5)}


def test_one_by_one_is_the_whole_record(kalman: Any, record: dict[str, np.ndarray]) -> None:
    run, online = kalman.filter(record), kalman.start()
    x = np.array([online.update({n: float(c[k]) for n, c in record.items()}).x for k in range(record["t"].size)])
    assert np.abs(x - run.x).max() <= 1e-12 * np.abs(run.x).max()


def test_a_saved_state_holds_what_is_still_to_act(kalman: Any, record: dict[str, np.ndarray], tmp_path: Any) -> None:
    rows = [{n: float(c[k]) for n, c in record.items()} for k in range(record["t"].size)]
    first, path = kalman.start(), tmp_path / "state.json"
    for row in rows[:40]:
        first.update(row)
    first.save(path)
    again = kalman.restore(path)
    for row in rows[40:60]:
        assert np.array_equal(first.update(row).x, again.update(row).x)
    for late in ({"delta": [["0x0p+0"], []]}, {"delta": [["nan"], ["0x0p+0"]]}, {}):
        state = json.loads(path.read_text()) | {"late": late}
        path.write_text(json.dumps(state | {"checksum": checksum_of(state)}))
        with pytest.raises(SavedStateError, match="is damaged"):
            kalman.restore(path)


def test_a_value_that_is_missing_is_the_last_that_was_given() -> None:
    line = DelayLine(2.0)
    assert line.last is None
    for t, value in ((0.0, 1.0), (1.0, 3.0), (4.0, 5.0)):
        line.take(t, value)
    assert line.last == 5.0
    assert [line.at(t) for t in (1.0, 2.5, 3.0, 4.5, 6.0, 9.0)] == [1.0, 2.0, 3.0, 4.0, 5.0, 5.0]
    early = DelayLine(-2.0)
    early.take(0.0, 1.0)
    early.take(1.0, 2.0)
    assert early.at(1.0) == 2.0


def test_a_multiple_model_filter_of_single_samples_says_that_it_cannot(kalman: Any) -> None:
    from shipid.estimation.multiple.online import OnlineMultipleModel

    class Design:
        designs = (kalman.design,)

    with pytest.raises(UsageError, match=r"A multiple-model filter that takes one sample at a time cannot carry it"):
        OnlineMultipleModel(Design())
