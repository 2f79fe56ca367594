"""The same recursion for samples that arrive one by one, with its state saved to and restored from a file."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.named_quantities import SampleEstimate
from shipid.estimation.online.samples import SampleReader
from shipid.estimation.online.saving import (
    check_clock,
    check_covariance,
    check_finite,
    examined,
    numbers,
    read_state,
    write_state,
)
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion.layout import total
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import quantity
from shipid.generation.loop import Stepper
from shipid.identification.recursive.design import RecursiveDesign
from shipid.identification.recursive.recursion import FEW


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveEstimate(SampleEstimate):
    """The estimate after a sample.

    Attributes
    ----------
    t : float
        Time of the sample in s.
    y : float
        Estimate of the measured state, SI.
    theta : ndarray, shape (parameters,)
        Estimates, SI.
    covariance : ndarray, shape (parameters, parameters)
        Their covariance.
    refused : str
        Why the whole sample was refused; empty where it was not.
    design : RecursiveDesign
        Which recursion.
    """

    t: float
    y: float
    theta: np.ndarray
    covariance: np.ndarray
    refused: str
    design: RecursiveDesign = field(repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, and the published coefficients that follow from them."""
        return (*self.design.names, *self.design.published_names)

    @functools.cached_property
    def _values(self) -> dict[str, tuple[float, float]]:
        std = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        also = self.design.published_along(self.theta[None, :], self.covariance[None])
        own = {n: (float(self.theta[i]), float(std[i])) for i, n in enumerate(self.design.names)}
        return own | {n: (float(v[0]), float(s[0])) for n, (v, s) in also.items()}

    @property
    def model(self) -> Model:
        """The model whose parameters they are."""
        return self.design.model

    def quantity(self, name: str) -> tuple[float, float]:
        """Return a parameter, or a published coefficient that follows from them, and its standard deviation, SI.

        Parameters
        ----------
        name : str
            One of `names`.

        Raises
        ------
        UnknownNameError
            If it is none of them.
        """
        if name not in self.names:
            raise UnknownNameError("estimated parameter", name, self.names)
        return self._values[name]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI, free of NaN."""
        return {"t": quantity(self.t, "s"), "estimates": self.estimates, "refused": self.refused}

    @property
    def remarks(self) -> tuple[str, ...]:
        """Why the sample was refused."""
        return (f"refused: {self.refused}",) if self.refused else ()


class OnlineIdentifier:
    """A recursion between two samples; made by `RecursiveIdentifier.start` and `restore`.

    Parameters
    ----------
    design : RecursiveDesign
        Which recursion.
    """

    def __init__(self, design: RecursiveDesign) -> None:
        self.design = design
        self._level = design.level_of()
        self._reader = SampleReader(design.instruments)
        self._stepper: Stepper | None = None

    @property
    def t(self) -> float | None:
        """Time of the last sample in s; None before the first."""
        return self._reader.t

    @property
    def refused(self) -> int:
        """Whole samples left out so far: their time stamp cannot be right (see `shipid.estimation.records.clock`)."""
        return self._reader.refused

    def update(self, sample: Mapping[str, float]) -> RecursiveEstimate:
        """Process one sample.

        Parameters
        ----------
        sample : mapping of str to float
            Time ``t`` in s, inputs, and the measured state unless it is missing, SI. An input that is missing keeps its value.

        Returns
        -------
        RecursiveEstimate

        Raises
        ------
        UsageError
            If the sample has no time.
        UnstatedInputError
            If the first sample lacks an input that declares no default.
        """
        reader, places, held = self._reader, self.design.layout.control, self.design.layout.carried["u"]
        elapsed = reader.elapsed(sample)
        if elapsed is None:
            return self._estimate(reader.why_refused(sample))
        inputs, _ = reader.inputs(sample, None if self._stepper is None else self._stepper.z[held])
        if self._stepper is None:
            reader.begin()
        z, there = np.zeros(1), np.zeros(1)
        reader.shown(sample, z, there)
        if self._stepper is None:
            self._stepper = self._first_stepper(self.design.carried(float(z[0]), inputs, self._level))
        control = self._stepper.control
        for interval, between, is_sample in reader.bridge(elapsed, self._stepper.z[held].copy(), inputs):
            control[places["u"]] = between
            control[places["T"]] = interval
            control[places["z"]] = z * is_sample
            control[places["there"]] = there * is_sample
            self._stepper.step()
        return self._estimate("")

    def _first_stepper(self, carried: np.ndarray) -> Stepper:
        return self.design.loop.one_at_a_time(carried, self.design.constants(self._level))

    @property
    def estimate(self) -> RecursiveEstimate | None:
        """The estimate after the last sample; None before the first."""
        return None if self._stepper is None else self._estimate("")

    def _estimate(self, refused: str) -> RecursiveEstimate:
        assert self._stepper is not None
        design, layout, z = self.design, self.design.layout, self._stepper.z
        covariance = unpacked(z[layout.carried["joint"]][None, :], layout.n + 1)[0, 1:, 1:]
        count = float(z[layout.carried["count"]][0])
        if not design.method.uses_noise_level and count >= FEW * layout.n:
            covariance = covariance * (float(z[layout.carried["nis"]][0]) / count)
        theta = np.array(z[layout.carried["theta"]])
        return RecursiveEstimate(self.t or 0.0, float(z[layout.carried["y"]][0]), theta, covariance, refused, design)

    def save(self, path: str | Path) -> None:
        """Write the state to a file, whole or not at all; every number exactly.

        Parameters
        ----------
        path : str or Path
            A JSON file; one that exists is replaced.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        if self._stepper is None:
            raise UsageError("a recursion without a sample has no state to save.")
        state = self._reader.state | {"carried": [float(v).hex() for v in self._stepper.z]}
        write_state(Path(path), self.design.fingerprint, self.design.model.name, state)

    def load(self, path: str | Path) -> None:
        """Go on from a state as `save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to another recursion.
        """
        path, layout = Path(path), self.design.layout
        state = read_state(path, self.design.fingerprint, "recursion")
        with examined(path, "recursion"):
            check_clock(state, self.design.instruments.rates)
            carried = numbers(state, "carried", total(layout.carried))
            check_finite("carried", carried)
            for name in ("P_y", "phase", "waited", "age", "nis", "count"):
                check_finite(name, carried[layout.carried[name]], low=0.0)
            check_covariance(unpacked(carried[layout.carried["joint"]][None, :], layout.n + 1)[0])
        self._reader.state = state
        self._stepper = self._first_stepper(carried)
