"""A record with holes in its inputs: the loop of a filter over one stretch after the other.

What a missing input drives starts anew behind a hole, from the first samples there, as at the beginning of a record. Parameters,
and states that the input does not move (a current), go on with the estimate and the covariance they had.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import Arrangement, Hole
from shipid.estimation.records.first_estimate import carried_vector
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.settings.first_look import LOOK, first_value
from shipid.generation.loop import Loop

#: From the carried vector at the end of a stretch, and the hole behind it, to the one before the next.
Restart = Callable[[np.ndarray, Hole], np.ndarray]


def run_stretches(
    loop: Loop, start: np.ndarray, control: np.ndarray, constants: np.ndarray, arranged: Arrangement, restart: Restart
) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, ...]]:
    """Run a loop over a record, anew behind each hole.

    Parameters
    ----------
    loop : Loop
        The step with its loop.
    start : ndarray
        What it carries into the first row.
    control : ndarray, shape (rows, controls)
        What it takes of each row.
    constants : ndarray
        Coefficients and noise levels.
    arranged : Arrangement
        The record.
    restart : callable
        What is carried into the next stretch.

    Returns
    -------
    end : ndarray
        What is carried out of the last row.
    out : ndarray, shape (rows, outputs)
    starts : tuple of ndarray
        What was carried into each stretch.
    """
    if not arranged.holes:
        end, out = loop(start, control, constants)
        return end, np.asarray(out, dtype=float), (start,)
    parts, starts, carried = [], [], start
    for k, piece in enumerate(arranged.pieces):
        if k:
            carried = restart(np.asarray(carried, dtype=float), arranged.holes[k - 1])
        starts.append(carried)
        carried, out = loop(carried, control[piece], constants)
        parts.append(np.asarray(out, dtype=float))
    return carried, np.concatenate(parts), tuple(starts)


def kept_states(design: FilterDesign, hole: Hole) -> np.ndarray:
    """Return which states go on over a hole: those that the missing inputs do not drive, bool, shape (states,).

    Parameters
    ----------
    design : FilterDesign
        The filter.
    hole : Hole
        The hole.
    """
    driven = design.system.states_driven_by(hole.inputs)
    return np.array([n not in driven for n in design.model.states])


def restarted(design: FilterDesign, arranged: Arrangement, carried: np.ndarray, hole: Hole) -> np.ndarray:
    """Return the carried vector before the first sample behind a hole.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    arranged : Arrangement
        The record.
    carried : ndarray
        What was carried out of the last row before the hole.
    hole : Hole
        The hole.
    """
    kept, layout, places = kept_states(design, hole), design.layout, design.layout.carried
    anew = carried_vector(design, first_behind(design, arranged, hole), arranged.inputs[hole.row])
    state = np.where(kept, carried[places["x"]], anew[places["x"]])
    anew[places["x"]] = state
    both = np.zeros((layout.joint, layout.joint))
    old, new = (_covariance(design, z[places["P"]]) for z in (carried, anew))
    at = np.flatnonzero(kept)
    both[np.ix_(at, at)] = old[np.ix_(at, at)]
    others = np.setdiff1d(np.arange(layout.joint), at)
    both[np.ix_(others, others)] = new[np.ix_(others, others)]
    anew[places["P"]] = _packed(design, both)
    return anew


def first_behind(design: FilterDesign, arranged: Arrangement, hole: Hole) -> dict[str, float]:
    """Return the first sample of each sensor and input of the stretch behind a hole, SI, by name.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    arranged : Arrangement
        The record.
    hole : Hole
        The hole.
    """
    piece = next(p for p in arranged.pieces if p.start == hole.row)
    z, there = arranged.z[piece], arranged.there[piece]
    first = {}
    for j, name in enumerate(design.measured):
        at = np.flatnonzero(there[:, j])[:LOOK]
        if at.size:
            first[name] = first_value(arranged.t[piece][at], z[at, j], float(design.r[j]))
    inputs = dict(zip(design.model.inputs, arranged.inputs[hole.row].tolist()))
    return design.instruments.with_quantities(inputs | first)


def _covariance(design: FilterDesign, packed: np.ndarray) -> np.ndarray:
    n = design.layout.joint
    if design.form == "square-root":
        root = packed.reshape(n, n, order="F")
        return np.asarray(root @ root.T)
    return np.asarray(unpacked(packed[None], n)[0])


def _packed(design: FilterDesign, covariance: np.ndarray) -> np.ndarray:
    if design.form == "square-root":
        values, vectors = np.linalg.eigh(covariance)
        return np.asarray((vectors * np.sqrt(np.clip(values, 0.0, None))).ravel(order="F"))
    return np.asarray(covariance.T[np.tril_indices(len(covariance))])
