"""How commands hand over their results: one set of options, files whole or not at all, JSON without NaN."""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import sys
import types
from pathlib import Path

import click
import pytest

import shipid
from shipid.cli import main
from shipid.cli.frame.delivery import Delivery, delivered
from shipid.cli.frame.envelope import json_text
from shipid.cli.registry import COMMANDS
from shipid.foundation.errors import ShipidError
from shipid.foundation.exit_codes import ExitCode, markdown

#: What stands around every result.
ENVELOPE = {
    "schema_version": 2,
    "command": "own",
    "provenance": {"shipid": shipid.__version__, "inputs": []},
    "warnings": [],
}
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
    "--pdf",
    "--overwrite",
)


def options_of(name: str) -> dict[str, str | None]:
    context = click.Context(main, info_name="shipid", **main.context_settings)
    command = main.get_command(context, name)
    assert command is not None
    return {o: p.help for p in command.params if isinstance(p, click.Option) for o in p.opts}


def test_an_option_says_the_same_in_every_command():
    found = {name: options_of(name) for name in COMMANDS}
    for option in SHARED:
        words = {f[option] for f in found.values() if option in f}
        assert len(words) == 1, (option, words)
    assert (
        sum("--json" in f for f in found.values()) == len(COMMANDS) - 3
    )  # a simulated trial is a table, the bridge a live page, and a completion a script
    assert {n for n, f in found.items() if "--out" in f} == {
        "check",
        "identify",
        "compare",
        "plan",
        "criteria",
        "filter",
        "tune",
        "predict",
        "campaign",
        "report",
        "track",
    }


def test_one_table_of_exit_codes():
    assert [(int(c), c.meaning) for c in ExitCode] == [
        (0, "done"),
        (2, "usage"),
        (3, "bad data"),
        (4, "no convergence"),
        (5, "doubtful"),
        (70, "a fault of shipid itself"),
        (130, "interrupted"),
        (143, "terminated"),
    ]
    readme = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
    assert readme.count(markdown()) == 1
    assert readme.count("exit code |") == 1, "one table only"


def test_every_error_has_a_code_of_the_table():
    """Whatever class of error a room declares, the command ends with a code that the README explains."""
    for name in pkgutil.walk_packages(shipid.__path__, "shipid."):
        if name.name.rpartition(".")[2] == "errors":
            importlib.import_module(name.name)
    kinds, todo = set(), [ShipidError]
    while todo:
        kinds.add(kind := todo.pop())
        todo += kind.__subclasses__()
    assert len(kinds) > 20
    assert {k.exit_code for k in kinds} <= {ExitCode.USAGE, ExitCode.BAD_DATA, ExitCode.NO_CONVERGENCE}


class Answer:
    """A result with two numbers."""

    def __init__(self, value: float = 1.5) -> None:
        self.value = value

    def text(self) -> str:
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
    told = json.loads(own_command("--json").out)
    assert told == {**ENVELOPE, "answer": 1.5} and list(told)[:4] == list(ENVELOPE)


def test_files_are_written_under_their_names(own_command, tmp_path):
    out = tmp_path / "out"
    answer = own_command("--out", out)
    assert answer.out.splitlines()[-1] == f"written: {out / 'result.json'}, {out / 'notes.txt'}, {out / 'report.html'}"
    assert {p.name for p in out.iterdir()} == {"result.json", "notes.txt", "report.html"}
    assert json.loads((out / "result.json").read_text()) == {**ENVELOPE, "answer": 1.5}
    assert own_command("--out", out).code == ExitCode.USAGE
    assert own_command("--out", out, "--overwrite", "--json").code == 0


def test_a_folder_is_not_called_as_a_file(own_command, tmp_path):
    """Someone who types ``--out report.html`` expects a file of that name."""
    answer = own_command("--out", tmp_path / "trial.html")
    assert answer.code == ExitCode.USAGE and f"--out {tmp_path / 'trial'}:" in answer.said
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "trial.html").mkdir()
    assert own_command("--out", tmp_path / "trial.html").code == 0
    assert own_command("--out", tmp_path / "v1.2").code == 0


