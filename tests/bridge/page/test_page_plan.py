"""The plan view: its geometry, what it draws and what it withholds, its range, its markers, its sharpness."""

from __future__ import annotations

import math

import pytest

DEG = math.pi / 180

SQUARE = [
    {"x": 0, "y": 0, "xtd_port": 100, "xtd_starboard": 50},
    {"x": 1000, "y": 0, "xtd_port": 100, "xtd_starboard": 50},
    {"x": 1000, "y": 2000, "xtd_port": 200, "xtd_starboard": 80},
]


def run(page, module: str, code: str, argument: object = None):
    """Run code with a module of the page as `m` and an argument as `a`."""
    return page.evaluate(f"async (a) => {{ const m = await import('/static/script/{module}'); {code} }}", argument)


def test_limits_run_beside_the_legs_and_meet_at_the_corners(bridge, open_page):
    page = open_page(bridge.address)
    starboard = run(page, "plan/route.js", "return m.limitLine(a, 1);", SQUARE)
    port = run(page, "plan/route.js", "return m.limitLine(a, -1);", SQUARE)
    # The route goes north, then east: starboard is the inside of the corner.
    assert [(p["x"], p["y"]) for p in starboard] == [(0, 50), (920, 50), (920, 2000)]
    assert [(p["x"], p["y"]) for p in port] == [(0, -100), (1200, -100), (1200, 2000)]
    # Straight on there is no crossing, a sharp corner is cut off, and a leg without a limit has none.
    straight = [SQUARE[0], SQUARE[1], {"x": 2000, "y": 0, "xtd_port": 100, "xtd_starboard": 50}]
    assert all(abs(p["y"] - 50) < 1e-9 for p in run(page, "plan/route.js", "return m.limitLine(a, 1);", straight))
    back = [SQUARE[0], SQUARE[1], {"x": 0, "y": 20, "xtd_port": 100, "xtd_starboard": 50}]
    assert max(abs(p["x"]) for p in run(page, "plan/route.js", "return m.limitLine(a, -1);", back)) < 1500
    assert run(page, "plan/route.js", "return m.limitLine(a, 1);", [{**w, "xtd_starboard": None} for w in SQUARE]) == []


def test_the_wheel_over_line_crosses_the_leg_at_right_angles(bridge, open_page):
    page = open_page(bridge.address)
    route = {"waypoints": SQUARE, "leg": 1, "wheel_over": {"x": 1000, "y": 1500}}
    ends = run(page, "plan/route.js", "return m.wheelOverLine(a);", route)
    # The leg goes east: 200 m to port is north, 80 m to starboard south.
    assert [(round(p["x"]), round(p["y"])) for p in ends] == [(1200, 1500), (920, 1500)]
    assert run(page, "plan/route.js", "return m.wheelOverLine(a);", {**route, "wheel_over": None}) is None


def test_time_ticks_stand_at_whole_times(bridge, open_page):
    page = open_page(bridge.address)
    track = {"t": [0, 50, 130], "x": [0, 500, 500], "y": [0, 0, 800], "psi": [0, 0, 1]}
    ticks = run(page, "plan/tracks.js", "return m.ticksOf(a, 60);", track)
    assert [(t["t"], round(t["x"]), round(t["y"])) for t in ticks] == [(60, 500, 100), (120, 500, 700)]
    assert ticks[0]["slope"] == pytest.approx(90 * DEG)
    steps = run(
        page,
        "plan/tracks.js",
        "return a.map(([seconds, length]) => m.tickStep(seconds, length));",
        [[480, 250], [480, 60], [480, 2000], [0, 10]],
    )
    assert steps == [60, 300, 10, 1200]
    # Written are whole minutes where they have room, and nothing where not even the longest step has.
    cases = [[60, 480, 250], [60, 480, 300], [20, 180, 270], [10, 480, 2000], [1200, 480, 2]]
    numbers = run(
        page,
        "plan/tracks.js",
        "return a.map(([step, seconds, length]) => String(m.numberStep(step, seconds, length)));",
        cases,
    )
    assert numbers == ["120", "60", "60", "10", "Infinity"]


def test_the_projection_turns_the_world_and_finds_it_back(bridge, open_page):
    page = open_page(bridge.address)
    code = """
        const view = m.projection({ place: { x: 1000, y: -500 }, at: { x: 400, y: 300 }, scale: 0.1, up: a });
        const [px, py] = view.point(2000, 500);
        const drawn = view.matrix.transformPoint(new DOMPoint(500, 2000));
        return [px, py, drawn.x, drawn.y, view.world(px, py).x, view.world(px, py).y, ...view.offset([400, 300], Math.PI / 2, 10)];
    """
    north = run(page, "plan/projection.js", code, 0)
    assert north == pytest.approx([500, 200, 500, 200, 2000, 500, 410, 300])
    east = run(page, "plan/projection.js", code, math.pi / 2)  # east is up: north is to the left
    assert east == pytest.approx([300, 200, 300, 200, 2000, 500, 400, 290])


