"""Batches of course changes against an integrator we did not write, closed forms, and themselves."""

from __future__ import annotations

import dataclasses

import control
import numpy as np
import pytest

import shipid
from shipid.autopilot.course_changes.run_course_changes import course_histories, run_course_changes
from shipid.autopilot.course_changes.sea_filter import LAG
from shipid.autopilot.course_changes.weather import Weather, standard_weather
from shipid.autopilot.design.closed_loop import heading_frequency, to_control
from shipid.autopilot.design.control_law import IntegralCourseController
from shipid.generation.system import generate
from shipid.parameters.draws import Drawn, draw_coefficients
from shipid.parts.wind import Wind


def test_a_course_change_equals_python_controls(container):
    """60 degrees with limit, rate limit and loss of speed: overshoot and settling of solve_ivp over the nonlinear loop."""
    found = run_course_changes(container, [9.5], [np.deg2rad(60)])
    loop = to_control(container, 9.5, nonlinear=True)
    t = np.linspace(0, 400, 4001)
    order = np.zeros((len(loop.input_labels), t.size))
    order[loop.input_index["cruise"]], order[loop.input_index["psi_order"]] = 9.5, np.deg2rad(60)
    start = [9.5 if s == "u" else 0.0 for s in loop.state_labels]
    psi = control.input_output_response(
        loop, t, order, start, solve_ivp_kwargs={"rtol": 1e-8, "max_step": 1.0}
    ).outputs[0]
    assert np.rad2deg(found.overshoot[0]) == pytest.approx(np.rad2deg(psi.max()) - 60, abs=2e-3)
    outside = t[np.abs(psi - np.deg2rad(60)) > np.deg2rad(1.2)][-1]
    assert found.settling[0] == pytest.approx(outside, abs=0.5)


def test_settling_is_the_same_in_another_batch(container):
    """Runs of another speed beside it give another interval: the time at which the heading settles does not depend on it."""
    alone = run_course_changes(container, [9.5], [np.deg2rad(60)])
    beside = run_course_changes(container, [4.75, 9.5, 11.4], np.deg2rad([60, 60, 60]))
    assert alone.settling[0] == pytest.approx(beside.settling[1], abs=5e-3)


def test_measures_against_the_history(container):
    """The meter inside the model against numpy over the samples of the same run."""
    change = np.deg2rad(45)
    found = run_course_changes(container, [9.5], [change])
    shown = course_histories(container, [9.5], [change])
    t, psi, delta = shown["t"][0], shown["psi"][0], shown["delta"][0]
    span = found.duration[0]
    assert found.rms_error[0] == pytest.approx(np.sqrt(np.trapezoid((psi - change) ** 2, t) / span), rel=5e-3)
    assert found.rms_rudder[0] == pytest.approx(np.sqrt(np.trapezoid(delta**2, t) / span), rel=1e-2)
    assert found.travel[0] == pytest.approx(np.abs(np.diff(delta)).sum() / span, rel=1e-2)


def test_port_and_starboard_are_mirrored(container):
    found = run_course_changes(container, [9.5, 9.5], np.deg2rad([40, -40]))
    for name in ("overshoot", "settling", "rms_error", "rms_rudder", "reversals", "cross_track"):
        a, b = getattr(found, name)
        assert a == pytest.approx(b, rel=1e-9, abs=1e-12), name


def test_reversals_are_counted():
    """A helm that swings by 2 degrees at 0.1 rad/s through a ship that hardly answers: two reversals a period."""
    weather = Weather(0.0, 0.6, 0.0, 0.0)
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds=[9.5])
    assert run_course_changes(pilot, [9.5], [0.0], weather=weather).reversals[0] == 0.0
    found = run_course_changes(
        pilot, [9.5] * 6, [0.0] * 6, weather=standard_weather(226.0, 9.5), measured_from=5.0, headings=[np.pi] * 6
    )
    # Narrow-band waves from ahead at 0.6 + 0.6^2 9.5/9.81 rad/s: two reversals each period, some swings too small to count.
    assert 0.7 * 2 * 0.949 / (2 * np.pi) * 60 < found.reversals.mean() <= 1.35 * 2 * 0.949 / (2 * np.pi) * 60


