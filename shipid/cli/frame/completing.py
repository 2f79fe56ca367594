"""What a shell offers while a command is typed: models, ships, manoeuvres, files. Nothing numeric is imported for it."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import click
from click.shell_completion import CompletionItem

#: A model of a model file: a name and what it joins.
_JOINED = re.compile(r'^\w+ = (?:shipid\.)?join\(\s*"([^"]+)"', re.MULTILINE)
#: As in `shipid.trials.manoeuvres.manoeuvre.KINDS`, which is numeric to import.
MANOEUVRES = {
    "zigzag:": ("zigzag:10/10", "zigzag:20/20"),
    "turn:": ("turn:35",),
    "spiral:": ("spiral:25",),
    "reversed-spiral:": ("reversed-spiral:0.6",),
    "course:": ("course:60/15",),
    "telegraph:": ("telegraph:10",),
}


def complete_file(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Let the shell offer its files.

    Parameters
    ----------
    _context, _parameter : click.Context, click.Parameter
        As click calls it.
    incomplete : str
        What is typed so far.

    Returns
    -------
    list of CompletionItem
    """
    return [CompletionItem(incomplete, type="file")]


def complete_model(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Offer the models by name, and files.

    Parameters
    ----------
    _context, _parameter : click.Context, click.Parameter
        As click calls it.
    incomplete : str
        What is typed so far; of a list separated by commas its last name.

    Returns
    -------
    list of CompletionItem
    """
    return _named(model_names(), incomplete)


def complete_ship(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Offer the ships by name, and files.

    Parameters
    ----------
    _context, _parameter : click.Context, click.Parameter
        As click calls it.
    incomplete : str
        What is typed so far.

    Returns
    -------
    list of CompletionItem
    """
    return _named(ship_names(), incomplete)


def complete_model_or_ship(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Offer models and ships by name, and files.

    Parameters
    ----------
    _context, _parameter : click.Context, click.Parameter
        As click calls it.
    incomplete : str
        What is typed so far.

    Returns
    -------
    list of CompletionItem
    """
    return _named([*model_names(), *ship_names()], incomplete)


def complete_manoeuvre(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Offer manoeuvres: the kinds, and examples of a kind that is typed.

    Parameters
    ----------
    _context, _parameter : click.Context, click.Parameter
        As click calls it.
    incomplete : str
        What is typed so far.

    Returns
    -------
    list of CompletionItem
    """
    return [CompletionItem(e) for examples in MANOEUVRES.values() for e in examples if e.startswith(incomplete)]


def model_names() -> list[str]:
    """Return the names of the installed models, from the text of their files."""
    texts = (path.read_text(encoding="utf-8") for path in sorted(_folder().glob("*.py")))
    return sorted({name for text in texts for name in _JOINED.findall(text)})


def ship_names() -> list[str]:
    """Return the names of the installed ships."""
    return sorted(path.stem for path in (_folder() / "ships").glob("*.toml"))


def _folder() -> Path:
    spec = importlib.util.find_spec("shipid.models")
    assert spec is not None and spec.submodule_search_locations
    return Path(next(iter(spec.submodule_search_locations)))


def _named(names: list[str], incomplete: str) -> list[CompletionItem]:
    """The names that begin so; where none does, it is the path of a file."""
    before, mark, last = incomplete.rpartition(",")
    found = [CompletionItem(f"{before}{mark}{n}") for n in names if n.startswith(last)]
    return found or [CompletionItem(incomplete, type="file")]
