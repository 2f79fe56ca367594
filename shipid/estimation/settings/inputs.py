"""The inputs of a model along a record, and between their samples."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.estimation.settings.instruments import Instruments
from shipid.generation.simulator import input_rows
from shipid.trials.errors import NoStretchError
from shipid.trials.filling import GAP, usual_interval
from shipid.trials.speed import check_ahead, check_way, speed_before_in
from shipid.trials.stretches import fill_input, is_order


def input_table(instruments: Instruments, columns: Mapping[str, np.ndarray], record: str) -> np.ndarray:
    """Return the inputs of a model along a record, SI, shape (N, inputs); NaN where one is missing.

    Parameters
    ----------
    instruments : Instruments
        Constant inputs, and those that are needed.
    columns : mapping of str to ndarray, shape (N,)
        The record, SI.
    record : str
        Its name, for messages.

    Raises
    ------
    UnstatedInputError
        If the record lacks an input that is needed and declares no default.
    NotAheadError
        If the ship does not go ahead, and the model reads the speed before the manoeuvre.
    """
    given: dict[str, float | np.ndarray] = {}
    speed = instruments.scale.speed
    if speed is not None:
        given |= {"cruise": speed, "u": speed}
    before = speed_before_in(columns, instruments.scale.unit_time)
    if before is not None:
        given["cruise"] = before.value
    # A column without a number counts as absent, unless the user gave the standard deviation of the missing input.
    given |= {n: c for n, c in columns.items() if n in instruments.lost or np.isfinite(c).any()}
    given |= instruments.inputs
    if "cruise" in instruments.needed and isinstance(given.get("cruise"), float):
        check_ahead(float(given["cruise"]), record, instruments.model.name)
    if instruments.model.guards:
        check_way(columns, record, instruments.model.name)
    table = input_rows(instruments.model, given, columns["t"].size, f"trial {record}", instruments.needed).T
    if instruments.biases:
        table = table + np.array([instruments.biases.get(n, 0.0) for n in instruments.model.inputs])
    return table


def hold_last(table: np.ndarray) -> np.ndarray:
    """Return a table in which the last value stands in where one is missing.

    Parameters
    ----------
    table : ndarray, shape (N, columns)
        NaN where a value is missing.

    Returns
    -------
    ndarray, shape (N, columns)
        Before the first value of a column that value; zero where it has none.
    """
    finite = np.isfinite(table)
    if finite.all():
        return table
    index = np.where(finite, np.arange(len(table))[:, None], -1)
    index = np.maximum.accumulate(index, axis=0)
    first = np.argmax(finite, axis=0)
    index = np.where(index < 0, first[None, :], index)
    held = np.take_along_axis(table, index, axis=0)
    return np.where(np.isfinite(held), held, 0.0)


def ruled(instruments: Instruments) -> np.ndarray:
    """Return which inputs have to be known, bool, shape (inputs,): those with an influence, unless the uncertainty of a missing one was given.

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs of a filter.
    """
    names = instruments.model.inputs
    return np.array([n in instruments.needed and n not in instruments.lost for n in names], dtype=bool)


def names_of(instruments: Instruments, missing: np.ndarray) -> tuple[str, ...]:
    """Return the names of inputs that are missing and have to be known.

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs of a filter.
    missing : ndarray of bool, shape (inputs,)
        Which are missing.
    """
    return tuple(n for n, gone, rule in zip(instruments.model.inputs, missing, ruled(instruments)) if gone and rule)


def filled_inputs(instruments: Instruments, t: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Return the inputs between their samples, as far as the rule of `shipid.trials.stretches` reaches, shape (N, inputs).

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs of a filter.
    t : ndarray, shape (N,)
        Times in s.
    table : ndarray, shape (N, inputs)
        The inputs, NaN where one is missing. Before its first sample, and behind its last, that one stands for as long as a hole
        would be filled.
    """
    whole = table.copy()
    for k, (name, rule) in enumerate(zip(instruments.model.inputs, ruled(instruments))):
        own = np.flatnonzero(np.isfinite(table[:, k]))
        if not rule or own.size == t.size or not own.size:
            continue
        whole[:, k] = fill_input(t, table[:, k], is_order(name)).values
        reach = GAP * usual_interval(t[own]) if own.size > 1 else 0.0
        early, late = (t < t[own[0]]) & (t >= t[own[0]] - reach), (t > t[own[-1]]) & (t <= t[own[-1]] + reach)
        whole[early, k], whole[late, k] = table[own[0], k], table[own[-1], k]
    return whole


def never_known(instruments: Instruments, table: np.ndarray, record: str) -> NoStretchError:
    """Return the error for a record in which at no time every input is known.

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs of a filter.
    table : ndarray, shape (N, inputs)
        The inputs, NaN where one is missing.
    record : str
        Its name.
    """
    counts = np.isfinite(table).sum(axis=0)
    rows = zip(instruments.model.inputs, counts, ruled(instruments))
    held = ", ".join(f"{n} {c} of {len(table)}" for n, c, rule in rows if rule)
    return NoStretchError(
        f"trial {record}: at no time is everything known that drives model {instruments.model.name}. Samples there: {held}. "
        "Record it, state it as a constant input, or choose a model that does not read it."
    )
