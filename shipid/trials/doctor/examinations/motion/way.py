"""The way made good, block by block, and vector fits to it: what the other examinations of the track compare with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy


@dataclass(frozen=True, eq=False)
class Way:
    """The way made good in blocks of time, as complex numbers: north plus i times east.

    Attributes
    ----------
    at : ndarray of int, shape (m + 1,)
        Edges of the blocks.
    kept : ndarray of bool, shape (m,)
        Blocks in which everything asked for was measured.
    made : ndarray of complex, shape (k,)
        Way made good over the ground in each block kept [m].
    dt : ndarray, shape (k,)
        Their durations [s].
    rough : float
        Standard deviation of a made way by noise alone [m].
    """

    at: np.ndarray
    kept: np.ndarray
    made: np.ndarray
    dt: np.ndarray
    rough: float

    def __len__(self) -> int:
        return len(self.made)

    def integral(self, t: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the integral of a velocity over each block kept.

        Parameters
        ----------
        t, velocity : ndarray, shape (n,)
            Time [s] and velocity, complex or real [m/s].

        Returns
        -------
        ndarray, shape (k,)
        """
        result = np.diff(robust.integral(t, velocity)[self.at])[self.kept]
        return np.asarray(result)


def way_made_good(p: WorkingCopy, *needed: str) -> Way | None:
    """Return the way made good, from the positions, or else from speed and course over ground.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    *needed : str
        Channels it will be compared with; blocks in which one of them was not measured are left out.

    Returns
    -------
    Way or None
        None where there are too few blocks in which the ship makes way.
    """
    fixes = p.has("x", "y")
    if len(p) < 30 or not (fixes or p.has("SOG", "COG")):
        return None
    if fixes:
        place = p["x"] + 1j * p["y"]
        rough = p.noise("x") + p.noise("y") + 1e-12
    else:
        place = robust.integral(p.t, p["SOG"] * np.exp(1j * p["COG"]))
        rough = 1e-12
    coarse = np.abs(np.diff(place[:: max(1, len(p) // 60)]))
    count = int(np.clip(float(np.sum(coarse)) / (30 * rough), 16, 80))
    at = robust.edges(len(p), count)
    blind = p.blind(*(("x", "y") if fixes else ("SOG", "COG")), *needed)
    unseen = np.concatenate(([0], np.cumsum(blind)))
    kept = np.diff(unseen[np.append(at[:-1], at[-1] + 1)]) == 0
    made = np.diff(place[at])[kept]
    if len(made) < 8 or float(np.median(np.abs(made))) < 4 * rough:
        return None
    return Way(at, kept, made, np.diff(p.t[at])[kept], float(rough))


@dataclass(frozen=True)
class VectorFit:
    """A fit ``made = factor * sailed + flow * dt``, all of them vectors.

    Attributes
    ----------
    factor : complex
        Its size is a scale of lengths, its angle turns the track [rad].
    std : float
        Standard deviation of its size, and of its angle [rad].
    flow : complex
        What is left, as a drift [m/s]; 0 where it cannot be told from the factor.
    flow_std : float
        Its standard deviation; infinite where it was not estimated.
    misfit : float
        Root mean square of what is left over the better nine tenths of the blocks [m].
    """

    factor: complex
    std: float
    flow: complex
    flow_std: float
    misfit: float


def vector_fit(way: Way, sailed: np.ndarray, drift: bool = True) -> VectorFit | None:
    """Fit the way made good by a way sailed that is turned and stretched, and a drift.

    Parameters
    ----------
    way : Way
        The way made good.
    sailed : ndarray of complex, shape (k,)
        Way sailed in each block [m].
    drift : bool
        Whether a drift is estimated.

    Returns
    -------
    VectorFit or None
        None where it cannot be told.
    """
    zero = np.zeros_like(way.dt)
    columns = [
        np.concatenate([sailed.real, sailed.imag]), np.concatenate([-sailed.imag, sailed.real]),
        np.concatenate([way.dt, zero]), np.concatenate([zero, way.dt]),
    ]  # fmt: skip
    design = np.column_stack(columns if drift else columns[:2])
    target = np.concatenate([way.made.real, way.made.imag])
    found = robust.regress(design, target)
    if found is None:
        return None
    factor = complex(*found.value[:2])
    rest = np.abs(
        (target - design @ found.value).reshape(2, -1)[0] + 1j * (target - design @ found.value).reshape(2, -1)[1]
    )
    misfit = float(np.sqrt(np.mean(np.sort(rest**2)[: max(1, int(0.9 * len(rest)))])))
    flow = complex(*found.value[2:]) if drift else 0j
    std = float(np.max(found.std[:2])) / max(abs(factor), 1e-12)
    return VectorFit(factor, std, flow, float(np.max(found.std[2:])) if drift else np.inf, misfit)
