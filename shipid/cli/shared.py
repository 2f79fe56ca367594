"""What the commands share: messages, JSON, options, and the reading of their values."""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Sequence
from contextlib import contextmanager
from typing import Any

import click

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
overwrite_option = click.option("--overwrite", is_flag=True, help="Replace files that exist.")
format_option = click.option(
    "--format", "format_", metavar="FILE", help="Trial format file (TOML), for headers without units."
)


def watched() -> bool:
    """Whether stderr is a terminal; it may also be closed."""
    return sys.stderr is not None and sys.stderr.isatty()


def say(message: str) -> None:
    """Print one paragraph on stderr."""
    width = os.get_terminal_size(sys.stderr.fileno()).columns if watched() else 100
    filled = textwrap.fill(
        f"shipid: {message}", min(110, max(40, width)), break_long_words=False, break_on_hyphens=False
    )
    click.echo(filled, err=True)


def print_json(value: Any) -> None:
    """Print a result as JSON, which holds no NaN."""
    import json

    click.echo(json.dumps(value, indent=1, allow_nan=False, ensure_ascii=False))


def assignments(texts: Sequence[str]) -> dict[str, str]:
    """Read options of the form NAME=VALUE UNIT."""
    from shipid.foundation.errors import UsageError

    result: dict[str, str] = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise UsageError(f"'{text}' does not say NAME=VALUE with a unit, as in n3='0.4 s^2/deg^2'.")
        if name.strip() in result:
            raise UsageError(
                f"'{name.strip()}' is given twice, {result[name.strip()]} and {value.strip()}; choose one."
            )
        result[name.strip()] = value.strip()
    return result


def names_of(text: str | None) -> list[str] | None:
    """Read a list of names separated by commas."""
    from shipid.foundation.errors import UsageError

    if text is None:
        return None
    names = [n.strip() for n in text.split(",")]
    if not all(names):
        raise UsageError(f"'{text}' is not a list of names separated by commas, as in K,tau.")
    return names


def window_of(text: str | None) -> tuple[float | None, float | None] | None:
    """Read a window A:B in seconds; an end left out is the record's own."""
    from shipid.foundation.errors import UsageError

    if text is None:
        return None
    first, sign, second = text.partition(":")
    try:
        if not sign:
            raise ValueError
        return float(first) if first.strip() else None, float(second) if second.strip() else None
    except ValueError:
        raise UsageError(f"the window '{text}' is not A:B in seconds of the trial's clock, as in 1622:1712.") from None


def read(name: str, format_: str | None, window: tuple[float | None, float | None] | None) -> Any:
    """Read a trial, and pass on what its reading warned of."""
    from shipid.trials.logs.reading import read_trial

    trial = read_trial(name, format=format_, window=window)
    for note in trial.source.notes:
        if note.startswith("WARNING"):
            say(f"trial {trial.name}: {note}")
    return trial


class Variadic(click.Command):
    """A command whose option ``--validate`` takes every following word up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option before each of its values, which is the form click knows."""
        spread: list[str] = []
        taking = bare = False
        for arg in args:
            if arg == "--validate":
                taking = bare = True
                continue
            taking = taking and not (arg.startswith("-") and arg != "-")
            spread += ["--validate", arg] if taking else [arg]
            bare = bare and not taking
        if bare and not ctx.resilient_parsing:
            raise click.UsageError("--validate names no trial.", ctx)
        return super().parse_args(ctx, spread)


@contextmanager
def progress_on_stderr(quiet: bool) -> Any:
    """Show what is being done, on stderr, where somebody is looking."""
    if quiet or not watched():
        yield lambda _: None
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("reading") as status:
        yield lambda text: status.update(text)
