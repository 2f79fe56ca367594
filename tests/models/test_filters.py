"""The yaw filter and the position filter: states, what they find, and what they cannot tell apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.signal import lfilter

import shipid
from shipid.estimation.records.observability import observability
from shipid.parameters.catalogue import find_model
from shipid.parameters.parameter_set import ParameterSet

DEG = np.pi / 180
SENSORS = {"compass": "0.1 deg", "gyro": "0.01 deg/s"}
TRUTH = {"K": 1.6, "tau": 1.7}
THESIS: dict[str, Any] = {"method": "euler", "hold": "zero", "shared_noise": False}
STATES = {
    "yaw-filter": {"a", "b1", "r_disturbance", "r", "v_f", "psi"},
    "yaw-filter-seven": {"a", "b1", "r_disturbance", "r", "v_f", "psi", "psi_wave"},
    "position-filter": {"u", "gamma", "current_north", "current_east", "x", "y"},
    "own-ship-filter": {
        *("a", "b1", "r_disturbance", "r", "v_f", "psi", "psi_wave"),
        *("u", "gamma", "current_north", "current_east", "x", "y"),
    },
}


def make(name: str = "yaw-filter", **options: Any) -> shipid.ExtendedKalmanFilter:
    measured = options.pop("measured", SENSORS)
    return shipid.ExtendedKalmanFilter(find_model(name), "soesterberg", measured=measured, **options)


@pytest.fixture(scope="module")
def sailed() -> dict[str, np.ndarray]:
    """A 15/15 zig-zag of the container ship, 600 s at 0.4 s, without noise."""
    trial = shipid.simulate(
        find_model("de-keizer-minimal"), "soesterberg", "zigzag:15/15", duration="600 s", sampling="0.4 s"
    )
    return {n: trial[n] for n in ("t", "delta", "u", "psi", "r", "x", "y")} | {"cruise": np.full(len(trial), 9.5)}


def coloured(truth: dict[str, np.ndarray], sigma: float, seed: int) -> dict[str, np.ndarray]:
    """Waves exactly as the filter models them, and sensor noise: (5.29), (5.30) and (5.40) by scipy's recursion."""
    rng = np.random.default_rng(seed)
    count, b = truth["t"].size, 0.4 / 3.0
    w = sigma * rng.standard_normal(count)
    v_f = lfilter([0.0, b], [1.0, b - 1.0], w)
    psi = truth["psi"] + 3.0 * v_f + 0.1 * DEG * rng.standard_normal(count)
    return truth | {"psi": psi, "r": truth["r"] + w - v_f + 0.01 * DEG * rng.standard_normal(count)}


@pytest.mark.parametrize("name", sorted(STATES))
def test_each_filter_has_the_states_of_the_thesis(name: str) -> None:
    kalman = make(name, measured=None)
    assert set(kalman.model.states) == STATES[name]
    assert set(kalman.measured) == set(find_model(name).outputs)
    assert kalman.linear == (name == "position-filter")


def test_what_two_filters_carry_against_one() -> None:
    """Passenier (1989), section 5.4: 28 and 21 elements, and 91."""
    places = [make(n, measured=None, shared_noise=False).design.layout.carried["P"] for n in sorted(STATES)]
    sizes = [p.stop - p.start for p in places]
    assert dict(zip(sorted(STATES), sizes)) == {
        "own-ship-filter": 91,
        "position-filter": 21,
        "yaw-filter": 21,
        "yaw-filter-seven": 28,
    }


