"""Alarms are told at once and acknowledged one by one; a lost connection cannot be overlooked, and mends itself."""

from __future__ import annotations

import numpy as np


def alarm(number: int, kind: str, text: str, since: float = 250.0) -> dict:
    return {"id": number, "kind": kind, "text": text, "since": since, "acknowledged": False}


def test_alarms_come_gravest_first_and_are_acknowledged_one_by_one(bridge, open_page, until):
    page = open_page(bridge.address)
    assert "No alarms" in page.locator("#alarms").inner_text()
    bridge.state["alarms"] = [
        alarm(1, "caution", "Current changed"),
        alarm(2, "warning", "Wheel-over in 60 s"),
        alarm(3, "alarm", "Heading lost"),
    ]
    page.wait_for_selector(".alarm")
    rows = page.locator(".alarm")
    assert [rows.nth(i).locator(".words").inner_text() for i in range(3)] == [
        "Heading lost",
        "Wheel-over in 60 s",
        "Current changed",
    ]
    assert "alarm: Heading lost" in page.locator("#alarm-region").inner_text()
    assert page.title().startswith("(3)")
    assert rows.nth(0).evaluate("node => getComputedStyle(node).animationName") == "flash"
    page.get_by_role("button", name="Acknowledge alarm: Heading lost").click()
    until(page, "document.querySelectorAll('.unseen-yet').length === 2")
    assert [c for c in bridge.commands if c["command"] == "acknowledge"] == [{"command": "acknowledge", "id": 3}]
    # What waits goes before what was seen; what was seen stays until its cause is gone, and does not flash.
    assert rows.nth(2).locator(".words").inner_text() == "Heading lost"
    assert rows.nth(2).evaluate("node => getComputedStyle(node).animationName") == "none"
    bridge.state["alarms"] = []
    page.wait_for_selector(".alarms .quiet")


def test_alarms_are_acknowledged_by_keys_alone(bridge, open_page, until):
    bridge.state["alarms"] = [alarm(1, "alarm", "Off track"), alarm(2, "warning", "Position lost")]
    page = open_page(bridge.address)
    for _ in range(12):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.getAttribute('aria-label') ?? ''").startswith("Acknowledge"):
            break
    page.keyboard.press("Enter")
    until(page, "document.querySelectorAll('.unseen-yet').length === 1")
    # The focus is at the next one that waits, not lost.
    until(page, "(document.activeElement.getAttribute('aria-label') ?? '').endsWith('Position lost')")
    page.keyboard.press("Enter")
    until(page, "document.querySelectorAll('.unseen-yet').length === 0")
    assert not any(c["command"] == "execute" for c in bridge.commands)


def test_nothing_flashes_for_whoever_asks_for_less_motion(bridge, open_page, until):
    bridge.state["alarms"] = [alarm(1, "alarm", "Off track")]
    page = open_page(bridge.address, reduced_motion="reduce")
    assert page.locator(".alarm").evaluate("node => getComputedStyle(node).animationName") == "none"


def test_a_lost_connection_is_told_and_mends_itself(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.stop()
    page.wait_for_selector("#lost:not([hidden])")
    assert "Connection lost" in page.locator("#lost").inner_text()
    assert page.locator(".readout .number.old").count() == 6
    assert page.locator(".execute").is_disabled()
    assert "Old picture" in page.locator("#plan-note").inner_text()
    page.keyboard.press("Enter")
    assert page.locator(".execute").get_attribute("aria-pressed") == "false"
    bridge.state["own"]["psi"] = 1.0
    bridge.start()
    page.wait_for_selector("#lost", state="hidden", timeout=10000)
    until(page, "document.querySelector('.readout .number').textContent === '057.3'")
    assert page.locator(".readout .number.old").count() == 0
    # The browser itself logs that the server could not be reached.
    open_page.faults[:] = [fault for fault in open_page.faults if "ERR_CONNECTION_REFUSED" not in fault]


def test_a_server_that_falls_silent_is_told(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.silent = True
    page.wait_for_selector("#lost:not([hidden])")
    assert page.locator(".readout .number.old").count() == 6
    until(page, "document.querySelector('.readout .note').textContent === '3 s old'")
    bridge.silent = False
    page.wait_for_selector("#lost", state="hidden")


def test_a_frame_that_is_no_json_is_told_and_survived(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.raw = '{"kind": "tick", "own": {"psi": NaN}}'
    page.wait_for_selector("#lost:not([hidden])")
    assert "cannot be read" in page.locator("#lost").inner_text()
    bridge.raw = None
    page.wait_for_selector("#lost", state="hidden")


HEARD = """
window.heard = [];
new MutationObserver(() => heard.push(performance.now()))
  .observe(document.getElementById("state-region"), { childList: true, characterData: true, subtree: true });
"""


def test_the_state_is_spoken_at_most_once_in_ten_seconds(bridge, open_page, until):
    """By the page's own clock, which is set forward: neither waiting nor a slow machine has a part in it."""
    page = open_page(bridge.address)
    page.clock.install()
    page.reload()
    until(page, "document.getElementById('state-region').textContent.startsWith('Heading 007.5 degrees')")
    assert "wheel-over in 1:42, off track 12 m to starboard" in page.locator("#state-region").inner_text()
    page.evaluate(HEARD)
    for degrees in range(10, 70, 10):
        bridge.state["own"]["psi"] = np.radians(degrees)
        until(page, f"document.querySelector('.readout .number').textContent === '0{degrees}.0'")
        page.clock.fast_forward(4000)
    heard = page.evaluate("heard")
    assert len(heard) >= 2 and np.diff(heard).min() >= 10_000


def test_source_and_experiment_are_named(bridge, open_page, until):
    page = open_page(bridge.address)
    assert page.locator("#source").inner_text() == "Soesterberg · simulator ×4"
    assert page.locator("#experiment").is_hidden()
    bridge.state["time"] = {**bridge.state["time"], "source": "replay", "state": "ended", "clock_factor": None}
    bridge.state["experiment"] = {
        "scenario": "T1",
        "condition": "C",
        "leg": 6,
        "of": 6,
        "rms": 27.4,
        "done": True,
        "spread": 0.0033,
    }
    page.wait_for_selector("#experiment:not([hidden])")
    assert page.locator("#source").inner_text() == "Soesterberg · replay · ended"
    assert page.locator("#experiment").inner_text() == "Track T1 · condition C · finished · RMS 27 m"
    assert "11.3°/min" in page.locator("#voyage").inner_text()
