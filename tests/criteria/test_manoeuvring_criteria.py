"""Criteria against closed forms, against the measured simulation, and in words where there is no number."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.criteria.criteria import first_overshoot_limit, second_overshoot_limit
from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
from shipid.criteria.spiral import spiral_of
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value

L, U = 226.0, 9.5


@pytest.mark.parametrize(
    ("unit_time", "first", "second"),
    [(5, 10, 25), (10, 10, 25), (20, 15, 32.5), (30, 20, 40), (60, 20, 40)],
)
def test_limits_of_the_resolution(unit_time, first, second):
    """MSC.137(76) 5.3.3: 10, 5 + 0.5 L/V, 20 deg; 25, 17.5 + 0.75 L/V, 40 deg; continuous at 10 s and 30 s."""
    assert first_overshoot_limit(unit_time) == pytest.approx(first)
    assert second_overshoot_limit(unit_time) == pytest.approx(second)


def norrbin(a1: float) -> dict[str, float]:
    """Norrbin's ship of K 1.6 and a3 20 in regular coefficients, tau 1, SI."""
    return {"a": 1.6 * (U / L) ** 2, "b1": a1 * U / L, "b3": 20 * L / U}


def test_norrbin_s_loop_has_its_closed_form():
    """Half width 2/(3 K) sqrt(a1^3 / (3 a3)) = 3.08 deg; height 2 sqrt(a1/a3)."""
    spiral = spiral_of(shipid.find_model("norrbin"), norrbin(-1.0), U, L)
    assert np.rad2deg(spiral.half_width) == pytest.approx(3.08, abs=0.005)
    assert spiral.half_width == pytest.approx(2 / (3 * 1.6) / np.sqrt(60), rel=1e-4)
    # The branch is met between two points of the curve, 0.004 apart.
    assert spiral.loop_height * L / U == pytest.approx(2 * np.sqrt(1 / 20), rel=1e-3)
    assert not spiral.stable


def test_a_stable_ship_has_no_loop():
    spiral = spiral_of(shipid.find_model("norrbin"), norrbin(1.0), U, L)
    assert (spiral.half_width, spiral.loop_height, spiral.stable) == (0.0, 0.0, True)


def test_sway_and_speed_take_part_in_the_steady_state():
    """De Keizer's turn obeys H(r*) = K delta whatever speed it loses, so that the loop is the same."""
    model = shipid.find_model("de-keizer")
    known = shipid.find_ship("soesterberg").values(model, speed=U) | {"alpha1": -1.0, "alpha3": 20.0}
    spiral = spiral_of(model, known, U, L, np.deg2rad(35))
    assert np.rad2deg(spiral.half_width) == pytest.approx(3.08, abs=0.005)


def test_a_ship_in_the_wind_has_no_spiral():
    model = shipid.find_model("cubic-wind")
    known = shipid.find_ship("esso-osaka-3m").values(model, speed=0.4)
    assert spiral_of(model, known, 0.4, 3.0) is None


def test_the_numbers_are_those_of_the_measured_simulation():
    model = shipid.find_model("de-keizer")
    found = {r.key: r.starboard.value for r in manoeuvring_criteria(model, ship="soesterberg", draws=0).rows}
    turn = shipid.measure(shipid.simulate(model, "soesterberg", "turn:35", sampling="0.2 s"), length="226 m")
    zigzag = shipid.measure(shipid.simulate(model, "soesterberg", "zigzag:10/10", sampling="0.2 s"), length="226 m")
    assert found["advance"] == pytest.approx(turn.advance_ratio, rel=0.005)
    assert found["tactical_diameter"] == pytest.approx(turn.tactical_diameter_ratio, rel=0.005)
    assert found["initial_turning"] == pytest.approx(zigzag.initial_turning_ratio, rel=0.01)
    # The clocks of the two differ, and with them the sample in which the rudder is reversed.
    overshoots = np.rad2deg(zigzag.overshoots[:2])
    assert [found["first_overshoot_10"], found["second_overshoot_10"]] == pytest.approx(overshoots, abs=0.15)


def test_both_sides_of_a_symmetric_ship_are_the_same():
    for row in manoeuvring_criteria("norrbin", ship="zeefakkel", draws=0).rows:
        assert row.port.value == pytest.approx(row.starboard.value, rel=1e-6)


def test_bands_from_a_fit_and_words_of_extrapolation(sail):
    fit = shipid.identify("de-keizer", [sail("de-keizer", "soesterberg", "zigzag:10/10")], ship="soesterberg", starts=1)
    result = shipid.manoeuvring_criteria(fit)
    plain = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    swing = plain["criteria"]["first_overshoot_10"]
    low, high = swing["starboard"]["interval_95"]
    assert low < swing["starboard"]["value"] < high
    notes = " ".join(w["message"] for w in plain["warnings"])
    assert "up to 10 deg" in notes and "35 deg are extrapolated" in notes
    assert "20 and 35" in notes
    assert plain["standard"] == "evaluated against MSC.137(76) 5.3"
    assert "90 % of the speed at 85 %" in notes and "100 m and longer" in notes
    assert "compliant" not in repr(result) + str(plain)
    assert set(result.to_frame().columns) >= {"value", "interval_95", "limit"}


def test_bands_from_the_standard_deviations_of_a_set():
    own = shipid.find_ship("soesterberg")
    section = {n: replace(v, std=0.05 * abs(v.value) or None) for n, v in own.sections["de-keizer"].items()}
    spread = replace(own, sections={**own.sections, "de-keizer": section})
    row = manoeuvring_criteria("de-keizer", ship=spread).rows[0]
    assert row.starboard.band95[0] < row.starboard.value < row.starboard.band95[1]
    assert manoeuvring_criteria("de-keizer", ship=own).rows[0].starboard.band95 is None


def test_a_model_that_runs_away_says_so():
    own = shipid.find_ship("zeefakkel")
    bad = {
        "a": Value("a", 0.016, "1/s^2", "assumed"),
        "b1": Value("b1", 0.03, "1/s", "assumed"),
        "b3": Value("b3", -400.0, "s/rad^2", "assumed"),
    }
    ship = replace(own, sections={**own.sections, "norrbin": bad})
    result = manoeuvring_criteria("norrbin", ship=ship)
    plain = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    turn = plain["criteria"]["tactical_diameter"]
    assert turn["starboard"]["value"] is None and turn["within"] is None
    assert "runs away" in turn["starboard"]["words"] and "runs away" in plain["warnings"][0]["message"]


def test_what_is_missing_is_said():
    with pytest.raises(UsageError, match="need a ship"):
        manoeuvring_criteria("norrbin")
    with pytest.raises(UsageError, match="greater than zero"):
        manoeuvring_criteria("de-keizer", ship="soesterberg", speed="0 kn")
    with pytest.raises(ParameterSetError, match="no length L"):
        manoeuvring_criteria("norrbin", ship=ParameterSet("bare"), speed=5.0)
    with pytest.raises(UnknownNameError):
        manoeuvring_criteria("norrbin", ship="zeefakel")
    own = shipid.find_ship("soesterberg")
    kept = {n: v for n, v in own.sections[PARTICULARS].items() if n not in ("delta_max", "delta_rate")}
    notes = manoeuvring_criteria(
        "de-keizer", ship=replace(own, sections={**own.sections, PARTICULARS: kept}), draws=0
    ).notes
    assert any("35 deg is assumed" in n for n in notes) and any("65 deg in 28 s is assumed" in n for n in notes)
