"""Guards: the conditions within which a model is valid, declared beside its equations.

A model often has a floor that keeps a run finite: a least speed to divide by, a limit of a curve. On the floor its equations
are not the published ones, and what it shows is no ship. A guard says so: a run in which a margin is negative is not sailed by
the model, in whatever command it is run.
"""

from __future__ import annotations

from shipid.declaration.quantity import Quantity
from shipid.foundation.aliases import Expression

#: The words for a manoeuvre in which a model leaves the range in which it is valid.
NOT_SAILED = "not sailed by this model"


def guard(unit: str, meaning: str) -> Expression:
    """Declare a margin that is not negative while the model is valid: it needs ``@g.equals``.

    Parameters
    ----------
    unit : str
        Coherent SI unit of the margin.
    meaning : str
        What is the case where the margin is negative, as in ``"the forward speed is below a twentieth of the cruise"``.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is the margin.
    """
    return Quantity("guard", unit, meaning)
