"""``shipid models`` and ``shipid show``, and what the command line costs before it works."""

import json
import os
import subprocess
import sys

import pytest

MODELS = (
    "nomoto", "nomoto-second-order", "norrbin", "bech", "de-keizer", "van-leeuwen", "davidson-schiff", "pershitz",
)  # fmt: skip
SHIPS = ("zeefakkel", "soesterberg", "semerdjiev", "mariner", "kvlcc2", "kvlcc2-7m", "gunnerus", "esso-osaka-3m")
NUMERIC = ("casadi", "numpy", "scipy", "matplotlib", "control", "pandas", "pint", "sympy", "jinja2", "rich")


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["idenfity"]])
def test_help_imports_nothing_numeric(arguments):
    code = (
        "import sys; from shipid.cli import run; "
        f"code = run({arguments!r}); "
        f"print([m for m in {NUMERIC!r} if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ)
    assert done.stderr.splitlines()[-1] == "[]"


def test_help_names_every_command(call):
    answer = call("--help")
    assert answer.code == 0
    assert all(f"\n  {name} " in answer.out for name in ("models", "show", "ship", "simulate", "measure", "identify"))
    assert answer.err == ""


@pytest.mark.parametrize("command", ["models", "show", "simulate", "measure", "identify"])
def test_help_of_a_command(call, command):
    answer = call(command, "--help")
    assert answer.code == 0
    assert answer.out.startswith(f"Usage: shipid {command}")


def test_models_are_listed_a_line_each(call):
    lines = call("models").out.splitlines()
    first = [line.split()[0] for line in lines]
    assert set(MODELS) | set(SHIPS) <= set(first)
    assert len(first) == len(set(first))


def test_models_as_json(call):
    listed = json.loads(call("models", "--json").out)
    assert set(MODELS) <= set(listed["models"])
    assert set(SHIPS) <= set(listed["ships"])
    assert listed["models"]["nomoto"]["parameters"] == ["K", "tau"]
    assert "norrbin" in listed["ships"]["zeefakkel"]["models"]


@pytest.mark.parametrize("model", MODELS)
def test_show(call, model):
    plain = call("show", model)
    assert plain.code == 0
    assert plain.out.startswith(f"{model}: ")
    assert all(f"\n{title}\n" in plain.out for title in ("states", "inputs", "parameters", "equations"))
    shown = json.loads(call("show", model, "--json").out)
    assert shown["model"] == model
    assert {"psi", "r", "x", "y", "delta"} <= set(shown["quantities"])
    assert all(e["source"].strip() for e in shown["equations"])
    latex = call("show", model, "--latex").out
    assert latex.startswith(r"\begin{align}")
    assert latex.count("&=") == len(shown["equations"])


def test_called_with_nothing_it_shows_the_help(call):
    answer = call()
    assert "Commands:" in answer.out + answer.err


def test_a_model_as_json_says_what_each_quantity_is(call):
    quantities = json.loads(call("show", "norrbin", "--json").out)["quantities"]
    kinds = {n: q["kind"] for n, q in quantities.items()}
    assert (kinds["delta"], kinds["r"], kinds["a"], kinds["K"]) == ("input", "state", "parameter", "derived")
    assert {"start", "low", "high"} <= set(quantities["a"]) and "default" not in quantities["a"]
    assert quantities["current_north"]["default"] == 0.0
    assert "start" not in quantities["delta"]
