"""A record as a multiple-model filter takes it: one arrangement of its samples that fits every mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.estimation.errors import CovarianceError, ModeError
from shipid.estimation.multiple.design import MultipleModelDesign
from shipid.estimation.multiple.first_state import FirstState, check_covariance, packed
from shipid.estimation.multiple.transition import over_intervals
from shipid.estimation.multiple.whitening import whitened
from shipid.estimation.records.arrangement import Arrangement, FilterRecord, arrange, columns_of
from shipid.estimation.records.first_estimate import carried_vector, first_sample
from shipid.estimation.records.restart import first_behind
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion.layout import total


@dataclass(frozen=True, eq=False)
class MultipleRecord:
    """A record arranged for all modes.

    Attributes
    ----------
    arranged : Arrangement
        As the first mode takes it; rows and samples are those of every mode.
    control : ndarray, shape (rows, controls)
        What the cycle takes of each row.
    starts : tuple of ndarray, shape (carried,)
        What it carries into each stretch between holes of an input.
    """

    arranged: Arrangement
    control: np.ndarray
    starts: tuple[np.ndarray, ...]


def arrange_for_modes(
    design: MultipleModelDesign,
    record: FilterRecord,
    covariances: np.ndarray | None = None,
    first: FirstState | None = None,
) -> MultipleRecord:
    """Arrange a record for all modes of a filter.

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    covariances : ndarray, shape (samples, sensors, sensors) or (sensors, sensors), optional
        Covariance of the sensors' errors in each sample, SI, in the order of the sensors.
    first : FirstState, optional
        What is known before the first sample.

    Raises
    ------
    ModeError
        If no arrangement fits every mode.
    CovarianceError
        If the covariances do not fit.

    Returns
    -------
    MultipleRecord
    """
    arranged = _arrangements(design, record)
    layout, main = design.layout, arranged[0]
    control = np.zeros((main.t.size, total(layout.control)))
    for j, each in enumerate(arranged):
        control[:, layout.control[f"u{j}"]] = each.inputs
    control[:, layout.control["T"]] = main.intervals[:, None]
    chances = over_intervals(design.transition, design.per, main.intervals)
    control[:, layout.control["transition"]] = chances.reshape(main.t.size, -1)
    control[:, layout.control["z"]] = main.z
    control[:, layout.control["there"]] = main.there
    control[:, layout.control["variance"]] = design.first.r**2
    if covariances is not None:
        given = spread_covariances(design, np.asarray(covariances, dtype=float), main.forward.size)
        variance, below = whitened(given[main.forward][main.sample], main.there)
        control[:, layout.control["variance"]] = variance
        if design.settings.correlated:
            control[:, layout.control["whitening"]] = below
    starts = [
        first_carried(design, first_samples(design, record, main.forward), [a.inputs[0] for a in arranged], first)
    ]
    for hole in main.holes:
        samples = [first_behind(d, a, hole) for d, a in zip(design.designs, arranged)]
        starts.append(first_carried(design, samples, [a.inputs[hole.row] for a in arranged], None))
    return MultipleRecord(main, control, tuple(starts))


def spread_covariances(design: MultipleModelDesign, covariances: np.ndarray, samples: int) -> np.ndarray:
    """Return one covariance for each sample, checked, shape (samples, sensors, sensors).

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    covariances : ndarray
        One for each sample, or one for all.
    samples : int
        How many samples there are.

    Raises
    ------
    CovarianceError
        If they do not fit the sensors, are not positive, or are correlated where the filter is not made for it.
    """
    sensors = len(design.measured)
    wanted = (samples, sensors, sensors)
    if covariances.shape not in (wanted, wanted[1:]):
        raise CovarianceError(
            f"the covariances of the sensors have the shape {covariances.shape}: give {wanted}, one for each sample, or {wanted[1:]}, "
            "one for all."
        )
    known = np.isfinite(covariances).all(axis=(-1, -2))
    if not known.all():
        # Where no sample is there is no covariance either.
        covariances = np.where(known[..., None, None], covariances, np.diag(design.first.r**2))
    check_covariance(covariances, "a covariance of the sensors")
    if not design.settings.correlated and (covariances * (1 - np.eye(sensors)) != 0).any():
        raise CovarianceError("the errors of the sensors are correlated: make the filter with correlated=True.")
    return np.broadcast_to(covariances, wanted)


def _arrangements(design: MultipleModelDesign, record: FilterRecord) -> list[Arrangement]:
    """One arrangement for each mode, with the same rows: a sample that one cannot use is left out for all."""
    arranged = [arrange(d.instruments, record) for d in design.designs]
    used = np.logical_and.reduce([a.forward for a in arranged])
    if any((a.forward != used).any() for a in arranged):
        columns = {n: np.where(used, c, np.nan) for n, c in columns_of(record)[0].items() if n != "t"}
        columns["t"] = columns_of(record)[0]["t"]
        arranged = [arrange(d.instruments, columns) for d in design.designs]
    for name, each in zip(design.names, arranged):
        same = (
            each.t.shape == arranged[0].t.shape
            and (each.t == arranged[0].t).all()
            and each.pieces == arranged[0].pieces
        )
        if not same:
            raise ModeError(
                f"mode '{name}' reads inputs that are missing where mode '{design.names[0]}' goes on: give modes that read the same "
                "inputs, or a record without holes in them."
            )
    return arranged


def first_samples(design: MultipleModelDesign, record: FilterRecord, used: np.ndarray) -> list[dict[str, float]]:
    """Return the first finite value of each column, as each mode reads it.

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    used : ndarray of bool, shape (samples,)
        Which samples are used.
    """
    return [first_sample(d, record, used) for d in design.designs]


def first_carried(
    design: MultipleModelDesign,
    samples: list[dict[str, float]],
    inputs: list[np.ndarray],
    first: FirstState | None,
) -> np.ndarray:
    """Return what is carried into the first scan, shape (carried,).

    Parameters
    ----------
    design : MultipleModelDesign
        The filter.
    samples : list of dict
        The first sample of each mode, SI.
    inputs : list of ndarray
        The inputs of each mode there.
    first : FirstState, optional
        What is known besides.
    """
    places = design.layout.carried
    z = np.zeros(total(places))
    z[places["mu"]], z[places["theta"]] = np.maximum(design.probabilities, 1e-100), design.parameter
    for j, mode in enumerate(design.designs):
        own = carried_vector(mode, samples[j], inputs[j])
        x, n = own[mode.layout.carried["x"]].copy(), mode.layout.n
        covariance = unpacked(own[None, mode.layout.carried["P"]], n)[0]
        if first is not None:
            first.put_into(mode.model.states, x, covariance)
        z[places[f"x{j}"]], z[places[f"P{j}"]], z[places[f"u{j}"]] = x, packed(covariance), inputs[j]
    return z
