from __future__ import annotations

import dataclasses

import pytest

import shipid
from shipid.parameters.correlation import Joint
from shipid.parameters.parameter_set import Value


def _sized(ship: str, model: str, **changed: float) -> shipid.ParameterSet:
    """A ship with some coefficients of a model replaced, SI."""
    found = shipid.find_ship(ship)
    section = dict(found.sections.get(model, {}))
    for name, value in changed.items():
        section[name] = Value(name, value, shipid.find_model(model)[name].unit, "assumed")
    return dataclasses.replace(found, sections={**found.sections, model: section})


def _uncertain(ship: str, model: str, share: float = 0.1, correlation: float = 0.9) -> shipid.ParameterSet:
    """A ship as an identification leaves it: two coefficients with a standard deviation, correlated."""
    found = shipid.find_ship(ship)
    section = {
        n: dataclasses.replace(v, std=share * v.value) for n, v in found.sections[model].items() if n in ("K", "tau")
    }
    joint = Joint(("K", "tau"), ((1.0, correlation), (correlation, 1.0)), (9.0, 10.0))
    sections = {**found.sections, model: {**found.sections[model], **section}}
    return dataclasses.replace(found, name="uncertain", sections=sections, joint={model: joint})


@pytest.fixture(scope="session")
def container():
    """The container ship under De Keizer's model, poles placed by default."""
    return shipid.design_autopilot("de-keizer", "soesterberg", design="pole")


@pytest.fixture(scope="session")
def integral():
    return shipid.design_autopilot("de-keizer", "soesterberg", design="pid", speeds=[7.0, 9.5])


@pytest.fixture(scope="session")
def uncertain_pilot():
    return shipid.design_autopilot("nomoto", _uncertain("soesterberg", "nomoto"), speeds=[7.0, 9.5, 11.0])


@pytest.fixture(scope="session")
def sized():
    return _sized


@pytest.fixture(scope="session")
def uncertain():
    return _uncertain
