"""What priors hold in a fit: the share of the information, and where it is said."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid import Component, constant, given, parameter, state
from shipid.estimation.estimate import Estimate
from shipid.identification.fit_text import prior_lines
from shipid.identification.problem.prior import Prior
from shipid.identification.problem.prior_shares import held_words, prior_shares
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value
from shipid.parts.planar_motion import PlanarMotion

SHIP = {"L": (120.0, "m"), "speed": (8.0, "m/s"), "delta_max": (35.0, "deg"), "delta_rate": (3.0, "deg/s")}
TRUTH = {"a": (1.2, "1"), "b": (3.0, "1"), "c": (1.0, "1")}


class Turning(Component):
    """Yaw of the first order, and a damping that is too small to show."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard")
    u = given("m/s", "forward speed through the water")
    L = constant("m", "length between perpendiculars")
    a = parameter("1", "yaw moment per rudder angle", start=1.0, low=0.05, high=10.0)
    b = parameter("1", "yaw damping", start=2.0, low=0.05, high=10.0, spread=0.4)
    c = parameter("1", "yaw damping at large rates of turn", start=2.0, low=0.05, high=20.0, spread=0.5)

    @r.rate
    def yaw(self):
        """First order, with a term of the third that is made small."""
        pace = self.u / self.L
        turn = self.r / pace
        return pace**2 * (self.a * self.delta - self.b * turn - 1e-3 * self.c * turn**3)


@pytest.fixture(scope="module")
def fit():
    model = shipid.join("turning", Turning, PlanarMotion)
    values = {
        section: {n: Value(n, v, unit, "assumed") for n, (v, unit) in known.items()}
        for section, known in ((PARTICULARS, SHIP), ("turning", TRUTH))
    }
    noise = "psi=0.2 deg,r=0.02 deg/s"
    trial = shipid.simulate(model, ParameterSet("tender", sections=values), "zigzag:20/20", noise=noise, seed=1)
    return shipid.identify(
        model, [trial], ship=ParameterSet("tender", sections={PARTICULARS: values[PARTICULARS]}), starts=1
    )


def test_a_prior_holds_what_the_trial_does_not_show_and_nothing_else(fit):
    assert set(fit.prior_shares) == {"b", "c"}
    held, seen = fit.parameters["c"], fit.parameters["b"]
    assert fit.prior_shares["c"] > 0.95 and held.value == pytest.approx(2.0, abs=0.05)
    # The true damping lies two and a half of its prior's standard deviations away, and is found.
    assert fit.prior_shares["b"] < 0.05 and abs(seen.value - 3.0) < 3 * seen.std
    assert fit.prior_shares["b"] == pytest.approx((seen.std / 0.4) ** 2, rel=1e-12)


def test_it_is_said_in_text_json_and_page(fit, tmp_path):
    said = [line for line in fit.text().splitlines() if line.startswith("  held ")]
    share = f"c ({100 * fit.prior_shares['c']:.0f} %)"
    assert said == [f"  held      {share}: that much of the information is the prior that the model declares"]
    data = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    assert data["diagnostics"]["prior_shares"] == fit.prior_shares
    page = tmp_path / "fit.html"
    shipid.write_report(fit, page)
    text = page.read_text(encoding="utf-8")
    assert "Or do priors hold them?" in text and f"{share}: that much of the information" in text


@pytest.mark.parametrize(("std", "share"), [(None, 1.0), (1.0, 0.25), (4.0, 1.0), (0.0, 0.0)])
def test_the_share_is_that_of_the_variances(std, share):
    prior = Prior({}, {}, {}, {}, {"b": (3.0, 2.0)})
    estimate = Estimate("b", "1", "yaw damping", 1.0, std, None, "determined")
    assert prior_shares(prior, {"b": estimate}) == {"b": share}
    assert prior_shares(None, {"b": estimate}) == {}


def test_words_name_what_is_held_the_most_first():
    assert held_words({"a": 0.6, "b": 0.4, "c": 0.96, "d": 0.5}) == "c (96 %), a (60 %)"
    assert prior_lines({"a": 0.5}) == [] and prior_lines({}) == []
