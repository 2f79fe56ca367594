"""A newcomer's exercise: a ship model, a signal, a command and a section of a report; each touches at most two files."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

MODEL = '''
"""A first order with quadratic damping: what a newcomer writes on the first day."""

from shipid import Component, given, join, parameter, state
from shipid.models import PlanarMotion


class QuadraticDamping(Component):
    """Nomoto's first order with quadratic damping."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    a = parameter("1/s^2", "yaw acceleration per rudder angle", start=0.5, low=0.01, high=20, prime=True)
    b = parameter("1/s", "linear damping", start=0.5, low=-5, high=20, prime=True)
    c = parameter("1/rad", "quadratic damping", start=0.5, low=-50, high=50)

    @r.rate
    def yaw(self):
        """A notebook (2001), page 12."""
        return self.a * self.delta - self.b * self.r - self.c * abs(self.r) * self.r


quadratic_damping = join("quadratic-damping", QuadraticDamping, PlanarMotion)
'''

COMMAND = '''
"""``shipid duration``: how long a trial lasts."""

import click

from shipid.cli.frame.delivery import Delivery, delivered
from shipid.cli.frame.options import TrialReader, reading


@click.command()
@click.argument("trial")
@reading
@delivered()
def duration(trial: str, read: TrialReader, delivery: Delivery) -> None:
    """Say how long a trial lasts."""
    lasts = read(trial).duration
    delivery.hand_over_parts({"duration_s": lasts}, f"{lasts:g} s")
'''


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages as they are installed, in a folder of their own."""
    site = tmp_path_factory.mktemp("site")
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "shipid", site / "shipid", ignore=ignored)
    shutil.copytree(ROOT / "models", site / "shipid" / "models", ignore=ignored)
    return site


def change(site: Path, edits: dict[str, str | tuple[str, str]]) -> None:
    """Write new files, and put lines into files that are there: in front of a text that stands in them once."""
    assert len(edits) <= 2, "more than two files"
    for name, edit in edits.items():
        path = site / "shipid" / name
        if isinstance(edit, str):
            assert not path.exists()
            path.write_text(edit.lstrip(), encoding="utf-8")
        else:
            before, line = edit
            text = path.read_text(encoding="utf-8")
            assert text.count(before) == 1, f"{name} holds {before!r} {text.count(before)} times"
            path.write_text(text.replace(before, line + before), encoding="utf-8")


def python(site: Path, code: str, folder: Path) -> str:
    """Run code that sees the changed packages first."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def shipid(site: Path, folder: Path, *arguments: str) -> str:
    return python(site, f"import sys; from shipid.cli import run; sys.exit(run({list(arguments)!r}))", folder)


def test_a_ship_model_is_one_short_file(installed: Path, tmp_path: Path) -> None:
    assert len(MODEL.strip().splitlines()) < 40
    change(installed, {"models/quadratic_damping.py": MODEL})
    assert "quadratic-damping" in shipid(installed, tmp_path, "models")
    assert "A notebook (2001), page 12." in shipid(installed, tmp_path, "show", "quadratic-damping")
    trial = str(ROOT / "studies" / "trials" / "container-20-20.csv")
    found = shipid(
        installed, tmp_path, "identify", trial, "--model", "quadratic-damping", "--ship", "soesterberg", "--json"
    )
    assert set(json.loads(found)["parameters"]) == {"a", "b", "c"}


def test_a_signal_is_one_line_of_the_vocabulary(installed: Path, tmp_path: Path) -> None:
    line = '    Field("trim", "rad", "deg", "Trim", "trim angle, positive by the stern"),\n'
    change(installed, {"declaration/vocabulary.py": ('    Field("thrust"', line)})
    (tmp_path / "log.csv").write_text(
        "t [s],psi [deg],delta [deg],trim [deg]\n" + "".join(f"{k},{0.1 * k},5,{180 if k else 90}\n" for k in range(40))
    )
    code = (
        "import shipid; trial = shipid.read_trial('log.csv'); print(trial.unit('trim'), round(trial['trim'][1], 4));"
        "shipid.write_trial(trial, 'again.csv')"
    )
    assert python(installed, code, tmp_path).split() == ["rad", "3.1416"]
    assert "trim [deg]" in (tmp_path / "again.csv").read_text()


def test_a_command_is_a_file_and_a_line(installed: Path, tmp_path: Path) -> None:
    line = '    "duration": ("shipid.cli.duration:duration", "Say how long a trial lasts."),\n'
    change(installed, {"cli/duration.py": COMMAND, "cli/registry.py": ('    "measure": (', line)})
    trial = str(ROOT / "studies" / "trials" / "container-20-20.csv")
    assert "Say how long a trial lasts." in shipid(installed, tmp_path, "--help")
    assert shipid(installed, tmp_path, "duration", trial).strip().endswith(" s")
    assert json.loads(shipid(installed, tmp_path, "duration", trial, "--json"))["duration_s"] > 100


def test_a_section_of_a_report_is_a_template_and_a_line(installed: Path, tmp_path: Path) -> None:
    line = '    lambda fit, _: Section("Search", "fit/effort.html", {"evaluations": fit.evaluations}),\n'
    template = "<p>The trials were run {{ view.evaluations }} times.</p>\n"
    change(
        installed,
        {
            "report/templates/fit/effort.html": template,
            "report/views/fit/page.py": ("    lambda fit, _: provenance_section(fit),\n", line),
        },
    )
    trial = str(ROOT / "studies" / "trials" / "container-20-20.csv")
    code = (
        f"import shipid; fit = shipid.identify('nomoto', [shipid.read_trial({trial!r})], ship='soesterberg', starts=1);"
        "shipid.write_report(fit, 'report.html')"
    )
    python(installed, code, tmp_path)
    assert "The trials were run" in (tmp_path / "report.html").read_text(encoding="utf-8")
