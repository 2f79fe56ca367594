"""A heading that comes from two sources in turn: a true and a magnetic one, or two compasses, a constant angle apart."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import counted
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy

_APART = np.radians(0.5)
"""Sources nearer than this are of no concern."""
_FARTHEST = np.radians(60.0)
"""No variation and no compass is off by more: samples that far apart are marks of missing ones."""
_FEWEST = 6
"""Changes from one source to the other from which on they are told from a heading that is set."""
_WIDTH = 7
"""The smooth heading beside the steps is the mean of so many samples to either side."""
_ALIKE, _BETWEEN, _IN_TURN = 0.12, 0.1, 0.9
"""Steps scatter by this share of their size, this share of them lies halfway, and this share goes the other way than the one before."""

_RARE, _SHORT = 0.15, 5
"""A source with fewer samples than this share, and fewer than this in a row, is none: these are glitches."""


def examine_two_headings(p: WorkingCopy) -> None:
    """Find a heading that jumps to and fro by one and the same angle, and count all of it by one of the two.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading unwrapped and without holes.
    """
    if not p.has("psi") or len(p.own("psi")) < 10 * _FEWEST:
        return
    index = p.own("psi")
    psi = p["psi"][index]
    mean = np.convolve(np.pad(psi, _WIDTH, mode="reflect", reflect_type="odd"), np.ones(2 * _WIDTH + 1), "valid")
    step = np.diff(psi) - np.diff(mean / (2 * _WIDTH + 1))
    size = np.abs(step)
    largest = float(np.median(np.sort(size)[-max(_FEWEST, len(size) // 100) :]))
    # Under noise the largest steps are larger than the usual ones.
    largest = float(np.median(size[size > 0.5 * largest])) if largest > 0 else 0.0
    jumps = np.flatnonzero(size > 0.5 * largest)
    between = int(np.sum((size > 0.3 * largest) & (size < 0.7 * largest)))
    if len(jumps) < _FEWEST or between > _BETWEEN * len(jumps):
        return
    # Up and down in turn, what the ship turns within a sample cancels.
    apart = float(np.median(np.sign(step[jumps]) * np.diff(psi)[jumps]))
    others = np.delete(size, jumps)
    grid = robust.resolution(psi)[0]
    limit = max(_APART, 3 * grid, 4.5 * 1.4826 * float(np.median(others)) if others.size else 0.0)
    alike = robust.spread(size[jumps]) < _ALIKE * apart and apart < _FARTHEST
    in_turn = float(np.mean(np.diff(np.sign(step[jumps])) != 0))
    if apart < limit or not alike or in_turn < _IN_TURN:
        return
    # Up and down in turn: the state after each step is that of its sign.
    state = np.zeros(len(psi))
    state[jumps + 1] = step[jumps]
    last = np.maximum.accumulate(np.where(state != 0, np.arange(len(psi)), 0))
    high = np.where(last > 0, state[last] > 0, step[jumps[0]] < 0)
    few = min(float(np.mean(high)), 1 - float(np.mean(high)))
    if few < _RARE and few * len(psi) < _SHORT * len(jumps) / 2:
        return
    p.add(
        "heading-two-sources", "psi", robust.confidence_of(apart / limit, 0.6, 1.5),
        f"the heading goes to and fro between two values {angle(apart, 3)} apart, {counted(len(jumps), 'time')}: two sources in turn, such as a "
        f"true and a magnetic heading; the rarer one has {100 * few:.0f} % of the samples",
        "Every heading is wrong by that angle half of the time, and so are overshoots, rates derived from it and the noise that a fit sees.",
        "Take one source: by its sentence or column in the format file, or correct the magnetic one by its variation.",
        at=index[jumps + 1],
    )  # fmt: skip
    # The more frequent of the two is the heading; which is true is not known.
    shifted = p["psi"].copy()
    shifted[index] = psi - apart * high if float(np.mean(high)) < 0.5 else psi + apart * ~high
    p["psi"] = shifted
    p.void("psi", np.zeros(len(p), dtype=bool))
