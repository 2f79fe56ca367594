"""What all results of a filter have in common: quantities with standard deviations, by name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import shown_estimate
from shipid.estimation.records.arrangement import Arrangement
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import moment
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd

Values = TypeVar("Values", float, np.ndarray)


class NamedQuantities(ABC, Generic[Values]):
    """Quantities of a model with standard deviations: numbers at one sample, arrays along a record."""

    @abstractmethod
    def quantity(self, name: str) -> tuple[Values, Values]:
        """Return a quantity and its standard deviation, SI; shapes (N,) along a record.

        Parameters
        ----------
        name : str
            Of the quantity.

        Raises
        ------
        UnknownNameError
            If there is no such quantity.
        """

    def __getitem__(self, name: str) -> Values:
        """Return a quantity, SI; shape (N,) along a record."""
        return self.quantity(name)[0]

    def std_of(self, name: str) -> Values:
        """Return the standard deviation of a quantity, SI; shape (N,) along a record.

        Parameters
        ----------
        name : str
            See `quantity`.
        """
        return self.quantity(name)[1]


class SampleEstimate(NamedQuantities[float], Result):
    """The estimate after a sample: a table of its quantities, and lines of text."""

    t: float

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """The quantities that are shown."""

    @property
    @abstractmethod
    def model(self) -> Model:
        """The model whose quantities they are."""

    @property
    def estimates(self) -> dict[str, dict[str, Plain]]:
        """Value, unit and standard deviation by name, SI; None where a number is not finite."""
        return {
            n: {"value": plain(self[n]), "unit": self.model[n].unit, "std": plain(self.std_of(n))} for n in self.names
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        """What there is to say beside the estimates, in lines."""
        return ()

    def to_frame(self) -> pd.DataFrame:
        """Return the estimates as a pandas table, SI."""
        return table(({"name": n, **e} for n, e in self.estimates.items()), "name")

    def text(self) -> str:
        """Return the estimate in lines of text."""
        shown = (f"  {n:<12s} {shown_estimate(e['value'], e['std'], n, e['unit'])}" for n, e in self.estimates.items())
        return "\n".join([f"estimate at {moment(self.t)} s", *shown, *(f"  {line}" for line in self.remarks)])


class RecordRun(NamedQuantities[np.ndarray]):
    """What a filter made of a record, row by row; N samples."""

    arranged: Arrangement
    out: np.ndarray

    @property
    @abstractmethod
    def places(self) -> Mapping[str, slice]:
        """Where each part stands among the outputs of a row."""

    def rows(self, name: str) -> np.ndarray:
        """Return a part of the outputs, at the samples of the record, shape (N, part).

        Parameters
        ----------
        name : str
            A key of `places`.
        """
        return np.asarray(self.out[self.arranged.shown][:, self.places[name]])

    @property
    def t(self) -> np.ndarray:
        """Times of the samples that are used in s, shape (N,)."""
        return np.asarray(self.arranged.t[self.arranged.shown])

    @property
    def x(self) -> np.ndarray:
        """Estimates of the states after each sample, SI, shape (N, states)."""
        return self.rows("x")

    @property
    def log_likelihood(self) -> float:
        """Logarithm of the likelihood of the samples used, given the model and the noise levels."""
        return float(self.out[:, self.places["ll"]].sum())
