"""``shipid filter`` as its user meets it: a record, samples as they arrive, and what it refuses."""

from __future__ import annotations

import io
import json
import threading
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.trials.logs.nmea.writing import nmea_lines

TRIAL = Path(__file__).resolve().parents[2] / "studies" / "trials" / "container-20-20.csv"
NOMOTO = ("--model", "nomoto", "--ship", "soesterberg")
SENSORS = ("--measured", "psi=0.2 deg,r=0.02 deg/s")


@pytest.fixture
def lines() -> list[str]:
    return [line for line in TRIAL.read_text().splitlines() if not line.startswith("#")]


def test_estimates_come_with_intervals_and_the_whiteness_of_the_innovations(call):
    answer = call("filter", TRIAL, *NOMOTO, *SENSORS)
    assert answer.code == 0
    assert "K  " in answer.out and "rate of turn per rudder angle" in answer.out
    assert "innovations of psi" in answer.out and "whiteness" in answer.out
    assert "sensors psi (0.2 deg), r (0.02 deg/s)" in answer.out


def test_json_names_parameters_and_innovations(call):
    answer = call("filter", TRIAL, *NOMOTO, *SENSORS, "--json")
    result = json.loads(answer.out)
    assert set(result["parameters"]) == {"K", "tau"}
    for estimate in result["parameters"].values():
        assert {"value", "unit", "std", "interval_95", "identifiable", "meaning"} <= set(estimate)
        assert estimate["interval_95"][0] < estimate["value"] < estimate["interval_95"][1]
    for innovation in result["innovations"].values():
        assert {"nis_mean", "white_p", "rejected"} <= set(innovation)


def test_a_folder_holds_a_table_a_result_and_a_report(call, tmp_path):
    out = tmp_path / "made" / "here"
    assert call("filter", TRIAL, *NOMOTO, *SENSORS, "--out", out).code == 0
    assert sorted(p.name for p in out.iterdir()) == ["estimates.csv", "report.html", "result.json"]
    table = pd.read_csv(out / "estimates.csv")
    assert len(table) == 738 and np.isfinite(table.to_numpy()).all()
    assert {"t [s]", "r [rad/s]", "std_r [rad/s]", "K [1/s]", "tau [s]"} <= set(table.columns)
    result = json.loads((out / "result.json").read_text())
    assert result["parameters"]["K"]["value"] == pytest.approx(table["K [1/s]"].iloc[-1], rel=1e-8)
    assert "nan" not in (out / "report.html").read_text().lower().replace("nan)", "")
    again = call("filter", TRIAL, *NOMOTO, *SENSORS, "--out", out)
    assert again.code == 2 and "--overwrite" in again.said


def test_the_window_is_that_of_the_trial(call):
    answer = call("filter", TRIAL, *NOMOTO, *SENSORS, "--window", "100:300", "--json")
    assert json.loads(answer.out)["samples"] == 201


def test_samples_that_arrive_give_what_the_record_gives(call, lines, monkeypatch, tmp_path):
    out = tmp_path / "out"
    # With every level given: a record has its own otherwise.
    given = (*NOMOTO, *SENSORS, "--noise", "r=0.006 deg/s^1.5")
    assert call("filter", TRIAL, *given, "--out", out).code == 0
    record = pd.read_csv(out / "estimates.csv")
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(lines) + "\n"))
    answer = call("filter", "--follow", "-", *given)
    assert answer.code == 0
    table = pd.read_csv(io.StringIO(answer.out))
    for name in ("t [s]", "K [1/s]", "tau [s]"):
        np.testing.assert_allclose(table[name], record[name], rtol=1e-8, atol=1e-12)
    # In the units of the log.
    for name in ("psi", "std_psi"):
        np.testing.assert_allclose(np.deg2rad(table[f"{name} [deg]"]), record[f"{name} [rad]"], rtol=1e-8, atol=1e-10)


