"""Misspelt and misused arguments: exit code 2 (a name, an option) or 3 (a value whose unit does not fit)."""

import pytest


def test_misspelt_command(refused):
    refused(2, ["idenfity", "x.csv"], "'idenfity'", "Did you mean identify?")


def test_misspelt_option(refused, zigzag, fitted):
    refused(2, ["identify", zigzag, *fitted, "--estimat", "K"], "--estimat", "--estimate", "identify --help")


def test_argument_too_many(refused):
    refused(
        2, ["simulate", "nomoto", "--ship", "zeefakkel", "zigzag:20/20"], "(zigzag:20/20). See shipid simulate --help."
    )


def test_model_is_asked_for(refused, zigzag):
    refused(2, ["identify", zigzag], "'--model'", "shipid identify --help")
    refused(2, ["identify", "--model", "nomoto"], "TRIAL")


def test_misspelt_model(refused, zigzag):
    refused(2, ["identify", zigzag, "--model", "nomotto"], "'nomotto'", "Did you mean nomoto?", "file.py:Class")
    refused(2, ["show", "nomotto"], "'nomotto'", "Did you mean nomoto?")


def test_misspelt_ship(refused, zigzag):
    refused(2, ["identify", zigzag, "--model", "nomoto", "--ship", "zeefakel"], "'zeefakel'", "Did you mean zeefakkel?")


@pytest.mark.parametrize(
    ("manoeuvre", "words"),
    [
        ("zigzg:20/20", ("'zigzg'", "Did you mean zigzag?")),
        ("zigzag", ("zigzag:20/20",)),
        ("zigzag:a/20", ("zigzag:20/20",)),
        ("zigzag:0/0", ("zero",)),
        ("turn:nan", ("turn:35",)),
        ("", ("turn:35",)),
    ],
)
def test_manoeuvre(refused, manoeuvre, words):
    refused(2, ["simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", manoeuvre], *words)


@pytest.mark.parametrize(
    ("code", "options", "words"),
    [
        (2, ["--speed", "5"], ("bare number 5", "5 m/s")),
        (2, ["--speed", "5 s"], ("m/s", "does not fit")),
        (2, ["--speed", "nan kn"], ("does not start with a number",)),
        (3, ["--speed", "50 kn"], ("2 to 6.2 m/s", "outside")),
        (2, ["--speed", "0 kn"], ("greater than zero",)),
        (2, ["--speed", "-3 kn"], ("greater than zero",)),
        (2, ["--sampling", "0 s"], ("sampling interval",)),
        (2, ["--sampling", "5000 s"], ("sampling interval",)),
        (2, ["--duration", "-1 s"], ("-1 s",)),
        (2, ["--duration", "1e12 s"], ("steps", "shorter duration")),
        (2, ["--noise", "lots"], ("'lots'", "standard")),
        (2, ["--noise", "psi=0.2"], ("bare number 0.2", "0.2 deg")),
        (2, ["--noise", "psy=0.2 deg"], ("'psy'", "Did you mean psi")),
        (2, ["--noise", "psi=-0.2 deg"], ("psi", "zero or more")),
        (2, ["--seed", "-1"], ("'--seed'",)),
        (2, ["--seed", "x"], ("'--seed'",)),
        (2, ["--set", "K"], ("NAME=VALUE",)),
        (2, ["--set", "K=1 1/s", "--set", "K=2 1/s"], ("'K'", "twice")),
        (2, ["--set", "K=1"], ("'K'", "bare number 1", "1/s")),
        (2, ["--fix", "K=1 m"], ("'K'", "1/s", "m does not fit")),
        (2, ["--set", "Q=1 s"], ("'Q'",)),
        (2, ["--current", "3 kn 30 deg"], ("3 kn to 30 deg",)),
        (2, ["--current", "3 kn to 30"], ("bare number 30",)),
        (3, ["--wind", "10 m/s from 30 deg"], ("zeefakkel", "--set")),
    ],
)
def test_simulate(refused, code, options, words):
    refused(code, ["simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", "turn:20", *options], *words)


def test_ship_without_the_coefficients(refused):
    arguments = ["simulate", "pershitz", "--ship", "zeefakkel", "--manoeuvre", "turn:20"]
    refused(3, arguments, "q21", "zeefakkel", "[pershitz]")


def test_model_that_runs_away(refused):
    arguments = ["--ship", "zeefakkel", "--manoeuvre", "turn:20", "--set", "tau=0.001 s"]
    refused(4, ["simulate", "nomoto", *arguments], "nomoto", "not sailed by this model")


