"""How commands hand over their results: one set of options, files whole or not at all, JSON without NaN."""

from __future__ import annotations

import json
import sys
import types
from pathlib import Path

import click
import pytest

from shipid.cli import main
from shipid.cli.delivery import Delivery, delivered, json_text
from shipid.cli.registry import COMMANDS
from shipid.foundation.exit_codes import ExitCode, table

#: Options that mean the same in every command that has them.
SHARED = (
    "--model",
    "--format",
    "--window",
    "--validate",
    "--starts",
    "--sampling",
    "--set",
    "--json",
    "--open",
    "--overwrite",
)


def options_of(name: str) -> dict[str, str | None]:
    context = click.Context(main, info_name="shipid")
    command = main.get_command(context, name)
    assert command is not None
    return {o: p.help for p in command.params if isinstance(p, click.Option) for o in p.opts}


def test_an_option_says_the_same_in_every_command():
    found = {name: options_of(name) for name in COMMANDS}
    for option in SHARED:
        words = {f[option] for f in found.values() if option in f}
        assert len(words) == 1, (option, words)
    assert sum("--json" in f for f in found.values()) == len(COMMANDS) - 1  # a simulated trial is a table
    assert {n for n, f in found.items() if "--out" in f} == {"identify", "filter", "tune"}


def test_one_table_of_exit_codes():
    assert table() == "0 done, 2 usage, 3 bad data, 4 no convergence, 70 a fault of shipid itself, 130 interrupted"
    readme = (Path(__file__).resolve().parents[2] / "README.md").read_text()
    assert f"Exit codes: {table()}." in readme
    assert [int(c) for c in ExitCode] == [0, 2, 3, 4, 70, 130]


class Answer:
    """A result with two numbers."""

    def __init__(self, value: float = 1.5) -> None:
        self.value = value

    def __repr__(self) -> str:
        return f"the answer is {self.value}"

    def to_dict(self) -> dict[str, float]:
        return {"answer": self.value}


@pytest.fixture
def own_command(monkeypatch, call):
    """A new command: a module of its own, and one line in the registry."""
    module = types.ModuleType("own_command")

    @click.command()
    @click.option("--short", is_flag=True)
    @click.option("--value", default=1.5)
    @delivered("result.json", "notes.txt", "report.html", instead={"short": ("result.json",)})
    def own(short: bool, value: float, delivery: Delivery) -> None:
        """Answer."""
        writers = {
            "notes.txt": lambda path: path.write_text("notes"),
            "report.html": lambda path: path.write_text("page"),
        }
        delivery.hand_over(Answer(value), {} if short else writers)

    module.own = own  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "own_command", module)
    monkeypatch.setitem(COMMANDS, "own", ("own_command:own", "Answer."))
    return lambda *arguments: call("own", *arguments)


def test_a_new_command_is_a_file_and_a_line(own_command, call):
    assert "\n  own " in call("--help").out
    answer = own_command()
    assert (answer.code, answer.out, answer.err) == (0, "the answer is 1.5\n", "")
    assert json.loads(own_command("--json").out) == {"answer": 1.5}


def test_files_are_written_under_their_names(own_command, tmp_path):
    out = tmp_path / "out"
    answer = own_command("--out", out)
    assert answer.out.splitlines()[-1] == f"written: {out / 'result.json'}, {out / 'notes.txt'}, {out / 'report.html'}"
    assert {p.name for p in out.iterdir()} == {"result.json", "notes.txt", "report.html"}
    assert json.loads((out / "result.json").read_text()) == {"answer": 1.5}
    assert own_command("--out", out).code == ExitCode.USAGE
    assert own_command("--out", out, "--overwrite", "--json").code == 0


def test_only_files_that_are_going_to_be_written_are_in_the_way(own_command, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert own_command("--out", tmp_path).code == ExitCode.USAGE
    assert own_command("--out", tmp_path, "--short").code == 0
    assert (tmp_path / "notes.txt").read_text() == "mine" and (tmp_path / "result.json").exists()


def test_nothing_that_json_cannot_hold_is_written(own_command, tmp_path):
    for value in ("nan", "inf"):
        answer = own_command("--value", value, "--json", "--out", tmp_path)
        assert answer.code == ExitCode.FAULT and answer.out == ""
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ValueError, match="JSON"):
        json_text([float("nan")])


def test_opening_needs_a_folder(own_command, monkeypatch, tmp_path):
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    assert own_command("--open").code == ExitCode.USAGE
    assert own_command("--open", "--out", tmp_path).code == 0
    assert opened == [(tmp_path / "report.html").as_uri()]
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    assert "no browser" in own_command("--open", "--out", tmp_path, "--overwrite").said
