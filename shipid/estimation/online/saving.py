"""The state of an online estimator in a file: every number exactly, and only for the estimator it came from.

A file that was cut or edited is found by its checksum. What it holds is examined all the same, since a checksum can be made anew:
a state that is loaded has the right shapes, finite numbers and a covariance.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.errors import SavedStateError
from shipid.estimation.records.clock import CONFIRMED, LATEST, LONGEST_GAP
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion.gate import MEMORY
from shipid.foundation.aliases import Plain
from shipid.foundation.printable import printable
from shipid.foundation.replacing import write_text

_SCHEMA = 3
#: A state is some ten kilobytes; what is larger than this is not read.
_LARGEST_FILE = 16 << 20
#: No quantity of a ship in SI is larger.
_LARGEST = 1e30
#: The smallest eigenvalue of a correlation matrix may be so far below zero by rounding; in double and in single precision.
_ROUNDING, _ROUNDING_SINGLE = 1e-6, 1e-2
#: No sensor has been watched for longer, in s or in samples.
_LONGEST_AGE = 1e15
#: No coefficient is larger than e to this.
_LARGEST_LOG = 70.0


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
    content = {"schema": _SCHEMA, "model": model, "filter": fingerprint} | state
    write_text(path, json.dumps(content | {"checksum": checksum_of(content)}, indent=1))


def checksum_of(content: Mapping[str, Plain]) -> str:
    """Return the checksum of a state.

    Parameters
    ----------
    content : mapping of str to Plain
        What the file holds besides its checksum.
    """
    plain = {k: v for k, v in content.items() if k != "checksum"}
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


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
        If the file cannot be read, is damaged, or belongs to another estimator.
    """
    try:
        if path.exists() and not path.is_file():
            raise not_a_state(path, what)
        if path.stat().st_size > _LARGEST_FILE:
            raise not_a_state(path, what)
        state = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SavedStateError(f"the saved state {path} cannot be read: {error.strerror}. Check the path.") from None
    except (ValueError, RecursionError):
        raise not_a_state(path, what) from None
    if not isinstance(state, dict) or not {"schema", "filter", "carried"} <= state.keys():
        raise not_a_state(path, what)
    if state["schema"] != _SCHEMA:
        raise SavedStateError(f"{path} was saved by another version of shipid: start a new {what} with start().")
    if state.get("checksum") != checksum_of(state):
        raise damaged(path, what, "it does not match its checksum, so that it was cut or edited")
    if state["filter"] != fingerprint:
        raise SavedStateError(
            f"{path} was saved by another {what} (of model {printable(str(state.get('model')))[:60]}): model, ship, sensors, "
            "noise and options must be the same. Use the same settings, or start a new one."
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


def damaged(path: Path, what: str, why: str) -> SavedStateError:
    """Return the error for a state that cannot be right.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What it should be the state of.
    why : str
        What is wrong.
    """
    return SavedStateError(f"the saved state {path} is damaged: {why}. Use an older copy, or start a new {what}.")


@contextmanager
def examined(path: Path, what: str) -> Iterator[None]:
    """Turn whatever is wrong with the content of a state into one error.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What it should be the state of.

    Yields
    ------
    None

    Raises
    ------
    SavedStateError
        If an entry is missing, of another kind, or cannot be right.
    """
    try:
        yield
    except KeyError as error:
        raise damaged(path, what, f"it has no entry {error}") from None
    except (ValueError, TypeError, AttributeError, ArithmeticError) as error:
        raise damaged(path, what, printable(str(error))[:200]) from None


def numbers(state: Mapping[str, Plain], name: str, count: int) -> np.ndarray:
    """Return an entry of numbers, written as text that keeps every digit.

    Parameters
    ----------
    state : mapping of str to Plain
        The state.
    name : str
        The entry.
    count : int
        How many numbers it has.

    Returns
    -------
    ndarray, shape (count,)

    Raises
    ------
    ValueError
        If it has another length, or holds something else.
    """
    return _numbers(name, state[name], count, count)


def _numbers(name: str, entry: Plain, least: int, most: int) -> np.ndarray:
    if not isinstance(entry, list) or not least <= len(entry) <= most or not all(isinstance(v, str) for v in entry):
        raise ValueError(f"'{name}' is not a list of {most} numbers")
    return np.array([float.fromhex(v) for v in entry], dtype=float)


def check_finite(name: str, values: np.ndarray, low: float = -_LARGEST, high: float = _LARGEST) -> None:
    """Check that numbers are finite and within bounds.

    Parameters
    ----------
    name : str
        What they are, for the message.
    values : ndarray
        The numbers.
    low, high : float
        The bounds.

    Raises
    ------
    ValueError
        If one is not.
    """
    if not ((values >= low) & (values <= high)).all():
        raise ValueError(f"'{name}' holds a number that cannot be right")


def check_covariance(covariance: np.ndarray, single: bool = False) -> None:
    """Check that a symmetric matrix is a covariance: no variance below zero, no correlation beyond one, and not zero altogether.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Symmetric. A variance of zero belongs to what is known exactly.
    single : bool
        Whether it was computed in single precision.

    Raises
    ------
    ValueError
        If it is not.
    """
    check_finite("P", covariance)
    variance = covariance.diagonal()
    known = variance == 0
    if known.all() or (variance < 0).any() or covariance[known].any():
        raise ValueError("'P' is no covariance")
    deviation = np.sqrt(np.where(known, 1.0, variance))
    correlation = covariance / deviation / deviation[:, None]
    check_finite("P", correlation)
    if np.linalg.eigvalsh(correlation)[0] < -(_ROUNDING_SINGLE if single else _ROUNDING) * len(variance):
        raise ValueError("'P' is no covariance")


def check_count(name: str, value: Plain, least: int = 0) -> int:
    """Return a whole number.

    Parameters
    ----------
    name : str
        What it counts, for the message.
    value : Plain
        The number.
    least : int
        The smallest it may be.

    Raises
    ------
    ValueError
        If it is something else.
    """
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value < 2**53:
        raise ValueError(f"'{name}' is {value!r:.40}, and has to be a whole number")
    return value


def check_counts(name: str, value: Plain, names: Iterable[str], least: int = 0) -> dict[str, int]:
    """Return a whole number for each of some names.

    Parameters
    ----------
    name : str
        What they count, for the message.
    value : Plain
        A table of them.
    names : iterable of str
        The names.
    least : int
        The smallest they may be.

    Raises
    ------
    ValueError
        If it is something else.
    """
    if not isinstance(value, dict) or set(value) != set(names):
        raise ValueError(f"'{name}' does not name the sensors of this filter")
    return {n: check_count(name, v, least) for n, v in value.items()}


def names_among(name: str, value: Plain, known: Iterable[str]) -> set[str]:
    """Return a list of names as a set.

    Parameters
    ----------
    name : str
        What they name, for the message.
    value : Plain
        The list.
    known : iterable of str
        What may stand in it.

    Raises
    ------
    ValueError
        If it is something else.
    """
    if not isinstance(value, list) or not set(value) <= set(known):
        raise ValueError(f"'{name}' does not name sensors of this filter")
    return set(value)


def check_clock(state: Mapping[str, Plain], rates: Iterable[str]) -> None:
    """Check what a state says of time: when it began, the clock, and how often slow sensors were read.

    Parameters
    ----------
    state : mapping of str to Plain
        The state.
    rates : iterable of str
        The slow sensors.

    Raises
    ------
    ValueError
        If an entry cannot be right.
    """
    check_finite("began", _numbers("began", [state["began"]], 1, 1), -10 * LATEST, 10 * LATEST)
    clock = state["clock"]
    if not isinstance(clock, list) or len(clock) != 3:
        raise ValueError("'clock' is not the state of a clock")
    check_finite("clock", _numbers("clock", clock[0], 2, 2), -10 * LATEST, 10 * LATEST)
    intervals = _numbers("clock", clock[1], 0, 64)
    check_finite("clock", intervals, np.nextafter(0, 1), LONGEST_GAP)
    check_finite("clock", _numbers("clock", clock[2], 0, CONFIRMED - 1), -LATEST, LATEST)
    check_counts("counts", state["counts"], rates, least=-1)
    check_count("refused", state["refused"])


def check_late(state: Mapping[str, Plain], late: Iterable[str]) -> None:
    """Check what a state says of inputs that act later than they are given: their last values, with their times.

    Parameters
    ----------
    state : mapping of str to Plain
        The state.
    late : iterable of str
        The inputs.

    Raises
    ------
    ValueError
        If an entry cannot be right.
    """
    for name in late:
        times, values = (_numbers("late", row, 1, _LARGEST_FILE) for row in state["late"][name])
        check_finite("late", times, -10 * LATEST, 10 * LATEST)
        check_finite("late", values)
        if times.size != values.size or (np.diff(times) < 0).any():
            raise ValueError(f"'late' holds no record of '{name}'")


def check_carried(design: FilterDesign, carried: np.ndarray) -> None:
    """Check what is carried from sample to sample.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    carried : ndarray, shape (carried,)
        What was read.

    Raises
    ------
    ValueError
        Which part cannot be right.
    """
    layout, parts = design.layout, {n: carried[place] for n, place in design.layout.carried.items()}
    for name in ("x", "w", "u", "P"):
        check_finite(name, parts[name])
    low, high = design.step_settings.low, design.step_settings.high
    margin = 1e-6 * (1 + np.abs(parts["x"]))  # single precision rounds a bound
    check_finite("x", parts["x"] - np.clip(parts["x"], low - margin, high + margin), 0.0, 0.0)
    logarithms = [design.model.states.index(s) for n, s in design.parameters.items() if s != n]
    check_finite("x", parts["x"][logarithms], -_LARGEST_LOG, _LARGEST_LOG)
    for name in MEMORY:
        # Without a last value, and without two that differ, the gate remembers an infinite one.
        values = parts[name][~np.isposinf(parts[name])] if name in ("last", "grain") else parts[name]
        check_finite(name, values, -np.inf if name == "last" else 0.0, _LONGEST_AGE)
    if design.form == "square-root":
        root = parts["P"].reshape(layout.joint, layout.joint, order="F")
        check_covariance(root @ root.T, design.single)
    else:
        check_covariance(unpacked(parts["P"][None, :], layout.joint)[0], design.single)
