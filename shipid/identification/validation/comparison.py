"""A trial beside its prediction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import FIELDS, shown_error
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import quantity
from shipid.foundation.result import Result
from shipid.generation.departure import Departure
from shipid.identification.validation.trial_measures import TrialMeasures
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Result):
    """A trial beside its prediction.

    Attributes
    ----------
    trial : Trial
        The record.
    predicted : mapping of str to ndarray
        Predicted signals and track, SI, at the samples of the trial.
    rmse : mapping of str to float
        Root-mean-square error of each signal, SI.
    measures : TrialMeasures
        The manoeuvre of the trial, measured.
    refitted : mapping of str to float
        Errors with rudder bias and initial state refitted on this record, SI; empty for a fitted trial.
    warm : mapping of str to float
        Errors with rudder bias and initial state fitted to the record up to the first reversal of the rudder, and counted on
        the rest, SI; empty for a fitted trial and where the rudder is never reversed.
    biases : mapping of str to float
        Bias of each input that was used, SI: the rudder, the speed before the manoeuvre, the current.
    bias_std : float or None
        Standard deviation of the rudder bias that was used, in rad; None where it is not estimated.
    refitted_bias, refitted_bias_std : float or None
        Rudder bias refitted on this record, and its standard deviation, in rad.
    overshoots, predicted_overshoots : tuple of float
        Overshoot angles in rad, measured and predicted with the recorded rudder.
    predicted_circle : TurningCircle or None
        The turning circle read off the prediction with the recorded rudder; None where the trial is none, or the model runs
        away.
    initial : mapping of str to float
        Initial states that were used.
    samples : mapping of str to tuple of int
        Samples of each fitted signal that are there, and how many there might be.
    notes : tuple of str
        What was filled and left out of the trial because of holes in what drives the model.
    departure : Departure or None
        Where the prediction leaves the range in which the model is valid; it has no overshoots and no circle then.
    """

    trial: Trial
    predicted: Mapping[str, np.ndarray]
    rmse: Mapping[str, float]
    measures: TrialMeasures
    refitted: Mapping[str, float] = field(default_factory=dict)
    warm: Mapping[str, float] = field(default_factory=dict)
    biases: Mapping[str, float] = field(default_factory=dict)
    bias_std: float | None = None
    refitted_bias: float | None = None
    refitted_bias_std: float | None = None
    overshoots: tuple[float, ...] = ()
    predicted_overshoots: tuple[float | None, ...] = ()
    predicted_circle: TurningCircle | None = None
    initial: Mapping[str, float] = field(default_factory=dict)
    samples: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    departure: Departure | None = None

    @property
    def not_sailed(self) -> Notice | None:
        """What there is to say of a prediction that ends on a floor or guard of the model."""
        if self.departure is None:
            return None
        name = self.trial.name
        return Notice(f"the prediction of {name} is {self.departure}", "not-sailed", serious=True, trial=name)

    @property
    def whole(self) -> bool:
        """Whether no sample is missing."""
        return not self.notes and all(there == possible for there, possible in self.samples.values())

    @property
    def fit_percent(self) -> dict[str, float]:
        """How much of each measured signal's variation is explained, in percent: 100 (1 - rms error / standard deviation).

        100 is a perfect prediction, 0 one as good as the mean of the signal, and below it is worse (Ljung 1999, section 16.4).
        """
        spread = {s: float(np.nanstd(self.trial[s])) for s in self.rmse if self.trial.has(s)}
        with np.errstate(over="ignore", invalid="ignore"):
            return {s: 100.0 * (1.0 - self.rmse[s] / v) for s, v in spread.items() if v > 0}

    @property
    def bias(self) -> float:
        """Rudder bias in rad that was used."""
        return self.biases.get("delta", 0.0)

    @property
    def told_bias(self) -> dict[str, Plain]:
        """The rudder bias that was used, for JSON: value, unit and standard deviation."""
        return {**quantity(self.bias, "rad"), "std": self.bias_std}

    @property
    def told_refitted_bias(self) -> dict[str, Plain]:
        """The rudder bias refitted on this record, for JSON."""
        return {**quantity(self.refitted_bias, "rad"), "std": self.refitted_bias_std}

    def to_frame(self) -> pd.DataFrame:
        """Return measured and predicted signals against time as a pandas table, SI, units in the headers where they are known."""
        import pandas as pd

        columns = {"t [s]": self.trial["t"]}
        for name, values in self.predicted.items():
            unit = f" [{inside}]" if (inside := self.unit(name)) else ""
            columns |= {f"{name}{unit}": self.trial[name]} if self.trial.has(name) else {}
            columns[f"predicted_{name}{unit}"] = values
        return pd.DataFrame(columns)

    def unit(self, name: str) -> str:
        """Return the unit of a signal inside; empty where the record does not hold it.

        Parameters
        ----------
        name : str
            The signal.
        """
        return FIELDS[name].unit if name in FIELDS else self.trial.units.get(name, "")

    def text(self) -> str:
        """Return the comparison in lines of text."""
        errors = [f"  rms error of {n:<8s} {shown_error(v, n, self.unit(n))}" for n, v in self.rmse.items()]
        left = [] if self.departure is None else [f"  {self.departure}"]
        return "\n".join(
            [f"trial {self.trial.name} beside its prediction", *errors, *left, *(f"  {n}" for n in self.notes)]
        )
