"""A design with other numbers: noise levels, biases of inputs, first estimates of parameters.

They are constants of what is generated: a design and its copy share the compiled code.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.estimation.design import FilterDesign


def started_at(design: FilterDesign, starts: Mapping[str, tuple[float, float]]) -> FilterDesign:
    """Return a design with other first estimates of parameters.

    Parameters
    ----------
    design : FilterDesign
        The design.
    starts : mapping of str to tuple of float
        First value and standard deviation by estimated parameter, SI; a larger deviation than before is not taken.
    """
    first, moved = design.first, dict(design.first.parameters)
    for name, (value, deviation) in starts.items():
        old = first.deviations.get(name, moved[name][1])
        # The deviation of a logarithm is a share of the value.
        share = abs(value / moved[name][0]) if design.parameters[name] != name else 1.0
        moved[name] = (value, min(deviation, old * share))
    others = {n: d for n, d in first.deviations.items() if n not in starts}
    return replace(design, first=replace(first, parameters=moved, deviations=others))


def with_levels(
    design: FilterDesign,
    sensors: Mapping[str, float],
    noise: Mapping[str, float],
    biases: Mapping[str, float] | None = None,
) -> FilterDesign:
    """Return a design with other noise levels, and with biases of inputs.

    Parameters
    ----------
    design : FilterDesign
        The design.
    sensors : mapping of str to float
        Standard deviation of one sample of each sensor, SI.
    noise : mapping of str to float
        Level of each noise of states and inputs, SI, as the design takes it: a sample's, or a density.
    biases : mapping of str to float, optional
        What is added to inputs, SI.
    """
    sources = tuple(
        replace(s, level=noise[s.name], assumed=s.assumed and noise[s.name] == s.level) for s in design.sources
    )
    return replace(
        design,
        sources=sources,
        q=np.array([s.level for s in sources]),
        r=np.array([sensors[n] for n in design.measured]),
        instruments=replace(design.instruments, biases=dict(biases or {})),
    )
