"""Campaigns on this machine: reproducible, resumed without loss, the same whatever runs them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import tracemalloc
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import popen_spawn_posix
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from shipid.campaign.campaign import Campaign, Measure, generator_of, run_batch
from shipid.campaign.errors import (
    CampaignDeclarationError,
    CampaignFolderError,
    CampaignRequestError,
    RunError,
    WorkerLostError,
)
from shipid.campaign.run_campaign import run_campaign
from shipid.campaign.table import read_runs
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.processes.stopping import Interrupted, watched


def same_runs(one: dict, other: dict) -> None:
    assert one.keys() == other.keys()
    for name in one:
        assert_array_equal(one[name], other[name], err_msg=name)


class StopAskedError(Exception):
    """Stands for Ctrl-C."""


def stopping_after(runs: int):
    def tell(text: str) -> None:
        words = text.split()
        if words[0].isdigit() and int(words[0]) >= runs:
            raise StopAskedError

    return tell


def test_a_run_has_the_random_numbers_of_its_child():
    children = np.random.SeedSequence(7).spawn(5)
    for k in range(5):
        assert generator_of(7, k).normal() == np.random.default_rng(children[k]).normal()


def test_a_run_is_repeated_on_its_own(studies, tmp_path):
    run_campaign(studies.darts, 60, seed=3, folder=tmp_path)
    rows = read_runs(tmp_path)
    assert_array_equal(rows["run"], np.arange(60))
    alone = run_batch(studies.darts, 3, [37])
    for name, column in alone.items():
        assert_array_equal(column[0], rows[name][37])


def test_engines_and_numbers_of_workers_do_not_matter(studies, tmp_path):
    one = run_campaign(studies.darts, 90, seed=1, folder=tmp_path / "one", workers=1)
    threads = run_campaign(studies.darts, 90, seed=1, folder=tmp_path / "threads", workers=2)
    processes = run_campaign(replace(studies.darts, engine="processes"), 90, seed=1, folder=tmp_path / "p", workers=2)
    with ThreadPoolExecutor(3) as pool:
        given = run_campaign(studies.darts, 90, seed=1, folder=tmp_path / "given", executor=pool)
    for name in ("threads", "p", "given"):
        same_runs(read_runs(tmp_path / "one"), read_runs(tmp_path / name))
    assert one.to_dict() == threads.to_dict() == processes.to_dict() == given.to_dict()
    assert run_campaign(studies.darts, 90, seed=2).to_dict() != one.to_dict()


def test_a_batch_at_once_is_the_same_study(studies):
    def throws(generators):
        found = [studies.throw(rng) for rng in generators]
        return {n: np.array([f[n] for f in found]) for n in found[0]}

    together = Campaign("darts", None, studies.MEASURES, runs=throws, batch=20)
    assert run_campaign(together, 50).to_dict() == run_campaign(studies.darts, 50).to_dict()


def test_a_stopped_campaign_is_gone_on_with(studies, tmp_path, monkeypatch):
    whole = run_campaign(studies.darts, 200, folder=tmp_path / "whole")
    with pytest.raises(StopAskedError):
        run_campaign(studies.darts, 200, folder=tmp_path / "part", workers=1, progress=stopping_after(60))
    kept = sorted((tmp_path / "part" / "batches").iterdir())
    assert 3 <= len(kept) < 10
    stamps = {p: p.stat().st_mtime_ns for p in kept}
    resumed = run_campaign(studies.darts, 200, folder=tmp_path / "part", resume=True)
    assert {p: p.stat().st_mtime_ns for p in kept} == stamps, "finished runs are not run again"
    assert resumed.to_dict() == whole.to_dict()
    same_runs(read_runs(tmp_path / "whole"), read_runs(tmp_path / "part"))


def test_a_process_that_is_just_started_is_ended_too(studies, monkeypatch):
    """The signal comes after a worker was started and before anything knows of it."""
    launch, started = popen_spawn_posix.Popen._launch, []  # noqa: SLF001 - where a process is started

    def interrupted(self: object, process: object) -> None:
        launch(self, process)
        started.append(self.pid)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(popen_spawn_posix.Popen, "_launch", interrupted)
    study = replace(studies.slow_darts, engine="processes")
    # In the background of a shell interruptions are ignored, and stay so.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with watched(), pytest.raises(Interrupted):
            run_campaign(study, 200, workers=2)
    finally:
        signal.signal(signal.SIGINT, before)
    left = [n for n in started if Path(f"/proc/{n}").exists() and "Z" not in Path(f"/proc/{n}/stat").read_text()]
    assert started and not left


def test_runs_are_added(studies, tmp_path):
    """The last batch was not full: it is run again, whole."""
    run_campaign(studies.darts, 30, folder=tmp_path / "a")
    run_campaign(studies.darts, 70, folder=tmp_path / "a", resume=True)
    run_campaign(studies.darts, 70, folder=tmp_path / "b")
    same_runs(read_runs(tmp_path / "a"), read_runs(tmp_path / "b"))


def test_a_damaged_batch_is_run_again(studies, tmp_path):
    run_campaign(studies.darts, 60, folder=tmp_path)
    before = read_runs(tmp_path)
    (tmp_path / "batches" / "000001.npz").write_bytes(b"PK half of a file")
    with pytest.raises(CampaignFolderError, match="damaged"):
        read_runs(tmp_path, 60)
    run_campaign(studies.darts, 60, folder=tmp_path, resume=True)
    same_runs(before, read_runs(tmp_path))


def test_a_killed_process_costs_nothing(studies, tmp_path, monkeypatch):
    monkeypatch.setenv("SHIPID_TEST_MARK", str(tmp_path / "mark"))
    (tmp_path / "mark").touch()
    run_campaign(studies.dying_darts, 40, folder=tmp_path / "calm", workers=2)
    (tmp_path / "mark").unlink()
    run_campaign(studies.dying_darts, 40, folder=tmp_path / "died", workers=2)
    assert (tmp_path / "mark").exists(), "a process died"
    same_runs(read_runs(tmp_path / "calm"), read_runs(tmp_path / "died"))


class DeadPool(ThreadPoolExecutor):
    """An engine of the caller's that is lost after two batches."""

    taken = 0
    refuses = False

    def submit(self, function, /, *arguments, **named):
        from concurrent.futures import BrokenExecutor

        self.taken += 1
        if self.taken <= 2:
            return super().submit(function, *arguments, **named)
        if self.refuses:
            raise BrokenExecutor("lost")
        lost: Future = Future()
        lost.set_exception(BrokenExecutor("lost"))
        return lost


