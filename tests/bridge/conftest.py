"""A bridge without a server and without a clock on the wall: the test says the time."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid.bridge.core.core import BridgeCore
from shipid.bridge.sources.simulated import SimulatedSource
from shipid.parameters.catalogue import find_model, find_ship


@pytest.fixture(scope="session")
def pilot():
    return shipid.design_autopilot(find_model("de-keizer"), find_ship("soesterberg"))


def sail(core: BridgeCore, seconds: float) -> None:
    """Step a core, and answer its questions at once."""
    until = core.t + seconds - 1e-6
    while core.t < until:
        core.step(core.t + core.filter_interval)
        question = core.question()
        if question is not None:
            core.take_answer(core.forecaster.answer(question))


def shown(core: BridgeCore) -> dict:
    """What a new client is sent, read as strict JSON."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"JSON holds {constant}")

    core.publish()
    return {k: json.loads(text, parse_constant=refuse) for k, text in core.board.since(0)}


@pytest.fixture
def make_core(pilot):
    """A core on the simulated ship, or on another source."""

    def make(source=None, **settings):
        return BridgeCore(pilot, source or SimulatedSource(pilot, seed=1), **settings)

    return make
