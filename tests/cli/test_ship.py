"""``shipid ship``: what is known of a ship, and the draft of a new one."""

import json
import tomllib

import pytest


def test_a_ship_is_shown_with_its_sources(call):
    answer = call("ship", "zeefakkel")
    assert answer.code == 0
    assert "L           45 m " in answer.out and "length between perpendiculars" in answer.out
    assert "0.15 at 2, " in answer.out and "MSS toolbox" in answer.out
    assert answer.out.splitlines()[-2].startswith("assumed: particulars: speed, de-keizer: K")
    assert answer.out.splitlines()[-1] == "not stated: B, T"
    shown = json.loads(call("ship", "zeefakkel", "--json").out)
    assert shown["particulars"]["L"] == {
        "value": 45.0,
        "unit": "m",
        "source": "MSS toolbox, zeefakkel.m, after van Amerongen (1982)",
    }
    assert "particulars: speed" in shown["assumed"] and shown["not_stated"] == ["B", "T"]


def test_what_a_regression_expects_of_the_hull_is_shown(call):
    lines = call("ship", "kvlcc2").out.splitlines()
    at = lines.index("expected of the hull, not of trials (Clarke, Gedling and Hine 1983):")
    assert lines[at + 1].split()[:4] == ["Y_v", "-0.0253", "±", "0.0040"] and "L/B 5 to 7.6" in lines[at + 9]
    shown = json.loads(call("ship", "kvlcc2", "--json").out)["hull_regression"]
    assert shown["found"]["Y_v"]["value"] == pytest.approx(-0.0253, abs=5e-5) and shown["beyond"] is None
    said = call("ship", "gunnerus").out
    assert "nothing. L/B of ship gunnerus is 3.53, and the regression is used from 4.97 to 7.64." in said


def test_a_draft_becomes_a_ship_when_its_sources_are_filled_in(call, tmp_path):
    path = tmp_path / "tender.toml"
    answer = call(
        "ship",
        "--new",
        "tender",
        "--length",
        "24 m",
        "--speed",
        "12 kn",
        "--rudder",
        "35 deg",
        "--coefficients",
        "nomoto",
        "-o",
        path,
    )
    assert answer.code == 0 and answer.out == "" and "Its sources are empty: fill them in." in answer.said
    refused = call("ship", path)
    assert refused.code == 3 and "L has an empty source" in refused.said
    path.write_text(path.read_text().replace('source = ""', 'source = "builder, drawing 12"'))
    shown = json.loads(call("ship", path, "--json").out)
    assert shown["particulars"]["speed"] == {"value": 12.0, "unit": "kn", "source": "builder, drawing 12"}
    assert shown["not_stated"] == ["B", "T", "delta_rate"] and shown["assumed"] == []
    text = path.read_text()
    assert '# B = { value = ..., unit = "m"' in text and "# beam, as in 8.5 m" in text
    assert '[nomoto]\n# K = { value = ..., unit = "1/s"' in text


def test_a_draft_with_a_source_is_read_by_other_commands(call, tmp_path):
    path = tmp_path / "ship.toml"
    stated = ("--length", "24 m", "--speed", "6 m/s", "--rudder", "35 deg", "--rudder-rate", "3 deg/s")
    assert call("ship", "--new", "tender", *stated, "--source", 'owner\'s "data"', "-o", path).code == 0
    parsed = tomllib.loads(path.read_text())
    assert parsed["particulars"]["delta_rate"]["source"] == 'owner\'s "data"'
    run = call(
        "simulate", "nomoto", "--ship", path, "--manoeuvre", "zigzag:20/20", "--set", "K=0.3 1/s", "--set", "tau=9 s"
    )
    assert run.code == 0 and run.out.count("\n") > 50
    again = call("ship", "--new", "tender", "-o", path)
    assert again.code == 2 and "--overwrite" in again.said
    printed = call("ship", "--new", "tender", "--length", "24 m", "--json")
    assert json.loads(printed.out)["text"].startswith("# Every number has its source")


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        (2, [], ("SHIP", "--new")),
        (2, ["zeefakkel", "--new", "x"], ("not both",)),
        (2, ["zeefakkel", "--length", "3 m", "--source", "x"], ("--length, --source", "only with --new")),
        (2, ["--new", "x", "--source", " "], ("--source is empty",)),
        (2, ["--new", "x", "--length", "24"], ("bare number", "24 m")),
        (2, ["--new", "x", "--length", "3 s"], ("'L'", "does not fit")),
        (2, ["--new", "x", "--beam", "-3 m"], ("'B' (beam)", "greater than zero")),
        (2, ["--new", " "], ("needs a name",)),
        (2, ["nosuch"], ("there is no ship 'nosuch'",)),
        (2, ["--new", "x", "--coefficients", "nosuch"], ("there is no model 'nosuch'",)),
    ],
)
def test_refusals(refused, code, arguments, words):
    refused(code, ["ship", *arguments], *words)


def test_a_draft_says_what_a_model_takes_for_what_is_left_out(call, own_model):
    """Gravity looked like one more number to be found."""
    path = own_model(
        ("import Component,", "import Component, constant,"),
        ("    K = ", '    g = constant("m/s^2", "gravity", default=9.81)\n    K = '),
    )
    drafted = call("ship", "--new", "own", "--coefficients", f"{path}:Yaw").out
    assert '# g = { value = ..., unit = "m/s^2", source = "" }  # gravity; 9.81 m/s² if it is left out' in drafted
    assert "# gain\n" in drafted
