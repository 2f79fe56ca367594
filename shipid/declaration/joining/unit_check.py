"""The unit check: every equation is run once over quantities with units.

The numbers are arbitrary (neither 0 nor 1, so that no division or root is special); only the units matter.
An error names the model, the equation, both units, the file and the line.
"""

from __future__ import annotations

import traceback
import types
from collections.abc import Mapping
from math import isfinite

from shipid.declaration import units
from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Entry, Evaluation, Model
from shipid.declaration.quantity import COMPUTED
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.aliases import Expression, PintUnit
from shipid.foundation.errors import DeclarationError, ShipidError, UnitError

_SOME_NUMBER = 0.7311
#: So many sets of numbers are tried for a finite result.
_ATTEMPTS = 8
#: Two values that differ by no more, relative to their size, are the same.
_SAME = 1e-9


def check_units(model: Model) -> None:
    """Run every equation of a model over quantities with units.

    Parameters
    ----------
    model : Model
        The model to check.

    Raises
    ------
    UnitError
        If terms of an equation do not match, its result does not have the unit of what it defines, or a shaft speed is declared
        in radians.
    DeclarationError
        If an equation raises, reads what is not declared, or derived quantities form a circle.
    """
    import numpy as np

    for entry in model.entries.values():
        _check_field(model, entry)
        _check_bounds(model, entry)
    quantity = units.registry().Quantity

    def value(name: str, unit: str) -> Expression:
        return quantity(np.float64(_SOME_NUMBER), units.unit(unit))

    plain = {n: value(n, e.unit) for n, e in model.entries.items() if e.quantity.kind not in COMPUTED}
    evaluation = _Checked(model, plain | {SAMPLING_INTERVAL: value(SAMPLING_INTERVAL, "s")})
    with np.errstate(all="ignore"):
        for entry in model.entries.values():
            if entry.equation is None:
                continue
            if entry.equation.kind == "equals":
                evaluation[entry.name]
            else:
                evaluation.equation(entry)


def _check_field(model: Model, entry: Entry) -> None:
    """A shaft speed is counted, as records count it: samples go into the model as they are."""
    if entry.name not in FIELDS or entry.quantity.kind in ("parameter", "constant"):
        return
    if units.counts_revolutions(FIELDS[entry.name].unit) and units.angle_exponent(entry.unit):
        raise UnitError(
            f"model {model.name}: {entry.owner.__name__} declares '{entry.name}' in {units.pretty(entry.unit)}, and in records "
            f"'{entry.name}' is {FIELDS[entry.name].meaning} [{units.pretty(FIELDS[entry.name].unit)}]. Declare it in that unit, "
            "or give the quantity another name."
        )


def _check_bounds(model: Model, entry: Entry) -> None:
    """A search begins within its bounds, and the lower one is below the upper one."""
    said = {w: v for w in ("start", "low", "high") if (v := entry.number(w)) is not None}
    within = [said[w] for w in ("low", "start", "high") if w in said]
    good = all(isfinite(v) or (w != "start" and v == v) for w, v in said.items()) and within == sorted(within)
    if not good or ("low" in said and said["low"] == said.get("high")):
        told = ", ".join(f"{w} {v:g}" for w, v in said.items())
        raise DeclarationError(
            f"model {model.name}: '{entry.name}' of {entry.owner.__name__} declares {told}: low has to be below high, and a start "
            "between them."
        )


class _Checked(Evaluation):
    """An evaluation over quantities with units that checks the unit of every result."""

    def __init__(self, model: Model, values: Mapping[str, Expression]) -> None:
        super().__init__(model, values)
        self._plain: dict[str, float] = {}

    def plain(self, name: str) -> Expression:
        """Return a value as a plain SI number.

        Parameters
        ----------
        name : str
            A quantity whose value is known by now.
        """
        import numpy as np

        if name not in self._plain:
            self._plain[name] = float(self[name].to_base_units().magnitude)
        return np.float64(self._plain[name])

    def equation(self, entry: Entry) -> Expression:
        equation = entry.equation
        assert equation is not None
        where = f"model {self._model.name}, equation {entry.owner.__name__}.{equation.name}"
        wanted = f"({entry.unit})/s" if equation.kind == "rate" else entry.unit
        try:
            result = super().equation(entry)
        except UnitError:
            raise
        except ShipidError as error:
            raise _named(error, where, user_line(error, equation.function.__code__)) from None
        except (Exception, SystemExit) as error:
            place = user_line(error, equation.function.__code__)
            if (words := _in_words(error)) is not None:
                raise UnitError(f"{where} ({place}): the units do not match: {words}.") from None
            raise DeclarationError(
                f"{where} ({place}) raises {type(error).__name__}: {str(error).rstrip('. ')}. An equation has to run with any "
                "numbers: correct the line. What it may use is arithmetic, abs, NumPy's elementwise functions, np.where and np.interp, "
                "each of single quantities and not of arrays."
            ) from error
        checked = _checked(result, wanted, where, equation.place, entry)
        self._same_without_units(entry, checked, where)
        _finite_somewhere(entry, where)
        return checked

    def _same_without_units(self, entry: Entry, checked: Expression, where: str) -> None:
        """Refuse what converts units by itself: an equation runs over plain SI numbers, and would give another number there."""
        import numpy as np

        assert entry.equation is not None
        try:
            found = float(np.asarray(checked.magnitude, dtype=float).item())
            plain = float(np.asarray(entry.value(self.plain), dtype=float).item())
        except Exception:  # it needs the units; over symbols it fails with its own words
            return
        if np.isfinite([plain, found]).all() and abs(plain - found) > _SAME * max(abs(plain), abs(found)):
            raise UnitError(
                f"{where} ({entry.equation.place}) gives {found:.4g} with units and {plain:.4g} over plain SI numbers, which it is "
                "run over: it converts a unit (np.deg2rad, math.degrees). Angles are in rad inside: leave the conversion out."
            )


