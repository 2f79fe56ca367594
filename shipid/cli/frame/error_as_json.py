"""An error in the form of a result, where a command is asked for JSON."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import ASKED, PRINTED, Delivery
from shipid.cli.frame.envelope import json_text
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.notices import Notice


def deliver_error(context: click.Context, code: ExitCode, kind: str, message: str) -> None:
    """Print an error as JSON where that is asked for: a program that reads a command finds what went wrong where it looks.

    Parameters
    ----------
    context : click.Context
        Of any command.
    code : ExitCode
        What the command ends with.
    kind : str
        What went wrong, in lower case with hyphens.
    message : str
        The same in words, as on standard error.
    """
    asked: click.Context | None = context.meta.get(ASKED)
    if asked is None or context.meta.get(PRINTED):
        return
    with asked.scope(cleanup=False):
        told = Notice(message, kind, serious=True)
        data = {"warnings": [told.to_dict()], "error": {"kind": kind, "exit_code": int(code), "message": message}}
        lines = asked.params.get("follow") is not None
        click.echo(json_text(Delivery(as_json=True).enveloped(data), indent=None if lines else 1))
