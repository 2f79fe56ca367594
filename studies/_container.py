"""The container ship of the thesis with the loss of speed that the acceptance numbers were computed with.

The thesis prints no K_u*. The shipped set takes one with which all turns are stable; the prototypes that the numbers in these
studies come from took 0.9, with which De Keizer's steady turn is unstable beyond 28 degrees of rudder.
"""

from __future__ import annotations

import dataclasses

import shipid
from shipid.parameters.parameter_set import ParameterSet, Value

#: K_u* of the prototypes, and the names the coefficient has in the models.
LOSS = 0.9
_NAMES = ("K_u", "K_u_star")


def container_ship() -> ParameterSet:
    """Return the shipped set with the prototypes' loss of speed."""
    found = shipid.find_ship("soesterberg")
    sections = {
        name: {n: Value(n, LOSS, "1", "assumed") if n in _NAMES else value for n, value in section.items()}
        for name, section in found.sections.items()
    }
    return dataclasses.replace(found, sections=sections)
