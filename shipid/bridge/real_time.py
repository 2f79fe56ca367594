"""The real-time loop: one task that steps the core on its own clock, and asks the predictor in a thread."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

from shipid.bridge.core.core import BridgeCore
from shipid.bridge.core.forecast import PredictionAnswer
from shipid.foundation.aliases import Plain

#: The page is sent what has changed ten times a second.
DISPLAY = 0.1
#: The loop steps the core for so long at a stretch, in s; time that it cannot catch up with is given up.
_STRETCH, _LAG = 0.08, 2.0
#: For so many seconds after time was given up, the page says that the simulation is slower than its clock factor.
_SLOWED = 10.0


class RealTime:
    """Runs a core against the clock on the wall.

    Parameters
    ----------
    core : BridgeCore
        What is run.
    clock : callable
        Returns the time in s.

    Attributes
    ----------
    core : BridgeCore
        What is run.
    sequence : int
        Counts the times the page was brought up to date.
    """

    def __init__(self, core: BridgeCore, clock: Callable[[], float] = time.monotonic) -> None:
        self.core, self.sequence = core, 0
        self._clock = clock
        self._wake = asyncio.Event()
        self._shown = asyncio.Condition()
        self._predicting: asyncio.Future[PredictionAnswer] | None = None
        self._thread = ThreadPoolExecutor(1, "predictor")
        self._target, self._gave_up = core.t, -math.inf

    async def run(self) -> None:
        """Run until the task is cancelled."""
        core = self.core
        await core.source.start()
        # The first question waits for what has to be compiled; the filter and the page do not.
        warming = asyncio.get_running_loop().run_in_executor(self._thread, core.warm)
        before = display = self._clock()
        try:
            while True:
                now = self._clock()
                self.advance(now - before)
                before = now
                self._ask()
                if now >= display:
                    display = max(display + DISPLAY, now)
                    await self._show()
                self._wake.clear()
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._wake.wait(), max(display - self._clock(), 0.001))
        finally:
            warming.cancel()
            await core.source.stop()
            self._thread.shutdown(wait=False, cancel_futures=True)

    def advance(self, elapsed: float) -> None:
        """Step the core up to the time that is due, and ask what is due on the way.

        Parameters
        ----------
        elapsed : float
            Since the last call, in s on the wall.
        """
        core, began = self.core, self._clock()
        if core.standing:
            return
        self._target += elapsed * (core.clock_factor or 1.0)
        interval = core.filter_interval
        while core.t + interval <= self._target + 1e-9 and not self._waits and not core.standing:
            core.step(core.t + interval)
            self._ask()
            if self._clock() - began > _STRETCH:
                break
        late = self._target - core.t - interval
        if late > _LAG * (core.clock_factor or 1.0):
            # A simulation that filters or predictor cannot keep up with runs slower; live samples go on at the present time.
            if core.source.timed:
                self._target, self._gave_up = core.t + interval, began
            else:
                core.step(self._target)
        core.slowed = began - self._gave_up < _SLOWED

    @property
    def _waits(self) -> bool:
        """Whether time stands until the predictor has answered: simulated time does, or the track pilot would order late."""
        return self.core.source.timed and self._predicting is not None

    def _ask(self) -> None:
        """Put the next question to the predictor, once it has answered the one before."""
        if self._predicting is not None:
            return
        question = self.core.question()
        if question is None:
            return
        loop = asyncio.get_running_loop()
        self._predicting = loop.run_in_executor(self._thread, self.core.forecaster.answer, question)
        self._predicting.add_done_callback(self._answered)

    def _answered(self, future: asyncio.Future[PredictionAnswer]) -> None:
        self._predicting = None
        if not future.cancelled():
            self.core.take_answer(future.result())
            # A track is shown at once, not with the next turn of the display.
            asyncio.ensure_future(self._show())  # noqa: RUF006 - it ends by itself
        self._wake.set()

    async def _show(self) -> None:
        self.core.publish()
        self.sequence += 1
        async with self._shown:
            self._shown.notify_all()

    async def shown(self, sequence: int) -> int:
        """Wait until the page was brought up to date again.

        Parameters
        ----------
        sequence : int
            What was sent last; what comes in between is skipped.

        Returns
        -------
        int
            The newest.
        """
        async with self._shown:
            await self._shown.wait_for(lambda: self.sequence > sequence)
        return self.sequence

    def command(self, message: Mapping[str, Plain]) -> None:
        """Do what the page asks for, and predict what has changed at once.

        Parameters
        ----------
        message : mapping
            See `BridgeCore.command`.
        """
        self.core.command(message)
        self._wake.set()
