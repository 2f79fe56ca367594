"""The correlation of the coefficients of a parameter set, and the speeds and amplitudes they were identified at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from shipid.declaration.units import factor, to_si
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ParameterSetError, UnitError

#: The table of a parameter set in which it stands, one inner table a model.
IDENTIFIED = "identified"
_KEYS = {"names", "correlation", "speeds", "speed_unit", "speed", "rudder", "rate", "drift", "draught", "displacement"}
#: What the trials say in one number, their speed before the manoeuvre and largest amplitudes: entry, SI unit, unit that is written.
_SINGLE = (("speed", "m/s", "m/s"), ("rudder", "rad", "deg"), ("rate", "rad/s", "deg/s"), ("drift", "rad", "deg"))
#: What says a loading of the trials, lowest and highest: entry, SI unit, unit that is written.
_LOADINGS = (("draught", "m", "m"), ("displacement", "kg", "t"))
#: A value of each unit, for messages.
_EXAMPLES = {"m/s": "8 m/s", "rad": "20 deg", "rad/s": "1 deg/s"}


@dataclass(frozen=True)
class Joint:
    """Correlation of identified coefficients; their standard deviations stand beside their values.

    Attributes
    ----------
    names : tuple of str
        The coefficients.
    correlation : tuple of tuple of float
        Their correlation matrix, in that order.
    speeds : tuple of float or None
        Lowest and highest speed in m/s that the trials went through.
    speed : float or None
        Mean speed before the manoeuvre of the trials in m/s, to which coefficients with a dimension belong.
    rudder, rate, drift : float or None
        Largest rudder angle in rad, rate of turn in rad/s and drift angle in rad of the trials, where they are known.
    loadings : mapping of str to tuple of float
        Lowest and highest ``draught`` in m, or ``displacement`` in kg, of the trials, for coefficients that change with it.
    """

    names: tuple[str, ...]
    correlation: tuple[tuple[float, ...], ...]
    speeds: tuple[float, float] | None = None
    speed: float | None = None
    rudder: float | None = None
    rate: float | None = None
    drift: float | None = None
    loadings: Mapping[str, tuple[float, float]] = field(default_factory=dict, hash=False)

    @property
    def belongs_to(self) -> float | None:
        """The speed in m/s that coefficients with a dimension belong to: `speed`, or the middle of `speeds` where only those are known."""
        return self.speed if self.speed is not None or self.speeds is None else 0.5 * sum(self.speeds)


def read_joint(where: str, raw: Plain) -> dict[str, Joint]:
    """Return the entries of the table ``[identified.MODEL]``, by model.

    Parameters
    ----------
    where : str
        The file, for messages.
    raw : Plain
        What TOML made of the table.

    Raises
    ------
    ParameterSetError
        If it is not a correlation matrix, or the speeds are not two rising numbers.
    """
    if not isinstance(raw, Mapping) or not all(isinstance(v, Mapping) for v in raw.values()):
        raise ParameterSetError(f"{where}: '{IDENTIFIED}' holds one table for each model, as in [{IDENTIFIED}.nomoto].")
    return {model: _one(f"{where}, [{IDENTIFIED}.{model}]", content) for model, content in raw.items()}


def _one(where: str, raw: Mapping[str, Plain]) -> Joint:
    unknown = sorted(set(raw) - _KEYS)
    if unknown:
        raise ParameterSetError(
            f"{where} has an entry '{unknown[0]}' it does not know. Known: {', '.join(sorted(_KEYS))}."
        )
    names, matrix = raw.get("names", []), raw.get("correlation", [])
    square = isinstance(names, list) and isinstance(matrix, list) and len(matrix) == len(names) and all(
        isinstance(row, list) and len(row) == len(names) and all(_is_correlation(v) for v in row) for row in matrix
    )  # fmt: skip
    if not square or not all(isinstance(n, str) for n in names):
        raise ParameterSetError(
            f"{where}: the correlation is not a square matrix of numbers from -1 to 1 with one row for each name."
        )
    pairs = [(matrix[i][j], 1 if i == j else matrix[j][i]) for i in range(len(names)) for j in range(i + 1)]
    if any(abs(a - b) > 1e-6 for a, b in pairs):
        raise ParameterSetError(f"{where}: the correlation is not symmetric with ones on its diagonal.")
    speeds = raw.get("speeds")
    if speeds is not None:
        try:
            low, high = (to_si((v, raw.get("speed_unit", "m/s")), "m/s", f"speed in {where}") for v in speeds)
        except (TypeError, ValueError, OverflowError, AttributeError, UnitError):
            raise ParameterSetError(
                f"{where}: speeds are two numbers, the lowest and the highest, in a unit of speed."
            ) from None
        if not 0 <= low <= high:  # a ship that lies still has been identified too
            raise ParameterSetError(
                f"{where}: speeds are {speeds}, and have to be zero or greater than zero and rising."
            )
        speeds = (low, high)
    reached = {name: _single(where, name, raw.get(name), unit) for name, unit, _ in _SINGLE}
    loadings = {name: _pair(where, name, raw[name], unit) for name, unit, _ in _LOADINGS if name in raw}
    return Joint(
        tuple(names), tuple(tuple(float(v) for v in row) for row in matrix), speeds, **reached, loadings=loadings
    )


def _pair(where: str, name: str, texts: Plain, unit: str) -> tuple[float, float]:
    try:
        low, high = (to_si(v, unit, f"'{name}' in {where}") for v in texts)
    except (TypeError, ValueError, AttributeError, UnitError):
        low, high = 0.0, -1.0
    if not 0 < low <= high < math.inf:
        raise ParameterSetError(
            f"{where}: '{name}' is {texts!r}, and has to be two rising numbers with their units, the lowest and the highest."
        )
    return low, high


def _single(where: str, name: str, text: Plain, unit: str) -> float | None:
    if text is None:
        return None
    if not isinstance(text, str):
        raise ParameterSetError(f"{where}: '{name}' is {text!r}. Write it with its unit, as in '{_EXAMPLES[unit]}'.")
    try:
        value = to_si(text, unit, f"'{name}' in {where}")
    except UnitError as error:
        raise ParameterSetError(str(error)) from None
    if not 0 <= value < math.inf:
        raise ParameterSetError(f"{where}: '{name}' is {text}, and has to be zero or greater.")
    return value


def _is_correlation(value: Plain) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= 1


def seen_by(known: Joint | None) -> dict[str, Plain]:
    """Return the speeds and the largest amplitudes of the trials behind coefficients, with SI units; null where not known.

    Parameters
    ----------
    known : Joint or None
        What a set says of the origin of its coefficients.
    """
    speeds = None if known is None or known.speeds is None else list(known.speeds)
    reached = {n: {"value": getattr(known, n, None), "unit": unit} for n, unit, _ in _SINGLE}
    return {"speeds": {"value": speeds, "unit": "m/s"}, **reached}


def joint_table(joint: Mapping[str, Joint]) -> dict[str, Plain]:
    """Return the table of TOML that `read_joint` reads, under its name; empty where no correlation is known.

    Parameters
    ----------
    joint : mapping of str to Joint
        By model.

    Returns
    -------
    dict of str to Plain
    """
    tables: dict[str, Plain] = {}
    for model, one in joint.items():
        rows = [[float(f"{v:.6g}") for v in row] for row in one.correlation]
        speeds = {} if one.speeds is None else {"speeds": list(one.speeds), "speed_unit": "m/s"}
        reached = {n: getattr(one, n) for n, *_ in _SINGLE}
        written = {
            n: f"{reached[n] * factor(unit, shown):.4g} {shown}" for n, unit, shown in _SINGLE if reached[n] is not None
        }
        loaded = {
            n: [f"{v * factor(unit, shown):.4g} {shown}" for v in span]
            for n, unit, shown in _LOADINGS
            if (span := one.loadings.get(n)) is not None
        }
        tables[model] = {"names": list(one.names), "correlation": rows, **speeds, **written, **loaded}
    return {IDENTIFIED: tables} if tables else {}
