"""``shipid format``: the draft of a format file for a log."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import Delivery, json_option, output_or_stdout, overwrite_option
from shipid.cli.frame.messages import say
from shipid.foundation.exit_codes import ExitCode


@click.command("format")
@click.argument("log")
@click.option("-o", "--output", metavar="FILE", help="TOML file to write; stdout by default.")
@overwrite_option
@json_option
def format_log(log: str, output: str | None, overwrite: bool, as_json: bool) -> ExitCode:
    """Draft a format file for a log: its columns by the names in use, with a reason for each.

    LOG is any table that the other commands read; FILE#SHEET names a sheet, struct or group. What nothing says is left open, and
    the other commands refuse the format file until it is filled in.

    \b
    shipid format log.csv -o log.toml
    shipid check log.csv --format log.toml
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.foundation.replacing import write_text
    from shipid.trials.logs.drafting.draft import draft_format

    delivery = Delivery(as_json)
    path = output_or_stdout(output, overwrite)
    draft = draft_format(log)
    if path is not None:
        write_text(path, draft.text)
    if as_json or path is None:
        delivery.hand_over_parts(draft.to_dict(), draft.text.rstrip("\n"))
    if path is not None:
        units = f" Fill in the unit of {', '.join(draft.open)}." if draft.open else ""
        choice = (
            f" Decide what {', '.join(draft.undecided)} {'is' if len(draft.undecided) == 1 else 'are'}."
            if draft.undecided
            else ""
        )
        say(f"written: {path}.{units}{choice}")
    return ExitCode.DONE
