"""What a record says of the noise of its filter, and of the coefficients under that noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

from shipid.declaration.units import factor, pretty
from shipid.estimation.standing import DETERMINED, Standing
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief, uncertain_text
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import interval_95

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Judged:
    """A coefficient under the learnt noise, and without noise that drives the ship; natural logarithms where its own is estimated.

    Attributes
    ----------
    unit : str
        Its unit.
    value : float
        Its most probable value, SI.
    std : float
        Its standard deviation if the innovations were white.
    widening : float
        Standard deviation under the innovations as they are, over the one if they were white; 1 or more.
    simulated : float or None
        Its value by output error, where all that is not explained is sensor noise; None where that was not worked out.
    simulated_std : float or None
        Standard deviation of that one, under the residuals as they are.
    simulated_ends : tuple of float, or None
        95 % interval of that one, where it is not the normal one.
    """

    unit: str
    value: float
    std: float
    widening: float
    simulated: float | None = None
    simulated_std: float | None = None
    simulated_ends: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class BatchEstimate:
    """What identification makes of the same record.

    Attributes
    ----------
    method : str
        Its method, in words: ``"output error"``.
    values : mapping of str to tuple
        Value, standard deviation and 95 % interval of each coefficient, SI.
    at_bound : tuple of str
        Coefficients that ended at a bound: it does not determine these, and the others only as they are with these.
    undecided : mapping of str to str
        Coefficients that have other values where the record is fitted as well, and those in words.
    """

    method: str
    values: Mapping[str, tuple[float, float, tuple[float, float]]]
    at_bound: tuple[str, ...] = ()
    undecided: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class BiasStanding(Result):
    """What a record says of the constant bias of an input.

    Attributes
    ----------
    std : float
        Its standard deviation, SI.
    standing, why : str
        See `shipid.estimation.standing`.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"std": "SI"}

    std: float
    standing: Standing
    why: str


@dataclass(frozen=True, repr=False)
class RecordLevels(Result):
    """Noise levels of a filter, SI, and where each comes from.

    Attributes
    ----------
    sensors : mapping of str to float
        Standard deviation of one sample of each sensor.
    noise : mapping of str to float
        Level of what drives each state or input.
    learnt : tuple of str
        ``sensor:NAME`` and ``noise:NAME`` that come from the record; the others were given or declared.
    biases : mapping of str to float
        Constant bias of each input that may have one, SI: it is added to what the record holds.
    bias_standings : mapping of str to BiasStanding
        How well each bias is known.
    coefficients : mapping of str to Judged
        The estimated coefficients that are constants.
    converged : bool
        Whether the search ended at a maximum.
    evaluations : int
        How often the record was run through.
    units : mapping of str to tuple of str
        Unit of each level and of each ``bias:NAME``, and the one it is shown in, by key.
    method : str
        How `Judged.simulated` was found, in words.
    at_bound : tuple of str
        Coefficients that ended at a bound there, so that none is judged beside it.
    undecided : mapping of str to str
        Coefficients that have other values where the record is fitted as well, and those in words.
    """

    sensors: Mapping[str, float]
    noise: Mapping[str, float]
    learnt: tuple[str, ...]
    biases: Mapping[str, float]
    coefficients: Mapping[str, Judged]
    converged: bool
    evaluations: int
    units: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    bias_standings: Mapping[str, BiasStanding] = field(default_factory=dict)
    method: str = "output error"
    at_bound: tuple[str, ...] = ()
    undecided: Mapping[str, str] = field(default_factory=dict)

    def beside(self, batch: BatchEstimate) -> RecordLevels:
        """Return the same levels with the coefficients of an identification beside them, where it has all of them.

        Parameters
        ----------
        batch : BatchEstimate
            The identification.
        """
        if batch.at_bound:
            alone = {n: replace(c, simulated=None, simulated_std=None) for n, c in self.coefficients.items()}
            return replace(self, coefficients=alone, method=batch.method, at_bound=batch.at_bound)
        if not set(self.simulated) <= set(batch.values):
            return self
        known = {
            n: replace(c, simulated=v[0], simulated_std=v[1], simulated_ends=v[2])
            for n, c in self.coefficients.items()
            if (v := batch.values.get(n)) is not None
        }
        return replace(
            self, coefficients={**self.coefficients, **known}, method=batch.method, undecided=batch.undecided
        )

    @property
    def simulated(self) -> dict[str, tuple[float, float]]:
        """Value and standard deviation of each coefficient by output error, SI, where it was worked out."""
        return {
            n: (c.simulated, c.simulated_std)
            for n, c in self.coefficients.items()
            if c.simulated is not None and c.simulated_std is not None
        }

    def level(self, key: str) -> float:
        """Return a level, SI.

        Parameters
        ----------
        key : str
            ``sensor:NAME`` or ``noise:NAME``.
        """
        kind, _, name = key.partition(":")
        return (self.sensors if kind == "sensor" else self.noise)[name]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {
            "noise_levels": {
                key: {"value": self.level(key), "unit": unit, "from": "record" if key in self.learnt else "given"}
                for key, (unit, _) in self.units.items()
                if not key.startswith("bias:")
            },
            "biases": {n: self._bias_to_dict(n, v) for n, v in self.biases.items()},
            self.method.replace(" ", "_"): {
                n: {"value": v, "std": s, "unit": self.coefficients[n].unit} for n, (v, s) in self.simulated.items()
            },
        }

    @property
    def words(self) -> tuple[str, ...]:
        """What comes from the record, a line each."""
        said = [f"noise from the record: {self}"] if self.learnt else []
        if self.biases:
            biases = (self._bias_text(n, v) for n, v in self.biases.items())
            said.append(f"added to inputs, from the record: {', '.join(biases)}")
        if self.simulated:
            values = (
                f"{n} {uncertain_text(v, s)} {pretty(self.coefficients[n].unit)}".removesuffix(" 1")
                for n, (v, s) in self.simulated.items()
            )
            said.append(f"{self.method} on the same record: {', '.join(values)}")
        return tuple(said)

    def _bias_to_dict(self, name: str, value: float) -> dict[str, Plain]:
        known = self.bias_standings.get(name)
        told: dict[str, Plain] = {"value": value, "unit": self.units[f"bias:{name}"][0]}
        if known is not None:
            ends = list(interval_95(value, known.std))
            told |= {"std": known.std, "interval_95": ends, "standing": known.standing, "why": known.why}
        return told

    def _bias_text(self, name: str, value: float) -> str:
        known = self.bias_standings.get(name)
        if known is None:
            return self._shown(f"bias:{name}", value)
        unit, shown = self.units[f"bias:{name}"]
        size = factor(unit, shown)
        text = f"{name} {uncertain_text(value * size, known.std * size)} {pretty(shown)}"
        return text if known.standing == DETERMINED else f"{text} ({known.standing}: {known.why.rstrip('.')})"

    def _shown(self, key: str, value: float) -> str:
        unit, shown = self.units[key]
        return f"{key.partition(':')[2]} {brief(value * factor(unit, shown), 3)} {pretty(shown)}"

    def __str__(self) -> str:
        said = []
        for key in self.learnt:
            level = self._shown(key, self.level(key))
            said.append(level if key.startswith("sensor:") else f"noise that drives {level}")
        return ", ".join(said)

    def to_frame(self) -> pd.DataFrame:
        """Return the noise levels as a pandas table, SI: a sensor's of one sample, a driving noise as it was declared."""
        return table(({"name": n, **level} for n, level in self.to_dict()["noise_levels"].items()), "name")

    def text(self) -> str:
        """Return the levels in one line of text."""
        return f"noise levels: {self}"
