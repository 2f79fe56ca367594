"""How a command is stopped from outside: Ctrl-C (SIGINT) and a request to end (SIGTERM). Neither is lost.

The exception that a signal raises may be lost where it arrives: Python drops one raised in a destructor, and a library may
turn one into an error of its own. So the signal is also noted, and asked for where the work goes on.
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from sys import UnraisableHookArgs


class Interrupted(KeyboardInterrupt):
    """Ctrl-C (SIGINT).

    It is a class of its own because Python ends with another exit code than it is told to where its own KeyboardInterrupt has
    passed through an ``exec``, as those in dataclasses.
    """


class Terminated(BaseException):
    """The process was asked to end (SIGTERM)."""


_CODES = {signal.SIGINT: ExitCode.INTERRUPTED, signal.SIGTERM: ExitCode.TERMINATED}
_ERRORS: dict[int, type[BaseException]] = {signal.SIGINT: Interrupted, signal.SIGTERM: Terminated}
#: What the signals do where nobody has said otherwise; a process that is to ignore them goes on doing so.
_USUAL = (signal.SIG_DFL, signal.default_int_handler)
#: The signals that came since the outermost `watched` began; None outside of it.
_noted: list[int] | None = None


def why_stopped() -> ExitCode | None:
    """Return the exit code of the first signal that came, or None where none came."""
    return _CODES[signal.Signals(_noted[0])] if _noted else None


def stop_if_asked() -> None:
    """Raise the exception of a signal again whose own was lost.

    Raises
    ------
    Interrupted
        If SIGINT came.
    Terminated
        If SIGTERM came.
    """
    if _noted:
        raise _ERRORS[_noted[0]]


@contextmanager
def watched() -> Iterator[None]:
    """Note the signals that stop a command, and let each raise its exception; inside another one it does nothing.

    Only the main thread of Python can receive signals: in any other nothing is changed.

    Yields
    ------
    None
    """
    global _noted
    if _noted is not None or threading.current_thread() is not threading.main_thread():
        yield
        return
    _noted = []
    before = {s: signal.getsignal(s) for s in _CODES}
    replaced = {s: h for s, h in before.items() if h in _USUAL}
    hook = sys.unraisablehook
    sys.unraisablehook = _quiet(hook)
    try:
        for number in replaced:
            signal.signal(number, _note)
        yield
    finally:
        for number, handler in replaced.items():
            if signal.getsignal(number) is _note:  # and not ignored from now on
                signal.signal(number, handler)
        sys.unraisablehook = hook
        _noted = None


def _note(number: int, _frame: FrameType | None) -> None:
    if _noted is not None:
        _noted.append(number)
    raise _ERRORS[number]


def _quiet(hook: Callable[[UnraisableHookArgs], object]) -> Callable[[UnraisableHookArgs], object]:
    """A signal that came in a destructor is noted: its traceback is of no use."""

    def quiet(lost: UnraisableHookArgs) -> None:
        if not issubclass(lost.exc_type, (KeyboardInterrupt, Terminated)):
            hook(lost)

    return quiet


@contextmanager
def undisturbed() -> Iterator[None]:
    """Put off the signals that stop a command until a few short steps that belong together are done.

    Yields
    ------
    None
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    put_off: list[int] = []
    before = {s: signal.getsignal(s) for s in _CODES}
    replaced = {s: h for s, h in before.items() if callable(h) or h == signal.SIG_DFL}
    for number in replaced:
        signal.signal(number, lambda n, _: put_off.append(n))
    try:
        yield
    finally:
        for number, handler in replaced.items():
            signal.signal(number, handler)
        if put_off:
            signal.raise_signal(put_off[0])


def ignore_from_now() -> None:
    """Ignore the signals: the work is done, and only the end of the process is left."""
    if threading.current_thread() is threading.main_thread():
        for number in _CODES:
            signal.signal(number, signal.SIG_IGN)


def end_now(code: int) -> NoReturn:
    """End a process that was stopped, without taking the interpreter apart.

    A call of a library of C that was broken off may have left something behind that ends in a crash when Python takes itself
    apart, and what is registered for the end of the process may wait for that call. Nothing of shipid is left for then: folders and
    processes are given back where the exception passed. What was printed is written.

    Parameters
    ----------
    code : int
        The exit code.
    """
    logging.shutdown()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)
