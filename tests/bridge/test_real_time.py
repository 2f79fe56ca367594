"""The loop against a clock that the test turns: simulated time waits for the predictor, live time does not."""

from __future__ import annotations

import asyncio
import threading
from types import SimpleNamespace

import pytest

import shipid
from shipid.bridge.real_time import RealTime
from shipid.bridge.sources.replayed import ReplayedSource

from .conftest import shown


class Core:
    """A core whose predictor answers when the test says so; a prediction is due every 2 s."""

    filter_interval, clock_factor, standing, slowed = 0.4, 64.0, False, False

    def __init__(self, timed):
        self.t, self.asked, self.answered = 0.0, [], []
        self.source = SimpleNamespace(timed=timed)
        self.forecaster, self.gate = self, threading.Event()

    def step(self, t):
        self.t = t

    def question(self):
        if self.asked and self.t - self.asked[-1] < 2.0 - 1e-6:
            return None
        self.asked.append(self.t)
        return self.t

    def answer(self, question):
        assert self.gate.wait(10)
        return question

    def take_answer(self, answer):
        self.answered.append((answer, self.t))

    def publish(self):
        pass


@pytest.mark.parametrize("timed", [True, False])
def test_simulated_time_waits_for_the_predictor_and_live_time_does_not(timed):
    """At a high clock factor, or on a busy machine, the track pilot would else order where the ship was long ago."""
    core = Core(timed)
    loop = RealTime(core, lambda: 0.0)

    async def run():
        loop.advance(0.1)  # 6.4 s of the ship's time, and no answer yet
        waited = core.t
        core.gate.set()
        while len(core.asked) < 4 and core.t < 6.0:
            await asyncio.sleep(0.001)
            loop.advance(0.0)
        return waited

    waited = asyncio.run(run())
    if timed:
        assert waited == pytest.approx(0.4)
        assert [then - asked for asked, then in core.answered] == [0.0] * len(core.answered)
        assert core.asked == pytest.approx([0.4, 2.4, 4.4, 6.4][: len(core.asked)])
    else:
        assert waited == pytest.approx(6.4)


def test_a_simulation_that_cannot_keep_up_says_so():
    core = Core(timed=True)
    now = [0.0]
    loop = RealTime(core, lambda: now[0])

    async def run():
        loop.advance(1.0)
        assert not core.slowed
        loop.advance(5.0)
        assert core.slowed
        core.gate.set()
        now[0] = 11.0
        loop.advance(0.0)
        assert not core.slowed

    asyncio.run(run())


@pytest.mark.parametrize("due", [1.0, 60.0])
def test_time_stands_where_a_replay_has_ended(make_core, due):
    """The filter would sail on, and the page show as the ship's state what nobody has seen: at a high clock factor for minutes."""
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:10/10", noise="standard", duration="30 s")
    core = make_core(ReplayedSource(trial), prediction_interval=60.0)
    loop = RealTime(core, lambda: 0.0)

    async def run():
        for _ in range(6000):
            loop.advance(due)
            if core.source.state == "ended":
                break
            await asyncio.sleep(0.01)
        for _ in range(20):
            loop.advance(due)

    asyncio.run(run())
    assert core.source.state == "ended" and core.t == pytest.approx(trial["t"][-1], abs=0.4)
    told = shown(core)
    assert told["own"]["age"] <= 0.4 and told["time"]["state"] == "ended"
    # Its clock can be set on the page as that of a simulation; there is no weather to be changed.
    assert told["simulation"]["clock_factor"] == 1.0 and "wind_speed" not in told["simulation"]
