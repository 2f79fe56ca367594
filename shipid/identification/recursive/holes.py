"""A recursion over a record with holes in its inputs: behind each the measured state starts anew, and the parameters go on."""

from __future__ import annotations

import numpy as np

from shipid.estimation.records.arrangement import Arrangement, Hole
from shipid.estimation.records.restart import run_stretches
from shipid.estimation.records.triangles import diagonal_of
from shipid.identification.recursive.design import RecursiveDesign


def run_over_holes(
    design: RecursiveDesign,
    start: np.ndarray,
    control: np.ndarray,
    constants: np.ndarray,
    arranged: Arrangement,
    level: float,
) -> np.ndarray:
    """Return the outputs of a recursion over a record, shape (rows, outputs).

    Parameters
    ----------
    design : RecursiveDesign
        The recursion.
    start : ndarray
        What it carries into the first row.
    control : ndarray, shape (rows, controls)
        What it takes of each row.
    constants : ndarray
        Its constants.
    arranged : Arrangement
        The record.
    level : float
        Standard deviation of a sample of the measured state, SI.
    """

    def anew(carried: np.ndarray, hole: Hole) -> np.ndarray:
        piece = next(p for p in arranged.pieces if p.start == hole.row)
        z, there = arranged.z[piece, 0], arranged.there[piece, 0]
        first = float(z[np.argmax(there)]) if there.any() else None
        return _behind(design, carried, first, arranged.inputs[hole.row], level)

    return run_stretches(design.loop, start, control, constants, arranged, anew)[1]


def _behind(
    design: RecursiveDesign, carried: np.ndarray, first: float | None, inputs: np.ndarray, level: float
) -> np.ndarray:
    """What is carried into the first sample behind a hole, from what was carried out of the last one before it."""
    places, z, n = design.layout.carried, np.array(carried, dtype=float), design.layout.n
    if first is not None:
        z[places["y"]] = z[places["y_aux"]] = first
    z[places["u"]], z[places["P_y"]] = inputs, level**2
    joint = z[places["joint"]]
    # The first row of the matrix: the state, and what it has in common with the parameters.
    joint[diagonal_of(n + 1) - np.arange(n + 1)] = 0.0
    joint[0] = level**2
    z[places["joint"]] = joint
    if design.starts_at_sample:
        z[places["age"]] = 0.0
    return z
