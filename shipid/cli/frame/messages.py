"""What a command says on standard error: messages, and progress on a terminal."""

from __future__ import annotations

import os
import shlex
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

from shipid.foundation.notices import Notice
from shipid.foundation.printable import printable
from shipid.foundation.processes.stopping import stop_if_asked

#: Where the context of a command keeps what was said.
_SAID = "shipid.said"
#: Where it keeps what was typed behind ``shipid``.
TYPED = "shipid.typed"


def watched() -> bool:
    """Return whether standard error is a terminal; it may also be closed."""
    return sys.stderr is not None and sys.stderr.isatty()


def say(message: str) -> None:
    """Print a message on standard error, each of its lines as a paragraph.

    Parameters
    ----------
    message : str
        Sentences.
    """
    width = os.get_terminal_size(sys.stderr.fileno()).columns if watched() else 100
    width = min(110, max(40, width))
    lines = [printable(line) for line in f"shipid: {message}".split("\n")]
    click.echo(
        "\n".join(textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False) for line in lines),
        err=True,
    )


def warn(notice: Notice) -> None:
    """Say something about the result on standard error, and keep it for the ``warnings`` of the JSON and for the exit code.

    Parameters
    ----------
    notice : Notice
        What is not part of the result itself, which prints its own.
    """
    say(notice)
    context = click.get_current_context(silent=True)
    if context is not None:
        context.meta.setdefault(_SAID, []).append(notice)


def warned() -> list[Notice]:
    """Return what `warn` has said while the command ran."""
    context = click.get_current_context(silent=True)
    said: list[Notice] = [] if context is None else context.meta.get(_SAID, [])
    return list(said)


def typed() -> str:
    """Return the running command as it was typed, with the quotes of a shell; empty where there is none."""
    context = click.get_current_context(silent=True)
    found: list[str] = [] if context is None else context.meta.get(TYPED, [])
    return shlex.join(["shipid", *found]) if found else ""


@contextmanager
def progress(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Show what is being done, on standard error, where it is a terminal; and stop where the command was asked to.

    Parameters
    ----------
    quiet : bool
        Whether nothing is shown.

    Yields
    ------
    callable
        Called with what is being done.
    """
    if quiet or not watched():
        yield lambda _: stop_if_asked()
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("reading") as status:

        def tell(text: str) -> None:
            stop_if_asked()
            status.update(text)

        yield tell