def test_waves_have_the_size_asked_for():
    """The heading by waves of a ship at rest: root mean square as asked, over 64 runs."""
    from shipid.generation.ensemble import make_ensemble, steps_of
    from shipid.models import Waves

    model = shipid.join("waves", Waves)
    batch = make_ensemble(model, ("wave_noise",))
    weather = Weather(0.0, 0.6, np.deg2rad(0.5), 0.0)
    interval, count = np.full(64, 0.2), steps_of(2000)
    held = np.zeros((len(model.inputs), 64))
    p = np.repeat(
        [[{"wave_frequency": 0.6, "wave_damping": 0.15, "g": 9.81}[n]] for n in batch.system.coefficients], 64, axis=1
    )
    ends = [
        batch(np.zeros((2, 64)), held, p, interval, count, weather.noise(count, interval, s)[None])[0] for s in range(8)
    ]
    # 512 independent ends: the standard deviation is known to 3 %.
    assert np.rad2deg(np.std(ends)) == pytest.approx(0.5, rel=0.1)


def test_an_integral_takes_out_the_steady_error(container, integral):
    weather = Weather(12.0, 0.6, 0.0, 0.0)
    for pilot, least, most in ((container, 2.0, 9.0), (integral, 0.0, 0.05)):
        found = run_course_changes(
            pilot, [9.5], [0.0], weather=weather, headings=[np.deg2rad(135)], measured_from=60.0, lengths=90.0
        )
        assert least <= abs(np.rad2deg(found.mean_error[0])) <= most


def test_the_integral_does_not_wind_up(integral):
    """A course change of 120 degrees, rudder on its limit most of the time, overshoots no more than one of 20 does."""
    found = run_course_changes(integral, [9.5, 9.5], np.deg2rad([20, 120]))
    assert found.overshoot[1] <= found.overshoot[0] + np.deg2rad(0.3)


def test_the_integral_stands_while_the_rudder_lags():
    """Limit 20 deg, Kp = 2: the integral takes errors up to a fifth of 20/2 deg, while the rudder is within 10 deg of its order."""
    system = generate(shipid.join("law", IntegralCourseController))

    def rate(error: float, rudder: float) -> float:
        known = {"gain_Kp": 2.0, "rudder_limit": np.deg2rad(20)}
        known |= {"psi_order": np.deg2rad(error), "delta": np.deg2rad(rudder)}
        x, u, p = (system.vector(n, known, 0.0) for n in (system.states, system.inputs, system.coefficients))
        return float(np.rad2deg(system.right_hand_side(x, u, p)))

    for side in (1, -1):
        assert rate(side * 1.5, side * 3.0) == pytest.approx(side * 1.5)
        assert rate(side * 8.0, side * 16.0) == pytest.approx(side * 2.0)
        # The order is 16 deg: the rudder is 9 deg short of it, then 11, then 11 beyond.
        assert rate(side * 8.0, side * 7.0) == pytest.approx(side * 2.0)
        assert rate(side * 8.0, side * 5.0) == 0.0
        assert rate(side * 8.0, side * 27.0) == 0.0
        # The order is 22 deg, and limited.
        assert rate(side * 11.0, side * 20.0) == 0.0


def test_the_track_is_the_same_in_ship_lengths_at_any_speed(sized):
    """Passenier (1989), section 3.3.2.2, with a rudder at once and no loss of speed: Kd by u/L scales the run exactly."""
    ship = sized("soesterberg", "de-keizer", K_u=1e-9)
    pilot = shipid.design_autopilot("de-keizer", ship, actuator=None, speeds=[4.75, 9.5, 19.0])
    found = run_course_changes(pilot, [4.75, 9.5, 19.0], np.deg2rad([60] * 3))
    np.testing.assert_allclose(found.cross_track / 226.0, found.cross_track[1] / 226.0, atol=1e-6)
    np.testing.assert_allclose(found.settling * found.speed, found.settling[1] * 9.5, rtol=1e-6)


