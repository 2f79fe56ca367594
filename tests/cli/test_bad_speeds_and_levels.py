"""Noise levels no sensor has, ships that go astern or lie still, and what one command writes for the next."""

from __future__ import annotations

import pytest

import shipid


@pytest.fixture
def moved(changed, column):
    """The zig-zag with its speed times a factor."""
    return lambda factor: changed(column("u", lambda value, _: f"{factor * float(value):.9g}"), name=f"u{factor:g}.csv")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("simulate", "--manoeuvre", "turn:20", "--noise", "psi=1e-300 deg"),
            "the noise on psi is 1e-300 deg, smaller",
        ),
        (("identify", "--noise", "psi=1e-300 deg,r=0.1 deg/s"), "the noise on psi is 1e-300 deg, smaller than any"),
        (("filter", "--measured", "psi=1e-300 deg"), "noise of the sensor of 'psi' is 1e-300 deg, smaller than"),
        (("filter", "--noise", "r=1e-300 deg/s^1.5"), "is 1e-300 deg/s^1.5, smaller than anything"),
        (
            ("simulate", "--manoeuvre", "turn:20", "--noise", "psi=1e300 deg"),
            "noise on psi is 1e300 deg, larger than any",
        ),
        (("identify", "--noise", "psi=1e300 deg,r=0.1 deg/s"), "the noise on psi is 1e300 deg, larger than any"),
        (("filter", "--measured", "psi=1e300 deg"), "noise of the sensor of 'psi' is 1e300 deg, larger than"),
    ],
)
def test_levels_that_no_sensor_has(refused, zigzag, arguments, words):
    command, *options = arguments
    model = ["nomoto"] if command == "simulate" else [zigzag, "--model", "nomoto"]
    refused(2, [command, *model, "--ship", "zeefakkel", *options], words)


@pytest.mark.parametrize("command", ["identify", "filter"])
@pytest.mark.parametrize(("factor", "does"), [(-1.0, "goes astern"), (0.0, "lies still")])
def test_a_model_that_holds_ahead(refused, moved, command, factor, does):
    words = f"the ship {does} before the manoeuvre"
    trial = moved(factor)
    said = refused(3, [command, trial, "--model", "de-keizer", "--ship", "soesterberg"], words)
    assert "model de-keizer holds for a ship that goes ahead" in said


def test_a_filter_says_that_the_ship_lies_still(call, moved):
    answer = call("filter", moved(0.0), "--model", "nomoto", "--ship", "soesterberg")
    # Doubtful: a ship that turns without speed is none of which the coefficients of identification are determined.
    assert answer.code == 5 and "The speed is 0 m/s" in answer.err


def test_a_ship_identified_at_zero_speed_is_read(call, moved, tmp_path):
    out, ship = tmp_path / "out", ("--model", "nomoto", "--ship", "soesterberg")
    assert call("identify", moved(0.0), *ship, "--signals", "psi,r", "--starts", "1", "--out", out).code == 0
    assert shipid.read_parameter_set(out / "ship.toml").joint["nomoto"].speeds == (0.0, 0.0)
    assert call("simulate", "nomoto", "--ship", out / "ship.toml", "--manoeuvre", "turn:10").code == 0