def test_it_recovers_the_truth_in_its_own_waves(sailed: dict[str, np.ndarray]) -> None:
    sigma = 0.2 * DEG
    kalman = make(noise={"wave_noise": "0.2 deg/s"})
    finals, errors, spreads = [], [], []
    for seed in range(12):
        run = kalman.filter(coloured(sailed, sigma, seed))
        finals.append([run.parameters[n].value for n in TRUTH])
        errors.append([run.parameters[n].value - v for n, v in TRUTH.items()])
        spreads.append([run.parameters[n].std for n in TRUTH])
        late = run.t > 300
        assert np.sqrt(np.mean((run["psi"] - sailed["psi"])[late] ** 2)) < 0.15 * DEG
    # The coefficients do not walk in truth, so the filter's own spread is an upper bound of the scatter.
    assert np.abs(np.mean(finals, axis=0) / list(TRUTH.values()) - 1).max() < 0.01
    assert np.abs(np.array(errors) / spreads).max() < 3.0


def test_the_timing_of_the_thesis_costs_two_percent_and_the_exact_step_does_not(sailed: dict[str, np.ndarray]) -> None:
    thesis, exact = make(**THESIS).filter(sailed), make(shared_noise=False).filter(sailed)
    assert thesis["K"][-1] == pytest.approx(1.58, rel=0.01)
    assert thesis["tau"][-1] == pytest.approx(1.66, rel=0.01)
    for name, value in TRUTH.items():
        assert exact[name][-1] == pytest.approx(value, rel=0.005)


def test_a_change_of_speed_leaves_the_coefficients_alone() -> None:
    """K* and tau* belong to the ship and not to her speed: first-order yaw sailed at two speeds, by scipy's recursion."""
    t = np.arange(2000) * 0.4
    u = np.where(t < 400, 9.5, 5.0)
    delta = 15 * DEG * np.sign(np.sin(2 * np.pi * t / 160))
    pace = u / 226.0
    r = np.zeros(t.size)
    for half in (t < 400, t >= 400):
        # The rudder stands through each sample: the exact step of a first-order lag.
        k, tau = TRUTH["K"] * pace[half][0], TRUTH["tau"] / pace[half][0]
        hold = np.exp(-0.4 / tau)
        begin = 0.0 if half[0] else r[t < 400][-1]
        r[half], _ = lfilter([0.0, k * (1 - hold)], [1.0, -hold], delta[half], zi=[begin])
    psi = np.concatenate([[0.0], cumulative_simpson(r, dx=0.4)])
    run = make(hold="zero", shared_noise=False).filter(
        {"t": t, "u": u, "delta": delta, "r": r, "psi": psi, "cruise": np.full(t.size, 9.5)}
    )
    assert np.abs(run["K"][t > 200] - 1.6).max() < 0.05
    assert np.abs(run["tau"][t > 200] - 1.7).max() < 0.1


def test_the_seventh_state_cannot_be_told_from_the_heading(sailed: dict[str, np.ndarray]) -> None:
    alike = {"psi": "1 deg", "psi_wave": "1 deg"}
    wrong = make("yaw-filter-seven", start={"psi_wave": "1 deg"}, initial=alike).filter(sailed)
    found = observability(wrong)
    assert [set(d.weights) for d in found.unobservable] == [{"psi", "psi_wave"}]
    assert "psi" in found.messages[0] and "psi_wave" in found.messages[0]
    # Both are believed alike, and only their sum is seen: half of what one is wrong by stays in each (a little more in the
    # heading, which the unknown first rate makes less sure).
    late = wrong.t > 300
    assert np.mean((wrong["psi"] - sailed["psi"])[late]) / DEG == pytest.approx(-0.5, abs=0.03)
    six = make().filter(sailed)
    assert not observability(six).unobservable
    assert abs(np.mean((six["psi"] - sailed["psi"])[late])) < 0.01 * DEG


def test_the_combined_filter_starts_consistent(sailed: dict[str, np.ndarray]) -> None:
    """It has the seventh state too, but knows it from the start: what cannot be told apart does no harm."""
    run = make("own-ship-filter", measured=None).filter(sailed)
    late = run.t > 300
    assert abs(np.mean((run["psi"] - sailed["psi"])[late])) < 0.02 * DEG
    assert run["K"][-1] == pytest.approx(1.6, rel=0.02)
    assert run["gamma"][-1] == pytest.approx(0.573, rel=0.02)