def test_the_sea_filter_spares_the_rudder_and_keeps_the_course(container):
    """Waves from ahead: the notch halves the rudder at least, and the heading is kept no worse."""
    raw, clean = (
        run_course_changes(container, [9.5] * 6, [0.0] * 6, weather=Weather(0.0, 0.6, np.deg2rad(0.2), 0.0), headings=[np.pi] * 6,
             measured_from=5.0, filtered=f)
        for f in (False, True)
    )  # fmt: skip
    assert clean.rms_rudder.mean() < 0.5 * raw.rms_rudder.mean()
    assert clean.rms_error.mean() < raw.rms_error.mean() + np.deg2rad(0.05)
    # Twice a wave, which comes 9.1 times a minute, the raw rudder reverses, and by its noise; the filtered one is no busier.
    assert clean.reversals.mean() < raw.reversals.mean() and raw.reversals.mean() > 2 * 9.1
    assert clean.travel.mean() < 0.5 * raw.travel.mean()


def test_the_sea_filter_is_set_to_the_waves_the_ship_meets(container):
    """Of waves to 100 deg, on the way from 0 to 60 deg: met at 70 deg off the bow, omega - omega^2 u/g cos 70 deg."""
    met = 0.6 - 0.6**2 * 9.5 / 9.81 * np.cos(np.deg2rad(70))
    sea = Weather(0.0, 0.6, np.deg2rad(0.2), 0.0)
    own, told = (
        run_course_changes(
            container, [9.5], [np.deg2rad(60)], weather=sea, headings=[np.deg2rad(100)], filtered=True, values=values
        )
        for values in ({}, {"sea_frequency": met, "sea_lag": LAG * heading_frequency(container, 9.5)})
    )
    assert own.rms_rudder[0] == pytest.approx(told.rms_rudder[0], rel=1e-9)


def test_what_a_load_condition_lacks_is_added_to_its_own(sized):
    """A ship of known length in its first condition; in the second the length is not known, and that of the design is taken."""
    ship = shipid.find_ship("soesterberg")
    parts = {n: v for n, v in ship.sections["particulars"].items() if n != "L"}
    second = dataclasses.replace(ship, sections={**ship.sections, "particulars": parts})
    pilot = shipid.design_autopilot("nomoto", [ship, second], speeds=[9.5])
    loop = shipid.join("ship", shipid.find_model("nomoto"), Wind)
    weather = standard_weather(pilot.length, 9.5)
    assert weather.values(pilot, loop, 1)["L"] == pilot.length == ship.particular("L", "m")
    assert "L" not in weather.values(pilot, loop, 0)
    assert weather.values(pilot, loop) == weather.values(pilot, loop, 0)


def test_the_weather_follows_froude():
    """Ships alike at one Froude number meet waves, wind and current alike: u/sqrt(L) and omega sqrt(L) are the same.

    From a length of 100 m on it is the weather of the sea.
    """
    small, large, largest = (standard_weather(length, 1.2 * np.sqrt(length)) for length in (4.0, 100.0, 400.0))
    assert (large.wind, large.wave_frequency, large.current) == (12.0, 0.6, 1.0)
    assert largest == large
    assert (small.wind, small.wave_frequency, small.current) == pytest.approx((12.0 / 5, 0.6 * 5, 1.0 / 5))
    assert small.wave_heading == large.wave_heading == pytest.approx(np.deg2rad(0.2))
    # The wind goes to 30 deg, the current across it.
    given = large.inputs(np.array([np.deg2rad(30)]))
    current = np.array([given["current_north"][0], given["current_east"][0]])
    assert current @ [np.sqrt(0.75), 0.5] == pytest.approx(0.0, abs=1e-12) and np.hypot(*current) == pytest.approx(1.0)


def test_the_sea_filter_is_a_notch_with_a_roll_off():
    """In the declared loop: what passes at its frequency is nothing, a steady rate passes whole, a rate of 60 rad/s by 1 %."""
    from shipid.autopilot.course_changes.sea_filter import SeaFiltered

    model = shipid.join("filter", SeaFiltered)
    linear = shipid.linearise(
        model, {"sea_frequency": 0.6, "sea_lag": 0.6, "sea_depth": 1.0, "sea_width": 0.7, "log_scale": 1.0}, ["r_swing", "r_band", "r_smooth"], ["r"],
        ["r_seen"],
    ).to_state_space()  # fmt: skip
    response = np.abs(linear(1j * np.array([1e-6, 0.6, 60.0])))
    np.testing.assert_allclose(response, [1.0, 0.0, 0.01], atol=1e-4)


