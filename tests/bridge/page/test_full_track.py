"""A whole track of the experiment, sailed through the page: read, set a heading, execute at the wheel-over, correct along the leg.

The page is the only way in: the headings are those it shows, and the weather of the experiment acts.
"""

from __future__ import annotations

import math
import os
import re
import subprocess
import sys
import time

import pytest

#: Simulated seconds a second: a track is 50 minutes, and slower where the machine is.
FACTOR = 64
#: How far ahead a correction aims, in m.
AIM = 600.0
#: Seconds to the wheel-over at which the turn is tried, at which it is close, at which it is armed, and at which the wheel goes over; from
#: the first two on the clock is slower, so that a page that lags by seconds of real time is in time. The lid stays open for ten of them.
BUSY, CLOSE, SOON, EARLY = 240.0, 40.0, 20.0, 2.0
SLOWER, SLOWEST = 16, 4
#: The rate of turn in degrees a minute below which the ship is on her leg, and the seconds between two corrections.
STEADY, LOOKS = 2.0, 40.0
#: The legs of the track in degrees, and the largest drift angle in a current of 2.5 kn at 17 kn.
COURSES, DRIFT = (75, 30, 60, -45, -30), 10.0
#: RMS in m that the navigators of the experiment reached without a predictor.
OFF = 100.0

LOOK = """() => {
    const text = (selector) => document.querySelector(selector)?.textContent ?? "";
    const row = (name) => [...document.querySelectorAll(".voyage dt")].find((n) => n.textContent === name && !n.hidden)?.nextSibling.textContent ?? "";
    return {
        wheel: text("[aria-label='time and distance to the wheel-over'] .number"), off: text("[aria-label^='distance off'] .number"),
        rate: text(".bar .numbers b"), next: row("Next heading"), experiment: text("#experiment"), executed: text(".executed b"),
    };
}"""


@pytest.fixture
def served(request):
    """The real bridge on track T1 with the track predictor, and its address."""
    command = [
        sys.executable,
        "-m",
        "shipid",
        "bridge",
        "--scenario",
        "T1",
        "--condition",
        "C",
        "--port",
        "0",
        *request.param,
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as running:
        said = ""
        while not (found := re.search(r"http://127\.0\.0\.1:\d+/", said)):
            line = running.stdout.readline()
            assert line, said
            said += line
        yield running, found[0]
        running.terminate()
        running.wait(10)


def seconds(text: str) -> float:
    match = re.fullmatch(r"(−?)(\d+):(\d\d)", text)
    return math.inf if match is None else (-1 if match[1] else 1) * (60 * int(match[2]) + int(match[3]))


def per_minute(text: str) -> float:
    return float(text.removesuffix("°/min").removeprefix("P ").removeprefix("S "))


def metres(text: str) -> float:
    """Distance off the track, positive to starboard."""
    match = re.fullmatch(r"([\d.]+) (m|nm)(?: ([PS]))?", text)
    return (
        0.0 if match is None else float(match[1]) * (1852 if match[2] == "nm" else 1) * (-1 if match[3] == "P" else 1)
    )


def steer(page, heading: float) -> None:
    field = page.get_by_role("textbox", name="Trial heading")
    field.fill(f"{heading % 360:.1f}")
    field.press("Enter")


def choose(page, name: str) -> None:
    page.get_by_role("radio", name=name, exact=True).click()


def pause(page, paused: bool) -> None:
    page.get_by_role("button", name="Pause" if paused else "Paused", exact=True).click()
    page.get_by_role("button", name="Paused" if paused else "Pause", exact=True).wait_for()
    page.locator("#plan").focus()


def execute(page) -> None:
    page.get_by_role("slider", name="Trial heading").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")


def sail(page, count: float = math.inf) -> list[float]:
    """Sail until the experiment is finished or so many turns are sailed; return the headings that were executed at the wheel-over."""
    page.get_by_role("button", name="Details").click()
    page.wait_for_selector("#legend .executed:visible")  # the predictor is ready; until then the ship hardly moves
    choose(page, f"×{FACTOR}")
    base = float(re.search(r"heading ([\d.]+)", page.evaluate(LOOK)["executed"])[1])
    turns, state, ends, again = [], "leg", time.monotonic() + 150, 0.0
    while "finished" not in (seen := page.evaluate(LOOK))["experiment"]:
        assert time.monotonic() < ends, seen
        wheel = seconds(seen["wheel"])
        if state == "leg" and wheel < BUSY:
            # The turn is tried while the simulator stands still: how fast this machine is does not matter.
            pause(page, True)
            base = float(seen["next"].rstrip("°"))
            steer(page, base)
            page.wait_for_selector("#trial-mark", state="visible")
            choose(page, f"×{SLOWER}")
            pause(page, False)
            state = "tried"
        elif state == "tried" and wheel < CLOSE:
            choose(page, f"×{SLOWEST}")
            state = "close"
        elif state == "close" and wheel < SOON:
            page.get_by_role("slider", name="Trial heading").focus()
            page.keyboard.press("Enter")
            page.wait_for_selector(".execute[aria-pressed=true]")
            state = "armed"
        elif state == "armed" and wheel <= EARLY:
            page.keyboard.press("Enter")
            page.wait_for_selector("#trial-mark", state="hidden")
            choose(page, f"×{FACTOR}")
            turns.append(base)
            state = "turn"
        elif state == "turn" and wheel > BUSY and abs(per_minute(seen["rate"])) < STEADY:
            if len(turns) >= count:
                return turns
            state = "leg"
        elif state == "leg" and time.monotonic() > again:
            again = time.monotonic() + LOOKS / FACTOR
            steer(page, base - math.degrees(math.atan(metres(seen["off"]) / AIM)))
            execute(page)
        page.wait_for_timeout(15)
    return turns


def between(turn: float, course: float) -> float:
    """The angle between two directions in degrees."""
    return abs((turn - course + 180) % 360 - 180)


@pytest.mark.parametrize("served", [("--clock-factor", "1")], indirect=True)
def test_a_navigator_sails_the_first_turn_of_the_experiment(served, open_page):
    """The page shows when and to what heading the wheel goes over; the ship that executes it there comes out on the next leg."""
    _, address = served
    page = open_page(address)
    (turn,) = sail(page, 1)
    assert between(turn, COURSES[0]) < DRIFT
    pause(page, True)
    seen = page.evaluate(LOOK)
    assert abs(metres(seen["off"])) < OFF
    assert between(float(re.search(r"heading ([\d.]+)", seen["executed"])[1]), turn) < 0.1
    page.close()


@pytest.mark.skipif(
    "SHIPID_SAIL" not in os.environ,
    reason="SHIPID_SAIL=1 sails it: two minutes of real time, on a machine that does nothing else",
)
@pytest.mark.parametrize("served", [("--clock-factor", "1")], indirect=True)
def test_a_navigator_sails_a_track_of_the_experiment(served, open_page):
    running, address = served
    page = open_page(address)
    turns = sail(page)
    page.close()
    running.terminate()
    said = running.stdout.read()
    # Five changes of course, each within the drift angle of the leg that follows.
    assert len(turns) == len(COURSES)
    assert max(between(turn, course) for turn, course in zip(turns, COURSES)) < DRIFT
    score = re.search(r"experiment T1, condition C: the whole track\s+RMS distance .*? ([\d.]+) m", said)
    assert score, said
    assert float(score[1]) < OFF