def test_a_growing_file_is_followed(call, lines, tmp_path):
    path = tmp_path / "growing.csv"
    path.write_text("\n".join(lines[:50]) + "\n" + lines[50][:10])

    def grow() -> None:
        time.sleep(0.2)
        with path.open("a") as stream:
            stream.write(lines[50][10:] + "\n" + "\n".join(lines[51:60]) + "\n")

    writer = threading.Thread(target=grow)
    writer.start()
    answer = call("filter", "--follow", path, "--wait", "1 s", *NOMOTO, *SENSORS, "--json")
    writer.join()
    assert [json.loads(line)["t"]["value"] for line in answer.out.splitlines()] == [float(k) for k in range(59)]


def test_a_line_that_is_no_sample_is_left_out_and_said(call, lines, monkeypatch):
    broken = [*lines[:20], "not,a,sample", *lines[20:25], lines[10], *lines[25:30]]
    missing = lines[30].split(",")
    missing[3] = ""
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join([*broken, ",".join(missing)]) + "\n"))
    answer = call("filter", "--follow", "-", *NOMOTO, *SENSORS, "--json")
    assert answer.code == 0
    estimates = [json.loads(line) for line in answer.out.splitlines()]
    assert len(estimates) == 30
    assert estimates[-1]["taken"] == ["r"]
    assert "line 21: 3 fields" in answer.said and "line 27: refused" in answer.said


def test_nmea_and_dates_are_followed_as_a_table_is(call, tmp_path, lines):
    plain = pd.read_csv(io.StringIO(answer_of(call, tmp_path, "\n".join(lines[:200]))))
    header, *rows = lines[:200]
    stamps = pd.Timestamp("2026-05-04 23:59:00") + pd.to_timedelta([float(row.split(",")[0]) for row in rows], unit="s")
    dated = [f"{stamp:%d.%m.%Y %H:%M:%S.%f},{row.partition(',')[2]}" for stamp, row in zip(stamps, rows)]
    text = "\n".join([header.replace("t [s]", "Zeit"), *dated])
    pd.testing.assert_frame_equal(pd.read_csv(io.StringIO(answer_of(call, tmp_path, text))), plain)
    trial = shipid.read_trial(TRIAL, window="0:198")
    sentences = "\r\n".join(nmea_lines(trial))
    nmea = pd.read_csv(io.StringIO(answer_of(call, tmp_path, sentences, "--format", "nmea")))
    assert nmea["psi [deg]"].iloc[-1] == pytest.approx(plain["psi [deg]"].iloc[-1], abs=0.5)
    assert not nmea.drop(columns="rejected").isna().any().any()


def answer_of(call, tmp_path, text, *options):
    path = tmp_path / "live.log"
    path.write_text(text + "\n")
    answer = call("filter", "--follow", path, "--wait", "0.1 s", *NOMOTO, *SENSORS, *options)
    assert answer.code == 0, answer.err
    return answer.out


def test_a_stream_of_which_every_sample_is_left_out_is_no_success(call, lines, monkeypatch):
    header, *rows = lines[:40]
    place = header.split(",").index("delta [deg]")
    empty = [",".join("" if k == place else c for k, c in enumerate(row.split(","))) for row in rows]
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join([header, *empty]) + "\n"))
    answer = call("filter", "--follow", "-", *NOMOTO, *SENSORS)
    assert answer.code == 3 and not answer.out
    assert "gave no estimate" in answer.err


def test_a_stream_that_begins_before_its_rudder(call, lines, monkeypatch):
    header, *rows = lines[:40]
    late = [
        ",".join(["" if k == header.split(",").index("delta [deg]") else c for k, c in enumerate(row.split(","))])
        for row in rows[:5]
    ]
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join([header, *late, *rows[5:]]) + "\n"))
    answer = call("filter", "--follow", "-", *NOMOTO, *SENSORS, "--json")
    assert len(answer.out.splitlines()) == 34
    assert "line 6: no delta yet; left out" in answer.said and "line 7" not in answer.said


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        (2, ["--measured", "psi=0 deg"], ("psi", "greater than zero")),
        (2, ["--measured", "psi=-1 deg"], ("psi", "greater than zero")),
        (2, ["--measured", "heading=1 deg"], ("heading", "Known")),
        (2, ["--measured", "v=1 m/s"], ("v",)),
        (2, ["--measured", "psi=0.2"], ("bare number", "rad")),
        (2, ["--rates", "psi=0.1 s"], ("psi", "sampled every 1 s")),
        (2, ["--rates", "u=2 s"], ("u", "not measured")),
        (2, ["--noise", "r=0.1 m"], ("rad/s", "density")),
        (2, ["--noise", "q=1 m"], ("q", "Known")),
        (2, ["--initial", "r=0 deg/s"], ("r", "greater than zero")),
        (2, ["--estimate", "zeta"], ("zeta",)),
        (2, ["--gate", "-1"], ("gate", "greater than zero")),
        (2, ["--follow", "-"], ("--follow", "not both")),
    ],
)
def test_refusals(refused, code, arguments, words):
    sensors = () if "--measured" in arguments else SENSORS
    refused(code, ["filter", TRIAL, *NOMOTO, *sensors, *arguments], *words)


