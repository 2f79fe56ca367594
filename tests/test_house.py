"""Rules of the house: floors, the toolbox that knows no ship, short files, documented names, a tidy top level."""

from __future__ import annotations

import importlib
import inspect
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import shipid
from shipid.cli.registry import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted([*(ROOT / "shipid").rglob("*.py"), *(ROOT / "models").rglob("*.py")])
TOP_LEVEL = {"pyproject.toml", "shipid", "models", "tests", "studies", "README.md"}
BESIDES = {"LICENSE", "CHANGELOG.md", "CITATION.cff"}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def relative(path: Path) -> str:
    return str(path.relative_to(ROOT))


def dotted(path: Path) -> str:
    """The name a source file is imported by."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = ("shipid", *parts) if parts[0] == "models" else parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_a_file_is_one_idea():
    lengths = {relative(path): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    assert len(lengths) > 300
    assert {name: length for name, length in lengths.items() if length > 400} == {}


@pytest.fixture(scope="module")
def things() -> list[tuple[str, object]]:
    found = public_things()
    assert len(found) > 1000
    return found


def public_things() -> list[tuple[str, object]]:
    """Every public function and class of shipid, where it is defined; the commands of click document themselves."""
    found = []
    for path in SOURCES:
        name = dotted(path)
        if name.startswith("shipid.models") or name == "shipid.__main__":
            continue
        module = importlib.import_module(name)
        for key, thing in vars(module).items():
            own = getattr(thing, "__module__", None) == name
            if own and not key.startswith("_") and (inspect.isfunction(thing) or inspect.isclass(thing)):
                found.append((f"{name}.{key}", thing))
    return found


def documented(doc: str, section: str) -> set[str]:
    """Names that a numpydoc section of a docstring describes."""
    match = re.search(rf"^{section}\n-+\n(.*?)(?=^\S[^\n]*\n-+\n|\Z)", inspect.cleandoc(doc), re.MULTILINE | re.DOTALL)
    if not match:
        return set()
    heads = [line.partition(":")[0] for line in match.group(1).splitlines() if line[:1].strip()]
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def arguments_of(function: object) -> set[str]:
    return {n for n in inspect.signature(function).parameters if n not in ("self", "cls")}  # type: ignore[arg-type]


def undocumented(function: object) -> set[str]:
    """Arguments that a docstring with a Parameters section leaves out, or all of them where there is none."""
    return arguments_of(function) - documented(inspect.getdoc(function) or "", "Parameters")


def without_words(name: str, thing: object) -> list[str]:
    """The thing and its members that say nothing of themselves."""
    doc = thing.__doc__ or ""
    # What a dataclass writes for itself is its signature, not a docstring.
    bare = [] if len(doc.split()) >= 3 and not doc.startswith(f"{thing.__name__}(") else [name]
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
            if not key.startswith("_") and inspect.isfunction(function) and function.__name__ == key:
                bare += [] if function.__doc__ else [f"{name}.{key}"]
    return bare


# One test for all of them: as many tests as names cost more than they look at.
def test_public_names_are_documented(things):
    assert [bare for name, thing in things for bare in without_words(name, thing)] == []


def test_a_list_of_parameters_is_complete(things):
    """Where a docstring lists parameters it lists all of them, and none that is not there."""
    wrong = []
    for name, thing in things:
        functions = [thing] if inspect.isfunction(thing) else []
        if inspect.isclass(thing):
            members = [getattr(m, "__func__", m) for k, m in vars(thing).items() if not k.startswith("_")]
            functions = [m for m in members if inspect.isfunction(m)]
        for function in functions:
            listed = documented(function.__doc__ or "", "Parameters")
            if listed and listed != arguments_of(function):
                wrong.append(f"{name}: {function.__name__}")
    assert wrong == []


#: Results are made by the toolbox; their attributes are documented, and nobody calls them.
CALLED = [n for n in shipid.__all__ if inspect.isfunction(getattr(shipid, n))]


def test_every_argument_of_the_top_is_documented():
    assert {name: lacking for name in CALLED if (lacking := undocumented(getattr(shipid, name)))} == {}


def test_the_top_is_what_it_says():
    assert len(shipid.__all__) == len(set(shipid.__all__))
    assert {"Component", "state", "given", "derived", "constant", "parameter", "join"} <= set(shipid.__all__)
    assert {"read_trial", "simulate", "measure", "identify", "write_report"} <= set(shipid.__all__)
    for name in shipid.__all__:
        assert getattr(shipid, name) is not None
    assert set(shipid.__all__) <= set(dir(shipid))
    with pytest.raises(AttributeError, match="idenfity"):
        shipid.idenfity  # noqa: B018


def test_importing_the_package_costs_nothing():
    code = "import sys, shipid; sys.exit(any(m in sys.modules for m in ('numpy', 'casadi', 'pandas', 'pint', 'click')))"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_the_ship_models_are_at_hand():
    """Whoever has only imported the package can list them, and it has not read them before."""
    code = "import sys, shipid; sys.exit('shipid.models' in sys.modules or 'DeKeizer' not in dir(shipid.models))"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_every_folder_is_packaged():
    folders = {dotted(path) for path in SOURCES if path.name == "__init__.py"}
    assert set(PROJECT["tool"]["setuptools"]["packages"]) == folders
    lost = {relative(p) for p in SOURCES if dotted(p.parent / "__init__.py") not in folders}
    assert lost == set()


def test_the_version_is_one():
    assert PROJECT["project"]["version"] == shipid.__version__


def test_tidy_top_level():
    """The six names, licence, changelog, citation and dot files; a checkout's own tracked files are asked for."""
    listed = (
        subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True) if shutil.which("git") else None
    )
    if listed is None or listed.returncode != 0 or not listed.stdout:
        pytest.skip("not a git checkout: what else lies here is not the project's")
    tracked = {line.partition("/")[0] for line in listed.stdout.splitlines()}
    assert {n for n in tracked if not n.startswith(".")} <= TOP_LEVEL | BESIDES
    assert {"pyproject.toml", "shipid", "models", "tests", "studies"} <= tracked


