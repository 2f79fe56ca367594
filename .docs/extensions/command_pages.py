"""The page of the commands, written when the site is built from what click knows of each: usage, help and options."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import click
from markup import indented, plain, title

from shipid.cli import main
from shipid.foundation.exit_codes import table


def _help(text: str) -> str:
    """Turn click's help into marked-up text; a paragraph behind click's mark for it keeps its lines."""
    paragraphs = []
    for paragraph in inspect.cleandoc(text).split("\n\n"):
        kept = paragraph.startswith("\b")
        paragraphs.append("::\n\n" + indented(paragraph.lstrip("\b\n")) if kept else plain(paragraph))
    return "\n\n".join(paragraphs)


def _option(option: click.Option, context: click.Context) -> str:
    names, text = option.get_help_record(context) or ("", "")
    words, _, extra = text.rpartition("  [")
    about = plain(words if words else text)
    noted = f" [{plain(extra)}" if words else ""
    return f".. option:: {names}\n\n{indented(about + noted)}\n"


def _command(name: str, context: click.Context) -> str:
    command = main.get_command(context, name)
    assert command is not None
    own = click.Context(command, parent=context, info_name=name)
    usage = " ".join([own.command_path, *command.collect_usage_pieces(own)])
    options = [p for p in command.params if isinstance(p, click.Option) and not p.hidden]
    parts = [title(own.command_path, "-"), _help(command.help or ""), f".. code-block:: text\n\n   {usage}\n"]
    parts.append(f".. program:: {own.command_path}\n")
    return "\n\n".join([*parts, *(_option(o, own) for o in options)])


def _write_page(app: Any, config: Any) -> None:
    context = click.Context(main, info_name="shipid", **main.context_settings)
    about = (
        "Every command prints its options with ``--help``. Results go to standard output, with ``--json`` for programs; "
        f"progress and messages go to standard error. Exit codes: {table()}."
    )
    commands = [_command(name, context) for name in main.list_commands(context)]
    folder = Path(app.srcdir) / "generated"
    folder.mkdir(exist_ok=True)
    (folder / "commands.rst").write_text("\n\n".join([title("Commands"), about, *commands]), encoding="utf-8")


def setup(app: Any) -> dict[str, bool]:
    """Write the page before Sphinx looks for it."""
    app.connect("config-inited", _write_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
