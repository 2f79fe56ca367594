"""Pages of what is neither fitted nor judged: a predicted track, a record of several modes."""

from __future__ import annotations

import re

import numpy as np
import pytest

import shipid
from shipid.models import constant_velocity
from shipid.report.write_report import render


@pytest.fixture(scope="module")
def pilot():
    return shipid.design_autopilot("de-keizer", "soesterberg", speeds="9:10:1 m/s")


def test_a_track_without_a_band_says_so(pilot, read_page):
    """A lone line reads as one that is sure."""
    situation = shipid.Situation({"psi": 0.0, "u": 9.5})
    found = shipid.TrackPredictor(pilot).predict(situation, heading="60 deg")
    assert found.half_width is None
    assert "No band: no spread was asked for." in read_page(render(found)).text


def test_a_heading_along_a_track_is_told_in_compass_degrees(pilot, read_page):
    """The stages said 331.8 deg beside a line at -28."""
    found = shipid.predict_track(pilot, {"psi": np.deg2rad(320.0), "u": 9.5}, heading="60 deg")
    text = read_page(render(found)).text
    assert "The heading is drawn without a jump at north: −40 deg is 320 deg." in text
    straight = shipid.predict_track(pilot, {"psi": np.deg2rad(20.0), "u": 9.5}, heading="60 deg")
    assert "jump at north" not in read_page(render(straight)).text


def test_the_band_at_the_end_of_a_track_is_told_of_its_end(pilot, read_page):
    """The sentence before it told the course over the ground: "there" was no place."""
    found = shipid.predict_track(
        pilot, shipid.Situation({"psi": 0.0, "u": 9.5}, ("psi",), np.array([[1e-4]])), heading="60 deg"
    )
    reach = found.stages[-1].half_width
    assert f"At the end of the track the 95 % band reaches {reach:.0f} m to each side." in read_page(render(found)).text


def test_the_most_probable_mode_has_its_probability(read_page):
    """A mode at 0.47 was told as one at 0.99 is."""
    t = np.arange(0.0, 60.0)
    several = shipid.InteractingMultipleModel(
        {"calm": constant_velocity, "lively": constant_velocity},
        [[0.9, 0.1], [0.1, 0.9]],
        measured={"x": "20 m", "y": "20 m"},
        noise={"ax": "0.1 m/s^2", "ay": "0.1 m/s^2"},
    )
    run = several.filter({"t": t, "x": 5.0 * t, "y": 0.0 * t})
    text = read_page(render(run)).text
    assert re.search(r"Most probable at the end: (calm|lively), with a probability of 0\.50\.", text)