def test_what_cannot_be_followed(refused, tmp_path, lines):
    refused(3, ["filter", "--follow", tmp_path / "none.csv", *NOMOTO], "no file")
    empty = tmp_path / "empty.csv"
    empty.write_text("\n")
    refused(3, ["filter", "--follow", empty, "--wait", "0.1 s", *NOMOTO], "header")
    unitless = tmp_path / "unitless.csv"
    unitless.write_text("t,psi\n0,0\n")
    refused(3, ["filter", "--follow", unitless, "--wait", "0.1 s", *NOMOTO], "says no unit")
    lacking = tmp_path / "lacking.csv"
    lacking.write_text("t [s],psi [deg]\n0,0\n")
    refused(2, ["filter", "--follow", lacking, "--wait", "0.1 s", *NOMOTO], "delta", "first sample")
    refused(2, ["filter", *NOMOTO], "TRIAL")
    refused(2, ["filter", "--follow", "-", "--out", tmp_path / "out", *NOMOTO], "--out")
    assert len(lines) > 700


@pytest.mark.parametrize("method", ["rls", "mras-parallel", "combined", "instrumental-variables"])
def test_the_family_of_recursive_identification(call, method, tmp_path):
    arguments = (
        "filter",
        TRIAL,
        "--model",
        "yaw-filter",
        "--ship",
        "soesterberg",
        "--method",
        method,
        "--out",
        tmp_path,
    )
    assert call(*arguments).code == 0
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["method"] == method and not result["diverged"]
    # The trial was simulated with K* 1.6 and tau* 1.7; noise makes least squares biased by some percent.
    for name, truth in (("K", 1.6), ("tau", 1.7)):
        estimate = result["parameters"][name]
        assert estimate["value"] == pytest.approx(truth, rel=0.08)
        assert estimate["interval_95"][0] < estimate["value"] < estimate["interval_95"][1]
    assert method in (tmp_path / "report.html").read_text()
    told = [w["message"] for w in result["warnings"] if w["kind"] == "biased"]
    assert bool(told) is (method == "rls")
    assert not told or "biases the estimates of rls" in told[0]


def test_methods_and_what_they_do_not_take(refused):
    refused(2, ["filter", TRIAL, *NOMOTO, "--method", "kalman"], "kalman", "ekf")
    refused(2, ["filter", "--follow", "-", *NOMOTO, "--method", "rls"], "--follow")


def test_a_record_with_holes(call, lines, tmp_path):
    """Empty fields of a sensor are skipped; over a long hole of the rudder there are no rows, and it says so."""
    head, *rows = [line.split(",") for line in lines]
    rudder, heading = (next(k for k, name in enumerate(head) if name.startswith(n)) for n in ("delta [", "psi ["))
    for k, row in enumerate(rows):
        if 100 <= k < 160:
            row[rudder] = ""
        if k % 3 == 0:
            row[heading] = ""
    log = tmp_path / "holes.csv"
    log.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    out = tmp_path / "out"
    answer = call("filter", log, *NOMOTO, *SENSORS, "--out", out)
    assert answer.code == 0 and "60 of 738 samples lie in holes of an input" in answer.out
    table = pd.read_csv(out / "estimates.csv")
    assert len(table) == 678 and np.isfinite(table.to_numpy()).all()
    assert not ((table["t [s]"] >= 100) & (table["t [s]"] < 160)).any()
    result = json.loads((out / "result.json").read_text())
    assert (
        result["holes"]["samples_left_out"] == 60 and "No delta from 99 to 160 s" in (out / "report.html").read_text()
    )


