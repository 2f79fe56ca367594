"""The equations of a model over CasADi symbols; what only numbers can do is refused with the line that does it."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import casadi as ca
import numpy as np

from shipid.declaration.joining.unit_check import user_line
from shipid.declaration.model import Entry, Evaluation, Model
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, ShipidError

#: Two values that differ by no more, relative to the larger, are the same.
_SAME = 1e-9
#: Tries: the sign of states and inputs.
_SIGNS = (1.0, -1.0)
_LOCK = threading.RLock()
_CHOICE = (
    "A symbol is neither true nor false: write np.where(condition, a, b) for 'if', np.maximum and np.minimum for max and min, "
    "np.logical_and and np.logical_or for 'and' and 'or', & and |"
)
_NUMBER = (
    "A symbol has no number: use NumPy's functions (np.sin for math.sin) and leave out float(), int() and np.array()"
)
_OTHER = "An equation has to run with CasADi symbols: use NumPy's elementwise functions, np.where and np.interp in it"


class SymbolicEvaluation(Evaluation):
    """An evaluation over symbols whose errors name the model, the equation, the line, and what to write instead."""

    def equation(self, entry: Entry) -> Expression:
        """Return the right-hand side of an entry's equation.

        Parameters
        ----------
        entry : Entry
            A quantity that an equation defines.

        Raises
        ------
        DeclarationError
            If the equation does what only numbers can do.
        """
        equation = entry.equation
        assert equation is not None
        try:
            with _no_symbol_is_a_number():
                return super().equation(entry)
        except ShipidError:
            raise
        except (Exception, SystemExit) as error:
            text = str(error)
            advice = (
                _CHOICE
                if "truth value" in text or "type(s) for &" in text or "type(s) for |" in text
                else _NUMBER
                if any(part in text for part in ("to_int", "with a sequence", _MARK))
                else _OTHER
            )
            said = (
                ""
                if _MARK in text or "truth value" in text
                else f" ({type(error).__name__}: {text.strip().splitlines()[0][:200]})"
            )
            raise DeclarationError(
                f"model {self._model.name}, equation {entry.owner.__name__}.{equation.name} "
                f"({user_line(error, equation.function.__code__)}) cannot be run with symbols{said}. {advice}."
            ) from None


_MARK = "a symbol has no number"


@contextmanager
def _no_symbol_is_a_number() -> Iterator[None]:
    """Refuse ``float(symbol)``, which CasADi answers with NaN: ``math.sin`` of a symbol would be NaN without a word."""
    with _LOCK:
        before = ca.SX.__float__

        def number(self: Expression) -> float:
            if not self.is_constant():
                raise TypeError(_MARK)
            return float(before(self))

        ca.SX.__float__ = number  # type: ignore[method-assign]
        try:
            yield
        finally:
            ca.SX.__float__ = before  # type: ignore[method-assign]


def check_numbers(model: Model) -> None:
    """Compare every equation over symbols with itself over numbers of both signs.

    A function of Python or NumPy that knows symbols may compute something else with them: the remainder of a negative number, a
    branch of ``try``, a random number, a function that takes a symbol for an object.

    Parameters
    ----------
    model : Model
        Its equations run over symbols.

    Raises
    ------
    DeclarationError
        With the model, the equation, both values, and what to write instead.
    """
    signed = frozenset((*model.states, *model.inputs))
    for entry in model.entries.values():
        if entry.equation is None:
            continue
        differs = _differs(entry, signed & _reads(entry))
        if differs is not None:
            place = user_line(Exception(), entry.equation.function.__code__)
            raise DeclarationError(
                f"model {model.name}, equation {entry.owner.__name__}.{entry.equation.name} ({place}) gives {differs[0]:.4g} over "
                f"numbers and {differs[1]:.4g} over symbols, which it is run over. Use NumPy's elementwise functions, np.where, and "
                "np.interp with rising places, and neither try, isinstance, round, % nor //."
            )


def _numbers(sign: float, signed: frozenset[str]) -> Callable[[str], float]:
    """Arbitrary numbers by name, of which some have a sign; neither 0 nor 1, and no two alike."""
    known: dict[str, float] = {}

    def number(name: str) -> float:
        known.setdefault(name, 0.35 + 0.6 * (0.618034 * (len(known) + 1) % 1))
        return np.float64(known[name] * (sign if name in signed else 1.0))

    return number


@functools.lru_cache(maxsize=4096)
def _reads(entry: Entry) -> frozenset[str]:
    read: set[str] = set()

    def lookup(name: str) -> float:
        read.add(name)
        return np.float64(0.7311)

    # An equation that fails over plain numbers has read what it fails with.
    with np.errstate(all="ignore"), suppress(Exception):
        entry.value(lookup)
    return frozenset(read)


@functools.lru_cache(maxsize=4096)
def _differs(entry: Entry, signed: frozenset[str]) -> tuple[float, float] | None:
    """Values over numbers and over symbols where they differ; None where both are the same, or one is no number."""
    symbols: dict[str, ca.SX] = {}

    def symbol(name: str) -> ca.SX:
        return symbols.setdefault(name, ca.SX.sym(name))

    with _no_symbol_is_a_number():
        expression = ca.SX(entry.value(symbol))
    if not expression.is_scalar():
        return None
    run = ca.Function("equation", list(symbols.values()), [expression])
    for sign in _SIGNS:
        number = _numbers(sign, signed)
        try:
            with np.errstate(all="ignore"):
                over_numbers = float(np.asarray(entry.value(number), dtype=float).item())
        except (TypeError, ValueError, ArithmeticError):  # what numbers of this sign cannot do says nothing of symbols
            continue
        over_symbols = float(run.call([number(n) for n in symbols])[0])
        size = max(abs(over_numbers), abs(over_symbols))
        if np.isfinite([over_numbers, over_symbols]).all() and abs(over_numbers - over_symbols) > _SAME * size:
            return over_numbers, over_symbols
    return None
