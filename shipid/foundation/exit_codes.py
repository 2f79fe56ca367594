"""The exit codes of the commands; errors and commands refer to this table."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """The exit code of a command, with its meaning in a few words and in a sentence."""

    meaning: str
    when: str

    def __new__(cls, value: int, meaning: str, when: str) -> ExitCode:
        """Make a code of its number, its meaning, and when a command ends with it."""
        code = int.__new__(cls, value)
        code._value_ = value
        code.meaning, code.when = meaning, when
        return code

    DONE = 0, "done", "the command did what it was asked for"
    USAGE = 2, "usage", "an option, an argument or a name that does not exist or does not fit; nothing was computed"
    BAD_DATA = (
        3,
        "bad data",
        "a file that cannot be read, used or written; a result that could not be written is printed",
    )
    NO_CONVERGENCE = 4, "no convergence", "the search did not converge; what it knows is printed and written"
    DOUBTFUL = 5, "doubtful", "a serious warning stands beside the result: do not use its numbers as they are"
    FAULT = 70, "a fault of shipid itself", "please report it; with `SHIPID_DEBUG=1` it shows where"
    INTERRUPTED = 130, "interrupted", "Ctrl-C (SIGINT); every file is as it was before or whole"
    TERMINATED = 143, "terminated", "asked to end (SIGTERM); every file is as it was before or whole"


def table() -> str:
    """Return all codes in one line: ``"0 done, 2 usage, ..."``."""
    return ", ".join(f"{code.value} {code.meaning}" for code in ExitCode)


def markdown() -> str:
    """Return the table as the README prints it."""
    rows = [f"| {code.value} | {code.meaning} | {code.when} |" for code in ExitCode]
    return "\n".join(["| exit code | meaning | when |", "|---|---|---|", *rows])
