"""Two loadings, one model: the part of the coefficients that changes with the loading, and when there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.identification.validation.loadings import coefficients_at
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.loading import load_parts
from shipid.parameters.parameter_file import read_parameter_set, write_parameter_set
from shipid.parameters.parameter_set import ParameterSet, Value
from shipid.parameters.validity import BEYOND, beyond
from shipid.trials.conditions import Conditions

TRUE = {"K": 0.06, "K_draught": 0.6, "tau": 40.0, "tau_draught": 1.2, "draught_ref": 7.0}
MODEL = shipid.find_model("nomoto-draught")


def known(**coefficients: float) -> ParameterSet:
    particulars = {"L": (150.0, "m"), "speed": (8.0, "m/s")}
    gear = {"delta_max": (35.0, "deg"), "delta_rate": (3.0, "deg/s")}
    sections = {"particulars": particulars, "steering-machine": gear}
    sections |= {MODEL.name: {n: (v, MODEL[n].unit) for n, v in coefficients.items()}} if coefficients else {}
    named = {s: {n: Value(n, *v, "assumed") for n, v in values.items()} for s, values in sections.items()}
    return ParameterSet("ship", sections=named)


SHIP = known()


def sailed(draught: float, seed: int, stated: float | None = None) -> shipid.Trial:
    """A 20/20 zig-zag of the true ship at a draught, with noise; it may state another."""
    run = shipid.simulate(
        MODEL, known(**TRUE), "zigzag:20/20", inputs={"draught": f"{draught} m"}, sampling="2 s", duration="500 s"
    )
    table, noise = run.table[["t", "psi", "r", "delta", "u"]].copy(), np.random.default_rng(seed)
    for name, level in (("psi", 0.3), ("r", 0.02)):
        table[name] += np.deg2rad(level) * noise.standard_normal(len(table))
    conditions = Conditions({"draught_forward": stated or draught, "draught_aft": stated or draught})
    return replace(
        run, name=f"at-{stated or draught:g}", table=table, source=replace(run.source, conditions=conditions)
    )


@pytest.fixture(scope="module")
def fit() -> shipid.Fit:
    return shipid.identify("nomoto", [sailed(9.0, 1), sailed(5.0, 2)], ship=SHIP, starts=1)


def test_the_plain_call_finds_how_coefficients_change(fit):
    assert fit.model.name == "nomoto-draught" and fit.identified.load_part.kept
    assert not [w for w in fit.warnings if w.kind == "loadings"]
    for name in load_parts(MODEL).values():
        e = fit.parameters[name]
        assert e.identifiable and abs(e.value - TRUE[name]) < 4 * e.std and e.std < 0.05
    assert fit.fixed["draught_ref"] == 7.0


def test_coefficients_between_the_loadings_have_true_intervals(fit):
    for draught in (5.0, 6.0, 9.0):
        for name, e in coefficients_at(fit.identified, draught).items():
            true = TRUE[name] * (draught / 7.0) ** TRUE[f"{name}_draught"]
            assert abs(e.value - true) < 4 * e.std, (draught, name)
            assert e.std < 0.02 * true
    assert "at 5 m: K " in fit.text() and "odds more than 100000 to 1" in fit.text()


def test_a_loading_in_between_is_predicted_and_one_outside_is_said(fit):
    inside = fit.validate([sailed(6.5, 3)])
    assert inside.validation[0].rmse["psi"] == pytest.approx(np.deg2rad(0.3), rel=0.4)
    assert not [w for w in inside.warnings if w.kind == BEYOND]
    outside = fit.validate([sailed(10.5, 4)])
    assert any("The draught is 10.5 m" in w for w in outside.warnings if w.kind == BEYOND)


def test_the_ship_file_keeps_the_part_and_its_range(fit, tmp_path):
    write_parameter_set(fit.ship, tmp_path / "ship.toml")
    ship = read_parameter_set(tmp_path / "ship.toml")
    assert ship.joint[MODEL.name].loadings == {"draught": (5.0, 9.0)}
    for draught, said in (("7 m", False), ("3 m", True)):
        held = hold_inputs(MODEL, {"draught": draught})
        assert held.name == MODEL.name and "draught" not in held.inputs
        notices = [n for n in beyond(held, ship) if n.kind == BEYOND]
        assert bool(notices) is said and all("Outside what was fitted" in n for n in notices)


def test_one_ship_that_states_two_loadings_keeps_one_set():
    pooled = shipid.identify("nomoto", [sailed(9.0, 5), sailed(9.0, 6, stated=6.0)], ship=SHIP, starts=1)
    assert pooled.model.name == "nomoto" and set(pooled.estimated) == {"K", "tau"}
    (told,) = (w for w in pooled.warnings if w.kind == "loadings")
    assert "have to be 20 to 1" in told and pooled.identified.load_part.log_odds < 0


def test_at_one_loading_nothing_is_tried():
    alone = shipid.identify("nomoto", [sailed(9.0, 1)], ship=SHIP, starts=1)
    assert alone.model.name == "nomoto" and alone.identified.load_part is None


def test_a_comparison_of_trials_at_two_loadings_has_the_part_too():
    found = shipid.compare_models(["nomoto"], [sailed(9.0, 1), sailed(5.0, 2)], ship=SHIP, starts=1)
    (rank,) = found.ranks
    assert rank.model == MODEL.name and not rank.message
    # A hard turn reads the loading, which nothing but the trials states.
    assert rank.turn is not None and rank.turn.rate == pytest.approx(TRUE["K"] * np.deg2rad(35), rel=0.01)


def test_a_simulated_trial_states_the_loading_it_was_held_at():
    run = shipid.simulate(MODEL, known(**TRUE), "zigzag:20/20", inputs={"draught": "9 m"}, duration="60 s")
    assert run["draught"] == pytest.approx(9.0) and run.unit("draught") == "m"
