"""Signals that stop a command: noted, raised, put off, and never lost."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.processes.stopping import (
    Interrupted,
    Terminated,
    ignore_from_now,
    stop_if_asked,
    undisturbed,
    watched,
    why_stopped,
)


@pytest.fixture(autouse=True)
def usual() -> Iterator[None]:
    """Python's own handlers, also where the tests run in the background of a shell."""
    before = {s: signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(
    ("number", "error", "code"),
    [(signal.SIGINT, Interrupted, ExitCode.INTERRUPTED), (signal.SIGTERM, Terminated, ExitCode.TERMINATED)],
)
def test_a_signal_raises_and_is_noted(number: int, error: type[BaseException], code: ExitCode) -> None:
    with watched():
        stop_if_asked()
        with pytest.raises(error):
            signal.raise_signal(number)
        assert why_stopped() == code
        with pytest.raises(error):
            stop_if_asked()
        with watched():  # inside another one it does nothing
            assert why_stopped() == code
        assert why_stopped() == code
    assert why_stopped() is None
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


class Dropping:
    """What Python does with an error in a destructor: it is dropped."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


def test_a_signal_in_a_destructor_is_not_lost(capsys: pytest.CaptureFixture[str]) -> None:
    hook = sys.unraisablehook
    with watched():
        Dropping()
        with pytest.raises(KeyboardInterrupt):
            stop_if_asked()
    assert "ignored" not in capsys.readouterr().err
    assert sys.unraisablehook is hook


def test_steps_that_belong_together_are_not_torn_apart() -> None:
    done = []
    with watched(), pytest.raises(Interrupted):
        with undisturbed():
            signal.raise_signal(signal.SIGINT)
            done.append("both steps")
        done.append("more")
    assert done == ["both steps"]


def test_a_process_that_is_to_ignore_a_signal_goes_on() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with watched(), undisturbed():
        signal.raise_signal(signal.SIGINT)
        stop_if_asked()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_a_command_that_is_done_stays_done() -> None:
    """A signal while the process ends would change the exit code of work that was done and written."""
    with watched():
        ignore_from_now()
    signal.raise_signal(signal.SIGINT)
    signal.raise_signal(signal.SIGTERM)


def test_a_stopped_process_ends_at_once() -> None:
    """Its output is written; what others registered for the end, which may wait for a broken call of C, is not begun."""
    code = (
        "import atexit; from shipid.foundation.processes.stopping import end_now; "
        "atexit.register(print, 'taken apart'); print('done', end=''); end_now(130)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "done", "")
