"""The console: a heading is set and executed by keys alone, by the dial and by its field; what the server refuses is said."""

from __future__ import annotations

import math

import pytest

DEG = math.pi / 180


def wait_for(bridge, page, name: str, **wanted) -> dict:
    """Wait until the server has got a command, and return the newest of its kind."""
    for _ in range(60):
        found = [
            c
            for c in list(bridge.commands)
            if c["command"] == name and all(abs(c.get(k, math.inf) - v) < 1e-6 for k, v in wanted.items())
        ]
        if found:
            return found[-1]
        page.wait_for_timeout(50)
    raise AssertionError(f"no {name} {wanted} among {bridge.commands}")


def executed(bridge, key: str) -> float:
    return bridge.state["settings"]["executed"][key]


def test_a_heading_is_turned_and_executed_by_keys(bridge, open_page, until):
    page = open_page(bridge.address)
    for key in ("ArrowRight", "ArrowRight", "Shift+ArrowRight", "ArrowUp", "ArrowLeft", "]"):
        page.keyboard.press(key)
    wait_for(bridge, page, "trial", heading=86 * DEG)
    wait_for(bridge, page, "trial", rudder_limit=11 * DEG)
    page.keyboard.press("Enter")
    key = page.get_by_role("button", name="ARMED")
    assert key.get_attribute("aria-pressed") == "true"
    assert not any(c["command"] == "execute" for c in bridge.commands)
    page.keyboard.press("Enter")
    wait_for(bridge, page, "execute")
    until(page, "document.querySelector('.executed b').textContent === 'heading 086.0°, limit 11°'")
    assert executed(bridge, "heading") == pytest.approx(86 * DEG)
    assert page.get_by_role("button", name="EXECUTE").get_attribute("aria-pressed") == "false"
    # The trial is now what is executed, so there is nothing to mark with a T.
    page.wait_for_selector("#trial-mark", state="hidden")


def test_a_key_that_is_held_down_arms_and_does_not_execute(bridge, open_page, until):
    page = open_page(bridge.address)
    page.keyboard.down("Enter")
    for _ in range(3):
        page.keyboard.down("Enter")  # the browser repeats it
    page.keyboard.up("Enter")
    page.wait_for_selector(".execute[aria-pressed=true]")
    page.wait_for_timeout(200)
    assert bridge.commands == []


def test_turning_closes_the_lid_and_escape_cancels(bridge, open_page, until):
    page = open_page(bridge.address)
    page.wait_for_selector(".execute:enabled")
    page.keyboard.press("Enter")
    page.wait_for_selector(".execute[aria-pressed=true]")
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(".execute[aria-pressed=false]", timeout=5000)  # by itself the lid closes after ten seconds
    page.keyboard.press("Enter")
    page.keyboard.press("Escape")
    wait_for(bridge, page, "cancel")
    until(page, "document.querySelector('.primary input').value === '007.5'")
    assert page.locator(".execute").get_attribute("aria-pressed") == "false"
    assert not any(c["command"] == "execute" for c in bridge.commands)


def test_the_field_takes_a_number_and_says_what_is_wrong_with_another(bridge, open_page, until):
    page = open_page(bridge.address)
    field = page.get_by_role("textbox", name="Trial heading")
    field.fill("400")
    field.press("Enter")
    assert "A heading is a number from 0 to 360." in page.locator("#settings .message").inner_text()
    assert field.get_attribute("aria-invalid") == "true" and bridge.commands == []
    field.fill("271,5")
    field.press("Enter")
    wait_for(bridge, page, "trial", heading=271.5 * DEG)
    until(page, "document.querySelector('.primary input').value === '271.5'")
    assert page.locator("#settings .message").is_hidden()
    assert page.locator(".execute").get_attribute("aria-pressed") == "false"
    field.press("Enter")  # nothing new in the field: the key is EXECUTE's
    page.wait_for_selector(".execute[aria-pressed=true]")


def test_the_dial_is_a_slider_that_a_press_sets(bridge, open_page, until):
    page = open_page(bridge.address)
    dial = page.get_by_role("slider", name="Trial heading")
    box = dial.bounding_box()
    dial.click(position={"x": 4, "y": box["height"] / 2})
    wait_for(bridge, page, "trial", heading=270 * DEG)
    until(page, "document.querySelector('.compass').getAttribute('aria-valuetext') === '270.0 degrees'")
    dial.press("ArrowRight")
    wait_for(bridge, page, "trial", heading=271 * DEG)


def test_a_limit_is_held_within_what_the_server_allows(bridge, open_page, until):
    page = open_page(bridge.address)
    field = page.get_by_role("textbox", name="Trial rudder limit")
    field.fill("80")
    field.press("Enter")
    wait_for(bridge, page, "trial", rudder_limit=35 * DEG)
    until(page, "document.querySelector('[aria-label=\"Trial rudder limit\"]').value === '35'")


