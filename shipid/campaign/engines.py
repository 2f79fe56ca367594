"""Where batches run: threads or processes of this machine, or the workers of a dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.reduction import ForkingPickler
from time import monotonic
from typing import ParamSpec, TypeVar
from urllib.parse import urlsplit

from shipid.campaign.campaign import Engine
from shipid.campaign.errors import CampaignRequestError
from shipid.foundation.aliases import DaskClient
from shipid.foundation.errors import MissingExtraError
from shipid.foundation.processes.apart import processors
from shipid.foundation.processes.stopping import undisturbed

P = ParamSpec("P")
T = TypeVar("T")

#: Batches handed to an engine at once, for each of its workers: enough that none waits, few enough to hold in memory.
_AHEAD = 3
#: Seconds a worker that is told to stop is given.
_GRACE = 1.0
#: Seconds a scheduler is given to answer.
_PATIENCE = 10.0
#: A message of dask begins with the number of its frames, in eight bytes; the first one has no more than so many.
_FRAMES = 1000


@dataclass(frozen=True)
class Running:
    """An engine that runs.

    Attributes
    ----------
    executor : concurrent.futures.Executor
        What takes the batches.
    in_flight : int
        How many are handed to it at once.
    words : str
        What it is.
    cancels : bool
        Whether what it has not begun is cancelled when it ends.
    """

    executor: Executor
    in_flight: int
    words: str
    cancels: bool = True


@contextmanager
def local_engine(engine: Engine, workers: int | None, batches: int) -> Iterator[Running]:
    """Run batches on this machine.

    Parameters
    ----------
    engine : {"threads", "processes"}
        See `Campaign`.
    workers : int, optional
        How many; by default one for each processor.
    batches : int
        How many there are to run.

    Yields
    ------
    Running
    """
    count = max(1, min(workers or processors(), batches))
    before = set(multiprocessing.active_children())
    executor: Executor
    if engine == "threads" or count == 1:
        executor = ThreadPoolExecutor(count)
        words = f"{count} thread{'s' * (count > 1)}"
    else:
        # Fresh processes: a fork would copy the locks of threads that run.
        executor = _Processes(count, multiprocessing.get_context("spawn"), _begin_worker)
        words = f"{count} processes"
    try:
        yield Running(executor, _AHEAD * count, words)
    except Exception:
        executor.shutdown(cancel_futures=True)
        raise
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        _end(set(multiprocessing.active_children()) - before)
        raise
    executor.shutdown()


def _end(children: set[multiprocessing.process.BaseProcess]) -> None:
    """Ask workers to end, and end those that do not: what they have in hand is run again."""
    for child in children:
        child.terminate()
    latest = monotonic() + _GRACE
    for child in children:
        child.join(max(0.0, latest - monotonic()))
        if child.is_alive():
            child.kill()


class _Processes(ProcessPoolExecutor):
    """A pool that is handed only what can travel to a process, and that knows every process it has started.

    What cannot be pickled is found here, by who hands it over: found by the pool's own thread it can keep the pool from ending
    (a lock of Python 3.11's executor).
    """

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        try:
            ForkingPickler.dumps((fn, args, kwargs))
        except Exception as error:
            refused: Future[T] = Future()
            refused.set_exception(error)
            return refused
        # A signal between the start of a process and its entry in the list of those to end would leave it working.
        with undisturbed():
            return super().submit(fn, *args, **kwargs)


def _begin_worker() -> None:
    """A worker is stopped by the process that started it, and ends with it: one that was killed tells nobody."""
    # Ctrl-C in a terminal reaches every process of a command.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, name="parent", daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def cluster_engine(address: str) -> Iterator[Running]:
    """Run batches on the workers of a dask cluster.

    Parameters
    ----------
    address : str
        Of its scheduler: ``"tcp://10.0.0.1:8786"``.

    Yields
    ------
    Running

    Raises
    ------
    MissingExtraError
        If dask.distributed is not installed.
    CampaignRequestError
        If no scheduler answers there, or it has no workers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError(
            "a campaign on a cluster", "distributed", "cluster", "Without --scheduler it runs on this machine."
        ) from None
    try:
        _check_scheduler(address)
        connect: DaskClient = type("_Client", (Client,), {"__del__": _end_client})
        client = connect(address, timeout=f"{_PATIENCE:g}s", set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__
        raise CampaignRequestError(f"no scheduler answers at '{address}': {reason}. Check the address.") from None
    with client, running_on(client) as running:
        yield running


def _check_scheduler(address: str) -> None:
    """Check that what answers speaks first, as a scheduler does: a client waits for ever for a web server to do so."""
    parts = urlsplit(address if "://" in address else f"tcp://{address}")
    if parts.scheme != "tcp" or parts.hostname is None or parts.port is None:
        return  # the client says what is wrong with it
    with socket.create_connection((parts.hostname, parts.port), _PATIENCE) as link:
        try:
            said = link.recv(8, socket.MSG_WAITALL)
        except TimeoutError:
            said = b""
    if len(said) < 8 or int.from_bytes(said, "little") > _FRAMES:
        raise CampaignRequestError(
            f"what answers at '{address}' is no scheduler. Check the port: that of a scheduler's web page is another."
        )


def _end_client(client: DaskClient) -> None:
    """Close a client that nobody closed; one that was never connected would wait for its scheduler, and complain."""
    if client.status == "running":
        client.close()


@contextmanager
def running_on(client: DaskClient) -> Iterator[Running]:
    """Run batches through a client of dask.

    Parameters
    ----------
    client : distributed.Client
        Connected to a scheduler with workers.

    Yields
    ------
    Running

    Raises
    ------
    CampaignRequestError
        If there are no workers.
    """
    threads = sum(client.nthreads().values())
    if not threads:
        raise CampaignRequestError(f"the scheduler at '{client.scheduler.address}' has no workers; start some first.")
    # Equal calls are not one call: a batch that is run again is run again.
    executor = client.get_executor(pure=False)
    try:
        yield Running(executor, _AHEAD * threads, f"{len(client.nthreads())} workers at {client.scheduler.address}")
    finally:
        executor.shutdown(wait=False)
