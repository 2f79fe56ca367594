"""Values of a ship and inputs of a model that the command line states, the same way in every command; and examples in the help."""

from __future__ import annotations

import click
import pytest

import shipid
from shipid.cli import main
from shipid.cli.frame.options import ships_given
from shipid.cli.registry import COMMANDS

#: A model with an input of its own, which nothing but the command line states.
TOWED = '''
from shipid import Component, given, parameter, state


class Towed(Component):
    """A ship on a tow line: the line turns it back."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    pull = given("1/s", "pull of the line, as a damping")
    K = parameter("1/s", "gain", start=0.2, low=0.01, high=5.0)
    tau = parameter("s", "time constant", start=15.0, low=0.5, high=500.0)

    @r.rate
    def yaw(self):
        """Own notes, page 1."""
        return (self.K * self.delta - self.r) / self.tau - self.pull * self.r
'''
SHIP = """
name = "towed"

[particulars]
L = { value = 45.0, unit = "m", source = "assumed" }
speed = { value = 5.0, unit = "m/s", source = "assumed" }
delta_max = { value = 30.0, unit = "deg", source = "assumed" }
delta_rate = { value = 10.0, unit = "deg/s", source = "assumed" }

[towed]
K = { value = 0.1, unit = "1/s", source = "assumed" }
tau = { value = 20.0, unit = "s", source = "assumed" }
"""


def commands() -> dict[str, click.Command]:
    context = click.Context(main, info_name="shipid", **main.context_settings)
    return {name: main.get_command(context, name) for name in COMMANDS}


@pytest.fixture(scope="module")
def towed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("towed")
    (folder / "towed.py").write_text(TOWED)
    (folder / "ship.toml").write_text(SHIP)
    return f"{folder / 'towed.py'}:Towed", str(folder / "ship.toml")


def test_every_command_with_a_ship_takes_values():
    """`ship` shows one and drafts another: it is the file itself that is stated there."""
    options = {name: {o for p in c.params for o in p.opts} for name, c in commands().items()}
    assert {n for n, o in options.items() if "--ship" in o} == {n for n, o in options.items() if "--set" in o}
    assert {n for n, o in options.items() if "--input" in o} == {
        "simulate", "plan", "identify", "compare", "filter", "tune", "predict", "bridge", "criteria",
    }  # fmt: skip


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_has_an_example(call, name):
    text = call(name, "--help").out
    assert f"\n  shipid {name}" in text or f'\n  eval "$(shipid {name}' in text
    assert call(name, "-h").out == text


def test_an_input_is_asked_for_and_held(call, refused, towed, tmp_path):
    model, ship = towed
    sail = ["simulate", model, "--ship", ship, "--manoeuvre", "turn:20", "--duration", "300 s"]
    refused(2, sail, "reads 'pull' (pull of the line, as a damping)", "state it")
    turned = []
    for pull in ("0.02 1/s", "0.2 1/s"):
        out = tmp_path / f"{pull[:4]}.csv"
        assert call(*sail, "--input", f"pull={pull}", "-o", out).code == 0
        trial = shipid.read_trial(out)
        assert f"pull {pull} held" in trial.source.comment
        turned.append(trial["r"][-1])
    # Steady: K delta / (1 + pull tau).
    assert turned[0] / turned[1] == pytest.approx((1 + 0.2 * 20) / (1 + 0.02 * 20), rel=1e-3)
    refused(2, [*sail, "--input", "pull=0.1"], "with no unit")
    refused(2, [*sail, "--input", "tug=1 s"], "reads no input 'tug'")
    refused(2, [*sail, "--input", "delta=1 deg"], "is what the command orders")
    for command in (
        ["criteria", model, "--ship", ship],
        ["predict", model, "--ship", ship, "--heading", "30 deg", "--band", "none"],
        ["tune", model, "--ship", ship, "--speeds", "5 m/s", "--samples", "0"],
        ["plan", "--model", model, "--ship", ship, "--time", "6 min", "--draws", "0", "--repertoire", "zigzag:20/20"],
    ):
        refused(2, command, "reads 'pull'")
        assert call(*command, "--input", "pull=0.05 1/s").code == 0, command


def test_waves_show_in_what_a_manoeuvre_records(call, tmp_path):
    """The heading by waves on top of the ship's own, and the same path."""
    sail = ["simulate", "de-keizer", "--ship", "soesterberg", "--manoeuvre", "zigzag:20/20", "--duration", "2000 s"]
    for name, waves in (("calm", ()), ("sea", ("--waves", "0.3 deg from 90 deg"))):
        assert call(*sail, *waves, "-o", tmp_path / f"{name}.csv").code == 0
    calm, sea = (shipid.read_trial(tmp_path / f"{n}.csv") for n in ("calm", "sea"))
    assert (sea["x"] == calm["x"]).all() and "waves 0.3 deg from 90 deg" in sea.source.comment
    # In the mean over a zig-zag the sea is met from many sides; abeam it is 0.3 deg.
    assert 0.2 < (sea["psi"] - calm["psi"]).std() * 180 / 3.14159265 < 0.4


def test_values_of_a_ship(call, refused, tmp_path):
    usual, long = (call("criteria", "norrbin", "--ship", "zeefakkel", *more).out for more in ((), ("--set", "L=60 m")))
    assert "L 45 m" in usual and "L 60 m" in long
    ship = ["criteria", "norrbin", "--ship", "zeefakkel", "--set"]
    refused(2, [*ship, "L=60"], "with no unit")
    refused(2, [*ship, "keel=3 m"], "no value of a ship called 'keel'")
    refused(2, [*ship, "delta=3 deg"], "state it with --input")
    refused(2, ["check", tmp_path / "t.csv", "--set", "L=60 m"], "name the ship with --ship")


def test_a_range_that_is_not_stated_is_no_news_of_a_simulation(call):
    answer = call("simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", "zigzag:20/20", "--duration", "100 s")
    assert answer.code == 0 and "is not known" not in answer.err


def test_show_takes_a_ship(call, refused, towed):
    shown = call("show", "zeefakkel")
    assert shown.code == 0 and shown.out == call("ship", "zeefakkel").out
    assert "[towed]" not in shown.out and "towed" in call("show", towed[1]).out
    refused(2, ["show", "zeefakel"], "no ship 'zeefakel'. Did you mean zeefakkel")
    refused(2, ["show", "norbin"], "no model 'norbin'")
    refused(2, ["show", "zeefakkel", "--latex"], "has no equations")


def test_ship_files_of_one_name_are_told_apart(tmp_path):
    """Two states of one ship, identified into two folders, keep the ship's name in both files."""
    for folder in ("loaded", "ballast"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "ship.toml").write_text(SHIP)
    files = [str(tmp_path / f / "ship.toml") for f in ("loaded", "ballast")]
    assert [s.name for s in ships_given(files, {})] == files
    assert [s.name for s in ships_given([files[0], "zeefakkel"], {})] == ["towed", "zeefakkel"]
