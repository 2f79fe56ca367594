"""Smoothing: the estimate at each sample from all samples of the record.

The backward recursion is that of `shipid.estimation.recursion.backward`. Where adaptation was switched off, every sample that was
used counts nevertheless.

The smoothed covariance is the filter's less a term from the later samples: where the standard deviation of a state falls
a million times over the record, the first ones keep few digits.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import shown_estimate
from shipid.estimation.design import FilterDesign
from shipid.estimation.named_quantities import NamedQuantities
from shipid.estimation.records.derived import named
from shipid.estimation.records.restart import kept_states
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.triangles import deviations_of, unpacked
from shipid.estimation.recursion.gate import TAKEN
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import moment
from shipid.foundation.result import DrawnResult

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Smoothed(NamedQuantities[np.ndarray], DrawnResult):
    """Smoothed estimates of a record.

    Attributes
    ----------
    design : FilterDesign
        Which filter.
    t : ndarray, shape (N,)
        Times of the samples in s.
    x : ndarray, shape (N, states)
        Estimates, SI.
    packed : ndarray, shape (N, states (states + 1) / 2)
        Upper triangles of their covariances, columns one after the other.
    """

    design: FilterDesign = field(repr=False)
    t: np.ndarray
    x: np.ndarray
    packed: np.ndarray = field(repr=False)

    @property
    def states(self) -> tuple[str, ...]:
        """Names along the estimates."""
        return self.design.model.states

    @property
    def std(self) -> np.ndarray:
        """Standard deviations of the estimates, SI, shape (N, states)."""
        return deviations_of(self.packed, len(self.states))

    def quantity(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return a state or an estimated parameter and its standard deviation along the record, SI, shapes (N,).

        Parameters
        ----------
        name : str
            A state or an estimated parameter.
        """
        return named(self.design, self.x, self.std, name)

    @functools.cached_property
    def covariance(self) -> np.ndarray:
        """Covariance of the states at each sample, shape (N, states, states)."""
        return unpacked(self.packed, len(self.states))

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table: time, estimates and standard deviations, SI, units in the headers."""
        import pandas as pd

        columns: dict[str, np.ndarray] = {"t [s]": self.t}
        hidden = self.design.parameters.values()
        for name in (*(s for s in self.states if s not in hidden), *self.design.parameters):
            unit = self.design.model[name].unit
            columns[f"{name} [{unit}]"], columns[f"std_{name} [{unit}]"] = self[name], self.std_of(name)
        return pd.DataFrame(columns)

    def text(self) -> str:
        """Return the result in lines of text: the filter, the record, and the estimates at its end."""
        span = f"{self.t.size} samples, {moment(self.t[0])} to {moment(self.t[-1])} s"
        lines = [f"smoothed by {repr(self.design).strip('<>')}", f"record: {span}; at its end:"]
        hidden = self.design.parameters.values()
        for name in (*(s for s in self.states if s not in hidden), *self.design.parameters):
            unit = self.design.model[name].unit
            lines.append(
                f"  {name:<12s} {shown_estimate(float(self[name][-1]), float(self.std_of(name)[-1]), name, unit)}"
            )
        return "\n".join(lines)


def _over_holes(run: FilterRun) -> tuple[np.ndarray, np.ndarray]:
    """Smoothed states along all rows, from the last stretch to the first.

    What starts anew behind a hole knows nothing of what was before it: back over the hole goes only what went on over it.
    """
    design, n = run.design, run.design.layout.joint
    later, parts = None, []
    for k, piece in reversed(list(enumerate(run.arranged.pieces))):
        x, packed, later = run_back(design, run.control[piece], run.out[piece], run.starts[k], later)
        parts.append((x, packed))
        if k:
            kept = np.pad(kept_states(design, run.arranged.holes[k - 1]), (0, n - design.layout.n))
            spread = unpacked(later[None, n:], n)[0] * np.outer(kept, kept)
            later = np.concatenate([later[:n] * kept, spread.T[np.tril_indices(n)]])
    x, packed = (np.concatenate(part[::-1]) for part in zip(*parts))
    return x, packed


def run_back(
    design: FilterDesign, control: np.ndarray, out: np.ndarray, start: np.ndarray, later: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return smoothed states along forward rows, and the packed triangles of their covariance.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    control, out : ndarray
        Controls and full outputs of its forward rows.
    start : ndarray
        Carried vector before the first of them.
    later : ndarray, optional
        What later rows say, carried back to the last of these; nothing by default.

    Returns
    -------
    x : ndarray, shape (rows, states)
    packed : ndarray, shape (rows, states (states + 1) / 2)
    earlier : ndarray
        What these rows and later ones say of the time before them.
    """
    if design.switchable and not control[:, design.layout.control["adapting"]].all():
        control, out = _adapting_throughout(design, control, out, start)
    rows = _backward_rows(design, control, out, start)[::-1]
    last = np.zeros(design.backward.sizes[0]) if later is None else later
    earlier, shown = design.backward(last, rows, design.constants)
    return shown[::-1, : design.layout.n], shown[::-1, design.layout.n :], np.asarray(earlier, dtype=float)


def _backward_rows(design: FilterDesign, control: np.ndarray, out: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The controls of the backward step in the order of the forward rows, shape (rows, controls)."""
    full, places = design.layout.full, design.layout.control
    before, inputs_before = rows_before(design, control, out, start)
    parts = [
        out[:, full["P_ahead"]],
        out[:, full["P"]],
        out[:, full["x"]],
        out[:, full["ahead"]],
        before,
        inputs_before,
        control[:, places["u"]],
        control[:, places["T"]],
        control[:, places["z"]],
        out[:, full["fate"]] == TAKEN,
        out[:, full["inflation"]],
        control[:, places["scale"]],
        control[:, places["adapting"]],
    ]
    return np.concatenate(parts, axis=1)


def rows_before(
    design: FilterDesign, control: np.ndarray, out: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the joint vector and the inputs before each row, shapes (rows, joint) and (rows, inputs).

    Parameters
    ----------
    design, control, out, start
        See `run_back`.
    """
    full, carried = design.layout.full, design.layout.carried
    joint = np.concatenate([out[:, full["x"]], out[:, full["w"]]], axis=1)
    first = np.concatenate([start[carried["x"]], start[carried["w"]]])
    inputs = control[:, design.layout.control["u"]]
    return np.vstack([first, joint[:-1]]), np.vstack([start[carried["u"]], inputs[:-1]])


def _adapting_throughout(
    design: FilterDesign, control: np.ndarray, out: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Controls and outputs of the same rows with parameters that adapt throughout, on the samples that were taken in.

    The innovations of a filter that holds its parameters are correlated, and a recursion back over them is not the best
    estimate: its variances may even come out below those from all samples.
    """
    places, bare = design.layout.control, start[: design.layout.carried["P"].stop]
    again = control.copy()
    again[:, places["there"]] = out[:, design.layout.full["fate"]] == TAKEN
    again[:, places["adapting"]] = 1.0
    _, adapted = design.loop(full=True, gated=False)(bare, again, design.constants)
    return again, np.asarray(adapted, dtype=float)


def smooth(run: FilterRun) -> Smoothed:
    """Smooth a filtered record.

    Parameters
    ----------
    run : FilterRun
        The result of the filter on the record.

    Returns
    -------
    Smoothed

    Raises
    ------
    UsageError
        If the run is a mixture of several filters.
    """
    if not run.smoothable:
        raise UsageError("an adaptive filter has no smoother; smooth the run of the filter it is based on.")
    x, packed = _over_holes(run)
    return Smoothed(run.design, run.t, x[run.arranged.shown], packed[run.arranged.shown])
