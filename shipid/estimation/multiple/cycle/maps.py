"""What the estimate of one mode says about the states of another: equal names, and an explicit map for all others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from shipid.declaration.units import same_dimension, to_si
from shipid.estimation.design import FilterDesign
from shipid.estimation.errors import ModeError
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.foundation.errors import UnknownNameError

#: By pair of modes (from, to), the states that the first does not have under that name: a quantity of the first, or a value and its
#: standard deviation.
ModeMaps = Mapping[tuple[str, str], Mapping[str, "str | tuple[Amount, Amount]"]]


@dataclass(frozen=True, eq=False)
class ModeMap:
    """The states of one mode out of the estimate of another.

    Attributes
    ----------
    same : bool
        Whether they are the same states in the same order.
    function : casadi.Function or None
        ``(x, u, p, T) -> (mean, Jacobian)``; None where they are the same.
    variance : ndarray, shape (states,)
        What is added to the mapped covariance.
    """

    same: bool
    function: CasadiFunction
    variance: np.ndarray

    def __call__(
        self, x: Expression, covariance: Expression, u: Expression, p: Expression, T: Expression
    ) -> tuple[Expression, Expression]:
        """Return mean and covariance in the states of the other mode.

        Parameters
        ----------
        x, covariance : casadi.SX
            Estimate of the first mode, shapes (n,) and (n, n).
        u, p, T : casadi.SX
            Its inputs, its coefficients, and the interval.
        """
        if self.same:
            return x, covariance
        mean, slope = self.function(x, u, p, T)
        return mean, slope @ covariance @ slope.T + ca.diag(ca.DM(self.variance))


def make_maps(designs: Mapping[str, FilterDesign], given: ModeMaps) -> dict[tuple[str, str], ModeMap]:
    """Return the map of every pair of modes that exchange estimates.

    Parameters
    ----------
    designs : mapping of str to FilterDesign
        The modes.
    given : mapping
        See `ModeMaps`.

    Raises
    ------
    ModeError
        If a mode has a state that another has not, and no map says what it is there.
    UnknownNameError
        If a map names a mode or a quantity that is not there.
    """
    for pair in given:
        for name in pair:
            if name not in designs:
                raise UnknownNameError("mode to map called", name, designs)
    return {
        (a, b): _map(a, b, designs[a], designs[b], given.get((a, b), {})) for a in designs for b in designs if a != b
    }


def _map(
    source: str, target: str, one: FilterDesign, other: FilterDesign, given: Mapping[str, str | tuple[Amount, Amount]]
) -> ModeMap:
    states = other.model.states
    for name in given:
        if name not in states:
            raise UnknownNameError(f"state of mode '{target}' called", name, states)
    variance = np.zeros(len(states))
    if one.model.states == states and not given:
        return ModeMap(True, None, variance)
    system = one.system
    rows = []
    for i, name in enumerate(states):
        said = given.get(name, name)
        unit = other.model[name].unit
        if isinstance(said, tuple):
            value, spread = (to_si(v, unit, f"'{name}' of mode '{target}' from mode '{source}'") for v in said)
            rows.append(ca.SX(value))
            variance[i] = spread**2
        elif said in one.model.states or (name in given and said in system.values):
            if not same_dimension(one.model[said].unit, unit):
                raise ModeError(
                    f"'{name}' of mode '{target}' is in {unit}, and '{said}' of mode '{source}' in {one.model[said].unit}."
                )
            rows.append(system.values[said])
        elif name in given:
            raise UnknownNameError(f"quantity of mode '{source}' called", str(said), system.values)
        else:
            raise ModeError(
                f"mode '{target}' has a state '{name}', and mode '{source}' has none of that name. Say what it is there: "
                f"maps={{('{source}', '{target}'): {{'{name}': ...}}}}, with a quantity of '{source}' or a value and its standard "
                "deviation."
            )
    mean = ca.densify(ca.vertcat(*rows))
    function = ca.Function(
        "mode_map", [system.x, system.u, system.p, system.T], [mean, ca.jacobian(mean, system.x)], {"allow_free": False}
    )
    return ModeMap(False, function, variance)
