"""Model files and parameter sets that are wrong: the file, the line or the table, and what to do."""

import json

import pytest

EQUATION = "return (self.K * self.delta - self.r) / self.tau"


GAIN = '"1/s", "gain"'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = 1\nraise RuntimeError('no luck')\n", ("fails in line 2", "RuntimeError: no luck")),
        ("import sys\n\nsys.exit(5)\n", ("fails in line 3", "SystemExit: 5")),
        ("x = 1\ny = (\n", ("fails in line 2", "SyntaxError")),
        ("import no_such_package\n", ("fails in line 1", "no_such_package")),
        ("", ("declares no model", "Component")),
        ("x = 1\n", ("declares no model",)),
    ],
)
def test_model_file_that_fails(refused, own_model, text, words):
    refused(3, ["show", f"{own_model(text=text)}:Yaw"], "own_model.py", *words)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (GAIN, '"1/s", 3', ("fails in line", "AttributeError")),
        ("@r.rate", "@r.rat", ("fails in line 13", "'rat'")),
        ("    @r.rate\n", "", ("state 'r' of Yaw has no equation", "@r.rate")),
        (GAIN, '"m", "gain"', ("Yaw.yaw", "own_model.py:16", "units do not match", "m·rad", "rad/s")),
        (EQUATION, "return self.r * 1", ("Yaw.yaw", "own_model.py", "rad/s²", "rad/s")),
        (EQUATION, "return None", ("Yaw.yaw", "own_model.py", "returns nothing")),
        ("self.delta -", "self.delte -", ("Yaw", "'delte'", "Did you mean delta?")),
        (GAIN, '"blorp", "gain"', ("'K' of Yaw", "'blorp' is not a unit")),
    ],
)
def test_model_that_is_wrong(refused, own_model, old, new, words):
    refused(3, ["show", f"{own_model((old, new))}:Yaw"], *words)


def test_binary_model_file(refused, tmp_path):
    path = tmp_path / "own.py"
    path.write_bytes(b"\xff\xfe\x00\x01")
    refused(3, ["show", f"{path}:Yaw"], "own.py", "SyntaxError")


def test_name_in_a_model_file(refused, own_model):
    path = own_model()
    refused(2, ["show", f"{path}:Yow"], "own_model.py", "'Yow'", "Did you mean Yaw?")
    refused(3, ["show", path], "own_model.py:NAME", "Yaw")
    refused(3, ["show", path.with_name("none.py")], "no model file", "none.py")


def test_what_a_model_file_prints_is_no_result(call, own_model):
    path = own_model(("class Yaw", "print('hello')\n\n\nclass Yaw"))
    answer = call("show", f"{path}:Yaw", "--json")
    assert json.loads(answer.out)["model"] == "yaw"
    assert answer.err == "hello\n"


@pytest.mark.parametrize("value", ["0.0", "-45.0"])
def test_length_of_zero(refused, zigzag, own_ship, value):
    ship = own_ship(("value = 45.0", f"value = {value}"))
    for model in ("nomoto", "de-keizer"):
        refused(3, ["identify", zigzag, "--model", model, "--ship", ship], "length L", f"{float(value):g} m")
    refused(3, ["simulate", "de-keizer", "--ship", ship, "--manoeuvre", "turn:20"], "own-ship", "length L")


@pytest.mark.parametrize("value", ["0 m", "-5 m"])
def test_length_fixed_at_zero(refused, zigzag, own_ship, value):
    arguments = ["identify", zigzag, "--model", "de-keizer", "--ship", own_ship(), "--fix", f"L={value}"]
    refused(3, arguments, "length L", value)


LENGTH = 'L = { value = 45.0, unit = "m", source = "assumed" }'


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("L = 45.0", ("bare number 45.0", "unit", "source")),
        ("L = '45 m'", ("is text",)),
        ("L = { value = 45.0, unit = 'm' }", ("has no source",)),
        ("L = { value = 45.0, source = 'assumed' }", ("has no unit",)),
        ("L = { value = 45.0, unit = 'm', source = ' ' }", ("empty source", "'assumed' is a source")),
        ("L = { value = nan, unit = 'm', source = 'assumed' }", ("nan", "finite")),
        ("L = { value = 'x', unit = 'm', source = 'assumed' }", ("x", "finite")),
        ("L = { value = 45.0, unit = 's', source = 'assumed' }", ("'L'", "s does not fit")),
        ("L = { value = 45.0, unit = 'blorp', source = 'assumed' }", ("'blorp' is not a unit",)),
        ("L = { value = 45.0, unit = 'm', sorce = 'assumed' }", ("'sorce'", "Did you mean source")),
        ("L = { value = 45.0,", ("not valid TOML",)),
    ],
)
def test_parameter_set(refused, zigzag, own_ship, line, words):
    ship = own_ship((LENGTH, line))
    refused(3, ["identify", zigzag, "--model", "de-keizer", "--ship", ship], *words)
    refused(3, ["simulate", "de-keizer", "--ship", ship, "--manoeuvre", "turn:20"], *words)


def test_parameter_set_that_is_not_there(refused, zigzag, tmp_path):
    refused(3, ["identify", zigzag, "--model", "nomoto", "--ship", tmp_path / "none.toml"], "none.toml")
    refused(2, ["identify", zigzag, "--model", "nomoto", "--ship", tmp_path], "there is no ship")


def test_what_the_ship_does_not_hold(refused, zigzag, own_ship):
    arguments = ["identify", zigzag, "--model", "de-keizer"]
    refused(3, arguments, "L [m]", "--set 'L=VALUE m'")
    refused(3, [*arguments, "--ship", own_ship((LENGTH, ""))], "L [m]", "own-ship")
    refused(3, ["simulate", "norrbin", "--ship", own_ship(), "--manoeuvre", "turn:20"], "own-ship", "[norrbin]")