def test_noise_that_does_not_fit_is_told_in_text_and_json_and_by_the_exit_code(call):
    """Sensors said to be far better than they are: the gate opens, and nobody takes the numbers for right."""
    wrong = (*NOMOTO, "--measured", "psi=0.01 deg,r=0.001 deg/s", "--noise", "r=1e-5 deg/s^1.5")
    text, data = call("filter", TRIAL, *wrong), call("filter", TRIAL, *wrong, "--json")
    assert text.code == data.code == 5
    serious = [w for w in json.loads(data.out)["warnings"] if w["serious"]]
    assert serious and all(w["message"] in text.out for w in serious)
    assert json.loads(data.out)["parameters"]["K"]["interval_95"] is None


def test_defaults_take_the_noise_from_the_record(call, tmp_path):
    answer = call("filter", TRIAL, *NOMOTO, "--out", tmp_path / "out", "--json")
    assert answer.code == 0
    data = json.loads(answer.out)
    levels = data["noise_levels"]
    # The noise of the trial, as its first line states it; what drives the ship stands for the other structure of the model.
    assert levels["sensor:psi"]["value"] == pytest.approx(np.deg2rad(0.2), rel=0.1)
    assert levels["sensor:r"]["value"] == pytest.approx(np.deg2rad(0.02), rel=0.1)
    assert {v["from"] for v in levels.values()} == {"record"}
    batch = shipid.identify("nomoto", [shipid.read_trial(TRIAL)], ship="soesterberg").parameters["K"]
    low, high = batch.ci95
    assert low < data["parameters"]["K"]["value"] < high
    # One record has one output error: the number that identify prints.
    assert data["output_error"]["K"]["value"] == pytest.approx(batch.value)
    text = call("filter", TRIAL, *NOMOTO)
    assert "noise from the record: psi 0.196 deg" in text.out and "output error on the same record: K" in text.out


def test_a_value_outside_the_interval_of_identify_is_told(call, tmp_path):
    """A heading of 2 deg noise: weights and priors of another output error than that of identify would not tell it."""
    noise = {"psi": "2 deg", "r": "0.02 deg/s"}
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", noise=noise, seed=37)
    shipid.write_trial(trial, tmp_path / "log.csv")
    answer = call("filter", tmp_path / "log.csv", *NOMOTO, "--json")
    low, high = shipid.identify("nomoto", [trial], ship="soesterberg").parameters["K"].ci95
    data = json.loads(answer.out)
    assert not low <= data["parameters"]["K"]["value"] <= high
    assert answer.code == 5
    assert any(w["serious"] and w["kind"] == "coefficients-differ" for w in data["warnings"])


def test_samples_beyond_the_gate_are_told_while_they_arrive(call, lines, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(lines) + "\n"))
    wrong = (*NOMOTO, "--measured", "psi=0.01 deg,r=0.001 deg/s", "--noise", "r=1e-5 deg/s^1.5")
    answer = call("filter", "--follow", "-", *wrong, "--json")
    assert answer.code == 5
    assert answer.said.count("samples of psi so far") + answer.said.count("innovations of psi so far") >= 1
    rows = [json.loads(line) for line in answer.out.splitlines()]
    assert not rows[10]["warnings"] and any(w["serious"] for w in rows[-1]["warnings"])


def test_a_wild_first_sample_that_arrives_is_no_first_estimate(call, lines, monkeypatch):
    at = lines[0].split(",").index("psi [deg]")
    first = lines[1].split(",")
    first[at] = "-999"
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join([lines[0], ",".join(first), *lines[2:60]]) + "\n"))
    answer = call("filter", "--follow", "-", *NOMOTO)
    table = pd.read_csv(io.StringIO(answer.out))
    assert table["rejected"][0] == "psi" and table["psi [deg]"].abs().max() < 40
    assert table["rejected"][1:].isna().all()


