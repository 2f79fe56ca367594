"""What is read off the page: numbers as a navigator reads them, what is old struck, what is estimated marked, what is not known a dash."""

from __future__ import annotations

import math

DEG = math.pi / 180
KNOT = 1852 / 3600

WRITTEN = [
    ("direction", 41.5 * DEG, "041.5°"),
    ("direction", 359.96 * DEG, "000.0°"),
    ("direction", -0.5 * DEG, "359.5°"),
    ("direction", 725 * DEG, "005.0°"),
    ("direction", None, "–––.–°"),
    ("rudder", -10 * DEG, "P 10.0°"),
    ("rudder", 4.04 * DEG, "S 4.0°"),
    ("rudder", -0.01 * DEG, "0.0°"),
    ("knots", 19 * KNOT, "19.0"),
    ("knots", -0.01, "0.0"),
    ("perMinute", -0.2 * DEG, "−12.0"),
    ("distance", 981.56, "0.53 nm"),
    ("distance", 185.0, "185 m"),
    ("distance", None, "–"),
    ("aside", 12.4, "12 m S"),
    ("aside", -931.0, "931 m P"),
    ("aside", 0.2, "0 m"),
    ("aside", -2778.0, "1.50 nm P"),
    ("clock", 102.4, "1:42"),
    ("clock", 3725, "1:02:05"),
    ("clock", -7, "−0:07"),
    ("clock", -0.2, "0:00"),
    ("coefficient", 1.5849, "1.58"),
    ("coefficient", 0.00012, "1.20e−4"),
    ("coefficient", 421.7, "422"),
    ("typed", "75,5", 75.5),
    ("typed", "P 12", -12),
    ("typed", "−3", -3),
    ("typed", "north", None),
    ("typed", "", None),
    ("typed", "7 5", None),
]


def test_numbers_are_written_as_a_navigator_reads_them(bridge, open_page, until):
    page = open_page(bridge.address)
    got = page.evaluate(
        "async (cases) => { const f = await import('/static/script/figures.js'); return cases.map(([name, value]) => f[name](value)); }",
        [[name, value] for name, value, _ in WRITTEN],
    )
    assert got == [expected for _, _, expected in WRITTEN]


def readout(page, name: str) -> str:
    return page.get_by_role("group", name=name).locator(".value").inner_text().replace("\n", " ")


def test_the_readouts_show_the_ship(bridge, open_page, until):
    page = open_page(bridge.address)
    until(page, "document.querySelector('.readout .number').textContent === '007.5'")
    assert readout(page, "heading") == "007.5°"
    assert readout(page, "speed through the water") == "18.5kn"
    assert readout(page, "time and distance to the wheel-over") == "1:420.53 nm"
    assert readout(page, "distance off the track") == "12 m S"
    bars = page.locator("#bars").inner_text()
    assert "P 2.1°" in bars and "order P 3.0°" in bars
    assert "not for navigation" in page.locator(".caveat").inner_text().lower()
    voyage = page.locator("#voyage").inner_text()
    assert "1 of 6, to WP1" in voyage
    assert (
        "2.4 ± 0.2 kn to 225.0°" in voyage and "7.0 m/s from 315.0°" in voyage and "voyage.csv, 1 355 samples" in voyage
    )


