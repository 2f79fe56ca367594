"""The group of commands, and how one of them is run: what it answers, and its exit code."""

from __future__ import annotations

import importlib
import os
import re
import warnings
from collections.abc import Sequence

import click

from shipid.cli.frame.messages import TYPED, say
from shipid.cli.registry import COMMANDS
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.processes.stopping import Terminated, watched, why_stopped


class _LazyGroup(click.Group):
    """A group that imports a command when it is called, so that ``shipid --help`` imports nothing numeric."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Keep what was typed, before it is taken apart."""
        ctx.meta[TYPED] = list(args)
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> object:
        """Run a command; an error is also told in JSON where that is asked for."""
        try:
            return super().invoke(ctx)
        except Exception as error:
            # Nobody reads behind a closed pipe, of a command that was stopped nothing more is written, and what click raises is usage.
            others = (BrokenPipeError, click.ClickException, click.exceptions.Exit, click.Abort)
            if why_stopped() is None and not isinstance(error, others):
                _tell_in_json(ctx, error)
            raise

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in the order of the work."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command."""
        if cmd_name not in COMMANDS:
            return None
        module, _, function = COMMANDS[cmd_name][0].partition(":")
        command: click.Command = getattr(importlib.import_module(module), function)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, about) for name, (_, about) in COMMANDS.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Offer the nearest command for a misspelt one."""
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from shipid.foundation.errors import UnknownNameError

            raise UnknownNameError("command", args[0], COMMANDS)
        return super().resolve_command(ctx, args)


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="shipid", message="shipid %(version)s")
def main() -> None:
    """Identify ships from trials: declare the ship once; everything else is generated.

    \b
    shipid models                                  what there is
    shipid simulate norrbin --ship zeefakkel --manoeuvre zigzag:20/20 --noise standard -o trial.csv
    shipid measure trial.csv                       overshoots, period, advance, transfer, ...
    shipid identify trial.csv --model norrbin --ship zeefakkel --out result
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; errors are one paragraph on stderr, never a traceback.

    Parameters
    ----------
    arguments : sequence of str, optional
        What stands behind ``shipid``; taken from the process by default.

    Returns
    -------
    int
        The exit code.
    """
    from shipid.foundation.errors import ShipidError

    given = None if arguments is None else list(arguments)
    with watched():
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _warn
                code = main.main(args=given, prog_name="shipid", standalone_mode=False)
        except (click.Abort, KeyboardInterrupt, Terminated) as error:
            return _stopped(ExitCode.TERMINATED if isinstance(error, Terminated) else ExitCode.INTERRUPTED)
        except (Exception, SystemExit) as error:
            # A signal that comes inside a library of C may end as an error of that library.
            stopped = why_stopped()
            if stopped is not None:
                return _stopped(stopped)
            if isinstance(error, click.ClickException):
                return _refuse(error)
            if isinstance(error, ShipidError):
                say(str(error))
                return error.exit_code
            return _failed(error)
        stopped = why_stopped()
        if stopped is not None:
            return stopped
    return code if isinstance(code, int) else ExitCode.DONE


def _tell_in_json(context: click.Context, error: Exception) -> None:
    from shipid.cli.frame.error_as_json import deliver_error
    from shipid.foundation.errors import ShipidError

    code, message = (error.exit_code, str(error)) if isinstance(error, ShipidError) else _failure(error)
    if code != ExitCode.USAGE:
        name = type(error).__name__.removesuffix("Error")
        kind = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).lower() or "error"
        deliver_error(context, code, kind, message)


def _stopped(code: ExitCode) -> ExitCode:
    """Say that the command was stopped from outside."""
    say(f"{code.meaning}; nothing more was written.")
    return code


def _failed(error: Exception | SystemExit) -> ExitCode:
    """Say in one paragraph what the system refused, or that shipid has a fault."""
    if isinstance(error, SystemExit):  # click raises it for a closed pipe
        return ExitCode.DONE
    code, message = _failure(error)
    if code == ExitCode.FAULT and os.environ.get("SHIPID_DEBUG"):
        raise error
    say(message)
    return code


def _failure(error: Exception) -> tuple[ExitCode, str]:
    """The exit code of an error that is none of shipid's own, and what is said of it."""
    if isinstance(error, OSError):
        return ExitCode.BAD_DATA, f"{error.filename or 'the output'}: {error.strerror or error}."
    if isinstance(error, MemoryError):
        advice = "Ask for fewer samples: a shorter time, or a longer interval."
        return ExitCode.BAD_DATA, f"there is not enough memory: {error}. {advice}"
    what = f"a fault in shipid itself, {type(error).__name__}: {error}"
    return ExitCode.FAULT, f"{what}. Set SHIPID_DEBUG=1 to see where, and report it."


def _refuse(error: click.ClickException) -> int:
    """Say in one paragraph what click refused; called with nothing, it hands over the help instead."""
    message = error.format_message()
    context: click.Context | None = getattr(error, "ctx", None)
    if context is None or message.startswith("Usage:"):
        click.echo(message, err=True)
    else:
        say(f"{message}{'' if message.endswith(('.', '?', '?)')) else '.'} See {context.command_path} --help.")
    return error.exit_code


def _warn(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Say shipid's own notices; the warnings of the libraries below are for developers."""
    if category.__module__.startswith("shipid.") or os.environ.get("SHIPID_DEBUG"):
        say(str(message))
