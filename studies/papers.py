"""Run the studies of the five papers and keep what they print for the documentation: rows, readings, figures.

    python studies/papers.py [STUDY ...]

Without names all of them run, one after the other: some twenty minutes. Chromium draws the figures. The rows go to `.docs/papers/verdicts.json`, the figures to
`.docs/papers/figures`. Claims that do not hold are kept as such.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from _browser import chromium, keep

HERE = Path(__file__).resolve().parent
KEPT = HERE.parent / ".docs" / "papers"
#: The runs of each study: fewer than its default where that takes minutes.
STUDIES: dict[str, tuple[str, ...]] = {
    "passenier_ch3": (),
    "passenier_ch4": ("--short",),
    "passenier_fig6_3": ("--runs", "20"),
    "passenier_fig6_4": (),
    "passenier_fig6_5": (),
    "passenier_fig6_6": ("--runs", "20"),
    "passenier_fig6_7": (),
    "passenier_fig6_17": ("--runs", "20"),
    "passenier_fig6_18": (),
    "passenier_fig6_21": (),
    "passenier_fig6_22": (),
    "passenier_table6_4": (),
    "semerdjiev_2000_ship": (),
    "semerdjiev_2000_ct": (),
    "song_2018": ("--short",),
    "grinyak_fuzzy": (),
}


def printed(name: str) -> tuple[str, str]:
    """Run one study; return its rows as JSON, and its figure as SVG, empty where it draws none."""
    program = [sys.executable, str(HERE / f"{name}.py"), *STUDIES[name], "--json"]
    with tempfile.TemporaryDirectory() as folder:
        drawing = Path(folder) / "figure.svg"
        done = subprocess.run([*program, "--figure", str(drawing)], capture_output=True, text=True)
        if not done.stdout.lstrip().startswith("["):
            raise SystemExit(f"{name} printed no rows: {done.stderr[-2000:]}")
        return done.stdout, drawing.read_text(encoding="utf-8") if drawing.exists() else ""


def keep_study(name: str, rows: str, drawing: str) -> None:
    """Keep the rows of a study, and its figure as a picture of twice its size."""
    picture = KEPT / "figures" / name.partition("_")[0] / f"{name}.webp"
    if drawing:
        with chromium() as browser:
            page = browser.new_page(viewport={"width": 1000, "height": 1000}, device_scale_factor=2)
            page.set_content(drawing[drawing.index("<svg") :])
            keep(page.locator("svg").screenshot(), picture)
    file = KEPT / "verdicts.json"
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    known[name] = {
        "command": " ".join(["python", f"studies/{name}.py", *STUDIES[name]]),
        "figure": picture.relative_to(KEPT).as_posix() if drawing else "",
        "rows": json.loads(rows),
    }
    ordered = {each: known[each] for each in STUDIES if each in known}
    file.write_text(json.dumps(ordered, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{name}, {len(known[name]['rows'])} rows")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studies", nargs="*", choices=[[], *STUDIES], help="which; all of them by default")
    for name in parser.parse_args().studies or STUDIES:
        keep_study(name, *printed(name))


if __name__ == "__main__":
    main()
