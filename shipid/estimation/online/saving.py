"""The state of an online estimator in a file: every number exactly, and only for the estimator it came from."""

from __future__ import annotations

import json
from pathlib import Path

from shipid.estimation.errors import SavedStateError
from shipid.foundation.aliases import Plain
from shipid.foundation.replacing import write_text

_SCHEMA = 2


def write_state(path: Path, fingerprint: str, model: str, state: dict[str, Plain]) -> None:
    """Write a state, whole or not at all.

    Parameters
    ----------
    path : Path
        A JSON file; one that exists is replaced.
    fingerprint : str
        A hash of everything that makes two estimators the same.
    model : str
        Name of the model.
    state : dict
        Plain values.
    """
    head = {"schema": _SCHEMA, "model": model, "filter": fingerprint}
    write_text(path, json.dumps(head | state, indent=1))


def read_state(path: Path, fingerprint: str, what: str) -> dict[str, Plain]:
    """Return a state as it was written.

    Parameters
    ----------
    path : Path
        The file.
    fingerprint : str
        That of the estimator that is to go on from it.
    what : str
        What that is, for messages.

    Returns
    -------
    dict

    Raises
    ------
    SavedStateError
        If the file cannot be read, or belongs to another estimator.
    """
    try:
        state = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SavedStateError(f"the saved state {path} cannot be read: {error.strerror}.") from None
    except ValueError:
        raise not_a_state(path, what) from None
    if not isinstance(state, dict) or not {"schema", "filter", "carried"} <= state.keys():
        raise not_a_state(path, what)
    if state["schema"] != _SCHEMA or state.get("filter") != fingerprint:
        raise SavedStateError(
            f"{path} was saved by another {what} (of model {state.get('model')}): model, ship, sensors, noise and options must "
            "be the same. Use the same settings, or start a new one."
        )
    return state


def not_a_state(path: Path, what: str) -> SavedStateError:
    """Return the error for a file that holds something else.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What it should be the state of.
    """
    return SavedStateError(f"{path} is not the saved state of a {what}: start a new one with start().")
