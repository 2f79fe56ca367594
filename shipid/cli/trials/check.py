"""``shipid check``: the trial doctor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.messages import say
from shipid.cli.frame.options import format_option, optional_ship_given, set_option, ship_option, trials_argument
from shipid.foundation.aliases import Plain
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.notices import Notice

if TYPE_CHECKING:
    from shipid.trials.doctor.findings import Diagnosis


@click.command()
@trials_argument
@format_option
@ship_option()
@set_option
@click.option("--fix", is_flag=True, help="Apply the proposed repairs and write a trial.")
@click.option("-o", "--output", metavar="FILE", help="File for --fix; it must not exist.")
@delivered(RESULT, REPORT)
def check(
    trials: tuple[str, ...],
    format_: str | None,
    ship: str | None,
    values: dict[str, str],
    fix: bool,
    output: str | None,
    delivery: Delivery,
) -> int:
    """Find what is wrong with a trial, what it does to an identification, and what repairs it.

    The length of the ship tells how quickly it can turn. Exit code 3 where something would spoil an identification, 0 where
    nothing would.

    \b
    shipid check trial.csv
    shipid check trial.csv --ship zeefakkel --fix -o repaired.csv
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.foundation.errors import MissingExtraError, MissingFileError, UsageError
    from shipid.foundation.numbers import counted
    from shipid.trials.doctor.check_trial import check_trial
    from shipid.trials.doctor.findings import not_read
    from shipid.trials.doctor.repair import fix_trial
    from shipid.trials.errors import TrialError

    if fix != (output is not None):
        raise UsageError("--fix and -o FILE go together: the repairs are written to a file of their own.")
    if fix and len(trials) > 1:
        raise UsageError(f"--fix repairs one trial at a time, and {len(trials)} are named.")
    known = optional_ship_given(ship, values)
    answers: list[dict[str, Plain]] = []
    texts: list[str] = []
    checked: list[Diagnosis] = []
    warnings: list[dict[str, Plain]] = []
    code = ExitCode.DONE
    for name in trials:
        try:
            found = check_trial(name, known, format_)
        except (TrialError, MissingFileError, MissingExtraError) as error:
            if len(trials) == 1:
                raise
            say(str(error))
            answers.append({"trial": name, "error": str(error), "findings": [], "manoeuvres": []})
            warnings.append(Notice(str(error), "not-read", serious=True, trial=name).to_dict())
            code = ExitCode.BAD_DATA
            checked.append(not_read(name, str(error)))
            texts.append(f"Check of '{name}': not read")
            continue
        checked.append(found)
        answers.append(found.to_dict())
        warnings += [f.to_dict() | {"trial": found.trial} for f in found.findings]
        texts.append(found.text())
        code = ExitCode.BAD_DATA if found.serious else code
    if output is not None:
        try:
            written, repaired = fix_trial(trials[0], output, known, format_)
        except OSError:
            delivery.hand_over_parts(
                answers[0] | {"warnings": warnings}, texts[0], {REPORT: delivery.report(tuple(checked))}
            )
            raise
        answers[0]["fixed"] = {"path": str(written), "repaired": [f.kind for f in repaired]}
        texts.append(f"written: {written}, {counted(len(repaired), 'repair')}")
        code = ExitCode.DONE
    answer = answers[0] if len(answers) == 1 else {"trials": answers}
    delivery.hand_over_parts(
        answer | {"warnings": warnings}, "\n".join(texts), {REPORT: delivery.report(tuple(checked))}
    )
    return code
