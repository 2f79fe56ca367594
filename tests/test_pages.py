"""The pages of the site and what they speak of: sections of reports, studies, verdicts on the claims of papers, links."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / ".docs"
VERDICTS = json.loads((DOCS / "papers" / "verdicts.json").read_text(encoding="utf-8"))
#: What a summary may say of a claim, by the verdicts of its rows.
HOLDS, READING, FAILS = "holds", "holds under a reading", "does not hold"


def text_of(folder: str) -> str:
    return "\n".join(p.read_text(encoding="utf-8") for p in sorted((DOCS / folder).glob("*.md")))


def test_every_section_of_a_report_is_explained():
    explained = set(re.findall(r"\*\*(.+?)\*\*", text_of("reports")))
    code = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / "shipid" / "report" / "views").rglob("*.py"))
    titles = {t.partition(" {")[0] for t in re.findall(r'\bSection\(\s*f?"([^"]+)"', code)}
    assert len(titles) > 25
    assert titles - explained == set()


def test_every_study_is_listed():
    listed = (DOCS / "studies.md").read_text(encoding="utf-8")
    names = {p.stem for p in (ROOT / "studies").glob("*.py") if not p.stem.startswith("_")}
    assert {n for n in names if f"{n}.py" not in listed} == set()
    assert {n for n in re.findall(r"(\w+)\.py", listed) if n not in names} == set()


def test_every_study_of_a_paper_is_shown():
    shown = set(re.findall(r"^```\{verdicts\} (\w+)", text_of("papers"), flags=re.MULTILINE))
    assert shown == set(VERDICTS)
    for name, study in VERDICTS.items():
        assert (ROOT / "studies" / f"{name}.py").is_file() and study["rows"]
        assert not study["figure"] or (DOCS / "papers" / study["figure"]).stat().st_size < 80_000


def found(claim: str) -> set[str]:
    """The verdicts of the rows that name a claim at their beginning."""
    begins = re.compile(r"(?:[A-DP]\d+(?:, )?)+")
    rows = [r for study in VERDICTS.values() for r in study["rows"]]
    named = [(r, begins.match(r["claim"])) for r in rows]
    return {r["verdict"] for r, match in named if match and claim in re.findall(r"[A-DP]\d+", match[0])}


SUMMARY = re.findall(r"^\| ([A-DP]\d+) \| .+? \| (.+?) \|$", text_of("papers"), flags=re.MULTILINE)


def test_every_claim_has_its_line():
    counts = {"P": 20, "A": 5, "B": 5, "C": 4, "D": 3}
    assert [c for c, _ in SUMMARY if c[0] == "P"] == [f"P{k}" for k in range(1, 21)]
    assert sorted(c for c, _ in SUMMARY) == sorted(f"{letter}{k + 1}" for letter, n in counts.items() for k in range(n))


@pytest.mark.parametrize(("claim", "says"), SUMMARY)
def test_a_summary_says_what_the_rows_say(claim, says):
    verdicts = found(claim)
    assert verdicts, "no study prints a row of it"
    if FAILS in verdicts:
        assert says.startswith("in part")
    elif says.startswith(READING):
        assert READING in verdicts
    else:
        assert says.startswith(HOLDS)
        assert HOLDS in verdicts


def test_pictures_are_small():
    pictures = list((DOCS / "pictures").iterdir())
    assert {"identification", "bridge"} <= {p.stem for p in pictures}
    assert all(p.stat().st_size < 80_000 for p in pictures)


def extension(name: str):
    """An extension of the build of the site, from its file."""
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    spec = importlib.util.spec_from_file_location(f"site_{name}", DOCS / "extensions" / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_what_a_keyboard_reaches():
    page = extension("accessible").mended('<p class="caption" role="heading">Learn</p><pre>code</pre>')
    assert page == '<p class="caption" role="heading" aria-level="2">Learn</p><pre tabindex="0">code</pre>'


def test_links_that_lead_nowhere_are_found(tmp_path):
    faults = extension("links").faults
    (tmp_path / "sub").mkdir()
    good = '<a href="sub/b.html#here">b</a><a href="https://example.org/x">far</a><link rel="canonical" href="https://example.org">'
    (tmp_path / "a.html").write_text(good + '<img src="p.png">', encoding="utf-8")
    (tmp_path / "p.png").write_bytes(b"")
    (tmp_path / "sub" / "b.html").write_text(
        '<h1 id="here">b</h1><a href="../a.html">a</a><a href="#here">up</a>', encoding="utf-8"
    )
    assert faults(tmp_path) == []
    (tmp_path / "a.html").write_text(
        '<a href="sub/b.html#gone">b</a><a href="c.html">c</a><script src="https://example.org/s.js"></script>',
        encoding="utf-8",
    )
    (tmp_path / "s.css").write_text("@import url('//example.org/font.css');", encoding="utf-8")
    assert faults(tmp_path) == [
        "a.html fetches https://example.org/s.js from another host",
        "a.html leads to sub/b.html#gone, and that page has no such place",
        "a.html leads to c.html, which is not there",
        "s.css fetches //example.org/font.css from another host",
    ]


@pytest.mark.parametrize("page", ["README.md", *(p.relative_to(ROOT).as_posix() for p in DOCS.rglob("*.md"))])
def test_links_lead_to_files(page):
    """Also where the pages are read as they are, without a build of the site."""
    text = (ROOT / page).read_text(encoding="utf-8")
    targets = {t.partition("#")[0] for t in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in t}
    assert {t for t in targets if t and not ((ROOT / page).parent / t).exists()} == set()
