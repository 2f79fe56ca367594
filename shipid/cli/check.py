"""``shipid check``: the trial doctor."""

from __future__ import annotations

from typing import Any

import click

from shipid.cli.shared import format_option, json_option, print_json, say


@click.command()
@click.argument("trials", nargs=-1, required=True, metavar="TRIAL...")
@format_option
@click.option("--ship", metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML), for its length.")
@click.option("--fix", is_flag=True, help="Apply the proposed repairs and write a trial.")
@click.option("-o", "--output", metavar="FILE", help="File for --fix; it must not exist.")
@json_option
def check(
    trials: tuple[str, ...], format_: str | None, ship: str | None, fix: bool, output: str | None, as_json: bool
) -> int:
    """Find what is wrong with a trial, what it does to an identification, and what repairs it.

    Exit code 3 where something would spoil an identification, 0 where nothing would.
    """
    from shipid.foundation.errors import MissingExtraError, MissingFileError, UsageError
    from shipid.parameters.catalogue import find_ship
    from shipid.trials.doctor.check_trial import check_trial
    from shipid.trials.doctor.repair import fix_trial
    from shipid.trials.errors import TrialError

    if fix != (output is not None):
        raise UsageError("--fix and -o FILE go together: the repairs are written to a file of their own.")
    if fix and len(trials) > 1:
        raise UsageError(f"--fix repairs one trial at a time, and {len(trials)} are named.")
    known = find_ship(ship) if ship else None
    answers: list[dict[str, Any]] = []
    code = 0
    for name in trials:
        try:
            found = check_trial(name, known, format_)
        except (TrialError, MissingFileError, MissingExtraError) as error:
            if len(trials) == 1:
                raise
            say(str(error))
            answers.append({"trial": name, "error": str(error), "findings": [], "manoeuvres": []})
            code = 3
            continue
        answers.append(found.to_dict())
        code = max(code, 3 if found.serious else 0)
        if not as_json:
            click.echo(repr(found))
    if fix and output is not None:
        written, repaired = fix_trial(trials[0], output, known, format_)
        answers[0]["fixed"] = {"path": str(written), "repaired": [f.kind for f in repaired]}
        if not as_json:
            click.echo(f"written: {written}, {len(repaired)} repairs")
        code = 0
    if as_json:
        print_json(answers[0] if len(answers) == 1 else {"trials": answers})
    return code
