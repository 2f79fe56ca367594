"""Many runs of one record function: segments of a trial, or walkers of a sampler, side by side where that pays."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from shipid.generation.record import Record

#: Samples of all runs below which threads cost more than they bring.
_WORTH_THREADS = 20_000


def run_many(
    record: Record,
    x0: np.ndarray,
    u: np.ndarray,
    intervals: np.ndarray,
    p: np.ndarray,
    bias: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Run a record function many times; the machine code lets go of Python's lock, so that threads run side by side.

    Parameters
    ----------
    record : Record
        Made by `shipid.generation.record.make_record`.
    x0 : ndarray, shape (runs, states)
        Initial states.
    u : ndarray, shape (runs, inputs, N) or (inputs, N)
        Inputs at the samples; the same for all runs where there is one only.
    intervals : ndarray, shape (runs, N) or (N,)
        Time from each sample to the next, in s; the last one is not used.
    p : ndarray, shape (runs, coefficients)
        Parameters and constants.
    bias : ndarray, shape (runs, inputs)
        Added to every sample of the inputs.

    Returns
    -------
    y : ndarray, shape (runs, outputs, N)
        Outputs; not finite from where the model diverges.
    dy : ndarray, shape (runs, outputs, unknowns, N)
        Derivatives of the outputs by the unknowns.
    """
    runs, count = len(x0), u.shape[-1]
    inputs = np.broadcast_to(u, (runs, *u.shape[-2:]))
    steps = np.broadcast_to(intervals, (runs, count))
    cores = min(os.cpu_count() or 1, runs) if runs * count >= _WORTH_THREADS else 1
    if cores == 1:
        found = list(map(record, x0, inputs, steps, p, bias))
    else:
        with ThreadPoolExecutor(cores) as pool:
            found = list(pool.map(record, x0, inputs, steps, p, bias))
    n_y, n_q = len(record.outputs), len(record.unknowns)
    y, dy = np.empty((runs, n_y, count)), np.empty((runs, n_y, n_q, count))
    for i, (one, slope) in enumerate(found):
        y[i], dy[i] = one, slope
    return y, dy
