"""Reading what is typed: lists of names, assignments, windows, folders of trials."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from shipid.cli.frame.messages import say

#: A part of a trial: first and last second; None for the record's own end.
Window: TypeAlias = "tuple[float | None, float | None]"


def names_of(text: str) -> list[str]:
    """Return the names of a list separated by commas.

    Parameters
    ----------
    text : str
        As in ``K,tau``.

    Raises
    ------
    UsageError
        If there is nothing between two commas.
    """
    from shipid.foundation.errors import UsageError

    names = [n.strip() for n in text.split(",")]
    if not all(names):
        raise UsageError(f"'{text}' is not a list of names separated by commas, as in K,tau.")
    return names


def assignments(texts: Sequence[str]) -> dict[str, str]:
    """Return values of the form NAME=VALUE UNIT by name.

    Parameters
    ----------
    texts : sequence of str
        As in ``["n3=0.4 s^2/deg^2"]``.

    Raises
    ------
    UsageError
        If one has another form, or a name stands twice.
    """
    from shipid.declaration.units import Typed
    from shipid.foundation.errors import UsageError

    result: dict[str, str] = {}
    for text in texts:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not name or not value:
            raise UsageError(f"'{text}' does not say NAME=VALUE with a unit, as in n3='0.4 s^2/deg^2'.")
        if name in result:
            raise UsageError(f"'{name}' is given twice, {result[name]} and {value}; choose one.")
        result[name] = Typed(value)
    return result


def levels_of(text: str) -> dict[str, str]:
    """Return a list of assignments separated by commas, by name.

    Parameters
    ----------
    text : str
        As in ``psi=0.2 deg,r=0.02 deg/s``.
    """
    return assignments(text.split(","))


def window_of(text: str) -> Window:
    """Return a window A:B in seconds; an end left out is the record's own.

    Parameters
    ----------
    text : str
        As in ``1622:1712``.

    Raises
    ------
    UsageError
        If it has another form.
    """
    from shipid.foundation.errors import UsageError

    try:
        first, second = (float(part) if part.strip() else None for part in text.split(":"))
        return first, second
    except ValueError:
        raise UsageError(f"the window '{text}' is not A:B in seconds of the trial's clock, as in 1622:1712.") from None


def trials_in(name: str) -> list[str]:
    """Return a trial as it is named, and of a folder the logs in it; what lies there and is not read is told.

    Parameters
    ----------
    name : str
        The path of a log or of a folder.

    Raises
    ------
    MissingFileError
        If no file of a folder can be a log.
    """
    if not Path(name).is_dir():
        return [name]
    from shipid.campaign.fleet import not_read, trial_files
    from shipid.foundation.errors import MissingFileError

    inside, left = trial_files(Path(name)), not_read(Path(name))
    for note in left:
        say(f"{name}: {note}")
    if not inside:
        raise MissingFileError(f"there are no trials in '{name}'. Give the folder that holds their files.")
    return [str(Path(name, file)) for file in inside]
