"""Many runs of one experiment through a multiple-model filter, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.multiple.design import MultipleModelDesign
from shipid.estimation.multiple.first_state import FirstState
from shipid.estimation.multiple.record import (
    arrange_for_modes,
    first_carried,
    first_samples,
    spread_covariances,
)
from shipid.estimation.multiple.whitening import whitened
from shipid.estimation.records.triangles import diagonal_of, unpacked
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.result import Result

if TYPE_CHECKING:
    import pandas as pd

#: Runs whose controls are laid out at a time: memory for them does not grow with the number of runs.
_BATCH = 128


@dataclass(frozen=True, eq=False, repr=False)
class MultipleModelRuns(Result):
    """What a multiple-model filter made of R runs with N samples each, M modes.

    Attributes
    ----------
    design : MultipleModelDesign
        Which filter.
    t : ndarray, shape (N,)
        Times of the samples that are used, in s.
    used : ndarray of bool, shape (samples,)
        Which samples of the record these are.
    out : ndarray, shape (R, N, outputs)
        What the cycle returned (`CycleLayout.brief`, then the moving parameter with its displacement).
    """

    design: MultipleModelDesign
    t: np.ndarray
    used: np.ndarray
    out: np.ndarray

    @property
    def states(self) -> tuple[str, ...]:
        """Names along the combined estimates."""
        return self.design.states

    @property
    def x(self) -> np.ndarray:
        """Combined estimates, SI, shape (R, N, states)."""
        return np.asarray(self.out[..., self.design.layout.brief["x"]])

    @property
    def covariance(self) -> np.ndarray:
        """Their covariance, shape (R, N, states, states)."""
        packed, n = self.out[..., self.design.layout.brief["P"]], self.design.layout.n
        return unpacked(packed.reshape(-1, packed.shape[-1]), n).reshape(*packed.shape[:-1], n, n)

    @property
    def std(self) -> np.ndarray:
        """Their standard deviations, shape (R, N, states)."""
        packed = self.out[..., self.design.layout.brief["P"]]
        return np.asarray(np.sqrt(np.maximum(packed[..., diagonal_of(self.design.layout.n)], 0.0)))

    @property
    def probabilities(self) -> np.ndarray:
        """Probability of each mode, shape (R, N, M)."""
        return np.asarray(self.out[..., self.design.layout.brief["mu"]])

    @property
    def parameter(self) -> np.ndarray:
        """The moving parameter of each mode, its displacement included, SI, shape (R, N, M); no mode where none moves."""
        return np.asarray(self.out[..., self.design.layout.brief["theta"]])

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the combined estimates of a state, SI, shape (R, N)."""
        if name not in self.states:
            raise UnknownNameError("state of the combined estimate called", name, self.states)
        return np.asarray(self.x[..., self.states.index(name)])

    def text(self) -> str:
        """Return the result in lines of text."""
        return f"{repr(self.design).strip('<>')}: {self.out.shape[0]} runs of {self.t.size} samples"

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table, one row a run and sample: combined estimates, standard deviations, mode probabilities, SI."""
        import pandas as pd

        runs, samples = self.out.shape[:2]
        x, std, mu = (a.reshape(runs * samples, -1) for a in (self.x, self.std, self.probabilities))
        columns = {"run": np.repeat(np.arange(runs), samples), "t [s]": np.tile(self.t, runs)}
        for i, name in enumerate(self.states):
            unit = self.design.first.model[name].unit
            columns[f"{name} [{unit}]"], columns[f"std_{name} [{unit}]"] = x[:, i], std[:, i]
        return pd.DataFrame(columns | {f"probability_{m} [1]": mu[:, j] for j, m in enumerate(self.design.names)})


def filter_runs(
    design: MultipleModelDesign,
    record: Mapping[str, np.ndarray],
    covariances: np.ndarray | None = None,
    first: FirstState | None = None,
    threads: int | None = None,
) -> MultipleModelRuns:
    """Filter many runs; see `InteractingMultipleModel.filter_runs`.

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    record, covariances, first, threads
        See `InteractingMultipleModel.filter_runs`.

    Returns
    -------
    MultipleModelRuns

    Raises
    ------
    UsageError
        If the runs do not fit each other.
    FilterDivergedError
        If an estimate diverges.
    """
    table, columns = _samples(design, record)
    runs, samples, sensors = table.shape
    one = None if first is None or first.mean.ndim == 1 else replace(first, mean=first.mean[0])
    if one is not None and first is not None and len(first.mean) != runs:
        raise UsageError(
            f"there are {runs} runs and {len(first.mean)} first states: give one for each run, or one for all."
        )
    base = arrange_for_modes(design, columns, None, first if one is None else one)
    main, layout = base.arranged, design.layout
    if main.holes:
        raise UsageError("the inputs of the runs have holes: filter each run on its own.")
    spread = None
    if covariances is not None:
        spread = np.asarray(covariances, dtype=float)
        spread = spread if spread.ndim == 4 else spread_covariances(design, spread, samples)[None]
        if spread.shape not in ((1, samples, sensors, sensors), (runs, samples, sensors, sensors)):
            raise UsageError(
                f"the covariances have the shape {spread.shape}: give {(runs, samples, sensors, sensors)}."
            )
        flat = spread.reshape(-1, sensors, sensors)
        spread = spread_covariances(design, flat, len(flat)).reshape(spread.shape)
    at = np.flatnonzero(main.shown)
    out = np.empty((runs, at.size, layout.brief["ll"].stop))
    for begin in range(0, runs, _BATCH):
        batch = np.arange(begin, min(begin + _BATCH, runs))
        control = np.repeat(base.control[None], batch.size, axis=0)
        z = table[batch][:, main.forward]
        there = np.isfinite(z)
        control[:, at, layout.control["z"]] = np.where(there, z, 0.0)
        control[:, at, layout.control["there"]] = there
        if spread is not None:
            own = np.broadcast_to(spread[batch] if len(spread) > 1 else spread, (batch.size, *spread.shape[1:]))
            variance, below = whitened(own[:, main.forward].reshape(-1, sensors, sensors), there.reshape(-1, sensors))
            control[:, at, layout.control["variance"]] = variance.reshape(*there.shape)
            if design.settings.correlated:
                control[:, at, layout.control["whitening"]] = below.reshape(*there.shape[:2], -1)
        starts = _starts(design, base.starts[0], columns, table[batch], main.forward, first, batch)
        ran = design.loop(full=False).map(starts, control, [design.constants] * batch.size, threads)
        for k, (_, found) in zip(batch, ran):
            out[k] = found[at]
    good = np.isfinite(out).all(axis=(1, 2))
    if not good.all():
        raise FilterDivergedError(
            f"{design!r} diverges in {np.count_nonzero(~good)} of {runs} runs, first in run {np.argmin(good)}. Start closer to the true "
            "state, or put more noise on the states."
        )
    return MultipleModelRuns(design, main.t[at], main.forward, out)


def _samples(design: MultipleModelDesign, record: Mapping[str, np.ndarray]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return what the sensors show, shape (runs, samples, sensors), and the columns of the first run."""
    columns = {n: np.asarray(c, dtype=float) for n, c in record.items()}
    names = [design.first.instruments.column_of(s, columns) or s for s in design.measured]
    lacking = [n for n in names if n not in columns]
    if lacking or "t" not in columns:
        raise UsageError(f"the runs lack the column '{(lacking or ['t'])[0]}'; they have {', '.join(columns)}.")
    shapes = {columns[n].shape for n in names}
    if len(shapes) != 1 or len(next(iter(shapes))) != 2:
        raise UsageError(
            f"the sensors of many runs have the shape (runs, samples), all the same; here: {sorted(shapes)}."
        )
    runs = next(iter(shapes))[0]
    if not runs:
        raise UsageError("there is no run to filter.")
    table = np.stack([columns[n] for n in names], axis=-1)
    return table, {n: c[0] if n in names else c for n, c in columns.items()}


def _starts(
    design: MultipleModelDesign,
    start: np.ndarray,
    columns: Mapping[str, np.ndarray],
    table: np.ndarray,
    used: np.ndarray,
    first: FirstState | None,
    batch: np.ndarray,
) -> np.ndarray:
    """Return what each run carries into its first scan, shape (runs, carried)."""
    starts = np.repeat(start[None], batch.size, axis=0)
    if first is not None and first.mean.ndim == 2:
        for j, mode in enumerate(design.designs):
            own, at = first.places_in(mode.model.states)
            places = np.arange(start.size)[design.layout.carried[f"x{j}"]]
            starts[:, places[at]] = first.mean[batch][:, own]
    if first is None or not set(design.measured) <= set(first.states):
        names = [design.first.instruments.column_of(s, columns) or s for s in design.measured]
        inputs = [start[design.layout.carried[f"u{j}"]] for j in range(design.layout.modes)]
        for k, z in enumerate(table):
            known = {**columns, **dict(zip(names, z.T))}
            one = first if first is None or first.mean.ndim == 1 else replace(first, mean=first.mean[batch[k]])
            starts[k] = first_carried(design, first_samples(design, known, used), inputs, one)
    return starts
