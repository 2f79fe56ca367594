"""The pages of the format file and of the ship file: their tables hold the keys that the readers accept, and no other."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from shipid.declaration.tables import Table
from shipid.encounter.plots.plot_format import read_plot_format
from shipid.foundation.errors import ParameterSetError
from shipid.parameters.draft import KNOWN_PARTICULARS
from shipid.parameters.parameter_file import HEAD_KEYS, VALUE_KEYS, read_parameter_set
from shipid.trials.logs.nmea.settings import chosen_format

PAGES = Path(__file__).resolve().parents[1] / ".docs" / "files"
EXAMPLE = re.compile(r"^```toml\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TOP = "Top of the file"
NAMED = re.compile(r"^(columns|windows|sensors|trials)\..+$")


def described(page: str) -> dict[str, list[str]]:
    """The keys that each section of a page lists in its table, by the name of the section."""
    found = {}
    for section in re.split(r"^##+ ", (PAGES / page).read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        title = re.sub(r"[`\[\]]", "", section.partition("\n")[0])
        keys = re.findall(r"^\| `(\w+)` \|", section, flags=re.MULTILINE)
        if keys:
            assert len(keys) == len(set(keys)), title
            found[title] = keys
    return found


@pytest.fixture
def accepted(monkeypatch) -> dict[str, set[str]]:
    """What `Table.check_keys` was told to accept, by the name of the table."""
    told: dict[str, set[str]] = {}
    check = Table.check_keys

    def noted(table, known, required=()):
        name = NAMED.sub(r"\1.NAME", table.name) or TOP
        told[name] = told.get(name, set()) | set(known)
        return check(table, known, required)

    monkeypatch.setattr(Table, "check_keys", noted)
    return told


def read_examples(page: str, read: Callable[[Path], object], folder: Path) -> None:
    for k, text in enumerate(EXAMPLE.findall((PAGES / page).read_text(encoding="utf-8"))):
        path = folder / f"example{k}.toml"
        path.write_text(text, encoding="utf-8")
        read(path)


def test_the_format_file(accepted, tmp_path):
    read_examples("format.md", chosen_format, tmp_path)
    pages = described("format.md")
    assert accepted["nmea.order"] == accepted.pop("nmea.rudder"), "the page says that both have the same keys"
    accepted["nmea.rudder"] = accepted.pop("nmea.order")
    assert accepted.pop(TOP) == {*pages.pop(TOP), "nmea"}
    assert accepted.pop("trials.NAME") == accepted["trial"], "the page says that both have the same keys"
    assert accepted == {name: set(keys) for name, keys in pages.items()}


def test_the_format_file_of_plots(accepted, tmp_path):
    read_examples("plots.md", read_plot_format, tmp_path)
    assert accepted == {name: set(keys) for name, keys in described("plots.md").items()}


def test_the_ship_file(tmp_path):
    """Its example is read whole, and what an identification leaves is refused with the list of what is known."""
    read_examples("ship.md", read_parameter_set, tmp_path)
    pages = described("ship.md")
    assert pages.pop(TOP) == list(HEAD_KEYS)
    assert pages.pop("particulars") == [known.name for known in KNOWN_PARTICULARS]
    assert set(pages.pop("MODEL: each value")) == set(VALUE_KEYS)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[identified.nomoto]\nnot_known = 1\n", encoding="utf-8")
    with pytest.raises(ParameterSetError, match="Known: ") as refused:
        read_parameter_set(wrong)
    known = str(refused.value).partition("Known: ")[2].rstrip(".").split(", ")
    assert set(pages.pop("identified.MODEL")) == set(known)
    assert not pages