class RefusingPool(DeadPool):
    """One that is found to be lost when the next batch is handed over."""

    refuses = True


@pytest.mark.parametrize("engine", [DeadPool, RefusingPool])
def test_a_lost_engine_is_told_and_gone_on_with(studies, tmp_path, engine):
    with engine(1) as pool, pytest.raises(WorkerLostError, match="--resume"):
        run_campaign(studies.darts, 100, folder=tmp_path, executor=pool)
    resumed = run_campaign(studies.darts, 100, folder=tmp_path, resume=True)
    assert resumed.to_dict() == run_campaign(studies.darts, 100).to_dict()


def test_memory_does_not_grow_with_the_runs():
    """Ten thousand runs take as much as one thousand; the rows of one batch are half a megabyte."""

    def runs(generators):
        return {"x": np.array([rng.normal() for rng in generators])[:, None] + np.zeros((1, 300))}

    wide = Campaign("wide", None, {"x": Measure("error", "m")}, runs=runs, batch=200)

    def peak(count: int) -> int:
        tracemalloc.start()
        run_campaign(wide, count, workers=1)
        top = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return top

    peak(200)
    # All rows would be 24 MB.
    assert peak(10_000) < 1.5 * peak(1000) < 12e6


def test_what_cannot_travel_to_a_process_is_told():
    lonely = Campaign("lonely", lambda rng: {"x": 1.0}, {"x": Measure()}, batch=1, engine="processes")
    with pytest.raises(WorkerLostError, match=r"gave up a batch \(.*0 of 4 runs are finished"):
        run_campaign(lonely, 4, workers=2)


