"""The dead time of the rudder: found again, found unasked, and carried by what comes after."""

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid import find_model
from shipid.foundation.errors import UsageError
from shipid.generation.linearisation import linearise
from shipid.generation.record import make_record
from shipid.generation.simulator import make_simulator
from shipid.generation.step import make_step
from shipid.generation.system import generate
from shipid.identification.problem.dead_time import usual_delay, with_dead_time
from shipid.identification.validation.runs import swings_of
from shipid.parameters.replaced import with_values
from shipid.trials.trial import Trial

TRUTH = {"K": 0.08, "tau": 12.0}
NOISE = {"psi": np.deg2rad(0.1), "r": np.deg2rad(0.02)}


def sailed(delay: float, noise: float = 0.0, seed: int = 0, name: str = "zz") -> Trial:
    """A zig-zag of a ship whose rudder acts late: integrated on a fine clock with the rudder of that time, not with a shift."""
    fine, every = 0.05, 5
    t = np.arange(0, 300 + fine / 2, fine)
    corners = np.array([0, 10, 16, 40, 53, 100, 113, 160, 173, 220, 233, 270, 283, 320])
    angles = np.deg2rad([0, 0, 20, 20, -20, -20, 20, 20, -20, -20, 20, 20, -20, -20])
    run = make_simulator(find_model("nomoto"), ("psi", "r"), compiled=False)(
        t, TRUTH, {"delta": np.interp(t - delay, corners, angles)}
    )
    random = np.random.default_rng(seed)
    shown = {n: run[n][::every] + noise * s * random.standard_normal(t[::every].size) for n, s in NOISE.items()}
    return Trial(
        name, pd.DataFrame({"t": t[::every], "delta": np.interp(t[::every], corners, angles), "u": 8.0, **shown})
    )


@pytest.fixture(scope="module")
def late() -> Trial:
    return sailed(2.3)


@pytest.fixture(scope="module")
def fit(late):
    return shipid.identify("nomoto", [late])


def test_the_derivative_by_a_dead_time_is_exact(late) -> None:
    """By central differences between corners of the rudder, for either sign of the dead time."""
    model = find_model("nomoto-delay")
    record = make_record(model, ("psi", "r"), ("delay", "K"), compiled=False)
    u = np.zeros((len(model.inputs), len(late)))
    u[model.inputs.index("delta")] = late["delta"]
    intervals = np.diff(late["t"], append=late["t"][-1])
    names = generate(model).coefficients

    def run(delay: float) -> tuple[np.ndarray, np.ndarray]:
        p = np.array([{**TRUTH, "delay": delay}[n] for n in names])
        return record(np.zeros(len(model.states)), u, intervals, p)

    for delay in (2.3, -1.2, 0.1):
        _, slopes = run(delay)
        numeric = (run(delay + 1e-3)[0] - run(delay - 1e-3)[0]) / 2e-3
        # Differences of eleven digits of a heading of 0.4 rad over 2e-3 s.
        assert slopes[:, 0] == pytest.approx(numeric, abs=1e-10)
        assert np.abs(slopes[0, 0]).max() > 0.01


def test_the_truth_is_found_without_being_asked_for(fit) -> None:
    """Without noise to 1e-3, from the plain call: the doctor is certain of the dead time."""
    assert fit.model.name == "nomoto-delay"
    assert fit.parameters["delay"].value == pytest.approx(2.3, rel=1e-3)
    assert fit.parameters["delay"].unit == "s"
    assert fit.parameters["K"].value == pytest.approx(0.08, rel=1e-3)
    assert fit.parameters["tau"].value == pytest.approx(12.0, rel=1e-3)
    assert fit.to_dict()["parameters"]["delay"]["unit"] == "s"
    assert "is a dead time: 'delta' acts so much later than it is recorded" in fit.text()