def test_the_name_of_a_command_leads_to_its_function():
    for command, (name, *_) in shipid._COMMANDS.items():  # noqa: SLF001
        assert command in COMMANDS
        with pytest.raises(AttributeError, match=f"'shipid {command}' is shipid.{name}"):
            shipid.__getattr__(command)
        home, _, last = name.rpartition(".")
        assert callable(getattr(importlib.import_module(f"shipid.{home}") if home else shipid, last))
    assert {c for c in COMMANDS if c not in (*shipid.__all__, *shipid._COMMANDS)} == {  # noqa: SLF001
        "models", "format", "bridge", "completion",
    }  # fmt: skip
    with pytest.raises(AttributeError, match=r"Did you mean shipid.identify\?"):
        shipid.__getattr__("identifi")
    assert "annotations" not in dir(shipid) and "identify" in dir(shipid)


#: Files that print numbers for a program to read, or that are typed into a file again; poles, and what only a programmer meets.
READ_BY_PROGRAMS = {
    "cli/frame/following.py", "parameters/correlation.py", "prediction/situations/own_ship_filter.py", "generation/linearisation.py",
    "generation/symbolic_evaluation.py", "declaration/joining/unit_check.py", "autopilot/design/placement.py",
    "autopilot/design/read_schedule.py", "foundation/result.py", "trials/measuring/results/measures.py",
}  # fmt: skip


def test_no_message_writes_an_ordinary_number_with_an_exponent():
    """Four digits of 12345 m are 1.234e+04 in an f-string: `shipid.foundation.numbers.brief` and `moment` write it out."""
    package = ROOT / "shipid"
    found = [
        f"{name}:{k}: {line.strip()}"
        for path in sorted(package.rglob("*.py"))
        if (name := path.relative_to(package).as_posix()) not in READ_BY_PROGRAMS
        for k, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        # What is to be typed, and a place on the earth, have their digits; a number that is only rounded is printed elsewhere.
        if re.search(r":\.[2-6]g\}", line)
        and not re.search(r"float\(f|Multiply|interval = |n × |scale = |_STATED_BY_USER", line)
    ]
    assert found == []
