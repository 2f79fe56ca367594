"""Many runs of one record function in one call: segments of a trial, or walkers of a sampler."""

from __future__ import annotations

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
    bias: np.ndarray | None = None,
    whole: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """Run a record function many times.

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
    bias : ndarray, shape (runs, inputs), optional
        Added to every sample of the inputs.
    whole : bool
        Whether to compile the whole record and not its step: a record that was made without compiling then runs several
        times faster, at the price of a compilation for each length of record. It pays for thousands of runs.

    Returns
    -------
    y : ndarray, shape (runs, outputs, N)
        Outputs; not finite from where the model diverges.
    dy : ndarray, shape (runs, outputs, unknowns, N)
        Derivatives of the outputs by the unknowns.
    """
    runs, count = len(x0), u.shape[-1]
    n_y, n_q = len(record.outputs), len(record.unknowns)
    if not runs or not count:
        return np.empty((runs, n_y, count)), np.empty((runs, n_y, n_q, count))
    shifted = np.broadcast_to(u, (runs, *u.shape[-2:]))
    shifted = shifted if bias is None else shifted + bias[:, :, None]
    following = np.concatenate([shifted[:, :, 1:], shifted[:, :, -1:]], axis=2)
    steps = np.array(np.broadcast_to(intervals, (runs, count)), dtype=float)
    steps[:, -1] = 0.0
    controls = np.concatenate([shifted, following, steps[:, None, :]], axis=1).transpose(0, 2, 1)
    z0 = np.concatenate([x0, np.broadcast_to(record.seed, (runs, record.seed.size))], axis=1)
    threads = None if runs * count >= _WORTH_THREADS else 1
    rows = np.array([out for _, out in record.loop.map(z0, controls, p, threads)])
    return rows[:, :, :n_y].transpose(0, 2, 1), rows[:, :, n_y:].reshape(runs, count, n_q, n_y).transpose(0, 3, 2, 1)