def test_a_current_that_may_be_none_and_a_calm_have_no_direction(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.state["flow"]["current"].update(speed=0.3, sd=0.16)
    bridge.state["flow"]["wind"].update(speed=0.0)
    until(page, "document.querySelector('#voyage').textContent.includes('0.6 ± 0.3 kn, direction not known')")
    voyage = page.locator("#voyage").inner_text()
    assert "0.0 m/s" in voyage and "m/s from" not in voyage


def test_a_value_of_a_lost_sensor_is_struck_with_its_age_and_an_estimated_one_is_marked(bridge, open_page, until):
    page = open_page(bridge.address)
    heading, course = (page.get_by_role("group", name=name) for name in ("heading", "course over ground"))
    assert "est." in course.inner_text() and "est." not in heading.inner_text()
    bridge.state["sensors"][0].update(lost=True, age=6.2)
    page.wait_for_selector(".readout .number.old")
    assert "6 s old" in heading.inner_text()
    assert "line-through" in heading.locator(".number").evaluate("node => getComputedStyle(node).textDecorationLine")
    # What the filter still estimates goes on being shown, marked as such.
    bridge.state["own"]["estimated"] = ["cog", "sog", "psi"]
    page.wait_for_selector(".readout[aria-label=heading] .number.estimated:not(.old)")
    assert "est." in heading.inner_text()


def test_every_number_is_struck_when_the_estimate_itself_is_old(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.state["own"]["age"] = 3.4
    page.wait_for_selector(".readout .number.old")
    assert page.locator(".readout .number.old").count() == 6
    assert page.locator(".bar .numbers .old").count() == 2
    assert "3 s old" in page.get_by_role("group", name="speed over ground").inner_text()
    assert "3 s old" in page.get_by_role("group", name="distance off the track").inner_text()


ABSENT = ["x", "y", "psi", "r", "u", "v", "stw", "sog", "cog", "delta", "delta_order", "age"]


def test_a_page_of_unknowns_is_a_page_of_dashes(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.state["own"].update(dict.fromkeys(ABSENT))
    bridge.state.update(
        tracks={"trial": None, "executed": None}, route=None, flow={"current": None, "wind": None}, targets=[], simulation=None, sensors=[],
        adaptation={"values": [], "health": {"state": "starting", "message": None, "rejected": None}},
        recording={"file": None, "samples": 0, "message": None},
    )  # fmt: skip
    bridge.state["ship"]["beam"] = None
    bridge.state["time"].update(utc=None, clock_factor=None)
    until(page, "document.querySelector('.readout .number').textContent === '–––.–'")
    page.get_by_role("button", name="Details").click()
    assert "No position" in page.locator("#plan-note").inner_text()
    for orientation in ("Head up", "Course up"):
        page.get_by_role("radio", name=orientation).click()
    text = page.locator("body").inner_text()
    assert "NaN" not in text and "undefined" not in text and "null" not in text and "Infinity" not in text
    assert "t 4:31" in text


def test_missing_numbers_inside_a_track_break_nothing(bridge, open_page, until):
    page = open_page(bridge.address)
    track = bridge.state["tracks"]["trial"]
    track["x"][5:9] = [None] * 4
    track["half_width"][3] = None
    bridge.state["tracks"]["executed"]["half_width"] = None
    bridge.state["route"].update(off_track=None, overshoot=None, wheel_over=None)
    bridge.state["targets"] = [
        {"id": "1", "name": None, "x": None, "y": 2.0, "course": None, "speed": None, "age": None}
    ]
    bridge.state["own"]["psi"] = None
    until(page, "document.querySelector('.readout .number').textContent === '–––.–'")
    assert page.get_by_role("radio", name="Heading").is_enabled()


def test_every_sensor_is_listed_with_its_age(bridge, open_page, until):
    bridge.state["sensors"].append(
        {"name": "position", "label": "position", "value": None, "unit": "m", "age": 0.4, "lost": False}
    )
    page = open_page(bridge.address)
    page.get_by_role("button", name="Details").click()
    rows = {
        row.locator("th").inner_text(): row.inner_text().split("\t")[1:]
        for row in page.locator("#drawer tr:has(th)").all()
    }
    assert (
        rows["heading"] == ["007.5°", "0 s"]
        and rows["position"] == ["received", "0 s"]
        and rows["rudder angle"] == ["P 2.1°", "0 s"]
    )
    bridge.state["sensors"][-1].update(lost=True, age=130.0)
    until(page, "document.querySelector('#drawer').textContent.includes('lost 2:10')")
