"""Run the studies of the five papers and keep what they print for the documentation: rows, readings, figures.

    python studies/papers.py [STUDY ...]

Without names all of them run, one after the other: some ten minutes. The rows go to `.docs/papers/verdicts.json`, the figures to
`.docs/papers/figures`. Claims that do not hold are kept as such.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

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
    "passenier_fig6_7": ("--runs", "3"),
    "passenier_fig6_17": ("--runs", "20"),
    "passenier_fig6_18": (),
    "passenier_fig6_21": (),
    "passenier_fig6_22": (),
    "passenier_table6_4": ("--runs", "1"),
    "semerdjiev_2000_ship": ("--short",),
    "semerdjiev_2000_ct": ("--short",),
    "song_2018": ("--short",),
    "grinyak_fuzzy": (),
}


def shortened(svg: str) -> str:
    """Return a drawing with its coordinates to a hundredth of a point, and without what only says who drew it."""
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    return re.sub(r"(?<=[ ML\"\n-])(\d+\.\d{2})\d+", r"\1", svg)


def keep(name: str) -> None:
    """Run one study and keep its rows and its figure."""
    folder = KEPT / "figures" / name.partition("_")[0]
    drawing = folder / f"{name}.svg"
    folder.mkdir(parents=True, exist_ok=True)
    program = [sys.executable, str(HERE / f"{name}.py"), *STUDIES[name], "--json"]
    done = subprocess.run([*program, "--figure", str(drawing)], capture_output=True, text=True)
    if done.returncode == 2:  # a study without a figure
        done = subprocess.run(program, capture_output=True, text=True)
    if not done.stdout.lstrip().startswith("["):
        raise SystemExit(f"{name} printed no rows: {done.stderr[-2000:]}")
    if drawing.exists():
        drawing.write_text(shortened(drawing.read_text(encoding="utf-8")), encoding="utf-8")
    rows = KEPT / "verdicts.json"
    known = json.loads(rows.read_text(encoding="utf-8")) if rows.exists() else {}
    known[name] = {
        "command": " ".join(["python", f"studies/{name}.py", *STUDIES[name]]),
        "figure": drawing.relative_to(KEPT).as_posix() if drawing.exists() else "",
        "rows": json.loads(done.stdout),
    }
    ordered = {each: known[each] for each in STUDIES if each in known}
    rows.write_text(json.dumps(ordered, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(name, f"{len(known[name]['rows'])} rows")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studies", nargs="*", choices=[[], *STUDIES], help="which; all of them by default")
    for name in parser.parse_args().studies or STUDIES:
        keep(name)


if __name__ == "__main__":
    main()
