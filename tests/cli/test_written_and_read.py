"""What one command writes the next one reads: names beyond ASCII, titles that need quotes, a log without speed."""

from __future__ import annotations

import json

import pytest

import shipid

#: A model whose coefficient is a Greek letter, which a key of TOML has in quotes.
GREEK = '''
from shipid import Component, given, parameter, state


class Yaw(Component):
    """A yaw model."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    K = parameter("1/s", "gain", start=0.2, low=0.01, high=5.0)
    τ = parameter("s", "time constant", start=15.0, low=0.5, high=500.0)

    @r.rate
    def yaw(self):
        """Own notes, page 1."""
        return (self.K * self.delta - self.r) / self.τ
'''


@pytest.fixture
def greek(tmp_path):
    path = tmp_path / "greek.py"
    path.write_text(GREEK, encoding="utf-8")
    return f"{path}:Yaw"


def test_a_ship_with_a_name_that_needs_quotes_goes_through_every_command(call, zigzag, greek, tmp_path):
    fit, tuned = tmp_path / "fit", tmp_path / "tuned"
    assert call("identify", zigzag, "--model", greek, "--ship", "zeefakkel", "--starts", "1", "--out", fit).code == 0
    ship = fit / "ship.toml"
    assert 'yaw."τ"' in ship.read_text(encoding="utf-8")
    assert "τ" in call("ship", ship).out
    filtered = call("filter", zigzag, "--model", greek, "--ship", ship, "--json")
    known = json.loads((fit / "result.json").read_text(encoding="utf-8"))["parameters"]["τ"]["value"]
    assert json.loads(filtered.out)["parameters"]["τ"]["value"] == pytest.approx(known, rel=0.01)
    options = ("--samples", "0", "--speeds", "5 m/s")
    assert call("tune", greek, "--ship", ship, *options, "--out", tuned).code == 0
    assert shipid.read_schedule(tuned / "schedule.toml", greek).ship.find(shipid.find_model(greek), "τ") is not None
    criteria = call("criteria", greek, "--ship", ship)
    assert criteria.code in (0, 5) and "τ" in criteria.out


def test_a_draft_with_quotes_and_line_breaks_in_its_words_is_read(call, tmp_path):
    path = tmp_path / "odd.toml"
    words = ("--source", 'the yard\'s "final" sheet\\B', "--title", "Zeilschip „Ω“", "--length", "24 m")
    assert call("ship", "--new", 'a "b"', *words, "-o", path).code == 0
    shown = call("ship", path)
    assert shown.code == 0 and 'a "b": Zeilschip „Ω“' in shown.out and 'the yard\'s "final" sheet\\B' in shown.out


def test_a_ship_identified_from_a_log_without_speed_is_read(call, changed, column, tmp_path):
    """Nomoto's model reads the speed for positions only; its ship file is one that every command reads."""
    log, fit = changed(column("u", lambda *_: "0")), tmp_path / "fit"
    arguments = ["identify", log, "--ship", "soesterberg", "--starts", "1", "--no-check"]
    assert call(*arguments, "--model", "nomoto", "--out", fit).code == 0
    assert call("ship", fit / "ship.toml").code == 0
    assert call("criteria", "nomoto", "--ship", fit / "ship.toml").code in (0, 5)


def test_a_model_that_scales_with_speed_refuses_a_ship_that_lies_still(changed, column, refused):
    log = changed(column("u", lambda *_: "0"))
    arguments = ["identify", log, "--model", "de-keizer", "--ship", "zeefakkel", "--starts", "1"]
    refused(3, arguments, "the ship lies still before the manoeuvre (0 m/s)", "holds for a ship that goes ahead")
