"""The examples of the README and of the pages: commands exist as written, and those of the README's tour do what is said."""

from __future__ import annotations

import io
import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import click
import pytest

from shipid.cli import main, run

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / ".docs").rglob("*.md") if "generated" not in p.parts)]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: Commands of the README's tour that are run; the others take long, and are run by the tests of their rooms.
RUN = ("models", "show", "simulate", "check", "measure", "identify", "report")


def blocks(path: Path, kind: str) -> list[str]:
    return [text for found, text in BLOCK.findall(path.read_text(encoding="utf-8")) if found == kind]


def commands(path: Path) -> list[list[str]]:
    """Every call of shipid in the shell blocks of a page, with lines that go on joined, and without comments."""
    found = []
    for text in [*blocks(path, "sh"), *(re.sub(r"^\$ ", "", t, flags=re.MULTILINE) for t in blocks(path, "console"))]:
        for line in text.replace("\\\n", " ").splitlines():
            calls = [part for part in re.split(r"&&|\|(?!\|)", line) if part.strip().startswith("shipid ")]
            found += [shlex.split(part, comments=True)[1:] for part in calls]
    return found


CALLS = [(path, call) for path in PAGES for call in commands(path)]


def test_there_are_examples():
    assert len(CALLS) > 60
    assert {call[0] for _, call in CALLS} >= set(main.list_commands(click.Context(main, **main.context_settings))) - {
        "completion"
    }


@pytest.mark.parametrize(("path", "call"), CALLS, ids=[f"{p.relative_to(ROOT)} {' '.join(c)}"[:90] for p, c in CALLS])
def test_a_command_is_one(path, call, monkeypatch):
    """Command, options, choices and quantities are known; whether a file is there is not asked."""
    monkeypatch.setattr(click.Path, "convert", lambda self, value, param, context: value)
    context = click.Context(main, info_name="shipid", **main.context_settings)
    command = main.get_command(context, call[0])
    assert command is not None, f"{path.name}: there is no command {call[0]}"
    command.make_context(call[0], call[1:], parent=context)


COMMANDS = {n: main.get_command(click.Context(main), n) for n in main.list_commands(click.Context(main))}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_a_command_has_examples_that_are_commands(name, monkeypatch):
    """The words after several blanks say what it does, and a pipe is the shell's."""
    monkeypatch.setattr(click.Path, "convert", lambda self, value, param, context: value)
    lines = [line.strip() for line in (COMMANDS[name].help or "").splitlines()]
    found = [shlex.split(re.split(r" {3,}| \|", line)[0])[1:] for line in lines if line.startswith("shipid ")]
    assert name in {call[0] for call in found}
    for call in found:
        COMMANDS[call[0]].make_context(call[0], call[1:], parent=click.Context(main, info_name="shipid"))


@pytest.fixture
def clone(tmp_path, monkeypatch) -> Path:
    """A folder with the trials of a clone, in which a reader works."""
    shutil.copytree(ROOT / "studies" / "trials", tmp_path / "studies" / "trials")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_readme_does_what_it_says(clone, capsys):
    """Its tour runs and writes the files that it names; so does its Python. The first command is run by ``.ci/run``."""
    for call in commands(ROOT / "README.md"):
        if call[0] in RUN and "--open" not in call and "n3=0.4" not in call:
            assert run(call) == 0, capsys.readouterr().err
    for name in ("trial.csv", "zeefakkel/ship.toml", "sheet/report.html"):
        assert (clone / name).is_file(), name
    (python,) = blocks(ROOT / "README.md", "python")
    exec(compile(python, "README.md", "exec"), {})
    assert (clone / "report.html").is_file()


def test_the_tour_can_be_walked(clone, capsys):
    """Each command takes what those before it wrote; those that take long are run by the tests of their rooms."""
    walked = ("simulate", "report", "identify", "filter")
    for call in commands(ROOT / ".docs" / "tour.md"):
        if call[0] in walked and "--autopilot" not in call:  # the jobs of `studies/` sail under one that they tune
            assert run(call) == 0, (call, capsys.readouterr().err)
    for name in ("sheet/report.html", "found/ship.toml", "turn.csv", "filtered/estimates.csv"):
        assert (clone / name).is_file(), name


#: Guides whose shell blocks are run, and what of them is not: it needs a measured log, a network, or is run by the tests of its room.
WALKED = {"logs.md": "@", "filters.md": "imm|--out", "programs.md": "tune|completion", "prediction.md": "route|--out"}


@pytest.mark.parametrize("page", WALKED)
def test_the_shell_blocks_of_a_guide(page, clone, monkeypatch, capsys):
    """As they are printed, with a log of the reader: what stands before a pipe is run too, and does not wait for more."""
    shutil.copy("studies/trials/container-20-20.csv", "log.csv")
    lines = "\n".join(blocks(ROOT / ".docs" / "guide" / page, "sh")).replace("\\\n", " ").splitlines()
    walked = [line for line in lines if line.strip() and not re.search(WALKED[page], line)]
    assert walked
    for line in walked:
        before, _, call = line.rpartition(" | ")
        sent = subprocess.run(
            before.replace(" -f ", " "), shell=True, capture_output=True, text=True, check=True
        ).stdout
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(sent.encode())))
        code = run(shlex.split(call, comments=True)[1:])
        told = capsys.readouterr().err
        # A log of one manoeuvre has no third one, and the command says which it has.
        assert code == (2 if "--manoeuvre 3" in line else 0), (line, told)


@pytest.mark.parametrize("path", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_the_python_of_a_page_is_python(path):
    for kind in ("python", "py"):
        for text in blocks(path, kind):
            compile(text, path.name, "exec")
    for text in blocks(path, "toml"):
        tomllib.loads(text)


def test_a_bare_number_is_refused_as_the_readme_prints_it(clone, capsys):
    assert run(["simulate", "norrbin", "--ship", "zeefakkel", "--manoeuvre", "turn:20", "-o", "trial.csv"]) == 0
    (text,) = blocks(ROOT / "README.md", "console")
    line, _, printed = text.partition("\n")
    capsys.readouterr()
    assert run(shlex.split(line)[2:]) == 2
    assert capsys.readouterr().err.split() == printed.split()


@pytest.mark.parametrize(
    ("page", "made"),
    [
        ("filters.md", {"run", "smoothed", "estimate", "tracker"}),
        ("notebook.md", {"table", "figure"}),
        ("campaigns.md", {"darts", "alpha"}),
    ],
)
def test_the_python_of_a_guide(page, made, clone):
    names: dict[str, object] = {}
    for text in blocks(ROOT / ".docs" / "guide" / page, "python"):
        exec(compile(text, page, "exec"), names)
    assert made <= names.keys()
