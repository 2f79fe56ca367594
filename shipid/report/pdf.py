"""A page of a report as PDF, printed by a browser without a window: Chromium, Chrome or Edge, whichever is installed."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from shipid.foundation.errors import MissingExtraError, ShipidError

_PROGRAMS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "microsoft-edge",
    "msedge",
)
_PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)
#: Seconds after which a browser that does not answer is given up.
_LONGEST = 120
#: Prints where Playwright has put a browser of its own.
_ASK = "from playwright.sync_api import sync_playwright as s\nwith s() as p: print(p.chromium.executable_path)"


class PdfError(ShipidError):
    """A browser that did not print a page."""


def browser() -> str:
    """Return the program that prints.

    Raises
    ------
    MissingExtraError
        If there is none.
    """
    found = next((p for name in _PROGRAMS if (p := shutil.which(name))), None)
    found = found or next((p for p in _PLACES if Path(p).is_file()), None)
    if found is None and importlib.util.find_spec("playwright") is not None:
        asked = subprocess.run(
            [sys.executable, "-c", _ASK], capture_output=True, text=True, check=False, timeout=_LONGEST
        )
        found = asked.stdout.strip()
    if not found or not Path(found).is_file():
        raise MissingExtraError(
            "a PDF",
            "Chromium, Chrome or Edge",
            "pdf",
            "Then: playwright install chromium. Or open report.html in any browser and print it.",
        )
    return found


def write_pdf(page: Path, path: Path) -> None:
    """Print a page.

    Parameters
    ----------
    page : Path
        The HTML file.
    path : Path
        The PDF to write.

    Raises
    ------
    MissingExtraError
        If there is no browser.
    PdfError
        If the browser does not print it.
    """
    program = browser()
    # The sandbox of Chromium does not start under the superuser, as in a container; the page holds no script.
    alone = ["--no-sandbox"] if getattr(os, "geteuid", lambda: 1)() == 0 else []
    with tempfile.TemporaryDirectory() as profile:
        options = [
            "--headless",
            "--disable-gpu",
            "--no-first-run",
            "--no-pdf-header-footer",
            f"--user-data-dir={profile}",
        ]
        try:
            done = subprocess.run(
                [program, *options, *alone, f"--print-to-pdf={path.resolve()}", page.resolve().as_uri()],
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
                timeout=_LONGEST,
            )
        except subprocess.TimeoutExpired:
            raise PdfError(
                f"{program} did not print the page within {_LONGEST} s. Print report.html from a browser."
            ) from None
    if not path.is_file():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise PdfError(f"{program} did not print the page: {last}. Print report.html from a browser.")
