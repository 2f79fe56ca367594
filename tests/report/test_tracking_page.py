"""The page of tracks: what it says of the closest approach, of false tracks and of courses, and what its plan shows."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.plots.plots import Sensor, make_plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.track import track
from shipid.report.views.tracking.page import course_shown
from shipid.report.write_report import render

T = np.arange(0, 90, 3.0)


def sailed(north: float, speed: float, truth: tuple[ShipPath, ...] = ()):
    """One target north of own ship, which lies still, on a course of north at this speed."""
    noise = np.random.default_rng(4).normal(0, 2, (2, T.size))
    plots = make_plots(T, north + speed * T + noise[0], 50 + noise[1], sensors=(Sensor("radar", position_std=5.0),))
    own = ShipPath("own ship", T, 0 * T, 0 * T)
    return track(Detections("log", plots, own, False, truth))


@pytest.fixture(scope="module")
def away():
    target = ShipPath("Gull", T, 300 + 4 * T, 50 + 0 * T)
    # A ship whose transponder says another latitude.
    far = ShipPath("Tern", T, 9e5 + 0 * T, 0 * T)
    return sailed(300.0, 4.0, (target, far))


@pytest.fixture(scope="module")
def page(away):
    return render(away)


def test_a_target_that_goes_away_comes_no_nearer(page):
    assert "No track that is held comes nearer to own ship" in page
    assert "within the next hour" not in page


def test_a_target_that_comes_is_told_with_its_distance():
    closing = sailed(900.0, -4.0)
    page = render(closing)
    assert "comes nearest to own ship: " in page
    # The terminal says the same, with the interval.
    assert closing.nearest_words.removeprefix("track") in page and closing.nearest_words in closing.text()


def test_no_false_track_is_told_without_a_rate(page):
    assert "No confirmed track moves where no ship is within 250 m." in page


def test_a_ship_beyond_the_horizon_does_not_shrink_the_plan(page):
    assert "800000" not in page


def test_a_course_is_shown_within_the_circle_and_only_of_what_moves(away):
    (one,) = away.tracks
    shown = course_shown(one)
    # A course of north goes to and fro across it.
    assert np.nanmax(np.abs(np.diff(shown))) < 180 and 0 <= np.nanmedian(shown) < 360
    assert np.isnan(shown).sum() == np.sum(one.speed <= 0.5)


def test_what_follows_a_plus_or_minus_is_said(page, read_page):
    """A standard deviation beside a 95 % interval, and neither named; the interval was of the distance, without a word."""
    text = read_page(page).text
    assert "standard deviations after ±" in text and "CPA 95 % [m]" in text
