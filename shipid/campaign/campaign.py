"""The declaration of a campaign: what one run is, what is measured in it, and where its random numbers come from.

A file that declares one::

    import numpy as np
    import shipid

    def throw(rng):
        \"\"\"One run: its own random numbers in, its measures out.\"\"\"
        return {"miss": rng.normal(0.0, 2.0)}

    darts = shipid.Campaign("darts", throw, {"miss": shipid.Measure("error", "m", "distance from the middle")})

is called as ``shipid campaign file.py:darts --runs 1000``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np

from shipid.campaign.errors import CampaignDeclarationError, RunError
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError, UnknownNameError

#: What a measure is, which decides its statistics.
Kind = Literal["value", "error", "nees", "probability", "event", "count", "text"]
#: How batches run side by side on this machine: threads, for compiled functions, or processes.
Engine = Literal["threads", "processes"]
#: One run: its random numbers in, its measures out.
Run: TypeAlias = "Callable[[np.random.Generator], Mapping[str, Plain]]"
#: A batch of runs at once: their random numbers in; measures with the runs along the first axis out.
Runs: TypeAlias = "Callable[[Sequence[np.random.Generator]], Mapping[str, np.ndarray]]"
#: Rows by measure, the runs along the first axis.
Rows: TypeAlias = "dict[str, np.ndarray]"
#: The column that numbers the runs.
RUN = "run"


@dataclass(frozen=True)
class Measure:
    """What is measured in a run: one number, a sequence of them (over the scans, say), or a text.

    Attributes
    ----------
    kind : {"value", "error", "nees", "probability", "event", "count", "text"}
        A value has a mean; an error a root mean square and a mean; a normalised squared error is compared with its
        degrees of freedom; a probability has a mean; an event (0 or 1) a share; a count (how many events a run has: 0, 1,
        2 and so on) a mean whose interval does not go below zero; a text is counted.
    unit : str
        SI, ``"1"`` for none.
    meaning : str
        In words.
    degrees : int
        Degrees of freedom of a "nees".
    """

    kind: Kind = "value"
    unit: str = "1"
    meaning: str = ""
    degrees: int = 0

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise UnknownNameError("kind of measure", self.kind, get_args(Kind))
        if self.kind == "nees" and self.degrees < 1:
            raise CampaignDeclarationError("a normalised squared error needs its degrees of freedom: degrees=2.")


@dataclass(frozen=True)
class Campaign:
    """A study that is run many times.

    Attributes
    ----------
    name : str
        Of the study.
    run : callable or None
        One run: takes a `numpy.random.Generator`, returns its measures by name.
    measures : mapping of str to Measure
        What a run returns.
    runs : callable or None
        Instead of `run`, a batch at once: takes a list of generators, returns arrays with the runs along the first axis.
        Each run takes random numbers from its own generator only.
    batch : int
        Runs in one batch: what one worker does at a time, and what is written at a time.
    engine : {"threads", "processes"}
        How this machine runs batches side by side: threads where compiled functions and NumPy do the work.
    most : int or None
        How many runs there are at most, where each run is one case of a list.
    identity : str
        What the runs depend on, as a hash; runs of another identity are not mixed with these.
    """

    name: str
    run: Run | None
    measures: Mapping[str, Measure]
    runs: Runs | None = None
    batch: int = 50
    engine: Engine = "threads"
    most: int | None = None
    identity: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        if (self.run is None) == (self.runs is None):
            raise CampaignDeclarationError(
                f"campaign {self.name} needs run (one run) or runs (a batch at once), one of the two."
            )
        if not self.measures or RUN in self.measures or not all(n.isidentifier() for n in self.measures):
            raise CampaignDeclarationError(
                f"campaign {self.name} declares no measures, one called '{RUN}', or one whose name is no word."
            )
        if self.batch < 1:
            raise CampaignDeclarationError(f"campaign {self.name} has batches of {self.batch} runs; give 1 or more.")
        if self.engine not in get_args(Engine):
            raise UnknownNameError("engine", self.engine, get_args(Engine))


def generator_of(seed: int, number: int) -> np.random.Generator:
    """Return the random numbers of one run: they depend on the campaign's seed and the number of the run only.

    Parameters
    ----------
    seed : int
        Of the campaign.
    number : int
        Of the run, from 0.

    Returns
    -------
    numpy.random.Generator
        That of child `number` of ``SeedSequence(seed).spawn(...)``.
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))


