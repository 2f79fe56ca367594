"""What an identification says of its coefficients together: written, read, drawn from."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import tomli_w

import shipid
from shipid.foundation.errors import ParameterSetError
from shipid.parameters.correlation import Joint
from shipid.parameters.draws import draw_coefficients
from shipid.parameters.parameter_file import parameter_table
from shipid.parameters.parameter_set import Value

MODEL = shipid.find_model("nomoto")


def ship(std=(0.1, 0.1), correlation=0.9, joint=True) -> shipid.ParameterSet:
    found = shipid.find_ship("soesterberg")
    section = {
        n: dataclasses.replace(
            found.sections["nomoto"][n], std=None if s is None else s * found.sections["nomoto"][n].value
        )
        for n, s in zip(("K", "tau"), std)
    }
    one = {"nomoto": Joint(("K", "tau"), ((1.0, correlation), (correlation, 1.0)), (4.5, 9.5))} if joint else {}
    return dataclasses.replace(found, sections={**found.sections, "nomoto": section}, joint=one)


def test_round_trip(tmp_path):
    path = tmp_path / "ship.toml"
    shipid.write_parameter_set(ship(), path)
    assert shipid.read_parameter_set(path) == ship()


NONSENSE = [
    ({"names": ["K"]}, "no square matrix"),
    ({"correlation": [[1, 1.9], [0.9, 1]]}, "no square matrix"),
    ({"correlation": [[1, 0.8], [0.9, 1]]}, "not symmetric"),
    ({"correlation": [[0.5, 0.9], [0.9, 1]]}, "with ones on its diagonal"),
    ({"speeds": [4.5]}, "speeds are two numbers"),
    ({"speeds": 4.5}, "speeds are two numbers"),
    ({"speeds": [9.5, 4.5]}, "have to rise"),
    ({"speed_unit": "deg"}, "in a unit of speed"),
    ({"name": 1}, "entry 'name' it does not know"),
]


@pytest.mark.parametrize(("changed", "words"), NONSENSE)
def test_nonsense_is_named(tmp_path, changed, words):
    table = parameter_table(ship())
    table["identified"]["nomoto"] |= changed
    path = tmp_path / "ship.toml"
    path.write_text(tomli_w.dumps(table))
    with pytest.raises(ParameterSetError, match=words):
        shipid.read_parameter_set(path)


def test_one_table_for_each_model(tmp_path):
    path = tmp_path / "ship.toml"
    path.write_text(tomli_w.dumps({**parameter_table(ship()), "identified": {"names": ["K"]}}))
    with pytest.raises(ParameterSetError, match="holds one table for each model"):
        shipid.read_parameter_set(path)


def test_draws_have_the_covariance(tmp_path):
    drawn = draw_coefficients(MODEL, ship(std=(0.1, 0.2)), 4000)
    logs = np.log(drawn.values / drawn.nominal)
    np.testing.assert_allclose(logs.std(axis=0), [0.1, 0.2], rtol=0.05)
    assert np.corrcoef(logs.T)[0, 1] == pytest.approx(0.9, abs=0.02)
    assert drawn.source == "the covariance of K, tau in the set of ship soesterberg"


def test_what_the_set_does_not_say():
    apart = draw_coefficients(MODEL, ship(joint=False), 2000)
    assert abs(np.corrcoef(apart.values.T)[0, 1]) < 0.1 and "taken as independent" in apart.source
    loose = draw_coefficients(MODEL, ship(std=(0.1, None), correlation=0.0), 2000)
    assert "tau left open by the trials" in loose.source
    assert np.log(loose.values[:, 1]).std() == pytest.approx(1.0, rel=0.1)
    none = draw_coefficients(MODEL, shipid.find_ship("soesterberg"), 10)
    assert none.names == () and none.values.shape == (10, 0) and "states no standard deviation" in none.source


def test_a_fit_keeps_its_correlation_and_its_speeds(tmp_path):
    trial = shipid.simulate(shipid.find_model("de-keizer"), "soesterberg", "zigzag:20/20", noise="standard")
    fit = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1)
    joint = fit.ship.joint["nomoto"]
    np.testing.assert_allclose(joint.correlation, fit.correlation, atol=1e-6)
    assert joint.speeds is not None and 5.0 < joint.speeds[0] <= joint.speeds[1] < 9.6
    shipid.write_parameter_set(fit.ship, tmp_path / "ship.toml")
    again = draw_coefficients(fit.model, shipid.read_parameter_set(tmp_path / "ship.toml"), 4000)
    spread = np.sqrt(np.diag(fit.covariance))
    np.testing.assert_allclose(again.values.std(axis=0), spread, rtol=0.05)
    assert isinstance(fit.ship.sections["nomoto"]["K"], Value)
