"""The equations of a model over CasADi symbols; what only numbers can do is refused with the line that does it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import casadi as ca

from shipid.declaration.joining.unit_check import user_line
from shipid.declaration.model import Entry, Evaluation
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, ShipidError

_LOCK = threading.RLock()
_CHOICE = (
    "A symbol is neither true nor false: write np.where(condition, a, b) for 'if', np.maximum and np.minimum for max and min, "
    "np.logical_and and np.logical_or for 'and' and 'or'"
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
        except Exception as error:
            text = str(error)
            advice = (
                _CHOICE
                if "truth value" in text
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
