"""The exit codes of the commands; errors and commands refer to this table."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """The exit code of a command, with its meaning."""

    meaning: str

    def __new__(cls, value: int, meaning: str) -> ExitCode:
        """Make a code of its number and its meaning."""
        code = int.__new__(cls, value)
        code._value_ = value
        code.meaning = meaning
        return code

    DONE = 0, "done"
    USAGE = 2, "usage"
    BAD_DATA = 3, "bad data"
    NO_CONVERGENCE = 4, "no convergence"
    FAULT = 70, "a fault of shipid itself"
    INTERRUPTED = 130, "interrupted"


def table() -> str:
    """Return all codes in one line: ``"0 done, 2 usage, ..."``."""
    return ", ".join(f"{code.value} {code.meaning}" for code in ExitCode)
