"""Options with a dimension: the unit is required, and the message says what to type."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from shipid.cli import main
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.cli.registry import COMMANDS

SHIP = ["nomoto", "--ship", "zeefakkel"]
SAIL = ["simulate", *SHIP, "--manoeuvre", "zigzag:20/20"]
PREDICT = ["predict", "de-keizer", "--ship", "soesterberg"]
TUNE = ["tune", "de-keizer", "--ship", "soesterberg"]
#: By option: a command with it, a bare number, and what the message tells to type.
BARE = {
    "--speed": (["criteria", *SHIP], "5", "5 m/s or 5 kn"),
    "--duration": (SAIL, "300", "300 s"),
    "--sampling": (SAIL, "1", "1 s"),
    "--heading": (SAIL, "10", "10 deg"),
    "--time": (["plan", "--model", *SHIP], "20", "20 s"),
    "--between": (["plan", "--model", *SHIP, "--time", "20 min"], "60", "60 s"),
    "--correlation": (["plan", "--model", *SHIP, "--time", "20 min"], "4", "4 s"),
    "--omega-n": (TUNE, "0.05", "0.05 rad/s or 0.05 deg/s"),
    "--rudder-limit": (TUNE, "15", "15 deg"),
    "--wind": (TUNE, "15", "15 m/s or 15 kn"),
    "--current": (TUNE, "1", "1 m/s or 1 kn"),
    "--rudder": (PREDICT, "10", "10 deg"),
    "--rate": (PREDICT, "20", "20 deg/s"),
    "--length": (["measure", "trial.csv"], "45", "45 m"),
    "--position-std": (["track", "plots.csv"], "5", "5 m"),
    "--bias-std": (["track", "plots.csv"], "5", "5 m"),
    "--bearing-bias-std": (["track", "plots.csv"], "1", "1 deg"),
    "--latency": (["track", "plots.csv"], "2", "2 s"),
    "--scan": (["track", "plots.csv"], "3", "3 s"),
    "--filter-interval": (["bridge"], "0.4", "0.4 s"),
    "--prediction-interval": (["bridge"], "2", "2 s"),
    "--wait": (["filter", "--follow", "trial.csv", "--model", "nomoto"], "5", "5 s"),
}


def options() -> dict[str, list[click.Option]]:
    context = click.Context(main, info_name="shipid", **main.context_settings)
    found: dict[str, list[click.Option]] = {}
    for name in COMMANDS:
        command = main.get_command(context, name)
        assert command is not None
        for p in command.params:
            if isinstance(p, click.Option):
                found.setdefault(p.opts[0], []).append(p)
    return found


@pytest.mark.parametrize("option", BARE)
def test_a_bare_number_is_refused_with_what_to_type(option, refused):
    arguments, number, typed = BARE[option]
    refused(2, [*arguments, option, number], f"{option} is the bare number", f"Write {typed}: shipid does not guess.")


def test_every_option_with_a_dimension_is_here():
    found = {o for o, several in options().items() for p in several if isinstance(p.type, NumberWithUnit)}
    assert found == set(BARE)


def test_no_other_option_takes_a_number_with_a_dimension():
    """An option of floating point has no dimension: a factor, a count of standard deviations or of ship lengths."""
    floats = {o for o, several in options().items() for p in several if p.type is click.FLOAT}
    assert floats == {"--gate", "--zeta", "--integral", "--rudder-weight", "--horizon"}


def test_the_help_tells_the_unit(call):
    text = call("tune", "--help").out
    assert re.search(r"--omega-n 'NUMBER rad/s'", text) and re.search(r"--rudder-limit 'NUMBER deg'", text)


def test_speeds_need_a_unit(refused):
    refused(2, [*TUNE, "--speeds", "4:12:1"], "Write '4:12:1 m/s': shipid does not guess.")
    refused(2, [*TUNE, "--speeds", "7,9.5"], "Write '7,9.5 m/s'")


def test_each_speed_of_a_list_has_a_unit(refused):
    refused(2, ["plan", "--model", *SHIP, "--time", "20 min", "--speed", "9 kn,6"], "--speed is the bare number 6")


def test_another_dimension_is_refused(refused):
    refused(2, ["measure", "trial.csv", "--length", "45 kg"], "--length needs the unit m, and kg does not fit it.")


TRIAL = Path(__file__).resolve().parents[2] / "studies" / "trials" / "container-20-20.csv"
OWN = ["nomoto", "--ship", "soesterberg"]
FILTER = ["filter", TRIAL, "--model", *OWN]


@pytest.mark.parametrize("value", ["3", "3 kg", "much"])
@pytest.mark.parametrize(
    "command",
    [
        [*FILTER, "--measured", "psi={}"],
        [*FILTER, "--noise", "r={}"],
        [*FILTER, "--initial", "K={}"],
        [*FILTER, "--start", "K={}"],
        [*FILTER, "--rates", "psi={}"],
        [*FILTER, "--input", "current_north={}"],
        ["identify", TRIAL, "--model", *OWN, "--fix", "K={}"],
        ["identify", TRIAL, "--model", *OWN, "--noise", "r=0.1 deg/s,psi={}"],
        [*SAIL, "--set", "K={}"],
        [*SAIL, "--noise", "psi={}"],
        [*SAIL, "--current", "{} to 30 deg"],
        [*SAIL, "--current", "1 m/s to {}"],
        ["plan", "--model", *SHIP, "--time", "20 min", "--set", "K={}"],
        ["plan", "--model", *SHIP, "--time", "20 min", "--noise", "psi={}"],
        [*PREDICT, "--heading", "30 deg", "--from", "psi={}"],
        [*PREDICT, "--heading", "30 deg", "--wind", "{} from 30 deg"],
        ["ship", "--new", "mine", "--length", "{}"],
    ],
    ids=lambda command: " ".join(str(word) for word in command[-2:]),
)
def test_a_value_in_a_list_is_refused_as_one_by_itself(refused, command, value):
    """One exit code for a unit that is missing or does not fit, wherever on the command line it stands."""
    refused(2, [str(word).format(value) for word in command], value.split()[-1])


def test_a_bare_number_in_a_file_is_bad_data(refused, tmp_path):
    ship = tmp_path / "ship.toml"
    text = (TRIAL.parents[2] / "models" / "ships" / "gunnerus.toml").read_text()
    ship.write_text(text.replace('value = 0.238, unit = "1/s"', 'value = 0.238, unit = "kg"'))
    refused(3, ["criteria", "nomoto", "--ship", ship], "kg does not fit")