def test_the_position_filter_is_least_squares_where_nothing_drifts() -> None:
    """Against numpy's least squares on the integrals of the heading: constant speed, sway constant and current."""
    length = 226.0
    fine = np.arange(0, 600.01, 0.1)
    psi = 0.7 * np.sin(2 * np.pi * fine / 150) + 0.2 * np.sin(2 * np.pi * fine / 61)
    r = 0.7 * 2 * np.pi / 150 * np.cos(2 * np.pi * fine / 150) + 0.2 * 2 * np.pi / 61 * np.cos(2 * np.pi * fine / 61)

    def integral(values: np.ndarray) -> np.ndarray:
        return np.concatenate([[0.0], cumulative_simpson(values, x=fine)])[::5]

    t, zero = fine[::5], np.zeros(fine[::5].size)
    one = np.ones(t.size)
    # Unknowns: u, gamma, current to the north and to the east, first position.
    north = np.column_stack([integral(np.cos(psi)), length * integral(r * np.sin(psi)), t, zero, one, zero])
    east = np.column_stack([integral(np.sin(psi)), -length * integral(r * np.cos(psi)), zero, t, zero, one])
    known = np.array([9.5, 0.573, 0.8, -0.4, 100.0, 50.0])
    rng = np.random.default_rng(3)
    x, y = north @ known + 10 * rng.standard_normal(t.size), east @ known + 10 * rng.standard_normal(t.size)
    log = 9.5 + 0.1 * rng.standard_normal(t.size)
    rows = np.vstack([north / 10, east / 10, np.column_stack([one, *[zero] * 5]) / 0.1])
    solution, *_ = np.linalg.lstsq(rows, np.concatenate([x / 10, y / 10, log / 0.1]), rcond=None)
    spread = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))

    still = {"u": "1e-9 m/s", "gamma": "1e-9", "current_north": "1e-9 m/s", "current_east": "1e-9 m/s"}
    # The sway constant keeps within its bounds all the while, or least squares without bounds is another problem.
    wide = {"u": "100 m/s", "gamma": "0.5", "current_north": "100 m/s", "current_east": "100 m/s"}
    kalman = make("position-filter", measured=None, noise=still, initial=wide | {"x": "1e4 m", "y": "1e4 m"}, gate=None)
    run = kalman.filter({"t": t, "psi": psi[::5], "r": r[::5], "x": x, "y": y, "u": log})
    for i, name in enumerate(("u", "gamma", "current_north", "current_east")):
        # Heading and rate run straight between samples in the filter: a few hundredths of a standard deviation.
        assert abs(run[name][-1] - solution[i]) < 0.1 * spread[i], name
        assert run.std_of(name)[-1] == pytest.approx(spread[i], rel=0.02), name


def test_published_coefficients_start_a_filter() -> None:
    """A ship that publishes K* and tau* starts the filter from K*/tau* and 1/tau*."""
    ship = shipid.find_ship("soesterberg")
    section = dict(ship.sections["de-keizer-minimal"])
    known = ParameterSet("known", sections=dict(ship.sections) | {"yaw-filter": {n: section[n] for n in TRUTH}})
    kalman = shipid.ExtendedKalmanFilter(find_model("yaw-filter"), known, measured=SENSORS)
    t = np.arange(3.0)
    run = kalman.filter({"t": t, "u": t + 9, "delta": 0 * t, "psi": 0 * t, "r": 0 * t})
    for name, value in TRUTH.items():
        assert run[name][0] == pytest.approx(value, rel=1e-6)


def test_one_filter_for_all_has_nothing_to_complain_of(sailed: dict[str, np.ndarray]) -> None:
    """The track tells a little of the heading, and what is left of the seventh state is known from the start."""
    run = make("own-ship-filter", measured=None).filter(sailed)
    assert observability(run).messages == ()
