"""The verb: run a campaign, here or on a cluster; what is finished is on disk, and a stopped campaign is gone on with."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import shipid
from shipid.campaign.campaign import Campaign, Rows, run_batch
from shipid.campaign.engines import Running, cluster_engine, local_engine
from shipid.campaign.errors import CampaignRequestError, WorkerLostError
from shipid.campaign.find_campaign import CampaignFile, whole
from shipid.campaign.moments import MeasureTally
from shipid.campaign.result import CampaignResult
from shipid.campaign.store import Store, open_store
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError
from shipid.foundation.notices import Notice

#: Batches handed to an executor of the caller's at once, whose number of workers is not known.
_IN_FLIGHT = 16
#: How often a pool of this machine whose process died is started again without a batch finished in between.
_RESTARTS = 3
#: How often this looks for a request to stop while it waits for a batch, s.
_LOOK = 0.2


def run_campaign(
    campaign: Campaign | CampaignFile,
    runs: int,
    *,
    seed: int = 0,
    folder: str | Path | None = None,
    resume: bool = False,
    overwrite: bool = False,
    executor: Executor | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Callable[[str], None] | None = None,
) -> CampaignResult:
    """Run a study many times.

    The result depends on the study, the seed and the number of runs, not on where and in which order the runs were made. Runs
    are held in memory one batch at a time.

    Parameters
    ----------
    campaign : Campaign or CampaignFile
        The study (`shipid.campaign.find_campaign.find_campaign` finds one by name).
    runs : int
        How many runs it has in the end.
    seed : int
        Run k has the random numbers of child k of ``SeedSequence(seed)``.
    folder : str or Path, optional
        Where finished runs are kept; by default they are not kept.
    resume, overwrite : bool
        What to do with runs that lie there: go on with them (more of them too), or begin again.
    executor : concurrent.futures.Executor, optional
        What runs the batches instead of this machine's threads or processes; functions and results are pickled.
    scheduler : str, optional
        Address of the scheduler of a dask cluster to run on.
    workers : int, optional
        Threads or processes of this machine; by default one for each processor.
    progress : callable, optional
        Called with a line of text as batches finish; may raise to stop.

    Returns
    -------
    CampaignResult

    Raises
    ------
    CampaignRequestError
        If the request does not fit.
    WorkerLostError
        If the engine loses its workers; finished runs are kept.
    ShipidError
        If a run fails: `RunError` says which.
    """
    study = whole(campaign)
    _check_request(study, runs, folder, resume, executor, scheduler)
    tell = progress or (lambda _: None)
    about: dict[str, Plain] = {"versions": _versions(), "identity": study.identity}
    with ExitStack() as stack:
        kept = None if folder is None else Path(folder)
        place = kept or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="shipid-campaign-")))
        store = open_store(place, study, seed, resume=resume, overwrite=overwrite, about=about)
        missing = store.missing(runs)
        if missing:
            _fill(store, campaign, study, runs, missing, _Where(executor, scheduler, workers), tell)
        tell("taking the statistics of the runs")
        return result_of(store, runs, kept)


def result_of(store: Store, runs: int, kept: Path | None) -> CampaignResult:
    """Return the statistics of finished runs, read in order, one batch at a time.

    Parameters
    ----------
    store : Store
        Where they lie.
    runs : int
        How many.
    kept : Path or None
        The folder, where it stays.
    """
    tallies: dict[str, MeasureTally] = {}
    for rows in store.batches(runs):
        for name, measure in store.measures.items():
            tallies.setdefault(name, MeasureTally.begin(measure, rows[name])).add(rows[name])
    statistics = {n: t.statistic(n) for n, t in tallies.items()}
    warnings = [
        Notice(f"'{n}' has no finite value in {s.missing} of {runs} runs; its statistics are those of the others.",
               "missing-values", serious=s.missing > runs // 2, measure=n)
        for n, s in statistics.items() if s.missing
    ]  # fmt: skip
    head = store.head
    return CampaignResult(
        head["campaign"], runs, head["seed"], store.batch, statistics, kept, head["provenance"], tuple(warnings)
    )


def _check_request(
    study: Campaign,
    runs: int,
    folder: str | Path | None,
    resume: bool,
    executor: Executor | None,
    scheduler: str | None,
) -> None:
    if runs < 1:
        raise CampaignRequestError(f"a campaign of {runs} runs has no statistics; ask for 1 or more.")
    if study.most is not None and runs > study.most:
        raise CampaignRequestError(f"campaign {study.name} has {study.most} runs at most; {runs} are asked for.")
    if resume and folder is None:
        raise CampaignRequestError(
            "a campaign is resumed from the folder that its runs were kept in, which is not given."
        )
    if executor is not None and scheduler is not None:
        raise CampaignRequestError("an executor and a scheduler are given; choose one of them.")


def _fill(
    store: Store,
    campaign: Campaign | CampaignFile,
    study: Campaign,
    runs: int,
    missing: list[int],
    where: _Where,
    tell: Callable[[str], None],
) -> None:
    """Run what is missing; a pool of this machine that loses a process is started again."""
    restarts = 0
    while missing:
        try:
            with _engine(study, where, len(missing)) as running:
                _run(store, campaign, study, runs, missing, running, tell)
            return
        except _EngineError as error:
            cause = error.__cause__
            left = store.missing(runs)
            restarts = 0 if len(left) < len(missing) else restarts + 1
            missing = left
            if not where.here or not isinstance(cause, BrokenExecutor) or restarts > _RESTARTS:
                raise WorkerLostError(
                    f"what runs campaign {study.name} gave up a batch ({type(cause).__name__}: {cause}); {store.done()} of "
                    f"{runs} runs are finished. Run the campaign again with --resume to go on."
                ) from error


class _EngineError(Exception):
    """The engine failed, not the study: the cause is its error."""


@dataclass(frozen=True)
class _Where:
    """Where the batches are to run."""

    executor: Executor | None
    scheduler: str | None
    workers: int | None

    @property
    def here(self) -> bool:
        return self.executor is None and self.scheduler is None


@contextmanager
def _engine(study: Campaign, where: _Where, batches: int) -> Iterator[Running]:
    if where.executor is not None:
        yield Running(where.executor, _IN_FLIGHT, type(where.executor).__name__, cancels=False)
    elif where.scheduler is not None:
        with cluster_engine(where.scheduler) as running:
            yield running
    else:
        with local_engine(study.engine, where.workers, batches) as running:
            yield running


def _run(
    store: Store,
    campaign: Campaign | CampaignFile,
    study: Campaign,
    runs: int,
    missing: list[int],
    running: Running,
    tell: Callable[[str], None],
) -> None:
    """Hand out batches, a few ahead, and write each as it comes; when stopped, what has come is written first."""
    waiting = iter(missing)
    out: dict[Future[Rows], int] = {}
    done = store.done()

    def hand_out() -> None:
        for index in waiting:
            numbers = store.numbers(index, runs)
            try:
                future = running.executor.submit(_task, campaign, int(store.head["seed"]), list(numbers))
            except BrokenExecutor as error:  # a worker died since the last batch came
                raise _EngineError from error
            out[future] = index
            if len(out) >= running.in_flight:
                return

    def take(future: Future[Rows]) -> int:
        index = out.pop(future)
        numbers = store.numbers(index, runs)
        try:
            rows = future.result()
        except ShipidError:
            raise
        except Exception as error:
            raise _EngineError from error
        store.write(index, numbers, rows)
        return len(numbers)

    try:
        hand_out()
        while out:
            tell(f"{done} of {runs} runs on {running.words}")
            for future in wait(out, timeout=_LOOK, return_when=FIRST_COMPLETED).done:
                done += take(future)
            hand_out()
    except BaseException:
        for future in list(out):
            if future.done() or (not running.cancels and not future.cancel() and future.done()):
                with suppress(Exception):
                    take(future)
        raise


def _task(campaign: Campaign | CampaignFile, seed: int, numbers: list[int]) -> Rows:
    return run_batch(whole(campaign), seed, numbers)


def _versions() -> dict[str, str]:
    versions = {name: metadata.version(name) for name in ("casadi", "numpy", "scipy")}
    return {"shipid": shipid.__version__, "python": sys.version.split()[0], **versions}
