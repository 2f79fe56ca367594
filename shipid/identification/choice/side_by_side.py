"""Candidates tried side by side, on all processors.

The workers are fresh interpreters that are told what to do through a pipe. A fork would copy the locks of threads that run, and
the processes of `multiprocessing` would run the user's script again where it has no guard. What a worker cannot do (a model that only
this process knows) is done here.
"""

from __future__ import annotations

import json
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import IO, cast

from shipid.foundation.numbers import counted
from shipid.foundation.processes.apart import processors
from shipid.foundation.processes.stopping import stop_if_asked
from shipid.identification.choice.trying import Attempt, Tried, try_candidate
from shipid.trials.trial import Trial

#: Seconds between two looks at whether the command was asked to stop.
_LOOK = 0.2
#: Its packages are found where those of this process are found.
_START = (
    "import json, sys; sys.path[:] = json.loads(sys.argv.pop()); "
    "from shipid.identification.choice.side_by_side import serve; serve()"
)
#: Bytes of the length that stands before each message.
_LENGTH = 8
#: What a worker did, by the place of the candidate; None where it could not.
_Answer = tuple[int, "Tried | None"]
#: The trials of an attempt, and those kept apart.
_Trials = tuple[tuple[Trial, ...], tuple[Trial, ...]]


def try_all(
    candidates: Sequence[Attempt], tell: Callable[[str], None], workers: int | None = None
) -> tuple[Tried, ...]:
    """Try candidates, as many at a time as there are processors.

    Parameters
    ----------
    candidates : sequence of Attempt
        The candidates.
    tell : callable
        Called with a line of text while they are tried.
    workers : int, optional
        How many processes; by default one for each processor. With one, everything is done in this process.

    Returns
    -------
    tuple of Tried
        In the order of the candidates.
    """
    count = min(workers or processors(), len(candidates))
    found: dict[int, Tried] = {}
    if count > 1 and sys.executable:
        _by_workers(candidates, count, tell, found)
    for place, one in enumerate(candidates):
        if place not in found:
            tell(f"{one.model.name}: candidate {len(found) + 1} of {len(candidates)}")
            found[place] = try_candidate(one)
    return tuple(found[place] for place in range(len(candidates)))


def _by_workers(
    candidates: Sequence[Attempt], count: int, tell: Callable[[str], None], found: dict[int, Tried]
) -> None:
    """Hand candidates to workers, those with most coefficients first; what they do is put into `found`."""
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    answers: queue.SimpleQueue[_Answer] = queue.SimpleQueue()
    for place in sorted(range(len(candidates)), key=lambda i: -len(candidates[i].model.parameters)):
        waiting.put(place)
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    processes = [subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) for _ in range(count)]
    try:
        for process in processes:
            threading.Thread(target=_employ, args=(process, candidates, waiting, answers), daemon=True).start()
        tell(f"{counted(len(candidates), 'candidate')}, {count} at a time")
        for done in range(len(candidates)):
            while True:
                try:
                    place, tried = answers.get(timeout=_LOOK)
                    break
                except queue.Empty:
                    stop_if_asked()
            if tried is not None:
                found[place] = tried
            tell(f"{candidates[place].model.name} is done: {done + 1} of {counted(len(candidates), 'candidate')}")
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _employ(
    process: subprocess.Popen[bytes],
    candidates: Sequence[Attempt],
    waiting: queue.SimpleQueue[int],
    answers: queue.SimpleQueue[_Answer],
) -> None:
    """Give one worker a candidate after the other; the trials, which are those of all, only with the first."""
    broken = False
    held: _Trials | None = None
    while True:
        try:
            place = waiting.get_nowait()
        except queue.Empty:
            return
        tried = None
        if not broken:
            try:
                assert process.stdin is not None and process.stdout is not None
                candidate = candidates[place]
                trials = candidate.trials, candidate.validate
                # Sent once, they are the same objects for every candidate: what is found of a trial is found once.
                if held is None or not all(map(_same, held, trials)):
                    _send(process.stdin, trials)
                    held = trials
                _send(process.stdin, replace(candidate, trials=(), validate=()))
                tried = cast("Tried | None", _receive(process.stdout))
            except Exception:  # a model that cannot be sent, a worker that has died: it is done in the main process
                broken = process.poll() is not None
        answers.put((place, tried))


def _same(one: Sequence[Trial], other: Sequence[Trial]) -> bool:
    """Whether two sequences hold the same trials, and not only equal ones."""
    return len(one) == len(other) and all(a is b for a, b in zip(one, other))


def serve() -> None:
    """Try the candidates that come through standard input, and answer through standard output, until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that asks ends this one
    answers: IO[bytes] = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever a model file prints
    held: _Trials = ((), ())
    while True:
        try:
            message = cast("Attempt | _Trials", _receive(sys.stdin.buffer))
            if not isinstance(message, Attempt):
                held = message
                continue
            candidate: Attempt | None = replace(message, trials=held[0], validate=held[1])
        except EOFError:
            return
        except Exception:  # a model of a file that only the other process has read
            candidate = None
        _send(answers, None if candidate is None else try_candidate(candidate))


def _send(pipe: IO[bytes], message: object) -> None:
    data = pickle.dumps(message)
    pipe.write(len(data).to_bytes(_LENGTH, "big") + data)
    pipe.flush()


def _receive(pipe: IO[bytes]) -> object:
    length = int.from_bytes(pipe.read(_LENGTH), "big")
    data = pipe.read(length)
    if not length or len(data) < length:
        raise EOFError
    return pickle.loads(data)
