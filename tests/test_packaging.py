"""The wheel: what it holds, and that the ship models are importable from it."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def missing_backend() -> str:
    """Say which build backend is missing, or nothing."""
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["build-system"]["requires"][0]
    name, _, least = wanted.partition(">=")
    try:
        version = importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return f"the build backend {wanted} is not installed"
    old = [int(n) for n in version.split(".")[:3]] < [int(n) for n in least.split(".")]
    return f"the build backend {wanted} is not installed, only {version}" if old else ""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Build a wheel from a copy of the sources, so that the checkout stays as it is."""
    if reason := missing_backend():
        pytest.skip(reason)
    source, out = tmp_path_factory.mktemp("source") / "shipid", tmp_path_factory.mktemp("wheel")
    kept = ("shipid", "models", "pyproject.toml", "README.md", "LICENSE")
    source.mkdir()
    for name in kept:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy(ROOT / name, source / name)
    if importlib.util.find_spec("build"):
        command = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(out)]
    else:
        command = ["-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(out), "."]
    done = subprocess.run([sys.executable, *command], cwd=source, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = out.glob("shipid-*.whl")
    return built


def files_of(folder: str, *suffixes: str) -> set[str]:
    found = {p for p in (ROOT / folder).rglob("*") if p.suffix in suffixes and "__pycache__" not in p.parts}
    return {p.relative_to(ROOT).as_posix() for p in found}


def test_contents(wheel):
    inside = set(zipfile.ZipFile(wheel).namelist())
    code = files_of("shipid", ".py", ".html", ".css", ".js", ".svg", ".csv", ".toml", ".typed")
    assert {"shipid/py.typed", "shipid/cli/__init__.py"} <= code
    assert any(name.startswith("shipid/report/") and name.endswith(".html") for name in code)
    declarations = {f"shipid/{name}" for name in files_of("models", ".py", ".toml")}
    assert {"shipid/models/norrbin.py", "shipid/models/ships/zeefakkel.toml"} <= declarations
    assert code | declarations <= inside
    beside = {name for name in inside - code - declarations if ".dist-info/" not in name}
    assert beside == set()


def test_metadata(wheel):
    archive = zipfile.ZipFile(wheel)
    (entries,) = (n for n in archive.namelist() if n.endswith(".dist-info/entry_points.txt"))
    assert "shipid = shipid.cli:entry" in archive.read(entries).decode()
    if (ROOT / "LICENSE").exists():
        assert any(n.endswith("LICENSE") for n in archive.namelist())


def test_unpacked_wheel_works(wheel, tmp_path):
    """From another folder, with the wheel first on the path."""
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    code = (
        "import shipid, shipid.models, sys\n"
        "from shipid.models import Norrbin\n"
        "from shipid.cli import run\n"
        "assert shipid.__file__.startswith(sys.argv[1]), shipid.__file__\n"
        "assert all(p.startswith(sys.argv[1]) for p in shipid.models.__path__), shipid.models.__path__\n"
        "assert Norrbin.__module__ == 'shipid.models.norrbin'\n"
        "sys.exit(run(['simulate', 'norrbin', '--ship', 'zeefakkel', '--manoeuvre', 'turn:20', '-o', 'turn.csv']))"
    )
    site = str(tmp_path / "site")
    environment = {**os.environ, "PYTHONPATH": site}
    command = [sys.executable, "-c", code, site]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "turn.csv").read_text().startswith("# Simulated, not measured")
