"""What a record says of the noise of its filter, and of the coefficients under that noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from shipid.declaration.units import factor, pretty
from shipid.foundation.aliases import Plain


@dataclass(frozen=True)
class Judged:
    """A coefficient under the learnt noise, and without noise that drives the ship; natural logarithms where its own is estimated.

    Attributes
    ----------
    value : float
        Its most probable value, SI.
    widening : float
        Standard deviation under the innovations as they are, over the one if they were white; 1 or more.
    simulated : float or None
        Its value by output error, where all that is not explained is sensor noise; None where that was not worked out.
    simulated_std : float or None
        Standard deviation of that one, under the residuals as they are.
    """

    value: float
    widening: float
    simulated: float | None = None
    simulated_std: float | None = None


@dataclass(frozen=True)
class RecordLevels:
    """Noise levels of a filter, SI, and where each comes from.

    Attributes
    ----------
    sensors : mapping of str to float
        Standard deviation of one sample of each sensor.
    noise : mapping of str to float
        Level of what drives each state or input.
    learnt : tuple of str
        ``sensor:NAME`` and ``noise:NAME`` that come from the record; the others were given or declared.
    coefficients : mapping of str to Judged
        The estimated coefficients that are constants.
    converged : bool
        Whether the search ended at a maximum.
    evaluations : int
        How often the record was run through.
    units : mapping of str to tuple of str
        Unit of each level, and the one it is shown in, by key.
    """

    sensors: Mapping[str, float]
    noise: Mapping[str, float]
    learnt: tuple[str, ...]
    coefficients: Mapping[str, Judged]
    converged: bool
    evaluations: int
    units: Mapping[str, tuple[str, str]] = field(default_factory=dict)

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
            key: {"value": self.level(key), "unit": unit, "from": "record" if key in self.learnt else "given"}
            for key, (unit, _) in self.units.items()
        }

    def __str__(self) -> str:
        said = []
        for key in self.learnt:
            kind, _, name = key.partition(":")
            unit, shown = self.units[key]
            level = f"{name} {self.level(key) * factor(unit, shown):.3g} {pretty(shown)}"
            said.append(level if kind == "sensor" else f"noise that drives {level}")
        return ", ".join(said)
