"""Columns under names that nothing else reads, and a record that says nothing of the motion of the ship."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.declaration.vocabulary import FIELDS
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.logs.drafting.names import WANTED, meaning_of, open_columns

#: Fields of which one has to be there: without them the record says nothing of how the ship moves.
_MOTION = ("psi", "r", "x", "y", "u", "v", "U", "SOG", "COG")
_REPAIR = "Rename the columns, or let shipid format FILE draft a format file."


def examine_names(p: WorkingCopy, guesses: Mapping[str, str]) -> None:
    """Find columns whose names are not those of a trial.

    The doctor examines a column under the field that its header usually means. The other commands read a column by the
    name of its field only.

    Parameters
    ----------
    p : WorkingCopy
        The record as logged.
    guesses : Mapping of str to str
        Headers by the field that the doctor took them for.
    """
    if guesses:
        told = ", ".join(f"{name} is '{header}'" for name, header in guesses.items())
        p.add(
            "name", ",".join(guesses), 0.95, f"columns are named otherwise than a trial names them: {told}",
            "The other commands do not read these columns.", _REPAIR,
            fix={"action": "rename", "columns": ",".join(guesses)}, spoils=any(name in WANTED for name in guesses),
        )  # fmt: skip
    for header, fields in open_columns(p.values, p.values).items():
        p.add(
            "name", header, 0.9, f"'{header}' can be {' or '.join(fields)}, and the log has neither",
            "The column is not read, and was not examined.", _REPAIR, spoils="psi" in fields,
        )  # fmt: skip
    if not any(name in p.values for name in _MOTION):
        p.add(
            "no-motion", "t", 0.95, f"none of {', '.join(_MOTION)} is in the log",
            "Nothing says how the ship moved.", _REPAIR,
        )  # fmt: skip


def examine_unread(p: WorkingCopy, unread: Mapping[str, str | None]) -> None:
    """Find columns of no field of the vocabulary for which the other commands refuse the log.

    Parameters
    ----------
    p : WorkingCopy
        The record as logged.
    unread : Mapping of str to str or None
        The unit that each of them says; None where it says none.
    """
    for name, unit in unread.items():
        # What can be the heading or the speed is not left out unasked.
        needed = any(field in FIELDS for field in meaning_of(name).fields)
        told = f"says the unit '{unit}', which is none" if unit else "says no unit"
        p.add(
            "unit", name, 0.95, f"the column is none that shipid knows by name, and {told}; it was not examined",
            "read_trial does not guess a unit and refuses the record.",
            f"Leave the column out; where it is needed, write '{name} [1]' for a pure number, or its unit.",
            fix=None if needed else {"action": "drop-column", "column": name},
        )  # fmt: skip
