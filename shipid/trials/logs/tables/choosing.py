"""One table out of a file that holds several: the one that is named, or the only one that looks like a trial."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import nearest
from shipid.trials.columns import split_header
from shipid.trials.errors import ChoiceError
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.tables.table import RawTable


@dataclass(frozen=True)
class Candidate:
    """A table among several in a file.

    Attributes
    ----------
    name : str
        Of the sheet, struct or group.
    headers : tuple of str
        Of its columns; none where nothing names them.
    read : callable
        Reads it, given the notes to add.
    hidden : bool
        Whether it is not shown: it counts only where it is named, or there is no other.
    """

    name: str
    headers: tuple[str, ...]
    read: Callable[[tuple[str, ...]], RawTable]
    hidden: bool = False


def chosen(
    candidates: Sequence[Candidate], wanted: str | None, columns: Collection[str], kind: str, where: str
) -> RawTable:
    """Choose a table and read it.

    Parameters
    ----------
    candidates : sequence of Candidate
        The tables of the file; at least one.
    wanted : str or None
        The name of the one that is wanted.
    columns : collection of str
        Headers that a format file names.
    kind : str
        What a table is called: sheet, struct or group.
    where : str
        The file, for messages.

    Returns
    -------
    RawTable

    Raises
    ------
    ChoiceError
        If there is none of that name, or none is named and several look like a trial.
    """
    names = [candidate.name for candidate in candidates]
    if wanted is not None:
        same = [c for c in candidates if c.name == wanted] or [
            c for c in candidates if c.name.strip().lower() == wanted.strip().lower()
        ]
        if len(same) != 1:
            raise ChoiceError(f"{where} has no {kind} '{wanted}' with a table. {nearest(wanted, names)}".rstrip())
        return same[0].read(())
    shown = [c for c in candidates if not c.hidden] or candidates
    unseen = [c.name for c in candidates if c not in shown]
    passed = (f"Hidden and passed over: {kind} {_listed(unseen)}.",) if unseen else ()
    candidates, names = shown, [c.name for c in shown]
    if len(candidates) == 1:
        return candidates[0].read(passed)
    ranks = [_likeness(candidate, columns) for candidate in candidates]
    best = [c for c, rank in zip(candidates, ranks) if rank == max(ranks)]
    if len(best) == 1 and max(ranks) > 0:
        others = [name for name in names if name != best[0].name]
        return best[0].read(
            (
                f"Of the {len(names)} tables in the file, {kind} '{best[0].name}' was read: {_listed(others)} look less like a trial.",
                *passed,
            )
        )
    raise ChoiceError(
        f"{where} has {len(names)} tables: {_listed(names)}. Name the {kind} behind the file, as in "
        f"{where.strip(chr(39))}#{best[0].name}, or as {kind} in [table] of a format file."
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name[:60]}'" for name in names[:20]) + (", ..." if len(names) > 20 else "")


def _likeness(candidate: Candidate, columns: Collection[str]) -> int:
    """How much a table looks like a trial: it has what the format file names, a clock, fields of the vocabulary."""
    names = {split_header(header)[0] for header in candidate.headers}
    if columns and set(columns) <= names | set(candidate.headers):
        return 3
    clock = any(short(header) in NAMES for header in candidate.headers)
    return 2 if clock and names & (set(FIELDS) - {"t"}) else int(clock and len(names) > 2)
