"""Errors of the toolbox: one class for each cause; a message says what is wrong, where, and what to do."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.printable import printable


class ShipidError(Exception):
    """Base of every error a user can cause; the command line prints it and exits with ``exit_code``."""

    exit_code = ExitCode.BAD_DATA

    def __str__(self) -> str:
        """Return the message; what it quotes from a file cannot steer a terminal."""
        return printable(super().__str__())


class UsageError(ShipidError):
    """A name, an option or an argument that does not exist or does not fit."""

    exit_code = ExitCode.USAGE


class UnitError(ShipidError):
    """A value or an equation whose unit does not fit."""


class TypedUnitError(UnitError, UsageError):
    """A value among the arguments of a command whose unit is missing or does not fit."""

    exit_code = ExitCode.USAGE


class DeclarationError(ShipidError):
    """A component or a model that is not well formed."""


class UnknownNameError(UsageError):
    """A misspelt name; the message offers the nearest ones."""

    def __init__(self, kind: str, name: str, known: Iterable[str], hint: str = "") -> None:
        self.kind, self.name, self.known = kind, name, sorted(known)
        super().__init__(f"there is no {kind} '{name}'. {nearest(name, self.known)}{hint}".strip())


class MissingFileError(ShipidError):
    """A file or a folder that is not there."""


class MissingExtraError(ShipidError):
    """A task that needs an optional package, which is not installed.

    Parameters
    ----------
    task : str
        What needs it, as the subject of a sentence: ``"the posterior"``.
    package : str
        The package.
    extra : str
        The extra of shipid that installs it.
    otherwise : str
        What can be done without it; a sentence, or nothing.
    """

    def __init__(self, task: str, package: str, extra: str, otherwise: str = "") -> None:
        super().__init__(
            f"{task} needs {package}, which is not installed. Install it with: pip install 'shipid[{extra}]'. {otherwise}".strip()
        )


class OverwriteError(ShipidError):
    """A file to be written that exists already."""


class ParameterSetError(ShipidError):
    """A parameter set that cannot be read, or lacks what a model needs."""


def nearest(name: str, known: Iterable[str], count: int = 4) -> str:
    """Return a sentence that says which known names are closest to a misspelt one; it ends in a full stop and a space.

    Parameters
    ----------
    name : str
        The misspelt name.
    known : iterable of str
        The names there are.
    count : int
        How many to offer at most.
    """
    known = sorted(set(known))  # several models may have one name
    lowered = {k.lower(): k for k in known}
    hits = [lowered[h] for h in difflib.get_close_matches(name.lower(), lowered, n=count, cutoff=0.5)]
    if hits:
        return f"Did you mean {' or '.join(hits)}? "
    if not known:
        return "None is known. "
    shown = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    return f"Known: {shown}. "
