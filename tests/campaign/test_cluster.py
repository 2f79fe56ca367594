"""A real cluster of dask with two worker processes: the same bits as here, and nothing lost when a worker is killed."""

from __future__ import annotations

import os
import signal
import socket
import threading
from contextlib import suppress

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from shipid.campaign import engines
from shipid.campaign.engines import running_on
from shipid.campaign.errors import CampaignRequestError
from shipid.campaign.find_campaign import find_campaign
from shipid.campaign.run_campaign import run_campaign
from shipid.campaign.table import read_runs

distributed = pytest.importorskip("distributed")

FILE = """
import shipid

def throw(rng):
    return {"miss": rng.normal(), "course": rng.normal(size=3)}

darts = shipid.Campaign("darts", throw, {n: shipid.Measure("error", "m") for n in ("miss", "course")}, batch=10)
"""


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as made:
        yield made


def same_runs(one: dict, other: dict) -> None:
    assert one.keys() == other.keys()
    for name in one:
        assert_array_equal(one[name], other[name], err_msg=name)


def test_a_cluster_gives_the_bits_of_this_machine(cluster, studies, tmp_path):
    here = run_campaign(studies.darts, 130, seed=4, folder=tmp_path / "here")
    there = run_campaign(studies.darts, 130, seed=4, folder=tmp_path / "there", scheduler=cluster.scheduler_address)
    same_runs(read_runs(tmp_path / "here"), read_runs(tmp_path / "there"))
    assert here.to_dict() == there.to_dict()


def test_a_campaign_file_travels_as_text(cluster, tmp_path):
    path = tmp_path / "study.py"
    path.write_text(FILE)
    found = find_campaign(f"{path}:darts")
    path.unlink()  # a worker elsewhere does not have it
    there = run_campaign(found, 45, scheduler=cluster.scheduler_address)
    assert there.to_dict() == run_campaign(found, 45).to_dict()


def test_an_executor_is_an_executor(cluster, studies):
    with distributed.Client(cluster, set_as_default=False) as client:
        there = run_campaign(studies.darts, 70, executor=client.get_executor(pure=False))
    assert there.to_dict() == run_campaign(studies.darts, 70).to_dict()


def test_a_worker_that_is_killed_costs_no_run(cluster, studies, tmp_path):
    here = run_campaign(studies.slow_darts, 300, folder=tmp_path / "here")
    killed = []

    def kill_one(text: str) -> None:
        words = text.split()
        if words[0].isdigit() and int(words[0]) >= 60 and not killed:
            with distributed.Client(cluster, set_as_default=False) as client:
                pids = client.run(os.getpid)
            killed.append(next(iter(pids.values())))
            os.kill(killed[0], signal.SIGKILL)

    there = run_campaign(
        studies.slow_darts, 300, folder=tmp_path / "there", scheduler=cluster.scheduler_address, progress=kill_one
    )
    assert killed
    same_runs(read_runs(tmp_path / "here"), read_runs(tmp_path / "there"))
    assert here.to_dict() == there.to_dict()
    assert np.array_equal(read_runs(tmp_path / "there")["run"], np.arange(300))


def test_a_cluster_that_is_not_there_is_told(studies):
    with pytest.raises(CampaignRequestError, match=r"no scheduler answers at 'nonsense://1'"):
        run_campaign(studies.darts, 10, scheduler="nonsense://1")


def test_what_is_no_scheduler_is_told_at_once(studies, monkeypatch):
    """A web server waits to be asked, and another service says what is no message: a client of dask would wait for ever."""
    monkeypatch.setattr(engines, "_PATIENCE", 0.2)

    def answer(server, greeting):
        link, _ = server.accept()
        link.send(greeting)
        with suppress(ConnectionResetError):
            link.recv(1)
        link.close()

    for greeting in (b"", b"SSH-2.0-OpenSSH\r\n"):
        with socket.create_server(("127.0.0.1", 0)) as server:
            answering = threading.Thread(target=answer, args=(server, greeting))
            answering.start()
            with pytest.raises(CampaignRequestError, match="is no scheduler"):
                run_campaign(studies.darts, 10, scheduler=f"tcp://127.0.0.1:{server.getsockname()[1]}")
            answering.join(10)


def test_a_cluster_without_workers_is_told(studies):
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None, silence_logs=50) as empty,
        distributed.Client(empty, set_as_default=False) as client,
        pytest.raises(CampaignRequestError, match="has no workers"),
        running_on(client),
    ):
        pass
