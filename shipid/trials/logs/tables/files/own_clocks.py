"""Signals that each have a clock of their own, as MATLAB's timeseries and Simulink's logs hold them: one table of them all.

A signal stands in the rows of its own clock and is empty in the others: nothing is interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.trials.logs.tables.files.arrays import Array, Node

_CLOCKS = ("time", "t", "times", "timestamp", "timestamps", "tvec", "tout")
_VALUES = ("data", "values", "value", "signal", "y", "val")
_DEEPEST = 12
_MOST = 8
"""Columns of one signal at most: a position has three, a quaternion four."""
_ALIKE = 1e-9
"""Stamps nearer to each other than this are one [units of the clock]: those of several signals are computed apart."""


@dataclass(frozen=True, eq=False)
class _Signal:
    name: str
    t: np.ndarray
    values: np.ndarray
    unit: str | None
    clock_unit: str | None


def on_one_clock(group: Mapping[str, Node], depth: int = 0) -> dict[str, Node]:
    """Return a group with the signals in it that have clocks of their own as columns of equal length.

    Parameters
    ----------
    group : Mapping of str to node
        A struct or group, or all variables of a file.
    depth : int
        How deep it lies.

    Returns
    -------
    dict of str to node
        Unchanged where fewer than two of its members are such signals.
    """
    found = {name: signals for name, node in group.items() if (signals := _signals(name, node))}
    together = [signal for signals in found.values() for signal in signals]
    if len(together) > 1 and _belong(together):
        rest = {name: node for name, node in group.items() if name not in found and not isinstance(node, Array)}
        return {**_joined(together), **rest}
    if depth >= _DEEPEST:
        return dict(group)
    return {name: on_one_clock(node, depth + 1) if isinstance(node, Mapping) else node for name, node in group.items()}


def _signals(name: str, node: Node) -> list[_Signal]:
    """The signals of a struct: its clock and one array beside it, or those that Simulink hangs under 'signals'."""
    if not isinstance(node, Mapping):
        return []
    named = {inner.lower(): (inner, leaf) for inner, leaf in node.items()}
    clocks = [_column(leaf) for inner, (_, leaf) in named.items() if inner in _CLOCKS]
    if len(clocks) != 1 or clocks[0] is None:
        return []
    t = clocks[0]
    inside = named.get("signals", ("", None))[1]
    if isinstance(inside, Mapping):
        several = [inside] if "values" in inside else [one for one in inside.values() if isinstance(one, Mapping)]
        read = [_named(name, one, t, len(several)) for one in several]
        return [signal for signal in read if signal is not None]
    arrays = {inner: leaf for inner, (_, leaf) in named.items() if inner not in _CLOCKS and _rows(leaf, len(t))}
    if len(arrays) != 1:
        return []
    inner, values = next(iter(arrays.items()))
    shown = name if inner in _VALUES else named[inner][0]
    unit = _text(node, "units", "unit") or _text(_inside(node, "datainfo"), "units")
    return [_Signal(shown, t, _rows_of(values, len(t)), unit, _text(_inside(node, "timeinfo"), "units"))]


def _named(name: str, one: Mapping[str, Node], t: np.ndarray, several: int) -> _Signal | None:
    """A signal of Simulink, by its label; its clock counts seconds."""
    values = one.get("values")
    if not _rows(values, len(t)):
        return None
    label = _text(one, "label") or (name if several == 1 else "")
    return _Signal(label, t, _rows_of(values, len(t)), None, "s")


def _belong(signals: list[_Signal]) -> bool:
    """Whether signals are of one record: no two of one name, as of two runs, and all at one time."""
    names = [signal.name for signal in signals]
    first, last = max(signal.t[0] for signal in signals), min(signal.t[-1] for signal in signals)
    return len(set(names)) == len(names) and bool(first < last)


def _joined(signals: list[_Signal]) -> dict[str, Node]:
    """All signals over the stamps of all their clocks."""
    stamps = np.concatenate([signal.t for signal in signals])
    order = np.argsort(stamps, kind="stable")
    # Each stamp has the row of the first that is as large.
    new = np.diff(stamps[order], prepend=-np.inf) > _ALIKE
    row = np.empty(len(stamps), dtype=np.int64)
    row[order] = np.cumsum(new) - 1
    t = stamps[order][new]
    units = {signal.clock_unit for signal in signals}
    columns: dict[str, Node] = {"t": Array(t, units.pop() if len(units) == 1 else None)}
    ends = np.cumsum([len(signal.t) for signal in signals])
    for signal, end in zip(signals, ends):
        width = signal.values.shape[1]
        for k in range(width):
            values = np.full(len(t), np.nan)
            values[row[end - len(signal.t) : end]] = signal.values[:, k]
            header = signal.name if width == 1 else f"{signal.name}_{k + 1}"
            while header in columns:
                header += "_"
            columns[header] = Array(values, signal.unit)
    return columns


def _inside(node: Mapping[str, Node], key: str) -> Mapping[str, Node]:
    found = next((leaf for inner, leaf in node.items() if inner.lower() == key), None)
    return found if isinstance(found, Mapping) else {}


def _text(node: Mapping[str, Node], *keys: str) -> str | None:
    """The text under one of some keys; None for none, or an empty one."""
    for inner, leaf in node.items():
        if (
            inner.lower() in keys
            and isinstance(leaf, Array)
            and leaf.values.dtype.kind in "SU"
            and leaf.values.size == 1
        ):
            cell = leaf.values.reshape(-1)[0]
            text = cell.decode("utf-8", "replace") if isinstance(cell, bytes) else str(cell)
            return "s" if text.lower() == "seconds" else text.strip() or None
    return None


def _column(node: Node | None) -> np.ndarray | None:
    """A clock: numbers that never fall, more than one."""
    if not isinstance(node, Array) or node.values.dtype.kind not in "fiu" or node.values.size < 2:
        return None
    if node.values.size != max(node.values.shape):
        return None
    t = node.values.reshape(-1).astype(float)
    return t if np.isfinite(t).all() and bool((np.diff(t) >= 0).all()) else None


def _rows(node: Node | None, length: int) -> bool:
    if not isinstance(node, Array) or node.values.dtype.kind not in "fiub":
        return False
    return node.values.size % length == 0 and length in node.values.shape and 1 <= node.values.size // length <= _MOST


def _rows_of(node: Node | None, length: int) -> np.ndarray:
    """Values as one row a stamp, whichever way round they lie."""
    assert isinstance(node, Array)
    values = np.moveaxis(node.values, node.values.shape.index(length), 0)
    return np.asarray(values.reshape(length, -1), dtype=float)