@pytest.mark.parametrize("seed", range(3))
def test_with_noise_the_truth_lies_in_the_intervals(seed: int) -> None:
    """Three standard deviations: nine numbers are looked at."""
    fit = shipid.identify("nomoto-delay", [sailed(2.3, noise=1.0, seed=seed)], starts=1)
    for name, truth in {**TRUTH, "delay": 2.3}.items():
        e = fit.parameters[name]
        assert abs(e.value - truth) < 3 * e.std, name
        assert e.std < 0.05 * truth


def test_a_rudder_that_is_logged_late_has_a_negative_one() -> None:
    fit = shipid.identify("nomoto-delay", [sailed(-1.2)], starts=1)
    assert fit.parameters["delay"].value == pytest.approx(-1.2, rel=2e-3)
    assert fit.parameters["tau"].value == pytest.approx(12.0, rel=1e-3)


def test_a_ship_that_answers_at_once_has_none() -> None:
    prompt = sailed(0.0)
    assert usual_delay([prompt]) is None
    assert with_dead_time("nomoto", [prompt]).name == "nomoto"
    assert shipid.identify("nomoto", [prompt], starts=1).model.name == "nomoto"


def test_it_is_added_where_every_trial_has_it_and_no_lag_stands_for_it(late) -> None:
    assert with_dead_time("nomoto", [late]).name == "nomoto-delay"
    assert with_dead_time("nomoto", [late, sailed(0.0)]).name == "nomoto"
    assert with_dead_time("cubic-lag", [late]).name == "cubic-lag"
    assert usual_delay([late]) == pytest.approx(2.3, abs=0.3)


def test_it_is_held_or_estimated_alone_by_name(late) -> None:
    without = shipid.identify("nomoto", [late], fixed={"delay": "0 s"}, starts=1)
    assert without.fixed["delay"] == 0.0
    assert without.parameters["tau"].value > 13  # the dead time is taken for a slower ship
    ship = shipid.ParameterSet("known")
    alone = shipid.identify("nomoto", [late], ship=ship, fixed={"K": "0.08 1/s", "tau": "12 s"}, estimate=["delay"])
    assert alone.estimated == ("delay",)
    assert alone.parameters["delay"].value == pytest.approx(2.3, rel=1e-3)


def test_what_comes_after_carries_it(fit, late) -> None:
    """A prediction of another trial, its zig-zag in closed loop, and a filter of its record."""
    checked = fit.validate([sailed(2.3, name="other")]).validation[0]
    assert checked.rmse["psi"] < np.deg2rad(0.02)
    swing = swings_of(fit.identified, checked)
    assert np.rad2deg(swing.overshoots[:3]) == pytest.approx(np.rad2deg(checked.overshoots[:3]), abs=0.2)
    innovations = [
        np.nanmean(
            shipid.ExtendedKalmanFilter(fit.model, ship, measured={"psi": "0.1 deg", "r": "0.02 deg/s"}, estimated=[])
            .filter(late)
            .nis
        )
        for ship in (fit.ship, with_values(fit.ship, {"delay": "0 s"}, [fit.model]))
    ]
    assert innovations[0] < 0.01 * innovations[1]


def test_what_cannot_carry_it_refuses(fit, late) -> None:
    with pytest.raises(UsageError, match="Multiple shooting cannot carry it"):
        shipid.identify("nomoto-delay", [late], method="multiple-shooting")
    with pytest.raises(UsageError, match="Prediction error does not estimate the dead time"):
        shipid.identify("nomoto-delay", [late], method="prediction-error")
    with pytest.raises(UsageError, match="A step from sample to sample cannot carry it"):
        make_step(generate(fit.model))
    with pytest.raises(UsageError, match="A linear system without one cannot carry it"):
        linearise(fit.model, TRUTH)
    with pytest.raises(UsageError, match="A filter does not estimate the dead time"):
        shipid.ExtendedKalmanFilter(fit.model, fit.ship, measured={"psi": "0.1 deg"}, estimated=["delay"])
