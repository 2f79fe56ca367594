"""Model sets that move: modes whose parameter is corrected while the filter runs.

A *mode parameter* is an input of the models that has another constant value in each mode, such as the rate of turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from shipid.estimation.settings.instruments import Amount


@dataclass(frozen=True)
class Displaced:
    """Augmented modes: each estimates by how much the true parameter differs from its own.

    Semerdjiev and Mihaylova (2000), sections 4.1 and 4.2; Semerdjiev, Mihaylova and Li (2000), section 3.

    Attributes
    ----------
    parameter : str
        Input of the models with a constant value in each mode.
    displacement : str
        State of the models: the true value less that of the mode.
    bounds : mapping of str to tuple of str, optional
        Smallest and largest value of parameter and displacement together, by mode, with units; they may not overlap. A mode without
        bounds moves freely.
    variable : bool
        Whether the structure is variable: each scan then starts by adding the displacement to the parameter and setting it to zero.
        With a fixed structure the parameters stay, and only the displacements are kept within the bounds.
    """

    parameter: str
    displacement: str
    bounds: Mapping[str, tuple[Amount, Amount]] | None = None
    variable: bool = True


@dataclass(frozen=True)
class AdaptiveGrid:
    """Three modes on a grid of the parameter that follows their probabilities.

    The middle mode moves to the probable value of the parameter; a neighbour comes closer while it is improbable, and moves away while
    it holds. Jilkov, Angelova and Semerdjiev (1999), as in Semerdjiev, Mihaylova and Li (2000), section 5.1.

    Attributes
    ----------
    parameter : str
        Input of the models with a constant value in each mode.
    order : tuple of str
        The modes from the largest value of the parameter to the smallest: upper, middle, lower.
    closest, widest : str
        Smallest and largest distance of neighbours, with units.
    limit : str, optional
        Largest magnitude of the parameter; that of the modes at the start by default.
    improbable, dominant : float
        Probability below which a neighbour of the dominant middle comes closer (t1), and above which a dominant neighbour moves away
        (t2).
    """

    parameter: str
    order: tuple[str, str, str]
    closest: Amount
    widest: Amount
    limit: Amount | None = None
    improbable: float = 0.05
    dominant: float = 0.92


#: How the modes move; None where they stay.
Structure = Displaced | AdaptiveGrid | None
