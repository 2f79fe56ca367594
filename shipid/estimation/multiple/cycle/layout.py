"""Where everything stands in the vectors of a multiple-model cycle."""

from __future__ import annotations

from collections.abc import Sequence

from shipid.estimation.design import FilterDesign
from shipid.estimation.recursion.covariance_form import size
from shipid.estimation.recursion.layout import places_of


class CycleLayout:
    """Where everything stands in the vectors of a cycle; names end in the number of the mode.

    Parameters
    ----------
    designs : sequence of FilterDesign
        The modes.
    moving : bool
        Whether their parameter moves.
    correlated : bool
        Whether the errors of sensors are correlated.

    Attributes
    ----------
    modes, sensors, n : int
        Modes, sensors, and states of the combined estimate, which are those of the first mode.
    sizes : tuple of int
        States of each mode.
    carried, control, constants : dict of str to slice
        What the cycle takes: what it carries from scan to scan, what comes with a scan, what never changes.
    brief, full : dict of str to slice
        What it returns of a scan, without and with the estimates of each mode.
    """

    def __init__(self, designs: Sequence[FilterDesign], moving: bool, correlated: bool) -> None:
        self.modes, self.sensors = len(designs), len(designs[0].measured)
        self.sizes = tuple(d.layout.n for d in designs)
        self.n = self.sizes[0]
        inputs = [d.layout.inputs for d in designs]
        pairs = size(self.sensors) - self.sensors if correlated else 0
        each = range(self.modes)
        estimates = {f"x{j}": self.sizes[j] for j in each} | {f"P{j}": size(self.sizes[j]) for j in each}
        self.carried = places_of(
            mu=self.modes,
            theta=self.modes if moving else 0,
            **estimates,
            **{f"u{j}": inputs[j] for j in each},
        )
        self.control = places_of(
            **{f"u{j}": inputs[j] for j in each},
            T=1,
            transition=self.modes**2,
            z=self.sensors,
            there=self.sensors,
            variance=self.sensors,
            whitening=pairs,
        )
        self.constants = places_of(
            **{f"p{j}": len(d.p) for j, d in enumerate(designs)}, **{f"q{j}": len(d.q) for j, d in enumerate(designs)}
        )
        brief = {"x": self.n, "P": size(self.n), "mu": self.modes, "theta": self.modes if moving else 0, "ll": 1}
        self.brief = places_of(**brief)
        self.full = places_of(
            **brief,
            ahead=self.modes,
            **estimates,
            **{f"shown{j}": self.sensors for j in each},
            **{f"spread{j}": size(self.sensors) for j in each},
        )
