"""The folder of a campaign: what it is, and its finished batches, each written whole or not at all.

::

    DIR/campaign.json     name, seed, size of a batch, identity of the study, measures, versions
    DIR/batches/000000.npz  runs 0 to batch - 1, one array a measure
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from shipid.campaign.campaign import RUN, Campaign, Measure, Rows
from shipid.campaign.errors import CampaignFolderError, CampaignRequestError
from shipid.foundation.aliases import Plain
from shipid.foundation.replacing import replacing, write_text

HEAD = "campaign.json"
_BATCHES = "batches"
#: The campaign over the trials of a folder.
FLEET = "fleet"
#: What has to agree where runs are added.
_SAME = {
    "campaign": "campaign",
    "seed": "seed",
    "batch": "size of a batch",
    "identity": "study file",
    "measures": "measures",
}


@dataclass(frozen=True)
class Store:
    """Finished runs on disk.

    Attributes
    ----------
    folder : Path
        Where.
    head : mapping
        The content of ``campaign.json``.
    """

    folder: Path
    head: Mapping[str, Plain]

    @property
    def batch(self) -> int:
        """Runs in a batch."""
        return int(self.head["batch"])

    @property
    def measures(self) -> dict[str, Measure]:
        """What was measured."""
        return {n: Measure(**m) for n, m in self.head["measures"].items()}

    def numbers(self, index: int, runs: int) -> range:
        """Return the runs of a batch.

        Parameters
        ----------
        index : int
            Of the batch.
        runs : int
            How many the whole campaign has.
        """
        return range(index * self.batch, min((index + 1) * self.batch, runs))

    def missing(self, runs: int) -> list[int]:
        """Return the batches that are still to be run.

        Parameters
        ----------
        runs : int
            How many runs the campaign is to have.

        Raises
        ------
        CampaignRequestError
            If more runs are there than asked for.
        """
        count = -(-runs // self.batch)
        there = self._there()
        most = max(((self._numbers_in(i) or [-1])[-1] + 1 for i in there if i >= count - 1), default=0)
        if most > runs:
            raise CampaignRequestError(f"{self.folder} holds {most} runs already; ask for as many or more with --runs.")
        full = [i for i in range(count) if i not in there or len(self._numbers_in(i)) != len(self.numbers(i, runs))]
        return full

    def done(self) -> int:
        """Return how many runs are finished."""
        return sum(len(self._numbers_in(i)) for i in self._there())

    def write(self, index: int, numbers: range, rows: Rows) -> None:
        """Write a finished batch.

        Parameters
        ----------
        index : int
            Of the batch.
        numbers : range
            Its runs.
        rows : dict of str to ndarray
            Their measures.
        """
        with replacing(self._path(index)) as temporary, zipfile.ZipFile(temporary, "w") as archive:
            for name, column in {RUN: np.array(numbers), **rows}.items():
                with archive.open(f"{name}.npy", "w") as stream:
                    np.lib.format.write_array(stream, column, allow_pickle=False)

    def batches(self, runs: int) -> Iterator[Rows]:
        """Yield the finished batches in order, one in memory at a time.

        Parameters
        ----------
        runs : int
            How many runs the campaign has.

        Raises
        ------
        CampaignFolderError
            If one is missing.
        """
        for index in range(-(-runs // self.batch)):
            try:
                with np.load(self._path(index), allow_pickle=False) as stored:
                    yield {n: stored[n] for n in (RUN, *self.head["measures"])}
            except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
                raise CampaignFolderError(
                    f"{self._path(index)} is missing or damaged: {error}. Add --resume to run it again."
                ) from None

    def _path(self, index: int) -> Path:
        return self.folder / _BATCHES / f"{index:06d}.npz"

    def _there(self) -> set[int]:
        return {int(p.stem) for p in (self.folder / _BATCHES).glob("*.npz") if p.stem.isdigit()}

    def _numbers_in(self, index: int) -> list[int]:
        """The runs of a stored batch; none where the file is damaged, which is then run again."""
        try:
            with np.load(self._path(index), allow_pickle=False) as stored:
                return [int(n) for n in stored[RUN]]
        except (OSError, ValueError, KeyError, zipfile.BadZipFile):
            return []


def open_store(
    folder: Path, campaign: Campaign, seed: int, *, resume: bool, overwrite: bool, about: Mapping[str, Plain]
) -> Store:
    """Begin the folder of a campaign, or go on with one.

    Parameters
    ----------
    folder : Path
        Where.
    campaign : Campaign
        The study.
    seed : int
        Of the campaign.
    resume, overwrite : bool
        What to do with runs that are there: go on with them, or begin again.
    about : mapping
        Provenance.

    Returns
    -------
    Store

    Raises
    ------
    CampaignRequestError
        If runs are there and neither is asked for, or they are not of this campaign.
    CampaignFolderError
        If the head of the folder is damaged.
    """
    head = {
        "campaign": campaign.name,
        "seed": seed,
        "batch": campaign.batch,
        "identity": campaign.identity,
        "measures": {n: asdict(m) for n, m in campaign.measures.items()},
        "provenance": dict(about),
    }
    if (folder / HEAD).exists():
        if resume:
            store = read_store(folder)
            words = {**_SAME, "identity": "set of trials, model, ship or settings"} if campaign.name == FLEET else _SAME
            other = [words[key] for key in _SAME if store.head[key] != head[key]]
            if other:
                raise CampaignRequestError(
                    f"{folder} holds runs with another {' and another '.join(other)}: they do not mix with these. "
                    "Choose another --out, or add --overwrite without --resume to begin again."
                )
            return store
        if not overwrite:
            raise CampaignRequestError(
                f"{folder} holds {read_store(folder).done()} finished runs of a campaign. Add --resume to go on with them, "
                "or --overwrite to begin again."
            )
        (folder / HEAD).unlink()
    (folder / _BATCHES).mkdir(parents=True, exist_ok=True)
    for left in (folder / _BATCHES).glob("*.npz"):
        left.unlink()
    write_text(folder / HEAD, json.dumps(head, indent=1) + "\n")
    return Store(folder, head)


def read_store(folder: Path) -> Store:
    """Return the folder of a campaign as it lies there.

    Parameters
    ----------
    folder : Path
        Where.

    Raises
    ------
    CampaignFolderError
        If there is no campaign, or its head is damaged.
    """
    path = folder / HEAD
    try:
        head = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CampaignFolderError(f"{path} cannot be read: {error}. Choose another folder.") from None
    if not isinstance(head, dict) or not {*_SAME, "provenance"} <= set(head):
        raise CampaignFolderError(f"{path} is not the head of a campaign: entries are missing. Choose another folder.")
    return Store(folder, head)