def coloured(page, name: str) -> int:
    """Count the pixels of the plan view that have the colour of a role, as good as."""
    return page.evaluate(
        """(name) => {
            const probe = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
            probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);
            probe.fillRect(0, 0, 1, 1);
            const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
            const canvas = document.getElementById("plan");
            const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
            copy.drawImage(canvas, 0, 0);
            const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
            let count = 0;
            for (let i = 0; i < data.length; i += 4) {
                if (data[i + 3] > 250 && Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 12) count++;
            }
            return count;
        }""",
        name,
    )


def wait_for_colour(page, name: str, count: int) -> None:
    """Wait until more than a number of pixels have the colour of a role: a busy machine draws a moment after a press."""
    for _ in range(100):
        if coloured(page, name) > count:
            return
        page.wait_for_timeout(80)
    raise AssertionError(f"never more than {count} pixels of {name}: {coloured(page, name)}")


def only(page, *markers: str) -> None:
    """Leave on only the markers that are named."""
    # In one go and without a pointer: on a busy machine the row may be laid out anew between press and release.
    page.evaluate(
        """(wanted) => {
            for (const key of document.querySelectorAll(".markers button")) {
                const on = key.getAttribute("aria-pressed") === "true";
                if (!key.hidden && on !== wanted.includes(key.getAttribute("aria-label"))) key.click();
            }
        }""",
        markers,
    )


def test_trial_and_executed_are_drawn_apart_and_the_conditions_withhold_them(bridge, open_page, until):
    page = open_page(bridge.address)
    only(page)
    assert page.locator("#trial-mark").is_visible()
    wait_for_colour(page, "trial", 100)
    wait_for_colour(page, "executed", 100)
    only(page, "Ground-speed vector")
    sailed = bridge.state["own"]
    for condition, tracks, vector in (("A", False, False), ("B", False, True), ("C", True, False), ("D", True, True)):
        # Own ship has the colour of her vector, and how many of her pixels are whole depends on where the layout puts her:
        # the same picture is counted with a ship that lies still.
        counts = []
        for leg, speed in ((1, 0.0), (2, sailed["sog"])):
            bridge.state["own"] = {**sailed, "sog": speed}
            bridge.state["experiment"] = {
                "scenario": "T1",
                "condition": condition,
                "leg": leg,
                "of": 6,
                "rms": None,
                "done": False,
                "spread": None,
            }
            shown = "document.getElementById('experiment').textContent"
            until(page, f"{shown}.includes('condition {condition}') && {shown}.includes('leg {leg + 1} of')")
            counts.append(coloured(page, "own"))
        assert (counts[1] > counts[0] + 50) == vector, (condition, counts)
        for kind in ("trial", "executed"):
            if tracks:
                wait_for_colour(page, kind, 0)
            else:
                assert coloured(page, kind) == 0, condition
        assert page.locator("#trial-mark").is_visible() == tracks
        assert page.get_by_role("button", name="Ground-speed vector").is_visible() == vector


def test_a_trial_that_is_executed_leaves_no_dashes(bridge, open_page, until):
    page = open_page(bridge.address)
    only(page)
    bridge.state["tracks"] = {**bridge.state["tracks"], "trial": None}
    page.wait_for_selector("#trial-mark", state="hidden")
    assert coloured(page, "trial") == 0
    wait_for_colour(page, "executed", 100)


def test_every_marker_has_a_switch(bridge, open_page):
    bridge.state["targets"] = [
        {"id": "1", "name": "Maasborg", "x": 3600.0, "y": -900.0, "course": 2.0, "speed": 5.0, "age": 2.0}
    ]
    bridge.state["route"] = None
    page = open_page(bridge.address)
    seen = {
        "Range rings and bearings": "ring",
        "Trial heading marker": "trial",
        "Past track": "past",
        "Other ships": "target",
        "Chart": "land",
        "Heading line": "own",
    }
    bridge.state["tracks"] = {"trial": None, "executed": None}
    page.wait_for_selector("#trial-mark", state="hidden")
    for marker, role in seen.items():
        only(page)
        off = coloured(page, role)
        only(page, marker)
        wait_for_colour(page, role, off + 10)
    assert "predicted" not in page.locator("#legend").inner_text()


