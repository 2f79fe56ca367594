"""``shipid bridge``: what is refused before the page opens, and how it ends."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
import time
from urllib.parse import urlsplit

import httpx
import pytest

import shipid
from shipid.foundation.exit_codes import ExitCode


class Opened:
    """The command as a process."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "shipid", "bridge", "--port", "0", *map(str, arguments)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.said = ""
        while "Ctrl-C ends it" not in self.said:
            line = self.process.stderr.readline()
            assert line, self.said
            self.said += line
        self.address = re.search(r"http://\S+", self.said)[0]

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=60)
        return self.process.returncode, out, self.said + err


@pytest.fixture
def opened():
    """Open a bridge; a test that fails leaves no process behind that goes on sailing."""
    processes = []

    def command(*arguments):
        bridge = Opened(*arguments)
        processes.append(bridge.process)
        return bridge

    yield command
    for process in processes:
        process.kill()
        process.communicate()


def answer_of(address: str) -> httpx.Response:
    """What the server answers, on a machine that does much else beside."""
    return httpx.get(address, timeout=60)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_it_opens_says_where_and_ends_cleanly(opened, tmp_path, number, code):
    file, route = tmp_path / "voyage.csv", tmp_path / "route.csv"
    route.write_text("lat [deg],lon [deg],port_xtdd [m]\n53.5,8.1,50\n53.6,8.1,50\n")
    bridge = opened("--record", file, "--clock-factor", 16, "--route", route)
    assert "port_xtdd [m] (is" in " ".join(bridge.said.split())
    assert answer_of(bridge.address).status_code == 200
    assert "NOT FOR NAVIGATION" in bridge.said and "127.0.0.1" in bridge.address
    for _ in range(200):
        if file.read_text().count("\n") > 30:
            break
        answer_of(bridge.address + "health")
        time.sleep(0.05)
    code_, out, said = bridge.end(number)
    assert code_ == code and out == "" and f"The recording is {file}" in " ".join(said.split())
    assert "Traceback" not in said and len(shipid.read_trial(file)) > 25


def test_another_host_gets_a_token(opened):
    bridge = opened("--host", "0.0.0.0")
    assert "?token=" in bridge.address
    place = urlsplit(bridge.address)
    assert answer_of(f"http://127.0.0.1:{place.port}/").status_code == 403
    assert answer_of(bridge.address.replace(str(place.hostname), "127.0.0.1")).status_code == 200
    bridge.end()


def test_the_experiment_prints_its_score_when_it_is_ended(opened):
    bridge = opened("--scenario", "T1", "--condition", "A", "--clock-factor", 100)
    time.sleep(3)
    code, out, _ = bridge.end()
    assert code == ExitCode.INTERRUPTED
    assert "experiment T1, condition A: NOT SAILED TO ITS END" in out and "(6.5)" in out and "table 6.5" in out


def test_a_port_in_use_is_refused(call):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        answer = call("bridge", "--port", taken.getsockname()[1])
    assert answer.code == ExitCode.USAGE and "is in use already" in answer.err


def test_a_recording_that_cannot_be_written_is_refused(call, tmp_path):
    answer = call("bridge", "--port", 0, "--record", tmp_path / "none" / "x.csv")
    assert answer.code == ExitCode.BAD_DATA and "no folder" in answer.err
    there = tmp_path / "there.csv"
    there.write_text("mine")
    answer = call("bridge", "--port", 0, "--record", there)
    assert answer.code == ExitCode.USAGE and "--overwrite" in answer.err and there.read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "code", "what"),
    [
        (["--source", "sonar"], 2, "there is no source 'sonar'"),
        (["--source", "replay:none.csv"], 3, "none.csv"),
        (["--source", "nmea:tcp:10110"], 2, "nmea:tcp:HOST:PORT"),
        (["--scenario", "T9"], 2, "there is no scenario 'T9'"),
        (["--scenario", "T1", "--condition", "E"], 2, "condition"),
        (["--condition", "A"], 2, "--scenario"),
        (["--scenario", "T1", "--source", "nmea:udp:10110"], 2, "simulated"),
        (["--model", "yaw-filter"], 2, "position"),
        (["--chart", "x.json"], 2, "--route"),
        (["--route", "none.rtz"], 3, "none.rtz"),
        (["--clock-factor", "0"], 2, "clock-factor"),
        (["--filter-interval", "0.4"], 2, "unit"),
        (["--filter-interval", "0 s"], 2, "--filter-interval"),
        (["--host", "no-such-host.invalid"], 2, "cannot be used"),
    ],
)
def test_what_cannot_be_is_one_clear_line_before_the_page_opens(call, arguments, code, what):
    answer = call("bridge", "--port", 0, *arguments)
    assert (answer.code, answer.out) == (code, "") and what in " ".join(answer.err.split())


def test_a_missing_extra_is_named(call, monkeypatch):
    monkeypatch.setitem(sys.modules, "starlette.datastructures", None)
    for name in [n for n in sys.modules if n.startswith("shipid.bridge.server")]:
        monkeypatch.delitem(sys.modules, name)
    answer = call("bridge", "--port", 0)
    assert answer.code == ExitCode.BAD_DATA and "pip install 'shipid[bridge]'" in " ".join(answer.err.split())


def test_the_help_says_what_it_is_not(call):
    assert "NOT FOR NAVIGATION" in call("bridge", "--help").out
