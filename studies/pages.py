#!/usr/bin/env python3
"""Every kind of report page, made as a user makes it and looked at on every screen: light, dark, a phone of 390 px, and on paper.

    python studies/pages.py [KIND ...] [--pictures FOLDER] [--json]

Each page comes from the command that makes it, or from a few lines of Python where no command does. Chromium asks of each: does axe-core
find anything, does the page scroll sideways on a phone, do words of a figure lie over each other or outside of it, does text run out of
its box, is a number raw. With ``--pictures`` what was seen is kept: KIND-light.png, -dark.png, -phone.png and one picture a printed page
(pdftoppm). Chromium and ``pip install -e '.[test]'`` are needed; all kinds take some minutes.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import html5lib
import pypdf
from _browser import chromium
from _commands import empty_folder
from _table import Row, show
from axe_playwright_python.sync_playwright import Axe
from pictures import TRIALS, faulty, plots
from playwright.sync_api import Browser, Page

from shipid.foundation.exit_codes import ExitCode
from shipid.report.pdf import write_pdf

ROOT = Path(__file__).resolve().parents[1]
SHIP = "de-keizer --ship soesterberg"
#: What stands at the head of a script: the trial, and a filter on it.
TRIAL = "import shipid; trial = shipid.read_trial('container-20-20.csv'); "
FILTER = (
    f"{TRIAL}model = shipid.find_model('own-ship-filter'); "
    "ekf = shipid.ExtendedKalmanFilter(model, 'soesterberg', measured={'psi': '0.2 deg', 'x': '5 m', 'y': '5 m'}); run = ekf.filter(trial); "
)
MODES = (
    "from shipid.models import constant_velocity, coordinated_turn; "
    "turn = lambda rate: shipid.Mode(coordinated_turn, inputs={'omega': rate}); "
    "several = shipid.InteractingMultipleModel("
    "{'straight': constant_velocity, 'port': turn('-0.8 deg/s'), 'starboard': turn('0.8 deg/s')}, "
    "[[0.9, 0.05, 0.05], [0.1, 0.9, 0.0], [0.1, 0.0, 0.9]], measured={'x': '20 m', 'y': '20 m'}, "
    "noise={'ax': '0.1 m/s^2', 'ay': '0.1 m/s^2'}); "
)
PILOT = "import shipid; pilot = shipid.design_autopilot('de-keizer', 'soesterberg'); "
ROUTE = "route = shipid.read_route('plan.csv'); "
#: What makes the page of each kind, by its name in `write_report`: commands of shipid, or Python with the result as its last expression.
PAGES: dict[str, tuple[str, ...]] = {
    "Fit": ("shipid identify container-20-20.csv --model de-keizer --ship soesterberg --validate container-10-10.csv",),
    "FilterRun": ("shipid filter container-20-20.csv --model yaw-filter --ship soesterberg",),
    "Observability": (f"{FILTER}ekf.observability(run)",),
    "WhichShip": (
        "shipid filter container-20-20.csv --model de-keizer --method imm --ship soesterberg --ship slow.toml",
    ),
    "RecursiveIdentification": (
        "shipid filter container-20-20.csv --model yaw-filter --ship soesterberg --method rls",
    ),
    "Autopilot": (f"{PILOT}pilot",),
    "Judgement": (f"shipid tune {SHIP}",),
    "TuningComparison": (
        f"shipid tune {SHIP} --samples 0 --out firm",
        f"shipid tune {SHIP} --samples 0 --omega-n '0.02 rad/s' --out gentle",
        "shipid tune --compare firm/schedule.toml gentle/schedule.toml",
    ),
    "Prediction": (f"shipid predict {SHIP} --from container-20-20.csv@200 --heading '60 deg'",),
    "TrialSheet": ("shipid report container-20-20.csv container-10-10.csv --length '226 m'",),
    "CampaignResult": ("shipid campaign song-2018 --runs 40",),
    "FleetResult": ("shipid campaign trials --model de-keizer --ship soesterberg",),
    "Tracking": ("shipid track plots.csv --position-std '15 m' --own container-20-20.csv",),
    "Ranking": (
        "shipid compare container-20-20.csv container-10-10.csv --models nomoto,norrbin,de-keizer --ship soesterberg",
    ),
    "Plan": ("shipid plan --model norrbin --ship zeefakkel --time 20min",),
    "Criteria": (f"shipid criteria {SHIP}",),
    "Diagnosis": ("shipid check faulty.csv --ship soesterberg",),
    "several Diagnosis": ("shipid check container-20-20.csv faulty.csv --ship soesterberg",),
    "Trial": (f"{TRIAL}trial",),
    "Voyage": (f"{PILOT}{ROUTE}shipid.sail_route(pilot, route)",),
    "PredictedTrack": (
        f"{PILOT}shipid.TrackPredictor(pilot).predict(shipid.Situation({{'psi': 0.0, 'u': 9.5}}), heading='60 deg')",
    ),
    "Smoothed": (f"{FILTER}ekf.smooth(run)",),
    "MultipleModelRun": (f"{TRIAL}{MODES}several.filter(trial)",),
}
#: Words that a solver or a program says, and no engineer.
RAW = r"ftol|xtol|gtol|max_nfev|termination condition|\bnan\b|\binf\b|\bNone\b|\bTrue\b|\bFalse\b|array\(|np\.|dtype|Traceback|\[\]"
#: Seven decimals are a good value with a small interval.
DIGITS = r"\d\.\d{9,}|\b\d+\.\d*e[+-]?\d+|\b\d+e[+-]\d+"
ZERO = r"(?<![\w.^⁻])[-−]0(?:\.0+)?(?![\d.]*[1-9.])(?![\d/])"
#: Words of a figure that lie over each other, or outside of it; and words of the page that run out of their box.
WORDS = """() => {
  const told = [];
  for (const svg of document.querySelectorAll('figure svg')) {
    const frame = svg.getBoundingClientRect(), seen = [];
    for (const text of svg.querySelectorAll('text')) {
      if (!text.textContent.trim()) continue;
      const b = text.getBoundingClientRect(), name = text.textContent.trim();
      if (b.width < 1) continue;
      if (b.left < frame.left - 1 || b.right > frame.right + 1 || b.top < frame.top - 1 || b.bottom > frame.bottom + 1)
        told.push(`${svg.getAttribute('aria-label').slice(0, 40)}: '${name}' is cut off`);
      for (const [other, o] of seen) {
        const w = Math.min(b.right, o.right) - Math.max(b.left, o.left), h = Math.min(b.bottom, o.bottom) - Math.max(b.top, o.top);
        if (w > 1.5 && h > 3) told.push(`${svg.getAttribute('aria-label').slice(0, 40)}: '${name}' lies over '${other}'`);
      }
      seen.push([name, b]);
    }
  }
  for (const box of document.querySelectorAll('p, li, th, td, h1, h2, h3, figcaption, .box')) {
    if (box.closest('.unseen, .stack thead, math') || !box.getClientRects().length) continue;
    if (box.scrollWidth > box.clientWidth + 2 && box.clientWidth > 0 && getComputedStyle(box).overflowX === 'visible'
        && getComputedStyle(box).display !== 'inline')
      told.push(`<${box.tagName.toLowerCase()}> '${box.textContent.trim().slice(0, 40)}' runs out of its box`);
  }
  return told;
}"""


def prepare() -> None:
    """Lay out what the commands read: two trials, also in a folder of their own, a log with faults, plots, a route, a second ship."""
    Path("trials").mkdir()
    for name in TRIALS:
        shutil.copy(ROOT / "studies" / "trials" / name, name)
        shutil.copy(name, Path("trials", name))
    Path("faulty.csv").write_text(faulty(), encoding="utf-8")
    Path("plots.csv").write_text(plots(), encoding="utf-8")
    Path("plan.csv").write_text("x [m],y [m]\n0,0\n4000,0\n6500,3000\n11000,3000\n", encoding="utf-8")
    ship = (ROOT / "models" / "ships" / "soesterberg.toml").read_text(encoding="utf-8")
    ship = re.sub(r'(?m)^name = "soesterberg"', 'name = "slower"', ship).replace(
        "K = { value = 1.6,", "K = { value = 1.1,"
    )
    Path("slow.toml").write_text(ship, encoding="utf-8")


def make(kind: str) -> Path:
    """Run what makes the page of a kind, as a user types it, and return the page."""
    for step in PAGES[kind]:
        if step.startswith("shipid "):
            out = "" if " --out " in step else f" --out '{kind}'"
            print(f"$ {step}{out}", file=sys.stderr)
            program = ["-m", *shlex.split(step + out)]
        else:
            *lines, last = step.split("; ")
            code = "\n".join([*lines, f"shipid.write_report({last}, '{kind}/report.html')"])
            print(code, file=sys.stderr)
            Path(kind).mkdir()
            program = ["-c", code]
        done = subprocess.run([sys.executable, *program], capture_output=True, text=True)
        # A check that found something serious, and a result beside a serious warning, have written their page.
        if done.returncode not in (ExitCode.DONE, ExitCode.BAD_DATA, ExitCode.DOUBTFUL):
            raise SystemExit(f"{kind}: {done.stderr}")
    return Path(kind, "report.html")


def seen_on(page: Page, name: str, pictures: Path | None) -> list[str]:
    """What is wrong with a page on one screen, and its picture."""
    found = [f"axe: {v['id']} {[n['target'] for n in v['nodes']][:3]}" for v in Axe().run(page).response["violations"]]
    found += page.evaluate(WORDS)
    wide = page.evaluate("document.documentElement.scrollWidth - innerWidth")
    if wide > 0:
        found.append(f"scrolls sideways by {wide} px")
    if pictures is not None:
        page.screenshot(path=pictures / f"{name}.png", full_page=True)
    return [f"{name.rpartition('-')[2]}: {one}" for one in found]


def on_screens(browser: Browser, kind: str, file: Path, pictures: Path | None) -> list[str]:
    """What is wrong with a page in light, in dark and on a phone."""
    found: list[str] = []
    for mode, width, scheme in (("light", 1200, "light"), ("dark", 1200, "dark"), ("phone", 390, "light")):
        with contextlib.closing(
            browser.new_context(viewport={"width": width, "height": 844}, color_scheme=scheme)
        ) as c:
            page = c.new_page()
            page.goto(file.resolve().as_uri())
            page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
            found += seen_on(page, f"{kind.replace(' ', '-')}-{mode}", pictures)
            if mode == "light":
                words = page.evaluate("document.body.innerText")
                words += "\n".join(page.evaluate("[...document.querySelectorAll('svg text')].map(t => t.textContent)"))
                for what, pattern in (("raw word", RAW), ("raw number", DIGITS), ("signed zero", ZERO)):
                    found += [
                        f"{what}: {words[max(0, m.start() - 25) : m.end() + 15]!r}" for m in re.finditer(pattern, words)
                    ]
    return found


def look(browser: Browser, kind: str, pictures: Path | None) -> list[Row]:
    """Make the page of one kind and look at it."""
    file = make(kind)
    text = file.read_text(encoding="utf-8")
    html5lib.HTMLParser(strict=True).parse(text)
    found = on_screens(browser, kind, file, pictures)
    ids = re.findall(r"\sid=\"([^\"]*)\"", text)
    found += [f"'{one}' is the id of two elements" for one in sorted(set(ids)) if ids.count(one) > 1]
    printed = file.with_suffix(".pdf")
    write_pdf(file, printed)
    if pictures is not None:
        name = pictures / f"{kind.replace(' ', '-')}-print"
        subprocess.run(["pdftoppm", "-r", "60", "-png", printed, name], check=True)
    pages, size = len(pypdf.PdfReader(printed).pages), len(text.encode()) / 1000
    return [
        Row(f"{kind}: faults seen", "none", "; ".join(found) or "none", not found),
        Row(f"{kind}: size", "below 1000 kB", f"{size:.0f} kB", size < 1000),
        Row(f"{kind}: printed pages", "12 or fewer", f"{pages}", pages <= 12),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"{', '.join(PAGES)}; all by default")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="keep what was seen in this folder")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    kinds = chosen.kinds or list(PAGES)
    if unknown := set(kinds) - set(PAGES):
        parser.error(f"there is no page of {', '.join(sorted(unknown))}")
    pictures = None if chosen.pictures is None else chosen.pictures.resolve()
    if pictures is not None:
        pictures.mkdir(parents=True, exist_ok=True)
    with empty_folder(), chromium() as browser:
        prepare()
        rows = [row for kind in kinds for row in look(browser, kind, pictures)]
    show("Every kind of page, on every screen", rows, "", chosen.json)


if __name__ == "__main__":
    main()
