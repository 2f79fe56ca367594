"""Saved states that were cut, edited, or made up: one clear error, whatever they hold."""

from __future__ import annotations

import json
import os
import random
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shipid.estimation.errors import FilterDivergedError, SavedStateError
from shipid.estimation.online.saving import checksum_of

SENSORS = {"psi": 0.01, "r": 5e-4}
OPTIONS: dict[str, Any] = {"density": {"r": 1e-4}, "estimated": ["K", "tau"], "gate": 5.0, "rates": {"psi": "2.1 s"}}
SAMPLE = {"psi": 0.1, "r": 1e-3, "delta": 0.05}
ODD = (
    None,
    True,
    0,
    -1,
    1.5,
    10**400,
    "",
    "nan",
    "inf",
    "-inf",
    "0x1p+2000",
    "0x0p+0",
    "x",
    "\ud800",
    [],
    {},
    [[]],
    "1e300",
)


@pytest.fixture(params=["covariance", "square-root"])
def saved(request: Any, setup: Any, tmp_path: Path) -> tuple[Any, dict[str, Any], Path]:
    kalman = setup("yaw", SENSORS, form=request.param, **OPTIONS).kalman
    online = kalman.start()
    for k in range(12):
        online.update({"t": 0.7 * k, **SAMPLE})
    path = tmp_path / "state.json"
    online.save(path)
    return kalman, json.loads(path.read_text()), path


def seal(state: Any, path: Path) -> None:
    """Write a state that was changed, with a checksum that fits it."""
    if isinstance(state, dict):
        state = state | {"checksum": checksum_of(state)}
    path.write_text(json.dumps(state))


def mutated(state: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """The same with one to three entries changed at any depth."""
    copy = json.loads(json.dumps(state))
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        place: Any = copy
        key: Any = chance.choice([k for k in copy if k not in ("schema", "filter", "checksum")] or [None])
        while key is not None and isinstance(place[key], (dict, list)) and place[key] and chance.random() < 0.8:
            place = place[key]
            key = chance.choice(list(place)) if isinstance(place, dict) else chance.randrange(len(place))
        if key is None:
            break
        change = chance.random()
        if change < 0.2:
            del place[key]
        elif change < 0.3 and isinstance(place, list):
            place.insert(key, chance.choice(ODD))
        elif change < 0.5 and isinstance(place[key], str) and place[key].startswith(("0x", "-0x")):
            with suppress(OverflowError, ValueError):  # an odd one of the turn before
                place[key] = (float.fromhex(place[key]) * chance.choice((-1.0, 0.0, 2.0, 1e3, 1e20))).hex()
        else:
            place[key] = chance.choice(ODD)
    return copy


def test_a_thousand_edited_states(saved: tuple[Any, dict[str, Any], Path]) -> None:
    """Each is refused with its file and a reason, or goes on as a filter."""
    kalman, state, path = saved
    chance, refused = random.Random(11), 0
    for _ in range(1000):
        seal(mutated(state, chance), path)
        try:
            online = kalman.restore(path)
        except SavedStateError as error:
            refused += 1
            assert str(path) in str(error) and "start" in str(error)
            continue
        try:
            estimate = online.update({"t": 9.0, **SAMPLE})
        except FilterDivergedError:
            continue
        assert np.isfinite(estimate.x).all() and np.isfinite(estimate.std).all()
        json.dumps(estimate.to_dict(), allow_nan=False)
    assert 500 < refused < 1000


def test_a_state_that_was_cut_or_edited_is_found_by_its_checksum(saved: tuple[Any, dict[str, Any], Path]) -> None:
    kalman, state, path = saved
    whole = path.read_text()
    for k in range(0, len(whole), 37):
        path.write_text(whole[:k])
        with pytest.raises(SavedStateError, match="is not the saved state of a filter"):
            kalman.restore(path)
    number = state["carried"][0]
    path.write_text(whole.replace(number, (float.fromhex(number) + 0.001).hex(), 1))
    with pytest.raises(SavedStateError, match="does not match its checksum, so that it was cut or edited"):
        kalman.restore(path)
    path.write_text(whole)
    assert kalman.restore(path).t == pytest.approx(7.7)


def test_states_that_cannot_be_right(saved: tuple[Any, dict[str, Any], Path]) -> None:
    kalman, state, path = saved
    zero = (0.0).hex()
    place = kalman.design.layout.carried["P"]
    negative = list(state["carried"])
    negative[place.start] = (-1.0).hex()
    wide = list(state["carried"])
    wide[place.start + 1] = (1e3).hex()
    cases = {
        "'P' is no covariance": {"carried": [zero] * len(state["carried"])},
        "'carried' is not a list of": {"carried": state["carried"][:-1]},
        "'out' is not a list of": {"out": [*state["out"], zero]},
        "'x' holds a number that cannot be right": {"carried": [(np.nan).hex(), *state["carried"][1:]]},
        "'refused' is 1.5, and has to be a whole number": {"refused": 1.5},
        "'rejected' does not name the sensors": {"rejected": {"psi": 0}},
        "'unseen' does not name sensors": {"unseen": ["x"]},
        "'clock' holds a number that cannot be right": {"clock": [["0x1p+3", zero], [zero], []]},
        "'clock' is not the state of a clock": {"clock": []},
        "'began' holds a number that cannot be right": {"began": "inf"},
    }
    if kalman.design.form == "covariance":
        for carried in (negative, wide):
            seal(state | {"carried": carried}, path)
            with pytest.raises(SavedStateError, match=r"is damaged: 'P' is no covariance. Use an older copy, or start"):
                kalman.restore(path)
    for words, change in cases.items():
        seal(state | change, path)
        with pytest.raises(SavedStateError, match=words):
            kalman.restore(path)
    without = {k: v for k, v in state.items() if k != "unseen"}
    seal(without, path)
    with pytest.raises(SavedStateError, match="it has no entry 'unseen'"):
        kalman.restore(path)
    seal(state | {"schema": 2}, path)
    with pytest.raises(SavedStateError, match="was saved by another version of shipid"):
        kalman.restore(path)


def test_what_is_no_file_of_a_state(saved: tuple[Any, dict[str, Any], Path], tmp_path: Path) -> None:
    kalman, _, path = saved
    path.write_text("[" * 100_000)
    with pytest.raises(SavedStateError, match="is not the saved state"):
        kalman.restore(path)
    path.write_bytes(b" " * (17 << 20))
    with pytest.raises(SavedStateError, match="is not the saved state"):
        kalman.restore(path)
    with pytest.raises(SavedStateError, match="is not the saved state"):
        kalman.restore(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")  # reading it would wait for ever
        with pytest.raises(SavedStateError, match="is not the saved state"):
            kalman.restore(tmp_path / "pipe")


def test_a_state_that_is_refused_leaves_the_filter_as_it_was(saved: tuple[Any, dict[str, Any], Path]) -> None:
    kalman, state, path = saved
    online = kalman.restore(path)
    seal(state | {"unseen": 3}, path)
    with pytest.raises(SavedStateError):
        online.load(path)
    assert online.t == pytest.approx(7.7)
    assert online.update({"t": 8.4, **SAMPLE}).taken


def test_three_writers_leave_a_whole_state(saved: tuple[Any, dict[str, Any], Path]) -> None:
    kalman, _, path = saved

    def write(count: int) -> None:
        online = kalman.start()
        for k in range(count):
            online.update({"t": 0.7 * k, **SAMPLE})
            online.save(path)

    threads = [threading.Thread(target=write, args=(n,)) for n in (5, 6, 7)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert kalman.restore(path).t is not None
    assert os.listdir(path.parent) == [path.name]
