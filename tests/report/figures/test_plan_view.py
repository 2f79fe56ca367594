"""A route and a chart below a predicted track."""

from __future__ import annotations

import re

import numpy as np
import pytest

import shipid
from shipid.prediction.charts.chart import Buoy, Chart, Contour, DepthArea
from shipid.prediction.predict_route import predict_route
from shipid.prediction.routes.route import Route, Waypoint
from shipid.report.figures.svg import collected
from shipid.report.figures.tracks import track_figure
from shipid.report.views.record.plan import plan_figure


@pytest.fixture(scope="module")
def found():
    pilot = shipid.design_autopilot("de-keizer", "soesterberg")
    points = tuple(
        Waypoint(p, n, 1300.0, 80.0, None)
        for p, n in zip([(0.0, 0.0), (5000.0, 0.0), (8000.0, -6000.0)], ("A", "B & C", "D"))
    )
    return predict_route(pilot, {"u": 9.5, "r": 0.0}, Route("tour", points, geographic=False), band="none")


def square(size: float, x: float = 4000.0, y: float = -500.0) -> np.ndarray:
    return np.array([[x - size, y - size], [x - size, y + size], [x + size, y + size], [x + size, y - size]])


def drawn(figure: str) -> list[str]:
    return re.findall(r'<path [^>]*d="([^"]*)"', figure)


def test_the_plan_its_limits_its_names_and_the_wheel_over(found):
    plain = track_figure(found.track, "k")
    figure = track_figure(found.track, "k", turn=found.turn, now=found.turn.now)
    assert "B &amp; C" in figure and "B &amp; C" not in plain and "plan" in figure
    # A limit on one side only: one dotted line a leg that is in view, beside the line to the wheel-over.
    assert len(re.findall("stroke-dasharray: ?0.7", figure)) == 2


def test_a_chart_is_drawn_with_its_holes_and_cut_to_the_view(found):
    chart = Chart(
        "c",
        (0.9, 0.1),
        land=((square(300), square(100)), (square(300, x=90e3),)),
        depth_areas=(DepthArea(None, None, (square(50e3),)), DepthArea(3.0, 5.0, (square(800),)), DepthArea(-2.0, 0.0, (square(400),))),
        contours=(Contour(5.0, square(800)),),
        coast=(square(300), square(300, x=90e3)),
        buoys=(Buoy(4000.0, -1400.0, kind="port", colour=("red",)), Buoy(90e3, 0.0, kind="starboard", colour=("green",))),
    )  # fmt: skip
    figure = track_figure(found.track, "k", turn=found.turn, chart=chart)
    for colour in ("#b08d3c", "#3d85c6", "#5f9e6e", "#d23c3c"):
        assert colour in figure
    assert "#2e9b57" not in figure
    # One path of land: the outer ring and its hole, of opposite sense. What is far away is not in the page.
    land = re.findall(r'<path d="([^"]*)"[^>]*style="fill: #b08d3c', figure)
    assert len(land) == 1 and land[0].count("M") == 2
    areas = []
    for ring in land[0].split("M")[1:]:
        x, y = np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", ring), dtype=float).T
        areas.append(0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
    assert areas[0] * areas[1] < 0 and abs(areas[0] / areas[1]) == pytest.approx(9, rel=0.05)
    size = max(float(n) for n in re.findall(r"[ML]([\d.]+) ", " ".join(drawn(figure))))
    assert size < 2000


def test_a_track_below_its_plan_is_seen():
    """A ship that keeps to her plan was hidden by it."""
    line = (np.linspace(0, 1000, 50), np.zeros(50))
    with collected() as drawings:
        plan_figure({"track": line, "plan": line}, "Track")
    track, plan = drawings["track"].figure().axes[0].lines[:2]
    assert track.get_linewidth() > 2 * plan.get_linewidth()
