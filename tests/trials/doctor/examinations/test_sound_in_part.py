"""Logs that are right in one thing and wrong in another: what is named, and what is left alone."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.foundation.errors import ShipidError
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.repair import NoSafeRepairError, fix_trial
from shipid.trials.doctor.robust_statistics import straight_runs


def columns(trial, *names):
    return {c: trial[c].copy() for c in names or ("t", "x", "y", "psi", "u", "r", "delta")}


def check(values, path, ship=None):
    """Write a table in SI units, and examine it."""
    units = {"t": "s", "x": "m", "y": "m", "psi": "rad", "r": "rad/s", "delta": "rad"}
    head = ",".join(f"{c} [{units.get(c, 'm/s')}]" for c in values)
    rows = [",".join("" if np.isnan(v) else f"{v:.10g}" for v in row) for row in np.column_stack(list(values.values()))]
    path.write_text("\n".join([head, *rows]) + "\n")
    return check_trial(path, ship)


def found(diagnosis, kind):
    return next(f for f in diagnosis.findings if f.kind == kind)


@pytest.mark.parametrize("turn", [30, 90, -120])
def test_a_turned_track_says_nothing_against_the_speed(simulated, tmp_path, turn):
    log = columns(simulated())
    place = (log["x"] + 1j * log["y"]) * np.exp(1j * np.radians(turn))
    log["x"], log["y"] = place.real, place.imag
    diagnosis = check(log, tmp_path / "log.csv")
    finding = found(diagnosis, "track-direction")
    side = "starboard" if turn > 0 else "port"
    told = float(finding.message.split("turned by ")[1].split(" ")[0])
    assert told == pytest.approx(abs(turn), abs=2) and f"to {side}" in finding.message
    assert finding.serious and finding.fix is None and "speed-scale" not in diagnosis.kinds
    with pytest.raises(NoSafeRepairError, match="track-direction"):
        fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")


@pytest.mark.parametrize(("name", "said"), [("x", "counts to the south"), ("y", "counts to the west")])
def test_a_mirrored_position_is_named(simulated, tmp_path, name, said):
    log = columns(simulated())
    log[name] = -log[name]
    finding = found(check(log, tmp_path / "log.csv"), "track-direction")
    assert finding.serious and said in finding.message and finding.fix is None


def test_exchanged_positions_are_exchanged_back(simulated, tmp_path):
    truth = simulated()
    log = columns(truth)
    log["x"], log["y"] = log["y"], log["x"]
    assert found(check(log, tmp_path / "log.csv"), "track-direction").repaired
    fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")
    np.testing.assert_allclose(shipid.read_trial(tmp_path / "fixed.csv")["x"], truth["x"], atol=1e-6)


def test_a_speed_that_stands_is_named(simulated, tmp_path):
    log = columns(simulated())
    log["u"] = 1e-3 * np.random.default_rng(1).standard_normal(len(log["t"]))
    finding = found(check(log, tmp_path / "log.csv"), "speed-stands")
    assert finding.serious and "while the track makes" in finding.message and finding.fix is None


def test_a_speed_over_ground_called_u_is_not_scaled(simulated, tmp_path):
    """A current of 1 m/s to the east: the log follows the track, the ship is set off its heading."""
    log = columns(simulated("turn:35", "none"))
    log["y"] = log["y"] + 1.0 * log["t"]
    log["u"] = np.hypot(np.gradient(log["x"], log["t"]), np.gradient(log["y"], log["t"]))
    diagnosis = check(log, tmp_path / "log.csv")
    assert not any(f.repaired and "u" in f.channels for f in diagnosis.findings)
    assert {"ground-speed", "track-inconsistent"} & set(diagnosis.kinds)


@pytest.mark.parametrize("seconds", [10.0, 20.0])
def test_a_rudder_that_is_logged_before_it_acts(simulated, tmp_path, seconds):
    log = columns(simulated("zigzag:20/20", "none", "norrbin", "kvlcc2"))
    log["delta"] = np.interp(log["t"] + seconds, log["t"], log["delta"])
    finding = found(check(log, tmp_path / "log.csv"), "latency")
    told = float(finding.message.split("about ")[1].split(" ")[0])
    assert told == pytest.approx(seconds, abs=2) and "before it acts" in finding.message and finding.fix is None


def test_an_autopilot_in_gusts_is_named(faults, simulated, tmp_path):
    log = faults.Log(simulated(noise="none"), "soesterberg", 1)
    faults.FAULTS["closed-loop"][0](log, 2.0)
    log.frame().to_csv(tmp_path / "log.csv", index=False)
    finding = found(check_trial(tmp_path / "log.csv"), "closed-loop")
    assert finding.serious and "Output error is biased" in finding.effect


@pytest.mark.parametrize("gust", [0.0005, 0.001, 0.002])
@pytest.mark.parametrize("course", [0, 10])
def test_an_autopilot_is_named_however_mild_the_disturbance(tmp_path, gust, course):
    rng, n = np.random.default_rng(4), 1200
    wanted = np.radians(course) * np.sign(np.sin(2 * np.pi * np.arange(n) / 300))
    psi, r, delta, push = (np.zeros(n) for _ in range(4))
    for k in range(1, n):
        push[k] = 0.95 * push[k - 1] + gust * rng.standard_normal()
        delta[k] = np.clip(1.4 * (wanted[k] - psi[k - 1]) - 8 * r[k - 1], -0.6, 0.6)
        r[k] = r[k - 1] + (0.08 * delta[k - 1] - r[k - 1] + push[k]) / 12
        psi[k] = psi[k - 1] + r[k]
    log = {"t": np.arange(float(n)), "psi": psi, "r": r, "delta": delta}
    finding = found(check(log, tmp_path / "log.csv"), "closed-loop")
    explained = float(finding.message.split("% of the turning")[0].split()[-1])
    assert finding.confidence > 0.5 and finding.spoils == (explained < 90)


def test_holes_are_told_by_what_they_hide(simulated, tmp_path):
    log = columns(simulated())
    turning = int(np.argmax(np.abs(log["r"])))
    log["psi"][turning : turning + 60] = np.nan
    log["u"][5:20] = np.nan
    diagnosis = check(log, tmp_path / "log.csv")
    holes = {f.channel: f for f in diagnosis.findings if f.kind == "hole"}
    assert holes["psi"].serious and not holes["u"].serious
    t = log["t"]
    assert holes["psi"] in diagnosis.bearing_on(["psi"], t[turning], t[turning + 30])
    assert holes["psi"] not in diagnosis.bearing_on(["psi"], t[turning + 70], t[-1])
    assert holes["psi"] not in diagnosis.bearing_on(["r"])


def test_signals_on_their_own_clocks_are_no_holes(simulated, tmp_path):
    """Heading at every stamp, rate at every second, positions at every fifth: nothing is missing."""
    log = columns(simulated())
    n = np.arange(len(log["t"]))
    log["r"][n % 2 != 0] = np.nan
    for c in ("x", "y", "u"):
        log[c][n % 5 != 1] = np.nan
    diagnosis = check(log, tmp_path / "log.csv")
    assert not diagnosis.serious and not {"hole", "missing", "gap"} & set(diagnosis.kinds)


def test_every_row_comes_back_with_its_missing_samples(simulated, tmp_path):
    truth = simulated()
    log = columns(truth)
    log["r"][40:45] = np.nan
    log["psi"][100] = -9999.0
    log["delta"] = -log["delta"]
    diagnosis = check(log, tmp_path / "log.csv")
    assert (diagnosis.rows, diagnosis.kept) == (len(truth), len(truth)) and {"sentinel", "rudder-sign"} <= set(
        diagnosis.kinds
    )
    fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")
    fixed = shipid.read_trial(tmp_path / "fixed.csv")
    assert len(fixed) == len(truth)
    assert np.isnan(fixed["r"][40:45]).all() and np.isnan(fixed["psi"][100])
    np.testing.assert_allclose(fixed["delta"], truth["delta"], atol=1e-8)
    assert f"rows: {len(truth)} read, {len(truth)} written" in fixed.source.comment


def test_rows_that_are_left_out_are_counted(simulated, tmp_path):
    log = columns(simulated())
    log = {c: np.concatenate([v, v[-1:], [np.nan, np.nan]]) for c, v in log.items()}
    answer = check(log, tmp_path / "log.csv").to_dict()["rows"]
    n = len(log["t"])
    # The reader leaves rows without any number out itself, with a note; the doctor counts what it leaves out.
    assert answer["read"] - answer["kept"] == sum(part["rows"] for part in answer["left_out"]) > 0
    assert answer["kept"] == n - 3 and all(part["why"] for part in answer["left_out"])


def test_rows_of_several_sensors_at_one_stamp_become_one(simulated, tmp_path):
    log = columns(simulated(), "t", "psi", "r", "delta")
    gone = np.full(len(log["t"]), np.nan)
    both = {c: np.column_stack([v, v if c == "t" else gone]).ravel() for c, v in log.items()}
    both["r"] = np.column_stack([gone, log["r"]]).ravel()
    diagnosis = check(both, tmp_path / "log.csv")
    assert diagnosis.kept == len(log["t"]) and "none of their samples lost" in diagnosis.left_out[0].why
    fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")
    np.testing.assert_allclose(shipid.read_trial(tmp_path / "fixed.csv")["r"], log["r"], atol=1e-9)


def test_rows_with_one_stamp_and_two_readings_are_not_dropped(simulated, tmp_path):
    log = columns(simulated(), "t", "psi", "r", "delta")
    log["t"][300:320] = log["t"][300]
    check(log, tmp_path / "log.csv")
    try:
        fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")
    except NoSafeRepairError as error:
        assert "clock-repeats" in str(error)
    else:
        assert len(shipid.read_trial(tmp_path / "fixed.csv")) == len(log["t"])


@pytest.mark.parametrize("channel", ["psi", "r", "u", "x", "delta"])
@pytest.mark.parametrize("row", [0, 1, -1])
def test_a_wild_sample_at_either_end_draws_no_other_repair(simulated, tmp_path, channel, row):
    log = columns(simulated())
    reach = max(float(np.ptp(log[channel])), float(np.abs(log[channel]).max()))
    log[channel][row] -= 30 * reach
    diagnosis = check(log, tmp_path / "log.csv", "soesterberg")
    named = [f for f in diagnosis.findings if f.kind in ("outlier", "heading-glitch") and channel in f.channels]
    assert named and named[0].repaired
    assert {f.kind for f in diagnosis.findings if f.repaired} <= {"outlier", "heading-glitch", "heading-wrap"}


def test_a_rudder_that_goes_over_within_the_last_sample_is_wild(simulated, tmp_path):
    log = columns(simulated("zigzag:-20/10", "none", "nomoto", "kvlcc2"))
    log["delta"][-1] = -log["delta"][-1]
    finding = found(check(log, tmp_path / "log.csv", "kvlcc2"), "outlier")
    assert finding.channel == "delta" and finding.rows == (len(log["t"]) - 1,) * 2


def test_small_glitches_are_no_matter(simulated, tmp_path):
    log = columns(simulated(noise="none"))
    log["psi"][200:202] += np.radians(0.03)
    assert not check(log, tmp_path / "log.csv").findings


def test_many_findings_of_one_kind_are_told_once(simulated, tmp_path):
    log = columns(simulated())
    for k, c in enumerate(("x", "y", "u", "r", "delta")):
        log[c][100 + 40 * k] += 40 * max(float(np.ptp(log[c])), 1.0)
    diagnosis = check(log, tmp_path / "log.csv")
    assert len([f for f in diagnosis.findings if f.kind == "outlier"]) == 5
    text = diagnosis.text()
    assert text.count("  outlier (") == 1 and text.count("also: ") == 1


def test_numbers_beyond_every_instrument_end_in_a_diagnosis(simulated, tmp_path):
    log = columns(simulated())
    log["t"] = log["t"] * 1e15
    log["u"] = log["u"] * 1e25
    json.dumps(check(log, tmp_path / "log.csv").to_dict(), allow_nan=False)


def test_what_read_trial_would_refuse_is_not_written(simulated, tmp_path):
    log = {c: v[:9] for c, v in columns(simulated(), "t", "psi", "r").items()}
    check(log, tmp_path / "log.csv")
    with pytest.raises(ShipidError):
        fix_trial(tmp_path / "log.csv", tmp_path / "fixed.csv")
    assert not (tmp_path / "fixed.csv").exists()


@pytest.mark.parametrize("factor", [1e-170, 1e-310, 1e150])
@pytest.mark.parametrize("name", ["r", "delta", "u", "psi", "x"])
def test_a_channel_whose_squares_vanish_or_overflow_is_examined(simulated, name, factor):
    trial = simulated()
    log = {c: trial[c] * (factor if c == name else 1.0) for c in ("t", "x", "y", "psi", "u", "r", "delta")}
    units = {"t": "s", "x": "m", "y": "m", "psi": "rad", "u": "m/s", "r": "rad/s", "delta": "rad"}
    record = shipid.Trial.from_frame(pd.DataFrame(log), units=units)
    with np.errstate(all="ignore"):
        assert check_trial(record).findings is not None


@pytest.mark.parametrize("sampling", ["1 s", "2 s"])
def test_a_coarse_zigzag_of_a_nimble_ship_is_no_closed_loop(sampling):
    """A filter as wide as the time from one order to the next made waves of the steps, and they follow the heading."""
    assert (
        "closed-loop"
        not in check_trial(shipid.simulate("nomoto", "zeefakkel", "zigzag:10/10", sampling=sampling)).kinds
    )


def test_a_line_drawn_across_a_gap_is_found_in_the_digits_of_the_rest_and_calm_stretches_are_none():
    """A rough record has calm stretches, which bend little for it: they are no lines."""
    random, t = np.random.default_rng(4), np.arange(0.0, 600.0, 2.0)
    rough = np.where((t > 200) & (t < 300), 0.0, 1.0) * np.cumsum(np.cumsum(random.normal(0, 0.02, t.size)) * 0.5)
    heading = 30 * np.sin(t / 40) * (t < 200) + rough + random.normal(0, 0.05, t.size)
    assert not len(straight_runs(t, heading))
    drawn = np.round(np.where((t > 100) & (t < 140), np.interp(t, [100, 140], [heading[50], heading[70]]), heading), 2)
    assert straight_runs(t, drawn).tolist() == [[50, 70]]


def test_a_rudder_alone_is_examined():
    diagnosis = check_trial(
        shipid.Trial.from_frame({"t [s]": np.arange(60.0), "delta [deg]": np.sin(np.arange(60.0) / 5)})
    )
    assert "no-motion" in diagnosis.kinds
