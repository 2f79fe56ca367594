"""Chromium for the scripts that make pictures, and pictures that are small enough to be kept."""

from __future__ import annotations

import io
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, sync_playwright

#: Bytes that a picture has at most.
LARGEST = 80_000


@contextmanager
def chromium() -> Iterator[Browser]:
    """Run the Chromium of this machine."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        raise SystemExit("there is no Chromium on this machine, which takes the pictures")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


def keep(png: bytes, path: Path) -> None:
    """Write a picture as WebP, in the best quality that is small enough."""
    shown = Image.open(io.BytesIO(png)).convert("RGB")
    size = shown.size
    for share, quality in [(1.0, 85), (1.0, 70), (1.0, 55), (1.0, 40), (0.75, 60), (0.5, 70)]:
        scaled = shown.resize((round(size[0] * share), round(size[1] * share)), Image.Resampling.LANCZOS)
        written = io.BytesIO()
        scaled.save(written, "webp", quality=quality, method=6)
        if written.tell() < LARGEST:
            break
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(written.getvalue())
    print(f"    {path.name}, {scaled.width} x {scaled.height}, {written.tell() / 1000:.0f} kB")