@pytest.mark.parametrize(
    ("code", "options", "words"),
    [
        (2, ["--signals", "psi,rr"], ("nomoto", "'rr'", "Did you mean r?")),
        (2, ["--signals", "psi,,r"], ("'psi,,r'",)),
        (2, ["--signals", "delta"], ("'delta'",)),
        (2, ["--estimate", "K,tua"], ("'tua'", "Did you mean tau?")),
        (2, ["--estimate", "psi"], ("'psi'", "K, tau")),
        (2, ["--estimate", ","], ("','",)),
        (2, ["--fix", "Q=1 s"], ("nomoto", "'Q'")),
        (2, ["--fix", "K=1"], ("'K'", "bare number 1", "1/s")),
        (2, ["--fix", "K=1 m"], ("'K'", "1/s", "m does not fit")),
        (2, ["--fix", "K=nan 1/s"], ("'nan 1/s'",)),
        (2, ["--fix", "K=1e999 1/s"], ("'K'", "finite")),
        (2, ["--fix", "K"], ("NAME=VALUE",)),
        (2, ["--fix", "K="], ("NAME=VALUE",)),
        (2, ["--fix", "psi=1 rad"], ("'psi'", "state", "cannot be fixed")),
        (2, ["--fix", "delta=1 rad"], ("'delta'", "input", "cannot be fixed")),
        (2, ["--fix", "K=1 1/s", "--fix", "K=2 1/s"], ("'K'", "twice")),
        (2, ["--fix", "K=0.5 1/s", "--fix", "tau=30 s"], ("has no parameter left to estimate",)),
        (2, ["--fix", "K=0.5 1/s", "--estimate", "K"], ("'K'", "fixed as well")),
        (2, ["--noise", "psi=0.2 deg"], ("none for r",)),
        (2, ["--noise", "psi=0 deg,r=0.02 deg/s"], ("positive",)),
        (2, ["--noise", "psi=0.2 m,r=0.02 deg/s"], ("rad", "m does not fit")),
        (2, ["--noise", "none"], ("NAME=VALUE",)),
        (2, ["--starts", "0"], ("'--starts'",)),
        (2, ["--seed", "-1"], ("'--seed'",)),
        (2, ["--validate"], ("--validate", "no trial")),
        (2, ["--window", "100"], ("'100'", "A:B")),
        (2, ["--window", "a:b"], ("'a:b'", "A:B")),
        (3, ["--window", "100:900"], ("100:900", "0 to 279 s")),
        (3, ["--window", "200:100"], ("runs backwards",)),
        (3, ["--window", "nan:inf"], ("nan:inf",)),
        (3, ["--window", "0:20"], ("20 s", "time constant", "wider window")),
    ],
)
def test_identify(refused, zigzag, fitted, code, options, words):
    refused(code, ["identify", zigzag, *fitted, *options], *words)


def test_the_coefficient_that_belongs_to_degrees(refused, zigzag):
    """n3 = 0.4 s²/deg² without its unit, or without its angle, would be 3283 times too small or too large."""
    arguments = ["identify", zigzag, "--model", "norrbin", "--ship", "zeefakkel", "--fix"]
    refused(2, [*arguments, "n3=0.4"], "'n3'", "0.4 s²/rad² or 0.4 s²/deg²", "does not guess")
    refused(2, [*arguments, "n3=0.4 s^2"], "'n3'", "s²/rad²", "which angle")


def test_window_given_twice(refused, zigzag, fitted):
    refused(3, ["identify", f"{zigzag}@50:150", *fitted, "--window", "50:150"], "one of the two")


@pytest.mark.parametrize("window", ["5:5", "100:900", "name", "1:2:3"])
def test_window_of_a_trial(refused, zigzag, fitted, window):
    refused(3, ["identify", f"{zigzag}@{window}", *fitted], "zigzag", "window")


@pytest.mark.parametrize(
    ("code", "options", "words"),
    [
        (2, ["--length", "320"], ("bare number 320", "320 m")),
        (2, ["--length", "0 m"], ("0 m", "greater than zero")),
        (2, ["--length", "-3 m"], ("-3 m", "greater than zero")),
        (2, ["--kind", "zigzag"], ("'zigzag'", "zig-zag")),
        (3, ["--kind", "turning circle"], ("no turning circle", "FILE@start:end")),
        (2, ["--window", "x"], ("'x'", "A:B")),
    ],
)
def test_measure(refused, zigzag, code, options, words):
    refused(code, ["measure", zigzag, *options], *words)
