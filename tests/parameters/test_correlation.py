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
    ({"names": ["K"]}, "not a square matrix"),
    ({"correlation": [[1, 1.9], [0.9, 1]]}, "not a square matrix"),
    ({"correlation": [[1, 0.8], [0.9, 1]]}, "not symmetric"),
    ({"correlation": [[0.5, 0.9], [0.9, 1]]}, "with ones on its diagonal"),
    ({"speeds": [4.5]}, "speeds are two numbers"),
    ({"speeds": 4.5}, "speeds are two numbers"),
    ({"speeds": [9.5, 4.5]}, "greater than zero and rising"),
    ({"speed_unit": "deg"}, "in a unit of speed"),
    ({"name": 1}, "entry 'name' it does not know"),
    ({"draught": ["9 m", "5 m"]}, "two rising numbers with their units"),
    ({"displacement": [5, 9]}, "two rising numbers with their units"),
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


@pytest.mark.parametrize(
    ("model", "name", "si", "other", "factor"),
    [("nomoto", "tau", "s", "min", 60.0), ("norrbin", "b3", "s/rad^2", "s/deg^2", (180 / np.pi) ** 2)],
)
def test_a_standard_deviation_has_the_unit_of_its_value(model, name, si, other, factor):
    """A ship that is stated in two units has the same draws: tau by its logarithm, b3, which has either sign, as it is."""
    found, drawn = shipid.find_ship("soesterberg"), []
    for unit, value, std in ((si, 30.0, 3.0), (other, 30.0 / factor, 3.0 / factor)):
        stated = {name: Value(name, value, unit, "assumed", std=std)}
        own = dataclasses.replace(found, sections={**found.sections, model: stated}, joint={})
        drawn.append(draw_coefficients(shipid.find_model(model), own, 4000).values[:, 0])
    scattered = np.log(drawn[0] / 30.0) if name == "tau" else (drawn[0] - 30.0) / 30.0
    assert (scattered.mean(), scattered.std()) == pytest.approx((0.0, 0.1), abs=0.001)
    np.testing.assert_allclose(drawn[1], drawn[0], rtol=1e-12)


def test_draws_end_at_the_bounds_in_the_prime_system():
    """Nomoto's K' is declared from 0.02 to 50: K is within the same times U/L, and tau times L/U."""
    drawn = draw_coefficients(MODEL, ship(std=(3.0, 3.0), correlation=0.0), 4000)
    length, speed = (shipid.find_ship("soesterberg").particular(*p) for p in (("L", "m"), ("speed", "m/s")))
    scale = np.array([speed / length, length / speed])
    np.testing.assert_allclose(drawn.values.min(axis=0), 0.02 * scale, rtol=1e-12)
    np.testing.assert_allclose(drawn.values.max(axis=0), 50.0 * scale, rtol=1e-12)


def test_correlations_belong_to_names_in_whatever_order():
    """Three coefficients, correlated in the order of the set, which is not the order of the model."""
    names, matrix = ("b3", "a", "b1"), ((1.0, 0.9, -0.6), (0.9, 1.0, -0.3), (-0.6, -0.3, 1.0))
    stated = (("a", 0.01, "1/s^2"), ("b1", 0.1, "1/s"), ("b3", 30.0, "s/rad^2"))
    section = {n: Value(n, value, unit, "assumed", std=0.01 * value) for n, value, unit in stated}
    found = shipid.find_ship("soesterberg")
    own = dataclasses.replace(
        found, sections={**found.sections, "norrbin": section}, joint={"norrbin": Joint(names, matrix)}
    )
    drawn = draw_coefficients(shipid.find_model("norrbin"), own, 4000)
    assert drawn.names == ("a", "b1", "b3")
    # The correlations of 4000 draws scatter by at most 1/sqrt(4000).
    wanted = {("a", "b3"): 0.9, ("b1", "b3"): -0.6, ("a", "b1"): -0.3}
    for (one, other), value in wanted.items():
        columns = drawn.values[:, [drawn.names.index(one), drawn.names.index(other)]]
        assert np.corrcoef(columns.T)[0, 1] == pytest.approx(value, abs=0.05)


def test_a_table_against_speed_is_not_drawn():
    found = shipid.find_ship("soesterberg")
    section = {
        "K": Value("K", (0.1, 0.2), "1/s", "assumed", std=0.01, speed=(4.0, 8.0)),
        "tau": dataclasses.replace(found.sections["nomoto"]["tau"], std=1.0),
    }
    drawn = draw_coefficients(MODEL, dataclasses.replace(found, sections={**found.sections, "nomoto": section}), 10)
    assert drawn.names == ("tau",)


def test_what_the_set_does_not_say():
    apart = draw_coefficients(MODEL, ship(joint=False), 2000)
    assert abs(np.corrcoef(apart.values.T)[0, 1]) < 0.1 and "taken as independent" in apart.source
    loose = draw_coefficients(MODEL, ship(std=(0.1, None), correlation=0.0), 2000)
    assert "tau not determined by trials" in loose.source
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