def test_each_mode_turns_its_own_setting(bridge, open_page, until):
    page = open_page(bridge.address)
    page.get_by_role("radio", name="Rudder").click()
    field = page.get_by_role("textbox", name="Trial rudder")
    field.fill("P 10")
    field.press("Enter")
    wait_for(bridge, page, "trial", rudder=-10 * DEG)
    field.press("ArrowUp")
    wait_for(bridge, page, "trial", rudder=-9 * DEG)
    assert page.get_by_role("textbox", name="Trial rudder limit").is_hidden()
    page.get_by_role("radio", name="Rate").click()
    field = page.get_by_role("textbox", name="Trial rate of turn")
    field.fill("-12")
    field.press("Enter")
    wait_for(bridge, page, "trial", rate=-12 * DEG / 60)
    # A turn at a rate ends at the trial heading: it is shown, can be set, and is said.
    compass = page.get_by_role("slider", name="Trial heading")
    assert compass.get_attribute("aria-disabled") == "false"
    compass.click(position={"x": compass.bounding_box()["width"] - 30, "y": compass.bounding_box()["height"] / 2})
    wait_for(bridge, page, "trial", heading=90 * DEG)
    said = page.evaluate(
        "async () => { const { inWords } = await import('/static/script/console/settings.js'); "
        "return ['rate', 'track'].map((mode) => inWords({mode, rate: 0.01, heading: 0, rudder_limit: 0.2})); }"
    )
    # No limit of the track pilot: it goes 60 % beyond in a turn that gets too wide.
    assert said == ["rate 34.4°/min to 000.0°, limit 11°", "track pilot, turns planned with 11°"]
    page.get_by_role("radio", name="Track", exact=True).click()
    until(page, "document.querySelector('.follow').textContent === 'next 075.0°'")
    assert page.get_by_role("slider", name="Trial heading").get_attribute("aria-disabled") == "true"


def test_what_is_not_possible_cannot_be_chosen(bridge, open_page, until):
    bridge.state["settings"]["modes"] = ["heading", "rudder"]
    page = open_page(bridge.address)
    assert page.get_by_role("radio", name="Track", exact=True).is_disabled()
    assert page.get_by_role("radio", name="Rudder").is_enabled()


def test_a_refusal_is_said_and_the_setting_goes_back(bridge, open_page, until):
    page = open_page(bridge.address)
    bridge.refuse = "The model is not known at this speed."
    page.keyboard.press("ArrowRight")
    page.wait_for_selector("#settings .message:not([hidden])")
    assert "not known at this speed" in page.locator("#settings .message").inner_text()
    until(page, "document.querySelector('.primary input').value === '075.0'")


def test_a_key_pressed_with_the_pointer_leaves_the_keyboard_to_the_heading(bridge, open_page, until):
    page = open_page(bridge.address)
    page.get_by_role("radio", name="Rudder").click()
    page.get_by_role("radio", name="Heading").click()
    page.keyboard.press("ArrowRight")
    wait_for(bridge, page, "trial", heading=76 * DEG)
    page.get_by_role("button", name="Trial heading plus 5").click()
    wait_for(bridge, page, "trial", heading=81 * DEG)
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")
    wait_for(bridge, page, "execute")
    assert executed(bridge, "heading") == pytest.approx(81 * DEG)
    # By the tabulator the row is a row of radio keys like any other.
    page.get_by_role("radio", name="Heading").focus()
    page.keyboard.press("ArrowRight")
    until(
        page,
        "document.activeElement.textContent === 'Rudder' && document.activeElement.getAttribute('aria-checked') === 'true'",
    )
    page.keyboard.press("Enter")
    assert page.locator(".execute").get_attribute("aria-pressed") == "false"


def test_letters_can_be_switched_off_and_the_fields_keep_theirs(bridge, open_page, until):
    page = open_page(bridge.address)
    page.keyboard.press("h")
    assert page.get_by_role("radio", name="Head up").get_attribute("aria-checked") == "true"
    page.get_by_role("textbox", name="Trial heading").press("n")
    assert page.get_by_role("radio", name="Head up").get_attribute("aria-checked") == "true"
    page.get_by_role("button", name="Details").click()
    page.get_by_role("checkbox", name="Letters and signs are keys").uncheck()
    page.get_by_role("button", name="Details").focus()
    page.keyboard.press("n")
    assert page.get_by_role("radio", name="Head up").get_attribute("aria-checked") == "true"


def test_the_simulator_is_changed_in_the_drawer(bridge, open_page, until):
    page = open_page(bridge.address)
    page.get_by_role("button", name="Details").click()
    page.get_by_role("slider", name="Current", exact=True).fill("3")
    wait_for(bridge, page, "simulation", current_speed=3 * 1852 / 3600)
    page.get_by_role("slider", name="Ship's K*").fill("2.5")
    assert wait_for(bridge, page, "simulation", value=2.5)["coefficient"] == "K"
    page.get_by_role("radio", name="×16").click()
    wait_for(bridge, page, "simulation", clock_factor=16)
    page.get_by_role("button", name="Pause").click()
    page.wait_for_selector("button:has-text('Paused')")
    adaptation = page.locator("#drawer").inner_text()
    assert "1.580 ± 0.060" in adaptation and "true value 1.60" in adaptation


def test_what_was_not_understood_of_the_route_stands_in_the_drawer(bridge, open_page, until):
    page = open_page(bridge.address)
    page.get_by_role("button", name="Details").click()
    assert page.get_by_text("Route and chart").is_hidden()
    bridge.state["notes"] = ["route: not understood, and left out: portXTD of leg."]
    page.wait_for_selector(".notes li")
    assert "portXTD of leg" in page.locator(".notes").inner_text()


def test_the_trend_of_a_coefficient_grows_while_the_drawer_is_closed(bridge, open_page, until):
    page = open_page(bridge.address)
    for i in range(4):
        value = {**bridge.state["adaptation"]["values"][0], "value": 1.2 + 0.1 * i}
        bridge.state["time"]["t"] += 3.0
        bridge.state["adaptation"] = {**bridge.state["adaptation"], "values": [value]}
        page.wait_for_timeout(250)
    page.get_by_role("button", name="Details").click()
    points = page.locator(".trend .course").get_attribute("points").split()
    assert len(points) >= 4
    heights = [float(point.split(",")[1]) for point in points[-4:]]
    assert heights == sorted(heights, reverse=True)
