"""Day, dusk and night: every pair of colours that is used has the contrast it needs, and night is dark."""

from __future__ import annotations

import io
import re
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

STYLE = Path(__file__).resolve().parents[3] / "shipid" / "bridge" / "page" / "style"
PALETTES = ("day", "dusk", "night")
#: Text and what it stands on, 4.5 to 1; lines and the edges of keys, 3 to 1 (WCAG 2.2, 1.4.3 and 1.4.11).
TEXT = [
    ("text", "ground"), ("text", "panel"), ("text", "key"), ("text", "sea"), ("soft", "ground"), ("soft", "panel"), ("soft", "key"), ("soft", "sea"),
    ("on-key-on", "key-on"), ("on-trial", "trial"), ("on-alarm", "alarm"), ("on-warning", "warning"), ("on-caution", "caution"),
    ("trial", "panel"), ("trial", "key"), ("trial", "sea"), ("executed", "panel"), ("executed", "sea"), ("route", "sea"), ("port", "panel"),
    ("starboard", "panel"), ("target", "sea"), ("panel", "trial"),
]  # fmt: skip
LINES = [
    ("edge", "panel"), ("edge", "key"), ("key-on", "panel"), ("route", "ground"), ("route", "panel"), ("port", "key"), ("starboard", "key"),
    ("executed", "key"), ("own", "key"),
    *[(line, ground) for line in ("own", "trial", "executed", "route", "past", "ring", "target", "text", "soft") for ground in ("sea", "shoal", "shallow", "land")],
]  # fmt: skip


def palettes() -> dict[str, dict[str, str]]:
    text = (STYLE / "palette.css").read_text(encoding="utf-8")
    return {
        name: dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", block))
        for name, block in re.findall(r'data-palette="(\w+)"\] \{(.*?)\}', text, re.S)
    }


def luminance(colour: str) -> float:
    share = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return float(np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722])


def contrast(a: str, b: str) -> float:
    low, high = sorted([luminance(a), luminance(b)])
    return (high + 0.05) / (low + 0.05)


def test_the_measure_of_contrast():
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("name", PALETTES)
def test_every_pair_has_the_contrast_it_needs(name):
    colours = palettes()[name]
    weak = [
        (a, b, round(contrast(colours[a], colours[b]), 2)) for a, b in TEXT if contrast(colours[a], colours[b]) < 4.5
    ]
    weak += [
        (a, b, round(contrast(colours[a], colours[b]), 2)) for a, b in LINES if contrast(colours[a], colours[b]) < 3
    ]
    assert weak == []


def test_the_palettes_have_the_same_roles_and_every_role_is_used():
    roles = [set(colours) for colours in palettes().values()]
    assert len(roles) == 3 and roles[0] == roles[1] == roles[2]
    page = STYLE.parent
    elsewhere = "".join(
        p.read_text(encoding="utf-8") for p in [*page.rglob("*.js"), *STYLE.glob("*.css")] if p.name != "palette.css"
    )
    assert {role for role in roles[0] if f"var(--{role})" not in elsewhere and f'"{role}"' not in elsewhere} == set()
    used = set(re.findall(r"var\(--([\w-]+)\)", elsewhere)) - {"fill", "on-fill"}
    assert used <= roles[0]
    # A colour is written in the palettes only.
    assert re.findall(r"#[0-9a-fA-F]{3,8}\b(?=[;\s\"'])|rgba?\(|hsl", elsewhere) == []


def hue(colour: str) -> tuple[float, float]:
    """Hue in degrees and saturation of a colour."""
    r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    high, low = max(r, g, b), min(r, g, b)
    if high == low:
        return 0.0, 0.0
    part = {r: (g - b) / (high - low) % 6, g: (b - r) / (high - low) + 2, b: (r - g) / (high - low) + 4}[high]
    return 60 * part, (high - low) / high


@pytest.mark.parametrize("name", PALETTES)
def test_only_port_and_alarms_are_red(name):
    red = {
        role
        for role, colour in palettes()[name].items()
        if (hue(colour)[0] < 16 or hue(colour)[0] > 335) and hue(colour)[1] > 0.3
    }
    assert red == {"port", "alarm"}


def brightness(page) -> float:
    """Mean relative luminance of the page as it is seen."""
    image = matplotlib.image.imread(io.BytesIO(page.screenshot()), format="png")[..., :3]
    return float(
        np.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4).mean(axis=(0, 1))
        @ [0.2126, 0.7152, 0.0722]
    )


def test_a_palette_is_chosen_remembered_and_night_is_a_tenth_of_dusk_or_day(bridge, open_page):
    page = open_page(bridge.address)
    seen = {}
    for name in PALETTES:
        page.get_by_role("radio", name=name.title()).click()
        page.mouse.move(0, 0)
        seen[name] = brightness(page)
    assert seen["day"] > 10 * seen["dusk"] > 10 * seen["night"]
    page.reload()
    page.wait_for_selector("body[data-connected=yes]")
    assert page.get_by_role("radio", name="Night").get_attribute("aria-checked") == "true"
    assert page.locator("html").get_attribute("data-palette") == "night"


def test_no_control_of_the_drawer_is_bright_at_night_or_leaves_it(bridge, open_page):
    """A browser draws what is not styled in its own colours: a white rail of a slider, in the dark."""
    page = open_page(bridge.address, width=1080, height=810)
    page.get_by_role("radio", name="Night").click()
    page.get_by_role("button", name="Details").click()
    drawer = page.locator("#drawer")
    brightest = max(max(int(c[i : i + 2], 16) for i in (1, 3, 5)) for c in palettes()["night"].values()) / 255
    for control in ("#drawer .slider input", "#drawer .check input"):
        page.locator(control).first.scroll_into_view_if_needed()
        image = matplotlib.image.imread(io.BytesIO(drawer.screenshot()), format="png")[..., :3]
        assert image.max() <= brightest + 0.02, control
    assert drawer.evaluate("e => e.scrollWidth <= e.clientWidth")


def test_a_dark_system_begins_at_dusk(bridge, open_page):
    page = open_page(bridge.address, color_scheme="dark")
    assert page.locator("html").get_attribute("data-palette") == "dusk"