def test_what_does_not_fit_is_refused(studies, tmp_path):
    with pytest.raises(CampaignRequestError, match="0 runs has no statistics"):
        run_campaign(studies.darts, 0)
    with pytest.raises(CampaignRequestError, match="10 runs at most"):
        run_campaign(replace(studies.darts, most=10), 11)
    with pytest.raises(CampaignRequestError, match="resumed from the folder"):
        run_campaign(studies.darts, 5, resume=True)
    with ThreadPoolExecutor(1) as pool, pytest.raises(CampaignRequestError, match="choose one"):
        run_campaign(studies.darts, 5, executor=pool, scheduler="tcp://x:1")
    run_campaign(studies.darts, 40, folder=tmp_path)
    with pytest.raises(CampaignRequestError, match="40 finished runs"):
        run_campaign(studies.darts, 40, folder=tmp_path)
    with pytest.raises(CampaignRequestError, match="another seed"):
        run_campaign(studies.darts, 40, folder=tmp_path, seed=9, resume=True)
    with pytest.raises(CampaignRequestError, match="another study file and another measures"):
        other = replace(studies.darts, identity="changed", measures={"miss": Measure("value")})
        run_campaign(other, 40, folder=tmp_path, resume=True)
    # A folder of trials has no study file.
    fleet = replace(studies.darts, name="fleet", identity="the trials of Monday")
    run_campaign(fleet, 40, folder=tmp_path / "fleet")
    with pytest.raises(CampaignRequestError, match="another set of trials, model, ship or settings: they do not mix"):
        run_campaign(replace(fleet, identity="one more"), 40, folder=tmp_path / "fleet", resume=True)
    with pytest.raises(CampaignRequestError, match="holds 40 runs already"):
        run_campaign(studies.darts, 20, folder=tmp_path, resume=True)
    again = run_campaign(studies.darts, 20, folder=tmp_path, seed=9, overwrite=True)
    assert len(read_runs(tmp_path)["run"]) == 20 and again.seed == 9
    (tmp_path / "campaign.json").write_text("{}")
    with pytest.raises(CampaignFolderError, match="entries are missing"):
        run_campaign(studies.darts, 20, folder=tmp_path, resume=True)


def test_a_run_that_fails_is_named(studies):
    failing = Campaign("failing", studies.failing, {"miss": Measure("error", "m")})
    first = next(k for k in range(100) if generator_of(0, k).uniform() > 0.95)
    with pytest.raises(RunError, match=f"run {first} of campaign failing failed: ValueError: off the board"):
        run_campaign(failing, 100)


def test_a_declaration_that_is_none_is_refused(studies):
    one = {"x": Measure()}
    with pytest.raises(CampaignDeclarationError, match="one of the two"):
        Campaign("none", None, one)
    with pytest.raises(CampaignDeclarationError, match="declares no measures"):
        Campaign("none", studies.throw, {})
    with pytest.raises(CampaignDeclarationError, match="batches of 0"):
        Campaign("none", studies.throw, one, batch=0)
    with pytest.raises(UnknownNameError, match="engine 'ships'"):
        Campaign("none", studies.throw, one, engine="ships")
    with pytest.raises(UnknownNameError, match="kind of measure 'errors'"):
        Measure("errors")
    with pytest.raises(CampaignDeclarationError, match="degrees of freedom"):
        Measure("nees")


@pytest.mark.parametrize(
    ("run", "words"),
    [
        (lambda rng: {"y": 1.0}, "missing: x; not declared: y"),
        (lambda rng: {"x": np.zeros(int(rng.integers(1, 9)))}, "different lengths"),
        (lambda rng: {"x": "far"}, "not as numbers"),
        (lambda rng: {"x": np.zeros((2, 2))}, "shape"),
    ],
)
def test_runs_that_return_something_else_are_refused(run, words):
    with pytest.raises(CampaignDeclarationError, match=words):
        run_campaign(Campaign("odd", run, {"x": Measure()}), 10)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal")
def test_workers_end_with_a_process_that_was_killed():
    """Nobody tells them: they watch it."""
    script = (
        "import os, signal\n"
        "from shipid.campaign.engines import local_engine\n"
        "if __name__ == '__main__':\n"
        "    with local_engine('processes', 2, 2) as running:\n"
        "        print(running.executor.submit(os.getpid).result(), flush=True)\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    started = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    worker = int(started.stdout.readline())
    # The worker holds its output open: it ends when she does.
    ended = threading.Thread(target=started.stdout.read)
    ended.start()
    ended.join(20)
    gone = not ended.is_alive()
    if not gone:
        os.kill(worker, signal.SIGKILL)
    started.wait()
    assert gone
