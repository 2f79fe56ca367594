"""The controls of a filter: what its generated step takes of each row of a record."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import Arrangement
from shipid.estimation.recursion.layout import total
from shipid.foundation.errors import UnknownNameError, UsageError


def controls_of(
    design: FilterDesign,
    arranged: Arrangement,
    adapt: np.ndarray | bool = True,
    scale: Mapping[str, np.ndarray | float] | None = None,
) -> np.ndarray:
    """Return the controls of every row, shape (N, controls).

    Parameters
    ----------
    design : FilterDesign
        The filter.
    arranged : Arrangement
        The record.
    adapt : bool or ndarray of bool, shape (samples,)
        Where parameters adapt.
    scale : mapping of str to float or ndarray
        Factors on the noise of sources, over the samples: a sea state that changes.

    Raises
    ------
    UsageError
        If adaptation is to be switched off where it cannot be.
    """
    check_switch(design, adapt is not True)
    check_scale(design, scale)
    places, sample, lost = design.layout.control, arranged.sample, design.instruments.lost
    table = np.zeros((arranged.t.size, total(places)))
    table[:, places["u"]] = arranged.inputs
    table[:, places["T"]] = arranged.intervals[:, None]
    table[:, places["z"]] = arranged.z
    table[:, places["there"]] = arranged.there
    factors = table[:, places["scale"]]
    factors[:] = 1.0
    for i, source in enumerate(design.sources):
        if scale and source.name in scale:
            given = np.asarray(scale[source.name], dtype=float)
            factors[:, i] *= _each(given, arranged, f"factors on the noise of '{source.name}'")[sample]
        if source.name in lost:
            missing = arranged.lost[:, design.system.inputs.index(source.name)]
            usual = 0.0 if source.level == lost[source.name] else 1.0
            factors[:, i] *= np.where(missing, lost[source.name] / source.level, usual)
    if design.switchable:
        table[:, places["adapting"]] = _each(np.asarray(adapt), arranged, "'adapt'")[sample, None]
    return table


def check_switch(design: FilterDesign, off: bool) -> None:
    """Raise an error if adaptation is switched off and the filter was not made for it.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    off : bool
        Whether it is to be switched off.

    Raises
    ------
    UsageError
        If it cannot be.
    """
    if off and not design.switchable:
        raise UsageError("adaptation is to be switched off, and the filter was made without switchable=True.")


def check_scale(design: FilterDesign, scale: Collection[str] | None) -> None:
    """Raise an error for a factor on a noise that the filter does not have.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    scale : collection of str or None
        Names of sources.

    Raises
    ------
    UnknownNameError
        If one is no source.
    """
    for name in scale or ():
        if name not in (driven := [s.name for s in design.sources]):
            raise UnknownNameError("noise to scale called", name, driven)


def _each(values: np.ndarray, arranged: Arrangement, what: str) -> np.ndarray:
    """One value for each sample that is used, from one for each of the record or one for all."""
    if not values.ndim:
        return np.broadcast_to(values, arranged.forward.sum())
    if values.shape != arranged.forward.shape:
        raise UsageError(f"{what}: {values.size} values, and the record has {arranged.forward.size} samples.")
    return np.asarray(values[arranged.forward])