@pytest.mark.parametrize(("speed", "word"), [("0", "lies still"), ("-3", "goes astern")])
def test_a_ship_that_does_not_go_ahead_is_refused_live_as_from_a_record(
    refused, lines, monkeypatch, tmp_path, speed, word
):
    at = lines[0].split(",").index("u [m/s]")
    rows = [line.split(",") for line in lines[1:60]]
    text = "\n".join([lines[0], *(",".join([*row[:at], speed, *row[at + 1 :]]) for row in rows)]) + "\n"
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    model = ("--model", "de-keizer", "--ship", "soesterberg")
    refused(3, ["filter", "--follow", "-", *model], word)
    path = tmp_path / "log.csv"
    path.write_text(text)
    refused(3, ["filter", path, *model], word)


def test_a_record_that_adds_nothing_determines_nothing(call, zigzag):
    """Before the first execute no rudder turns the ship: the estimates are those the filter starts with."""
    answer = call("filter", f"{zigzag}@0:8", *NOMOTO, "--json")
    found = json.loads(answer.out)["parameters"]
    assert {p["standing"] for p in found.values()} == {"not determined"}
    assert all("of the one it started with" in p["why"] for p in found.values())
    assert "not determined: it is known from before" in call("filter", f"{zigzag}@0:8", *NOMOTO).out


def _condition(folder, name, gain, constant):
    text = f'name = "{name}"\ntitle = "{name}"\n[particulars]\nL = {{ value = 226.0, unit = "m", source = "test" }}\n'
    text += 'speed = { value = 9.5, unit = "m/s", source = "test" }\n[nomoto]\n'
    text += f'K = {{ value = {gain}, unit = "1/s", source = "test" }}\n'
    text += f'tau = {{ value = {constant}, unit = "s", source = "test" }}\n'
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path


def test_which_of_two_ships_sails(call, refused, tmp_path):
    """The container ship's own parameters beside those of a ship that turns half as fast."""
    loaded, heavy = _condition(tmp_path, "own", 0.0673, 40.4), _condition(tmp_path, "heavy", 0.035, 80.0)
    both = ("--model", "nomoto", "--ship", loaded, "--ship", heavy, "--method", "imm")
    out = tmp_path / "out"
    answer = call("filter", f"{TRIAL}@0:200", *both, *SENSORS, "--out", out)
    assert "own sails, with a probability of" in answer.out
    assert "does not say that it is right" in answer.out
    result = json.loads((out / "result.json").read_text())
    assert result["most_probable"] == "own" and result["told"]
    assert result["modes"]["own"]["probability"] > 0.95 > 0.05 > result["modes"]["heavy"]["probability"]
    table = pd.read_csv(out / "estimates.csv")
    assert np.isfinite(table.to_numpy()).all()
    assert table["probability_own [1]"].iloc[-1] == pytest.approx(result["modes"]["own"]["probability"])
    page = (out / "report.html").read_text()
    assert "which ship sails" in page and "Log-likelihood alone: of the filter of this ship by itself" in page
    refused(2, ["filter", TRIAL, *both[:4], "--method", "imm"], "two or more")
    refused(2, ["filter", TRIAL, *both[:6]], "--method imm")
    refused(2, ["filter", TRIAL, *both, "--estimate", "K"], "--estimate")
    refused(
        2,
        ["filter", TRIAL, "--model", "nomoto", "--ship", loaded, "--ship", loaded, "--method", "imm"],
        "different names",
    )


def test_nothing_to_learn_is_no_error(call):
    """Every level given, and no parameter to estimate."""
    given = ("--noise", "r=0.01 deg/s^1.5", "--estimate", "none")
    answer = call("filter", f"{TRIAL}@0:100", *NOMOTO, *SENSORS, *given)
    assert answer.code in (0, 5) and "innovations of psi" in answer.out


def test_the_waves_of_a_model_are_those_of_the_record(call):
    """A calm record filtered by a model of waves: the level that the model declares is ten times too large, and a given one stays."""
    own = ("--model", "yaw-filter", "--ship", "soesterberg", "--json")
    found = json.loads(call("filter", f"{TRIAL}@0:400", *own).out)
    assert 0.7 < found["innovations"]["gyro"]["nis_mean"] < 1.3
    assert not [w for w in found["warnings"] if "noise levels are too large" in w["message"]]
    kept = json.loads(call("filter", f"{TRIAL}@0:400", *own, "--noise", "wave_noise=0.45 deg/s").out)
    assert kept["innovations"]["gyro"]["nis_mean"] < 0.1
