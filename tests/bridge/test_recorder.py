"""The recording: read back by `read_trial`, identified from, whole after a kill, and no end of the voyage when the disk is full."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import shipid
from shipid.bridge.recorder import Recorder
from shipid.foundation.errors import MissingFileError

from .conftest import sail, shown


def test_a_voyage_is_read_back_and_identified(make_core, tmp_path):
    file = tmp_path / "voyage.csv"
    recorder = Recorder(file, "soesterberg", "simulate", simulated=True)
    core = make_core(recording=recorder)
    for heading in (0.0, 0.6, 0.0, 5.6, 0.3):
        core.command({"command": "trial", "heading": heading, "rudder_limit": math.radians(15)})
        core.command({"command": "execute"})
        sail(core, 150)
    told = shown(core)["recording"]
    recorder.close()
    assert told == {"file": str(file), "samples": 1875, "message": None}
    trial = shipid.read_trial(file)
    assert (
        len(trial) == 1875 and trial.source.simulated and trial.has("psi", "r", "u", "delta", "delta_order", "x", "y")
    )
    assert trial["t"][-1] == pytest.approx(750) and abs(trial["delta"]).max() == pytest.approx(
        math.radians(15), rel=1e-3
    )
    fit = shipid.identify("de-keizer-minimal", [trial], ship="soesterberg", starts=1)
    assert fit.ship.find(fit.model, "K").at(None, "1", "") == pytest.approx(1.6, rel=0.1)


def test_what_is_not_measured_stays_empty(tmp_path):
    file = tmp_path / "gaps.csv"
    recorder = Recorder(file, "x", "nmea:udp:1", simulated=False)
    for k in range(100):
        values = {"psi": 0.01 * k, "u": 5.0, "delta": 0.1, "r": math.nan if k % 2 else 0.01}
        recorder.add(0.4 * k, values)
    recorder.close()
    trial = shipid.read_trial(file)
    assert np.isnan(trial["r"]).sum() == 50 and not trial.source.simulated and not trial.has("x")


def test_a_kill_loses_no_row(tmp_path):
    file = tmp_path / "killed.csv"
    script = (
        "import sys; from pathlib import Path; from shipid.bridge.recorder import Recorder\n"
        f"r = Recorder(Path({str(file)!r}), 'x', 'simulate', simulated=True)\n"
        "for k in range(10**9):\n"
        "    r.add(0.4 * k, {'psi': 0.1, 'u': 5.0})\n"
        "    if k == 500: print('there', flush=True)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "there\n"
    os.kill(process.pid, signal.SIGKILL)
    process.wait(20)
    lines = file.read_text().splitlines()
    assert len(lines) > 500 and len({line.count(",") for line in lines[1:]}) == 2 - 1
    assert len(shipid.read_trial(file)) == len(lines) - 2


def test_a_row_that_was_cut_is_no_end_of_the_recording(tmp_path):
    file = tmp_path / "cut.csv"
    recorder = Recorder(file, "x", "simulate", simulated=True)
    for k in range(50):
        recorder.add(0.4 * k, {"psi": 0.1, "u": 5.0, "delta": 0.0})
    recorder.close()
    file.write_bytes(file.read_bytes()[:-12])
    assert len(shipid.read_trial(file)) >= 49


def test_a_full_disk_ends_the_recording_and_not_the_voyage(make_core):
    recorder = Recorder.__new__(Recorder)
    recorder.path, recorder.samples, recorder.message = "/dev/full", 0, ""
    recorder._file = open("/dev/full", "wb", buffering=0)  # noqa: SIM115, SLF001 - a disk that is full
    core = make_core(recording=recorder)
    sail(core, 10)
    told = shown(core)
    assert told["recording"]["message"].startswith("the recording has stopped: No space left")
    assert "the recording has stopped" in told["alarms"][0]["text"] and told["own"]["x"] > 50


def test_a_recording_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(MissingFileError, match="cannot be recorded to"):
        Recorder(tmp_path / "none" / "x.csv", "x", "simulate", simulated=True)


def test_a_row_that_the_disk_takes_half_of_does_not_stay(tmp_path):
    """A disk that becomes full says how much of a row it took, and raises nothing."""
    file = tmp_path / "half.csv"
    script = (
        "import resource; from pathlib import Path; from shipid.bridge.recorder import Recorder\n"
        "import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        f"r = Recorder(Path({str(file)!r}), 'x', 'simulate', simulated=True)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1013, 1013))\n"
        "for k in range(100):\n"
        "    r.add(0.4 * k, {'psi': 0.1, 'u': 5.0})\n"
        "r.close()\n"
        "print(r.samples, r.message)\n"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    samples, message = said.split(maxsplit=1)
    assert message.startswith("the recording has stopped")
    assert file.read_bytes().endswith(b"\n") and len(shipid.read_trial(file)) == int(samples) > 10
