"""What the page shows: only what has changed, strict JSON, alarms one by one, a past that does not grow."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shipid.bridge.shown.alarms import Alarms
from shipid.bridge.shown.board import Board
from shipid.bridge.shown.past_track import PastTrack
from shipid.bridge.shown.plain_values import number, strict_json
from shipid.foundation.errors import UsageError

VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.integers(-9, 9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=8,
)


@given(VALUES)
def test_json_never_holds_nan(value):
    def refuse(constant):
        raise AssertionError(constant)

    json.loads(strict_json(value), parse_constant=refuse)


def test_half_a_character_ends_no_connection():
    text = strict_json({"told": "a\ud800b", "x\udc80": math.nan, "whole": "é"})
    assert json.loads(text.encode("utf-8")) == {"told": "a?b", "x?": None, "whole": "é"}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, None])
def test_a_number_that_is_none_is_null(value):
    assert number(value) is None


def test_only_what_has_changed_is_sent():
    board = Board()
    board.put("a", 1)
    board.put("b", [1.0])
    seen = board.version
    board.put("a", 1)
    assert list(board.since(seen)) == []
    board.put("b", [2.0])
    assert list(board.since(seen)) == [("b", "[2.0]")] and dict(board.since(0)) == {"a": "1", "b": "[2.0]"}


def test_alarms_are_acknowledged_one_by_one():
    alarms = Alarms()
    alarms.set("one", True, 1.0, "caution", "first")
    alarms.set("two", True, 2.0, "alarm", "second")
    first, second = alarms.to_list()
    assert (first["text"], second["text"]) == ("second", "first")
    alarms.acknowledge(first["id"])
    assert [a["acknowledged"] for a in alarms.to_list()] == [False, True]
    alarms.set("one", False, 3.0)
    assert alarms.to_list()[0]["text"] == "first (no longer)"  # until it is acknowledged
    alarms.acknowledge(second["id"])
    assert [a["text"] for a in alarms.to_list()] == ["second"]
    alarms.set("two", False, 4.0)
    assert alarms.to_list() == []
    with pytest.raises(UsageError, match="no alarm 1"):
        alarms.acknowledge(1)


def test_the_past_is_sent_piece_by_piece_and_does_not_grow():
    past = PastTrack()
    for k in range(40_000):
        past.add(k * 1.0, float(k), 0.0)
    assert past.count == 4000
    assert len(past.to_dict()["t"]) == 2880
    assert [p[0] for p in past.since(3998)] == [39980.0, 39990.0]
    assert past.since(past.count) == []