def test_range_by_keys_and_by_wheel(bridge, open_page):
    page = open_page(bridge.address)
    note = page.locator("#scale-note")
    assert "North up · 2 nm" in note.inner_text() and "rings 0.5 nm" in note.inner_text()
    page.keyboard.press("+")
    page.keyboard.press("+")
    page.keyboard.press("+")
    assert "8 nm" in note.inner_text()
    page.keyboard.press("-")
    assert page.get_by_role("radio", name="Range 4 nautical miles").get_attribute("aria-checked") == "true"
    page.locator("#plan").hover()
    page.mouse.wheel(0, -100)
    page.wait_for_selector("button[aria-label='Range 2 nautical miles'][aria-checked=true]")
    # What was chosen is there again the next time.
    page.keyboard.press("c")
    page.reload()
    page.wait_for_selector("body[data-connected=yes]")
    assert "Course up · 2 nm" in page.locator("#scale-note").inner_text()


def test_the_variable_range_marker_by_press_and_by_numbers(bridge, open_page, until):
    page = open_page(bridge.address)
    assert page.locator("#vrm-note").is_hidden()
    box = page.locator("#plan").bounding_box()
    radius = min(box["width"], box["height"]) / 2 - 16
    # A quarter of the radius to the right of the ship, on the range of 2 miles: half a mile to the east.
    page.mouse.click(box["x"] + box["width"] / 2 + radius / 4, box["y"] + box["height"] / 2)
    # A press falls on a whole pixel, which is a degree at this distance.
    name, miles, unit, angle = page.locator("#vrm-note").inner_text().split()
    assert (
        (name, unit) == ("VRM", "nm")
        and float(miles) == pytest.approx(0.5, abs=0.011)
        and float(angle.rstrip("°")) == pytest.approx(90, abs=1.5)
    )
    field = page.get_by_role("textbox", name="Bearing of the variable range marker")
    field.fill("225")
    field.press("Enter")
    field = page.get_by_role("textbox", name="Range of the variable range marker")
    field.fill("1.25")
    field.press("Enter")
    assert page.locator("#vrm-note").inner_text() == "VRM 1.25 nm 225.0°"
    page.locator("body").click(position={"x": 400, "y": 20})
    page.keyboard.press("v")
    assert page.locator("#vrm-note").is_hidden()


def test_a_dense_screen_is_drawn_densely(bridge, open_page):
    page = open_page(bridge.address, device_scale_factor=2)
    assert page.evaluate(
        "(c => [c.width / c.clientWidth, c.height / c.clientHeight])(document.getElementById('plan'))"
    ) == pytest.approx([2, 2], abs=0.01)


def test_a_prediction_that_cannot_be_trusted_says_so(bridge, open_page):
    bridge.state["tracks"]["trial"].update(message="the model diverged")
    bridge.state["tracks"]["executed"].update(beyond=True)
    page = open_page(bridge.address)
    note = page.locator("#plan-note").inner_text()
    assert "Trial: the model diverged" in note and "Prediction: beyond what the model was identified on" in note


def test_the_past_of_a_day_stays_drawable(bridge, open_page):
    page = open_page(bridge.address)
    sizes = run(
        page, "wire/model.js",
        """
        const model = m.createModel();
        model.take({ kind: "snapshot", past: { t: [], x: [], y: [] } });
        for (let i = 0; i < 400; i++) {
          model.take({ kind: "tick", past_add: Array.from({ length: 100 }, (_, k) => [100 * i + k, k, k]) });
        }
        return [model.past.t.length, model.past.t.at(-1), model.past.t[0], model.past.x.length];
        """,
    )  # fmt: skip
    assert sizes[0] == sizes[3] <= 6000 and sizes[0] > 2000
    assert sizes[1] >= 39990 and sizes[2] == 0


def test_nothing_is_drawn_over_a_word(bridge, open_page):
    page = open_page(bridge.address)
    drawn = page.evaluate(
        """async () => {
        const seen = [], proto = CanvasRenderingContext2D.prototype;
        for (const name of ["clearRect", "fill", "stroke", "fillText"]) {
          const was = proto[name];
          proto[name] = function (...given) { seen.push(name); return was.apply(this, given); };
        }
        await new Promise((resolve) => setTimeout(resolve, 700));
        return seen;
      }"""
    )
    whole = " ".join(drawn).split("clearRect")[1:-1]
    assert whole and all("fillText" in one and "fill " in one for one in whole)
    assert not any({"fill", "stroke"} & set(one.split("fillText", 1)[1].split()) for one in whole)