def run_number(rng: np.random.Generator) -> int:
    """Return the number of the run that has these random numbers: which case of a list it is, say.

    Parameters
    ----------
    rng : numpy.random.Generator
        As a run is given it.
    """
    return int(rng.bit_generator.seed_seq.spawn_key[-1])  # type: ignore[attr-defined]


def run_batch(campaign: Campaign, seed: int, numbers: Sequence[int]) -> Rows:
    """Run some runs of a campaign, here.

    Parameters
    ----------
    campaign : Campaign
        The study.
    seed : int
        Of the campaign.
    numbers : sequence of int
        Which runs.

    Returns
    -------
    dict of str to ndarray, shape (len(numbers), ...)
        The measures.

    Raises
    ------
    RunError
        If a run fails.
    CampaignDeclarationError
        If it returns something else than declared.
    """
    generators = [generator_of(seed, n) for n in numbers]
    which = f"run {numbers[0]}" if len(numbers) == 1 else f"runs {numbers[0]} to {numbers[-1]}"
    if campaign.runs is not None:
        with _named(f"{which} of campaign {campaign.name}"):
            rows = dict(campaign.runs(generators))
        return _checked(campaign, rows, len(numbers))
    assert campaign.run is not None
    found = []
    for number, rng in zip(numbers, generators):
        with _named(f"run {number} of campaign {campaign.name}"):
            found.append(dict(campaign.run(rng)))
    _check_names(campaign, found[0])
    for one in found[1:]:
        _check_names(campaign, one)
    return _checked(
        campaign, {n: _column(campaign, n, [one[n] for one in found]) for n in campaign.measures}, len(numbers)
    )


@contextmanager
def _named(what: str) -> Iterator[None]:
    """Say which run failed; errors of shipid keep their words."""
    try:
        yield
    except ShipidError as error:
        raise RunError(f"{what} failed: {error}") from error
    except Exception as error:
        raise RunError(f"{what} failed: {type(error).__name__}: {error}. Correct it there.") from error


def _column(campaign: Campaign, name: str, values: list[Plain]) -> np.ndarray:
    try:
        return np.array(values, str if campaign.measures[name].kind == "text" else float)
    except (TypeError, ValueError):
        raise CampaignDeclarationError(
            f"the runs of campaign {campaign.name} return '{name}' with different lengths, or not as numbers."
        ) from None


def _check_names(campaign: Campaign, rows: Mapping[str, Plain]) -> None:
    if rows.keys() != campaign.measures.keys():
        missing = [n for n in campaign.measures if n not in rows]
        more = [n for n in rows if n not in campaign.measures]
        raise CampaignDeclarationError(
            f"a run of campaign {campaign.name} returns other measures than it declares"
            + (f"; missing: {', '.join(missing)}" if missing else "")
            + (f"; not declared: {', '.join(more)}" if more else "")
            + "."
        )


def _checked(campaign: Campaign, rows: Mapping[str, Plain], count: int) -> Rows:
    _check_names(campaign, rows)
    made: Rows = {}
    for name, measure in campaign.measures.items():
        column = np.asarray(rows[name])
        kinds = "U" if measure.kind == "text" else "fiub"
        if column.dtype.kind not in kinds or column.ndim not in (1, 2) or len(column) != count:
            raise CampaignDeclarationError(
                f"the measure '{name}' of campaign {campaign.name} has shape {column.shape} and type {column.dtype}; "
                f"{count} runs return {'texts' if measure.kind == 'text' else 'numbers'} of shape ({count},) or ({count}, k)."
            )
        made[name] = column if measure.kind == "text" else column.astype(float)
    return made
