"""The page for everyone and every screen: names, roles, no scrolling, keys alone, nothing from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[3] / "shipid" / "bridge" / "page"
FILES = sorted(path for path in PAGE.rglob("*") if path.is_file())
ALARMS = [
    {"id": 1, "kind": "alarm", "text": "Heading sensor lost", "since": 250.0, "acknowledged": False},
    {"id": 2, "kind": "warning", "text": "Wheel-over in less than one minute", "since": 250.0, "acknowledged": False},
    {"id": 3, "kind": "caution", "text": "Current changed", "since": 250.0, "acknowledged": True},
    {"id": 4, "kind": "alarm", "text": "Off track", "since": 250.0, "acknowledged": True},
]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PAGE).as_posix())
def test_a_file_is_short_and_asks_no_other_host(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 400
    assert set(re.findall(r"(?:https?:)?//[\w.-]+\.\w+", text)) <= {"http://www.w3.org"}
    # The policy of the server forbids both, and the browser would leave them out without a word to the navigator.
    assert not re.search(r"<[^>]+\sstyle=|<script(?![^>]*\ssrc=)|<style|\son\w+=\"|eval\(|innerHTML", text)


def test_folders_are_rooms():
    for folder in {path.parent for path in FILES}:
        assert len([p for p in folder.iterdir() if p.is_file()]) <= 12


@pytest.mark.parametrize("palette", ["Day", "Dusk", "Night"])
def test_no_fault_of_accessibility_is_found(bridge, open_page, palette):
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed"
    ).Axe()
    bridge.state["alarms"] = ALARMS
    page = open_page(bridge.address, reduced_motion="reduce")
    page.get_by_role("radio", name=palette).click()
    page.get_by_role("button", name="Details").click()
    page.keyboard.press("v")
    page.wait_for_selector(".alarm")
    found = axe.run(page).response["violations"]
    assert [(fault["id"], [node["target"] for node in fault["nodes"]]) for fault in found] == []


SCREENS = [(1280, 800), (1280, 720), (1920, 1080), (768, 1024), (1024, 768)]


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_nothing_scrolls_and_nothing_is_cut_off(bridge, open_page, width, height):
    bridge.state["alarms"] = ALARMS
    page = open_page(bridge.address, width, height)
    page.wait_for_selector(".alarm")
    for _ in range(2):
        assert page.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]") == [
            width,
            height,
        ]
        plan = page.locator("#plan").bounding_box()
        assert plan["width"] >= 400 and plan["height"] >= 250
        for control in [".execute", "#settings [role=slider]", ".voyage", ".plan-keys"]:
            box = page.locator(control).bounding_box()
            assert box["x"] >= 0 and box["x"] + box["width"] <= width, control
        box = page.locator(".execute").bounding_box()
        assert box["y"] + box["height"] <= height
        cut = page.evaluate(
            "[...document.querySelectorAll('.readout .value, .alarm .words, button')]"
            ".filter((n) => n.offsetParent && n.scrollWidth > n.clientWidth + 1).map((n) => n.textContent)"
        )
        assert cut == []
        page.get_by_role("button", name="Details").click()


def test_a_phone_shows_everything_in_one_column(bridge, open_page):
    page = open_page(bridge.address, 390, 844)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert page.locator("#plan").bounding_box()["width"] > 360
    page.get_by_role("button", name="EXECUTE").scroll_into_view_if_needed()
    page.get_by_role("button", name="EXECUTE").click()
    assert page.get_by_role("button", name="ARMED").is_visible()


def test_a_finger_hits_every_control(bridge, open_page):
    page = open_page(bridge.address, 768, 1024, has_touch=True)
    small = page.evaluate(
        "[...document.querySelectorAll('button, input')].filter((n) => n.offsetParent)"
        ".map((n) => [n.textContent || n.ariaLabel, n.getBoundingClientRect()]).filter(([, b]) => b.width < 30 || b.height < 30).map(([t]) => t)"
    )
    assert small == []


def test_every_control_is_reached_by_the_tabulator(bridge, open_page):
    page = open_page(bridge.address)
    page.get_by_role("button", name="Details").click()
    wanted = page.evaluate(
        "[...document.querySelectorAll('button, input, [tabindex=\"0\"]')].filter((n) => n.offsetParent !== null && !n.disabled && n.tabIndex >= 0).length"
    )
    page.evaluate(
        "window.reached = new Set(); document.addEventListener('focusin', (e) => window.reached.add(e.target)); document.activeElement.blur()"
    )
    for _ in range(wanted + 6):
        page.keyboard.press("Tab")
    got = page.evaluate(
        "[...document.querySelectorAll('button, input')].filter((n) => n.offsetParent !== null && !n.disabled && n.tabIndex >= 0 && !window.reached.has(n)).map((n) => n.outerHTML)"
    )
    assert got == []