def _finite_somewhere(entry: Entry, where: str) -> None:
    """Refuse an equation that divides by zero, or calculates with no number, whatever is put into it."""
    import numpy as np

    assert entry.equation is not None
    for attempt in range(_ATTEMPTS):
        random = np.random.default_rng(attempt)
        # Positive first, as speeds and lengths are; then of both signs.
        low = 0.1 if attempt < _ATTEMPTS // 2 else -2.0
        try:
            found = np.asarray(entry.value(lambda _: np.float64(random.uniform(low, 2.0))), dtype=float)  # noqa: B023
        except Exception:  # it needs the units; over symbols it fails with its own words
            return
        if np.isfinite(found).all():
            return
    raise DeclarationError(
        f"{where} ({entry.equation.place}) gives no finite number, whatever is put into it: it divides by zero, or has NaN or "
        "infinity in it."
    )


def _named(error: ShipidError, where: str, place: str) -> ShipidError:
    """The same error with the equation and its line before it, once."""
    text = str(error)
    return error if text.startswith("model ") else DeclarationError(f"{where} ({place}): {text}")


def _checked(result: Expression, wanted: str, where: str, place: str, entry: Entry) -> Expression:
    ureg = units.registry()
    unit = units.unit(wanted)
    if type(result).__name__ in ("bool", "bool_"):  # of Python, or of NumPy, which is not imported here
        raise DeclarationError(
            f"{where} ({place}) gives true or false, and {entry.name} is a number: choose one by np.where(condition, a, b)."
        )
    if not hasattr(result, "dimensionality"):
        if result is None:
            raise DeclarationError(f"{where} ({place}) returns nothing: end it with 'return ...'.")
        if isinstance(result, (str, tuple, list, set, dict)) or getattr(result, "size", 1) != 1:
            raise DeclarationError(
                f"{where} ({place}) returns a {type(result).__name__}, and {entry.name} is one number: return one value."
            )
        # A bare zero is zero in any unit; any other bare number is a pure number.
        result = ureg.Quantity(result, unit if result == 0 else ureg.Unit(""))
    if getattr(result.magnitude, "size", 1) != 1:
        raise DeclarationError(
            f"{where} ({place}) returns {result.magnitude.size} numbers, and {entry.name} is one: return one value."
        )
    if result.dimensionality != unit.dimensionality:
        left = {"rate": f"d{entry.name}/dt", "next": f"the next {entry.name}"}.get(_kind(entry), entry.name)
        raise UnitError(
            f"{where} ({place}): {left} needs {_unit_words(unit)}, and the equation gives {_unit_words(result.units)}."
        )
    return result.to_base_units()


def _kind(entry: Entry) -> str:
    return entry.equation.kind if entry.equation else ""


def _unit_words(unit: Expression) -> str:
    return _shown(units.registry().Quantity(1, unit).to_base_units().units)


def _shown(unit: PintUnit) -> str:
    """A unit of pint, with the dot of the other messages: pint has another one, which has changed."""
    return f"{unit:~P}".replace("⋅", "·") or "1"


def _in_words(error: Exception | SystemExit) -> str | None:
    """Which units do not match, or None where the error is another one. Pint's own words change with its version."""
    first, second = getattr(error, "units1", None), getattr(error, "units2", None)
    if first is not None and second is not None:
        return f"{_either(first)} against {_either(second)}"
    if isinstance(error, ValueError) and _raised_in(error).startswith("pint."):
        return "a quantity with a unit is compared with a number that has none"
    if type(error).__module__.startswith("pint"):
        return str(error)
    return None


def _raised_in(error: Exception) -> str:
    """The module of the innermost frame of a traceback."""
    frames = [frame for frame, _ in traceback.walk_tb(error.__traceback__)]
    return str(frames[-1].f_globals.get("__name__", "")) if frames else ""


def _either(unit: Expression) -> str:
    try:
        return _shown(units.registry().Unit(unit))
    except Exception:  # pint hands over text such as "a dimensionless quantity" at times
        return str(unit)


def user_line(error: Exception | SystemExit, code: types.CodeType) -> str:
    """Return the deepest line of the user's own file in a traceback: ``file:line``.

    Parameters
    ----------
    error : Exception
        As it was raised in an equation.
    code : types.CodeType
        Of the equation.
    """
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == code.co_filename]
    line = frames[-1].lineno if frames else code.co_firstlineno
    return f"{code.co_filename}:{line}"
