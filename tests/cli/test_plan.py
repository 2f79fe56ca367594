"""``shipid plan``: the shape of its JSON, its text, and what it refuses."""

import contextlib
import io
import json

import pytest

from shipid.cli import run
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre

QUICK = (
    "plan",
    "--model",
    "norrbin",
    "--ship",
    "zeefakkel",
    "--draws",
    "1",
    "--repertoire",
    "zigzag:20/10,telegraph:20",
)


@pytest.fixture(scope="module")
def calm():
    """The JSON of a short plan in calm water."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert run([*QUICK, "--time", "5min", "--json"]) == 0
    return json.loads(out.getvalue())


def test_json(call):
    answer = call(*QUICK, "--time", "12min", "--json")
    assert answer.code == 0, answer
    found = json.loads(answer.out)
    for leg in found["plan"]:
        assert set(leg) == {"manoeuvre", "speed", "duration", "start", "seed"}
        parse_manoeuvre(leg["manoeuvre"])
    assert found["gain_over_standard"]["det"] > 1
    assert set(found["gain_over_standard"]) == {"det", "a", "b1", "b3"}
    assert found["determinant"]["ratio"] > found["determinant"]["per_parameter"]
    last = found["plan"][-1]
    assert last["start"]["value"] + last["duration"]["value"] <= found["time"]["value"] == 720


def test_text(call):
    answer = call(
        *QUICK, "--time", "12min", "--criterion", "A", "--worst-case", "--speed", "9 kn", "--estimate", "a,b1"
    )
    assert answer.code == 0, answer
    for word in ("A-optimal over the worst of 1 draws", "4.63 m/s", "zigzag:20/20", "determinant", "b1"):
        assert word in answer.out
    assert "b3" not in answer.out


def test_a_plan_in_a_current_and_a_wind(call, calm, tmp_path):
    """The timetable, its sea room and the page are of the weather that is stated; the choice is that of calm water."""
    weather = ["--current", "2 kn to 0 deg", "--wind", "5 m/s from 90 deg", "--heading", "180 deg"]
    coefficients = ["--set", "N_w=5e-6 rad/m^2", "--set", "F_w=5e-6 1/m^2"]
    told = json.loads(
        call(*QUICK, "--time", "5min", *weather, *coefficients, "--json", "--out", str(tmp_path / "p")).out
    )
    assert told["plan"] == calm["plan"] and calm["timetable"]["weather"] == "calm"
    assert told["timetable"]["weather"] == (
        "a current of 1.03 m/s to 0 deg and a wind of 5 m/s from 90 deg, first heading 180 deg"
    )
    assert told["timetable"]["sea_room"]["ahead"]["value"] < calm["timetable"]["sea_room"]["ahead"]["value"] - 50
    page = (tmp_path / "p" / "report.html").read_text(encoding="utf-8")
    for word in (
        "Orders to the helm",
        "a wind of 5 m/s from 90 deg",
        "Sea room",
        told["timetable"]["orders"][1]["action"],
    ):
        assert word in page


def test_a_planned_manoeuvre_can_be_simulated(call, calm):
    leg = calm["plan"][0]
    answer = call(
        *("simulate", "norrbin", "--ship", "zeefakkel", "--manoeuvre", leg["manoeuvre"], "--seed", leg["seed"]),
        *("--speed", f"{leg['speed']['value']} m/s", "--duration", f"{leg['duration']['value']} s"),
    )
    assert answer.code == 0 and float(answer.out.splitlines()[-1].split(",")[0]) == pytest.approx(
        leg["duration"]["value"], abs=0.3
    )


@pytest.mark.parametrize(
    ("code", "options", "words"),
    [
        (2, ["--time", "10s"], ("too short", "72 s")),
        (2, ["--time", "20"], ("bare number 20", "20 s")),
        (2, ["--time", "20 m"], ("m does not fit",)),
        (2, ["--time", "-3min"], ("greater than zero",)),
        (2, ["--time", "9min", "--criterion", "E"], ("'E'", "A, D")),
        (2, ["--time", "9min", "--repertoire", "zigzg"], ("Did you mean zigzag?",)),
        (2, ["--time", "9min", "--repertoire", "zigzag:a/2"], ("zigzag:20/20",)),
        (2, ["--time", "9min", "--estimate", "b4"], ("'b4'", "b3")),
        (2, ["--time", "9min", "--noise", "lots"], ("'lots'",)),
        (2, ["--time", "9min", "--speed", "9"], ("bare number 9",)),
        (3, ["--time", "9min", "--speed", "50 kn"], ("2 to 6.2 m/s",)),
        (2, ["--time", "9min", "--set", "K"], ("NAME=VALUE",)),
        (2, ["--time", "9min", "--seed", "-1"], ("'--seed'",)),
        (2, ["--time", "9min", "--model", "norbin"], ("Did you mean norrbin",)),
        (2, ["--time", "9min", "--ship", "zeefakel"], ("Did you mean zeefakkel?",)),
        (3, ["--time", "9min", "--model", "pershitz"], ("q21", "[pershitz]")),
        (3, ["--time", "9min", "--wind", "8 m/s from 20 deg"], ("N_w", "--set 'N_w=", "[wind]")),
        (2, ["--time", "9min", "--current", "2 kn"], ("where it flows",)),
        (2, [], ("'--time'", "shipid plan --help")),
    ],
)
def test_refusals(refused, code, options, words):
    refused(code, [*QUICK, *options], *words)
