"""Bands of predicted manoeuvres: they hold the truth, they widen where the data are silent, and they are never NaN."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.identification.uncertainty.draws import band_of, draws_of
from shipid.identification.validation.bands import _held_on, manoeuvres_of
from shipid.identification.validation.closed_loop import helmsman_of
from shipid.identification.validation.trial_measures import measured_circle
from shipid.report.write_report import render
from shipid.trials.doctor.findings import Diagnosis
from shipid.trials.measuring.measure import measure

KEYS = ("advance", "transfer", "tactical_diameter", "steady_rate", "steady_speed")


@pytest.fixture(scope="module")
def fit(sail):
    held_out = [sail("de-keizer", "soesterberg", m, seed=i) for i, m in enumerate(("zigzag:10/10", "turn:20"), start=2)]
    return shipid.assess(
        shipid.identify(
            "de-keizer", [sail("de-keizer", "soesterberg", seed=1)], ship="soesterberg", starts=1, validate=held_out
        ),
        findings=False,
    )


def test_the_result_has_every_key_and_no_nan(fit):
    result = json.loads(json.dumps(fit.to_dict(), allow_nan=False))["manoeuvre"]
    zigzag, turn = (result[f"de-keizer-{m}"] for m in ("zigzag-10-10", "turn-20"))
    swings = len(zigzag["overshoots"]["value"])
    assert swings >= 4
    for key in ("predicted_overshoots", "predicted_overshoots_closed_loop"):
        assert len(zigzag[key]["value"]) == len(zigzag[key]["interval_95"]) == swings and zigzag[key]["unit"] == "deg"
    for key in KEYS:
        assert set(turn[key]) == {"measured", "predicted", "interval_95", "unit"}
        assert turn[key]["interval_95"][0] < turn[key]["predicted"] < turn[key]["interval_95"][1]
    assert turn["overshoots"]["value"] == [] and "advance" not in zigzag


def test_a_turn_is_predicted_from_its_order_however_long_the_approach(fit, sail):
    """A ship that holds her course against a wind by rudder is not turned by it for the length of her approach."""
    trial = sail("de-keizer", "soesterberg", "turn:20", noise="none", name="turn")
    t = np.arange(400) * trial.sampling
    ahead = trial.table.iloc[[0] * t.size].assign(
        t=t, psi=0.0, delta=np.radians(-7.0), u=np.linspace(0.8, 1.0, t.size) * trial["u"][0]
    )
    whole = trial.table.assign(t=trial["t"] + t[-1] + trial.sampling)
    long = replace(trial, name="held", table=pd.concat([ahead, whole], ignore_index=True))
    fit = fit.validate([trial, long])
    found = shipid.assess(fit, findings=False).assessment.manoeuvres
    for name in ("advance", "transfer", "tactical_diameter"):
        assert found["held"].turn[name].predicted == pytest.approx(found["turn"].turn[name].predicted, rel=0.01)


def test_a_ship_that_turns_more_slowly_than_the_record_lasts_is_in_the_band(fit, sail):
    """Of the ships that the trials allow many are not through 180 deg where the record ends, and the prediction itself is not."""
    # She turns faster than the fitted ship.
    trial = sail("de-keizer", "soesterberg", "turn:20", noise="none", name="whole", values={"K": "1.68"})
    through = float(np.interp(np.pi, np.abs(trial["psi"]), trial["t"]))
    short = replace(trial.window(None, through + 6.0), name="short")
    found = shipid.assess(fit.validate([trial, short]), findings=False).assessment.manoeuvres
    for name in ("advance", "transfer", "tactical_diameter"):
        whole, cut = found["whole"].turn[name], found["short"].turn[name]
        assert cut.measured == pytest.approx(whole.measured, rel=0.01)
        assert cut.predicted == pytest.approx(whole.predicted, rel=0.01)
        assert cut.band95 == pytest.approx(whole.band95, rel=0.01)


def test_a_turn_whose_propeller_stops_at_once_is_not_sailed_on(sail):
    trial = sail("de-keizer", "soesterberg", "turn:20", noise="none", name="turn")
    circle = measured_circle(trial, None)
    revolutions = np.where(trial["t"] <= circle.first_execute, 2.0, 0.0)
    assert _held_on(trial, circle) is not None
    assert _held_on(replace(trial, table=trial.table.assign(n=revolutions)), circle) is None


def test_the_prediction_in_the_band_is_the_one_of_the_fit(fit):
    for c in (*fit.fitted, *fit.validation):
        assert fit.assessment.manoeuvres[c.trial.name].open_loop == pytest.approx(c.predicted_overshoots, abs=1e-9)


def test_a_simulated_helmsman_is_read_from_the_record(fit, sail):
    trial = sail("de-keizer", "soesterberg", "zigzag:10/10", noise="none")
    helmsman = helmsman_of(trial, measure(trial))
    own = shipid.find_ship("soesterberg")
    assert helmsman.rate == pytest.approx(own.particular("delta_rate", "rad/s"), rel=0.15)
    assert np.rad2deg(helmsman.angles[:2]) == pytest.approx([10, -10], abs=0.1)
    # The helmsman decides on the samples of the record, a degree apart at the most.
    assert np.rad2deg(helmsman.headings[:4]) == pytest.approx([10, -10, 10, -10], abs=1.0)


def test_closed_loop_repeats_the_manoeuvre_of_the_true_ship(fit, sail):
    true = measure(sail("de-keizer", "soesterberg", "zigzag:10/10", noise="none")).overshoots
    foreseen = fit.assessment.manoeuvres["de-keizer-zigzag-10-10"].closed_loop
    count = min(len(true), len(foreseen)) - 1
    # The reading of an execute is good to a sample, in which this ship turns by 0.3 deg.
    assert np.rad2deg(foreseen[:count]) == pytest.approx(np.rad2deg(true[:count]), abs=0.6)


def test_the_bands_hold_what_the_truth_would_do_with_the_same_rudder(fit, truth_of):
    inside = []
    for c in fit.validation:
        manoeuvre = fit.assessment.manoeuvres[c.trial.name]
        solution, truth = fit.identified.solution, truth_of("de-keizer", "soesterberg")
        values = np.array([truth[n] for n in fit.estimated])
        exact = replace(solution, q=np.concatenate([values, solution.q[len(values) :]]))
        same = replace(c, biases={**c.biases, "delta": 0.0})
        identified = replace(fit.identified, solution=exact)
        foreseen = manoeuvres_of(identified, [same], draws_of(fit.identified, 2))[c.trial.name]
        pairs = [*zip(foreseen.open_loop, manoeuvre.band95)]
        pairs += [(foreseen.turn[k].predicted, v.band95) for k, v in manoeuvre.turn.items()]
        inside += [band[0] <= value <= band[1] for value, band in pairs]
    assert len(inside) >= 9
    # Quantities of one fit err together: 95 % hold on the average over campaigns, not within one.
    assert np.mean(inside) >= 0.6


def test_bands_can_be_left_out(sail):
    fit = shipid.identify("nomoto", [sail("nomoto", "zeefakkel")], ship="zeefakkel", starts=1)
    for unasked in (fit, shipid.assess(fit, bands=False)):
        result = unasked.to_dict()["manoeuvre"]
        assert set(next(iter(result.values()))) == {"overshoots", "predicted_overshoots", "not_sailed"}
    assert shipid.assess(fit, bands=False).assessment.manoeuvres is None


def test_draws_have_the_covariance_of_the_fit(fit):
    drawn = draws_of(fit.identified, 512).values
    seen = [i for i, n in enumerate(fit.estimated) if fit.parameters[n].identifiable]
    spread = np.sqrt(np.diag(fit.covariance))
    # 512 evenly spread draws scatter by a per cent or two; logarithms make the positive ones a little wider.
    assert drawn[:, seen].std(axis=0) == pytest.approx(spread[seen], rel=0.1)
    box = fit.identified.box
    assert (drawn >= box.low).all() and (drawn <= box.high).all()


def test_what_no_data_have_seen_is_drawn_over_its_bounds(sail):
    trial = sail("de-keizer", "soesterberg")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", signals=["psi", "r", "u"], starts=1)
    assert fit.parameters["gamma"].std is None
    drawn = draws_of(fit.identified).values[:, fit.estimated.index("gamma")]
    assert np.isfinite(drawn).all() and drawn.max() > 3 * drawn.min()
    json.dumps(fit.to_dict(), allow_nan=False)


def test_a_model_that_runs_away_has_no_band(sail):
    fit = shipid.identify(
        "norrbin", [sail("norrbin", "zeefakkel", "zigzag:5/5", seed=1)], ship="zeefakkel", fixed={"b3": "-200 s/rad^2"}
    )
    fit = fit.validate([sail("norrbin", "zeefakkel", "turn:35", seed=2)])
    turn = shipid.assess(fit).to_dict()["manoeuvre"]["norrbin-turn-35"]
    assert turn["advance"]["measured"] is not None
    assert turn["advance"]["predicted"] is None and turn["advance"]["interval_95"] is None
    json.dumps(turn, allow_nan=False)


def test_a_band_has_a_side_of_its_own_either_way():
    low, high = band_of(1.0, [0.9, 1.4, 0.9, 1.4])
    assert low == pytest.approx(1 - 1.96 * 0.1, abs=1e-3)
    assert high == pytest.approx(1 + 1.96 * 0.4, abs=1e-3)
    assert band_of(None, [1.0]) is None
    assert band_of(1.0, [1.0] * 8 + [None, None]) is None


def test_a_prediction_on_the_floor_of_the_model_has_no_numbers(sail):
    """K_u* 0.9 from a gentle zig-zag: over the rudder of a hard turn that another ship sailed, the model loses its way."""
    gentle = sail("de-keizer", "soesterberg", "zigzag:10/10", seed=1, values={"K_u": "0.9"})
    hard = sail("de-keizer", "soesterberg", "turn:35", seed=2, sampling="1 s")
    fit = shipid.identify(
        "de-keizer", [gentle], ship="soesterberg", starts=1, fixed={"K_u": "0.9", "tau_u": "2.5"}, validate=[hard]
    )
    fit = shipid.assess(fit, findings=False)
    compared = fit.validation[0]
    assert compared.departure.guard == "way_kept" and compared.predicted_circle is None
    assert 100 < compared.departure.time < 300
    words = (
        "not sailed by this model: the forward speed is on the model's floor, a twentieth of the cruising speed from "
    )
    assert words in fit.text()
    plain = json.loads(json.dumps(fit.to_dict(), allow_nan=False))["manoeuvre"]
    assert plain[hard.name]["not_sailed"].startswith(words) and plain[gentle.name]["not_sailed"] is None
    for key in KEYS:
        assert plain[hard.name][key]["predicted"] is plain[hard.name][key]["interval_95"] is None
        assert plain[hard.name][key]["measured"] is not None
    assert f"The prediction of {hard.name} is {compared.departure}." in render(fit).replace("&#39;", "'")


def test_a_model_turns_from_her_heading_at_the_order(sail):
    """Of a log in which the ship turned at the order no course is known; a model has no helmsman who would have kept one."""
    trial = sail("de-keizer", "soesterberg", "turn:20", noise="none", name="turn")
    t = np.arange(100) * trial.sampling
    ahead = trial.table.iloc[[0] * t.size].assign(t=t)
    whole = trial.table.assign(t=trial["t"] + t[-1] + trial.sampling)
    straight = replace(trial, table=pd.concat([ahead, whole], ignore_index=True))
    order = measured_circle(straight, None).first_execute
    swinging = np.where(straight["t"] < order, np.radians(0.6) * (straight["t"] - order), straight["psi"])
    turning = replace(straight, table=straight.table.assign(psi=swinging))
    read = measured_circle(turning, None, diagnosis=Diagnosis("turn"))
    assert read.advance is None and "no course" in read.reasons["advance"]
    sailed, true = measured_circle(turning, None), measured_circle(straight, None)
    for name in ("advance", "transfer", "tactical_diameter"):
        assert getattr(sailed, name) == pytest.approx(getattr(true, name), rel=0.01)