def test_draws_are_sailed(uncertain_pilot):
    drawn = draw_coefficients(uncertain_pilot.model, uncertain_pilot.ship, 40)
    assert drawn.names == ("K", "tau")
    found = run_course_changes(uncertain_pilot, np.full(40, 9.5), np.full(40, 0.5), drawn=drawn)
    assert np.isfinite(found.overshoot).all() and np.ptp(found.settling) > 1.0
    same = run_course_changes(
        uncertain_pilot, [9.5], [0.5], values={"K": drawn.values[7, 0], "tau": drawn.values[7, 1]}
    )
    assert same.settling[0] == pytest.approx(found.settling[7], rel=1e-9)


def test_a_draw_is_the_same_ship_at_any_speed(uncertain):
    """Passenier (1989), section 3.3.2.2: K follows u/L and tau L/u, so a drawn ship turns alike in ship lengths at any speed."""
    speeds = [4.75, 9.5, 19.0]
    pilot = shipid.design_autopilot("nomoto", uncertain("soesterberg", "nomoto"), actuator=None, speeds=speeds)
    drawn = draw_coefficients(pilot.model, pilot.ship, 4)
    each = Drawn(drawn.names, drawn.nominal, np.repeat(drawn.values, 3, axis=0), drawn.source)
    found = run_course_changes(pilot, speeds * 4, np.full(12, np.deg2rad(60)), drawn=each)
    lengths = (found.settling * found.speed).reshape(4, 3)
    assert np.ptp(lengths[:, 1]) > 10.0
    np.testing.assert_allclose(lengths, np.repeat(lengths[:, [1]], 3, axis=1), rtol=1e-9)
    np.testing.assert_allclose(
        found.overshoot.reshape(4, 3).T, found.overshoot[1::3][None].repeat(3, axis=0), rtol=1e-9
    )


def test_a_current_carries_the_track_along(container):
    """A uniform current moves water and ship alike: across the new course the track is as wide as in still water."""
    still = run_course_changes(container, [9.5], [np.deg2rad(70)])
    for direction in np.deg2rad([0.0, 50.0, 200.0]):
        found = run_course_changes(
            container, [9.5], [np.deg2rad(70)], weather=Weather(0.0, 0.6, 0.0, 2.0), headings=[direction]
        )
        assert found.cross_track[0] == pytest.approx(still.cross_track[0], rel=1e-9)


def test_a_ship_without_a_length_is_judged():
    """What it sails in a second stands in for its length, in the weather too."""
    from shipid.parameters.parameter_set import ParameterSet, Value

    numbers = {"K": Value("K", 0.1, "1/s", "assumed"), "tau": Value("tau", 20.0, "s", "assumed")}
    own = {"speed": Value("speed", 5.0, "m/s", "assumed")}
    pilot = shipid.design_autopilot(
        "nomoto", ParameterSet("bare", sections={"nomoto": numbers, "particulars": own}), speeds=[5.0]
    )
    assert pilot.length == 5.0
    found = run_course_changes(pilot, [5.0], [0.0], weather=standard_weather(pilot.length, 5.0))
    assert np.isfinite(found.rms_error).all()


def test_a_run_that_is_lost_is_no_number(sized):
    """A damping that turns negative at speed: the run diverges, and says so instead of a number."""
    ship = sized("soesterberg", "de-keizer", alpha3=-9.0)
    pilot = shipid.design_autopilot("de-keizer", ship, speeds=[7.0, 9.5], rudder_limit="30 deg")
    judged = shipid.judge(pilot, samples=0)
    assert any(s.lost and s.overshoot_deg is None for s in judged.steps)
    assert any(w.startswith("lost: course changes of") and "not sailed by this model" in w for w in judged.warnings)
    assert judged.weakest.share == 0.0


def test_a_run_on_the_floor_of_the_model_is_lost(sized):
    """K_u* 3 and 35 deg of rudder: in a change of 170 deg the ship loses its way, and its last numbers are finite."""
    lossy, shipped = (sized("soesterberg", "de-keizer", K_u=k) for k in (3.0, 0.35))
    found = []
    for ship in (lossy, shipped):
        pilot = shipid.design_autopilot("de-keizer", ship, speeds=[9.5], rudder_limit="35 deg")
        found.append(run_course_changes(pilot, [9.5, 9.5], np.deg2rad([10.0, 170.0])))
    assert np.isfinite(found[0].overshoot).tolist() == [True, False]
    assert np.isfinite(found[1].overshoot).all()
