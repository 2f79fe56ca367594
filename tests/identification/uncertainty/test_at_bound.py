"""A coefficient that ended at its bound is not determined, nor is what trades off with it; a filter is not judged beside it."""

import numpy as np
import pytest

import shipid
from shipid.estimation.by_record import filter_by_record
from shipid.generation.reduction import reduced
from shipid.identification.beside_filter import beside_filter


@pytest.fixture(scope="module")
def slow():
    """A ship far slower than the model allows: only K/tau shows."""
    values = {"K": "5 1/s", "tau": "3000 s"}
    return shipid.simulate(
        "nomoto", "soesterberg", "zigzag:10/10", values=values, noise={"psi": "0.3 deg", "r": "0.03 deg/s"}, seed=1
    )


def test_what_trades_off_with_a_bound_is_not_determined(slow):
    fit = shipid.identify("nomoto", [slow], ship="soesterberg", starts=2)
    assert "ended at its bound" in fit.parameters["tau"].why
    # Far from the true 5 1/s, with an interval of a sixth: it is not to be taken for the gain of this ship.
    assert abs(fit.parameters["K"].value - 5.0) > 4 * fit.parameters["K"].std
    assert not fit.parameters["K"].identifiable
    assert "trades off with tau, which ended at its bound" in fit.parameters["K"].why


def test_a_filter_is_not_judged_beside_a_coefficient_at_its_bound(slow):
    ship = shipid.find_ship("soesterberg")
    model = reduced(shipid.find_model("nomoto"), ("psi", "r"))
    kalman = shipid.ExtendedKalmanFilter(
        model, ship, measured={"psi": "0.2 deg", "r": "0.02 deg/s"}, estimated=["K", "tau"]
    )
    run, levels = filter_by_record(
        kalman, slow, identified=lambda: beside_filter(shipid.find_model("nomoto"), slow, ship, ("K", "tau"))
    )
    told = [n for n in run.warnings if n.serious]
    assert [n.kind for n in told] == ["not-confirmed"] and "does not determine tau" in told[0]
    assert levels.at_bound == ("tau",) and not levels.simulated and np.isfinite(run.parameters["K"].value)