def test_only_files_that_are_going_to_be_written_are_in_the_way(own_command, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert own_command("--out", tmp_path).code == ExitCode.USAGE
    assert own_command("--out", tmp_path, "--short").code == 0
    assert (tmp_path / "notes.txt").read_text() == "mine" and (tmp_path / "result.json").exists()


def test_nothing_that_json_cannot_hold_is_written(own_command, tmp_path):
    for value in ("nan", "inf"):
        answer = own_command("--value", value, "--json", "--out", tmp_path)
        assert answer.code == ExitCode.FAULT and set(json.loads(answer.out)) >= {"command", "error"}
        assert "NaN" not in answer.out and "Infinity" not in answer.out
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


@pytest.fixture
def failing_command(own_command, monkeypatch, tmp_path):
    """The command, whose files cannot be written because of an error."""

    def run(error: Exception, *arguments):
        def fail(*_, **__):
            raise error

        monkeypatch.setattr("shipid.foundation.replacing.os.replace", fail)
        answer = own_command("--out", tmp_path / "out", *arguments)
        assert list((tmp_path / "out").iterdir()) == []
        return answer

    return run


def test_a_result_that_cannot_be_written_is_printed(failing_command):
    answer = failing_command(OSError(28, "No space left on device"))
    assert (answer.code, answer.out) == (ExitCode.BAD_DATA, "the answer is 1.5\n")
    assert answer.said == "shipid: the output: No space left on device."
    answer = failing_command(OSError(30, "Read-only file system"), "--json")
    assert (answer.code, json.loads(answer.out)) == (ExitCode.BAD_DATA, {**ENVELOPE, "answer": 1.5})
    answer = failing_command(RuntimeError("a report that fails"))
    assert (answer.code, answer.out) == (ExitCode.FAULT, "the answer is 1.5\n")


def unchanged(place):
    """What a change of a file, or of a link, would show; when it was read is no change."""
    now = place.lstat()
    return now.st_ino, now.st_mode, now.st_size, now.st_mtime_ns


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with a name")
@pytest.mark.parametrize("kind", ["pipe", "link to a device", "link to a file", "link that leads nowhere", "folder"])
def test_only_files_are_replaced(own_command, tmp_path, kind):
    """Looked at before the work is done, and nothing is touched."""
    place = tmp_path / "notes.txt"
    if kind == "pipe":
        os.mkfifo(place)
    elif kind == "folder":
        place.mkdir()
    else:
        place.symlink_to({"link to a device": "/dev/null", "link to a file": __file__}.get(kind, tmp_path / "none"))
    before = unchanged(place)
    for more in ((), ("--overwrite",)):
        answer = own_command("--out", tmp_path, *more)
        assert (answer.code, answer.out) == (ExitCode.BAD_DATA, "")
        assert f"notes.txt' is a {kind.split()[0]}" in answer.said
    assert unchanged(place) == before and [p.name for p in tmp_path.iterdir()] == ["notes.txt"]


def test_a_folder_that_is_a_link_to_nowhere_is_named(own_command, tmp_path):
    (tmp_path / "out").symlink_to(tmp_path / "none")
    answer = own_command("--out", tmp_path / "out")
    assert (answer.code, answer.out) == (ExitCode.USAGE, "") and "leads nowhere" in answer.said


def test_a_file_that_comes_while_the_work_is_done_is_not_lost(own_command, monkeypatch, tmp_path):
    """Another run writes to the same folder, and neither was allowed to overwrite."""
    import shipid.foundation.replacing as replacing

    put = replacing.put_in_place

    def late(files, overwrite):
        (tmp_path / "notes.txt").write_text("of the other run")
        put(files, overwrite)

    monkeypatch.setattr(replacing, "put_in_place", late)
    answer = own_command("--out", tmp_path)
    assert (answer.code, answer.out) == (ExitCode.BAD_DATA, "the answer is 1.5\n")
    assert "notes.txt' exists already" in answer.said
    assert [p.name for p in tmp_path.iterdir()] == ["notes.txt"]
    assert (tmp_path / "notes.txt").read_text() == "of the other run"


def test_numbers_of_json_have_no_noise_and_no_negative_zero():
    noisy = {"a": [14.999999999999998, -0.0, 1e-300], "b": (1 / 3,), "n": 7, "yes": True, "none": None}
    told = json_text(noisy, indent=None)
    assert told == '{"a": [15.0, 0.0, 1e-300], "b": [0.333333333333], "n": 7, "yes": true, "none": null}'
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text({"a": float("nan")})


def test_json_holds_nothing_that_a_decay_leaves_of_a_zero():
    assert json_text({"a": [4.2e-318, -0.0, -1e-320, 1e-9]}, indent=None) == '{"a": [0.0, 0.0, 0.0, 1e-09]}'


def test_tables_are_written_in_one_place():
    sources = Path(shipid.__file__).parent.rglob("*.py")
    assert [str(p.name) for p in sources if ".to_csv(" in p.read_text(encoding="utf-8")] == ["result.py"]
