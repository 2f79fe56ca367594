from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


def _fake():
    spec = importlib.util.spec_from_file_location("fake_bridge", HERE / "fake_bridge.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["fake_bridge"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def bridge():
    """A server of a made-up ship, whose state the test may change."""
    served = _fake().FakeBridge()
    served.start()
    yield served
    served.stop()


@pytest.fixture
def open_page(browser):
    """Open a page of a server, and fail the test where it logs an error or asks another host for anything."""
    contexts, faults = [], []

    def opened(address: str, width: int = 1280, height: int = 800, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on(
            "console", lambda message: faults.append(message.text) if message.type in ("error", "warning") else None
        )
        page.on("request", lambda request: None if request.url.startswith(address) else faults.append(request.url))
        page.goto(address)
        page.wait_for_selector("body[data-connected=yes]")
        return page

    opened.faults = faults
    yield opened
    for context in contexts:
        context.close()
    assert faults == []


@pytest.fixture
def until():
    """Wait until an expression of the page holds; the page's own policy forbids Playwright to evaluate it inside the page."""

    def wait(page, expression: str, seconds: float = 8.0) -> None:
        for _ in range(int(seconds / 0.04)):
            if page.evaluate(expression):
                return
            page.wait_for_timeout(40)
        raise AssertionError(f"never: {expression}")

    return wait
