"""The innovations of a filter over the pieces of a record, as a function of its constants and of the biases of its inputs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import arrange
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import carried_vector, first_carried
from shipid.estimation.records.restart import first_behind
from shipid.estimation.recursion.gate import TAKEN
from shipid.estimation.recursion.layout import total


class Piece:
    """A piece of a record, ready to be run through; behind a hole of an input everything starts anew.

    Parameters
    ----------
    design : FilterDesign
        The filter, without a gate.
    columns : mapping of str to ndarray
        The piece, SI.
    """

    def __init__(self, design: FilterDesign, columns: Mapping[str, np.ndarray]) -> None:
        self.design = design
        arranged = arrange(design.instruments, columns)
        first = first_carried(design, columns, arranged)
        behind = (
            carried_vector(design, first_behind(design, arranged, h), arranged.inputs[h.row]) for h in arranged.holes
        )
        control = controls_of(design, arranged)
        self.stretches = list(zip((first, *behind), (control[piece].copy() for piece in arranged.pieces)))

    def leave_out(self, wild: np.ndarray) -> None:
        """Take samples for missing from now on.

        Parameters
        ----------
        wild : ndarray of bool, shape (rows, sensors)
            Which.
        """
        at, place = 0, self.design.layout.control["there"]
        for _, control in self.stretches:
            control[:, place] *= ~wild[at : at + len(control)]
            at += len(control)

    def innovations(self, constants: np.ndarray, shift: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return innovations, their variances, and which samples there are, shapes (rows, sensors).

        Parameters
        ----------
        constants : ndarray
            Coefficients and noise levels, as the step takes them.
        shift : ndarray, shape (inputs,)
            What is added to the inputs.
        """
        layout, parts = self.design.layout, []
        places, loop = layout.brief, self.design.loop(gated=False)
        for first, control in self.stretches:
            if shift.any():
                first, control = first.copy(), control.copy()
                first[layout.carried["u"]] += shift
                control[:, layout.control["u"]] += shift
            parts.append(np.asarray(loop(first[: total(layout.carried)], control, constants)[1]))
        out = np.concatenate(parts)
        return out[:, places["e"]], out[:, places["S"]], out[:, places["fate"]] == TAKEN
