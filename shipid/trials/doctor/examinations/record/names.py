"""Columns under names that nothing else reads, and a record that says nothing of the motion of the ship."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.logs.drafting.names import WANTED, open_columns

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
