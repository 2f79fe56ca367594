"""Coefficients about which the trials say nothing: they keep what was known of them, or are left out; never a draw."""

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ParameterSetError
from shipid.identification.search.unseen import covariance_by, unseen_directions

SENSORS = "psi=0.2 deg,r=0.02 deg/s"


def only(trial: shipid.Trial, *columns: str) -> shipid.Trial:
    table = trial.table[["t", *columns]]
    return shipid.Trial.from_frame(table, name="log", units={n: FIELDS[n].unit for n in table.columns})


@pytest.fixture(scope="module")
def log():
    return only(shipid.simulate("cubic", "kvlcc2", "zigzag:20/20", noise=SENSORS), "psi", "r", "delta")


@pytest.mark.parametrize("purpose", [None, "prediction", "filter"])
def test_a_coefficient_without_information_keeps_the_ships_value_and_spread(log, purpose):
    own = shipid.find_ship("kvlcc2").sections["cubic"]["gamma"]
    for seed in (0, 1, 2):
        fit = shipid.identify("cubic", [log], ship="kvlcc2", seed=seed, purpose=purpose)
        assert fit.ship.sections["cubic"]["gamma"] == own
        gamma = fit.parameters["gamma"]
        assert gamma.value == pytest.approx(own.value, rel=1e-9) and gamma.std == pytest.approx(own.std, rel=1e-9)
        assert not gamma.identifiable and "keeps the value known beforehand and its standard deviation" in gamma.why
        assert fit.parameters["a"].identifiable


def test_circles_of_the_identified_ship_do_not_depend_on_the_seed(log):
    circles = []
    for seed in (0, 2):
        ship = shipid.identify("cubic", [log], ship="kvlcc2", seed=seed, starts=3).ship
        circles.append(shipid.simulate("cubic", ship, "turn:35"))
    assert circles[0]["y"] == pytest.approx(circles[1]["y"], abs=0.01)


def test_what_nothing_states_is_left_out(log):
    ship = shipid.find_ship("kvlcc2")
    bare = dataclasses.replace(ship, sections={"particulars": ship.sections["particulars"]}, joint={})
    fit = shipid.identify("cubic", [log], ship=bare, starts=3)
    assert "gamma" not in fit.ship.sections["cubic"] and "gamma" not in fit.ship.joint["cubic"].names
    assert "leaves it out" in fit.parameters["gamma"].why
    with pytest.raises(ParameterSetError, match="gamma"):
        shipid.simulate("cubic", fit.ship, "turn:35")


def test_coefficients_known_only_together_do_not_depend_on_the_seed(sail):
    """Sway and yaw derivatives from heading and rate alone: only combinations show."""
    trial = sail("davidson-schiff", "mariner", noise=SENSORS)
    fits = [shipid.identify("davidson-schiff", [trial], ship="mariner", signals=["psi", "r"], seed=s) for s in (0, 3)]
    one, other = ([e.value for e in fit.parameters.values()] for fit in fits)
    assert one == pytest.approx(other, rel=1e-4)
    assert fits[0].identified.solution.cost == pytest.approx(fits[1].identified.solution.cost, rel=1e-6)
    assert "nearest to what was known beforehand" in fits[0].parameters["Y_v"].why


@pytest.mark.parametrize(
    "method", [None, "equation-error", "instrumental-variables", "prediction-error", "multiple-shooting"]
)
@pytest.mark.parametrize("calm", [False, True])
def test_a_model_with_wind_on_a_log_without_it(method, calm, monkeypatch):
    if method == "prediction-error":
        # To compile its likelihood takes longer than to run one short record on the virtual machine.
        monkeypatch.setenv("SHIPID_COMPILE", "0")
    sailed = shipid.simulate("cubic", "kvlcc2", "zigzag:20/20")
    trial = (
        only(sailed, "psi", "r", "u", "delta")
        if "v" not in sailed.table
        else only(sailed, "psi", "r", "u", "v", "delta")
    )
    rng = np.random.default_rng(4)
    table = trial.table.copy()
    table["v"] = 0.4746 * -320.0 * table["r"] + 0.01 * rng.standard_normal(len(table))
    table["psi"] += np.deg2rad(0.2) * rng.standard_normal(len(table))
    table["r"] += np.deg2rad(0.02) * rng.standard_normal(len(table))
    if calm:
        table["wind_speed"], table["wind_direction"] = 0.0, 1.0
    fit = shipid.identify(
        "cubic-wind", [dataclasses.replace(trial, table=table)], ship="kvlcc2", method=method, starts=2
    )
    assert fit.converged
    assert fit.parameters["a"].identifiable
    for name in ("N_w", "N_w1"):
        # What the declaration states of it, in the prime system.
        assert fit.parameters[name].value == pytest.approx(0.0, abs=1e-12)
        assert fit.parameters[name].std == pytest.approx(0.01 / 320.0**2)
        assert not fit.parameters[name].identifiable


def test_unseen_directions_are_those_that_change_no_residual():
    rng = np.random.default_rng(3)
    jacobian = rng.standard_normal((40, 4))
    jacobian[:, 2] = 0.0
    jacobian[:, 3] = -3.0 * jacobian[:, 0]
    found = unseen_directions(jacobian, 4)
    assert len(found) == 2
    assert jacobian @ found.T == pytest.approx(np.zeros((40, 2)), abs=1e-9)
    # A direction of the other unknowns alone is none of the coefficients'.
    assert len(unseen_directions(jacobian[:, [0, 1, 2]], 2)) == 0


def test_the_inverse_of_an_information_is_infinite_where_there_is_none():
    rng = np.random.default_rng(3)
    slopes = rng.standard_normal((40, 3)) * [1.0, 1e6, 1e-6]
    whole = slopes.T @ slopes
    assert covariance_by(whole) == pytest.approx(np.linalg.inv(whole), rel=1e-8)
    assert covariance_by(whole, 4 * whole) == pytest.approx(4 * np.linalg.inv(whole), rel=1e-8)
    empty = np.zeros((4, 4))
    empty[:3, :3] = whole
    assert np.isinf(covariance_by(empty)[3, 3]) and covariance_by(empty)[:3, :3] == pytest.approx(np.linalg.inv(whole))
    slopes[:, 2] = 1e-12 * slopes[:, 1]
    assert np.isinf(np.diag(covariance_by(slopes.T @ slopes))).tolist() == [False, True, True]
