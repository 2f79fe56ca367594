"""A fleet as a campaign: each file of a folder is a run, in which one model is identified from it."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from shipid.campaign.campaign import Campaign, Measure, Rows, run_number
from shipid.campaign.errors import CampaignRequestError
from shipid.campaign.store import FLEET, HEAD
from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError
from shipid.foundation.notices import Notice
from shipid.generation.system import generate
from shipid.identification.fit import Fit
from shipid.identification.identify import identify
from shipid.identification.uncertainty.estimates import published_names
from shipid.identification.validation.trial_findings import findings_of
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.parameter_file import parameter_table
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.replaced import with_values
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.logs.reading import read_trial
from shipid.trials.signals.ship_length import SHIP_LENGTH

#: What may come of a trial.
IDENTIFIED, NOT_CONVERGED, NOT_IDENTIFIED, NOT_READ, FAULT = (
    "identified", "did not converge", "not identified", "not read", "a fault of shipid",
)  # fmt: skip
#: What stands for the doctor where it could not read the trial.
NOT_EXAMINED = "not examined"
#: Columns of a coefficient beside its value.
PARTS = ("std", "low", "high", "standing")
#: Files that lie beside trials and are none.
_NO_TRIALS = {".toml", ".md", ".json", ".html", ".pdf", ".py", ".docx", ".png", ".jpg", ".jpeg"}
#: What commands leave in a folder of theirs; names that are listed at most.
_LEFT, _LISTED = (HEAD, "result.json"), 10


@dataclass(frozen=True)
class FleetSettings:
    """What is asked of every trial.

    Attributes
    ----------
    model : str
        A model's name, or path/to/file.py:Class.
    ship : str or None
        A ship's name, or the path of a parameter set.
    format : str or None
        A trial format file.
    window : tuple of float or None
        Part of every trial, in seconds of its clock.
    estimate : tuple of str or None
        Coefficients to estimate; the model's own choice by default.
    starts : int
        Starting points of each search.
    search_seed : int
        Of the random ones: the same for every trial, so that a row is what `shipid.identify` gives for it.
    values : tuple of (str, str)
        Values of the ship that are replaced, with their units.
    """

    model: str
    ship: str | None = None
    format: str | None = None
    window: tuple[float | None, float | None] | None = None
    estimate: tuple[str, ...] | None = None
    starts: int = 5
    search_seed: int = 0
    values: tuple[tuple[str, str], ...] = ()


def fleet_campaign(folder: str | Path, settings: FleetSettings) -> Campaign:
    """Return the campaign that identifies a model from each trial of a folder.

    Parameters
    ----------
    folder : str or Path
        Its files are the trials, in the order of their names; hidden files, folders, copies, and files of kinds that are no logs
        (TOML, JSON, HTML, Markdown, PDF, Word, Python, pictures) are left out; `not_read` says which.
    settings : FleetSettings
        What is asked of each.

    Returns
    -------
    Campaign

    Raises
    ------
    CampaignRequestError
        If there are no files.
    ShipidError
        If there is no such model or ship.
    """
    folder = Path(folder)
    files = trial_files(folder)
    if not files:
        why = "".join(f" {note[:1].upper()}{note[1:]}" for note in not_read(folder))
        raise CampaignRequestError(f"there are no trials in '{folder}'. Give the folder that holds their files.{why}")
    model = find_model(settings.model)
    ship = _ship(settings, model)
    names = coefficients_of(model, settings.estimate)
    measures = {
        "trial": Measure("text", meaning="file"),
        "outcome": Measure("text", meaning="what came of it"),
        "message": Measure("text", meaning="why"),
        "doctor": Measure("text", meaning="serious findings on the trial"),
        "samples": Measure("value", meaning="samples of the trial"),
        "chi_square": Measure("value", meaning="mean squared weighted residual per degree of freedom"),
    }
    for name, unit in names.items():
        measures[name] = Measure("value", unit, model[name].quantity.meaning)
        measures |= {f"{name}_{part}": Measure("value", unit, part) for part in PARTS[:3]}
        measures[f"{name}_{PARTS[3]}"] = Measure("text", meaning=f"what the trial says of {name}")
    digests = [_digest(folder / f) for f in files]
    about = [asdict(settings), files, digests, generate(model).digest, None if ship is None else parameter_table(ship)]
    identity = hashlib.sha256(json.dumps(about, default=str).encode()).hexdigest()
    run = FleetRun(str(folder.absolute()), tuple(files), settings, tuple(names))
    return Campaign(FLEET, run, measures, batch=1, engine="processes", most=len(files), identity=identity)


def _ship(settings: FleetSettings, model: Model) -> ParameterSet | None:
    """The ship, with the values that are replaced; None where none is named."""
    return with_values(find_ship(settings.ship), dict(settings.values), [model]) if settings.ship else None


def trial_files(folder: Path) -> list[str]:
    """Return the names of the files in a folder that are to be read as trials, in order: of files with one content, the first.

    Parameters
    ----------
    folder : Path
        The folder.
    """
    return [name for name, same in _logs(folder).items() if same is None]


def not_read(folder: Path) -> list[Notice]:
    """Return what lies in a folder beside its trials and might be taken for some: folders, links to nothing, copies.

    Parameters
    ----------
    folder : Path
        The folder.
    """
    inside = [p for p in folder.iterdir() if not p.name.startswith(".")]
    # What a command has written here, as by --out, is no folder of trials.
    below = sorted(
        p.name for p in inside if p.is_dir() and not any((p / left).exists() for left in _LEFT) and any(p.iterdir())
    )
    dead = sorted(p.name for p in inside if p.is_symlink() and not p.exists())
    copies = [f"{name} of {same}" for name, same in _logs(folder).items() if same is not None]
    told = (
        ("folders-not-read", below, "folders in it are not read, give them each by itself"),
        ("links-to-nothing", dead, "links that lead to no file are left out"),
        ("trial-twice", copies, "copies of a trial are left out, which would count twice"),
    )
    return [Notice(f"{words}: {listed(names)}.", kind, names=names) for kind, names, words in told if names]


def listed(names: Sequence[str]) -> str:
    """Return names in a row, the first ten of many.

    Parameters
    ----------
    names : sequence of str
        Of files.
    """
    return ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")


def _logs(folder: Path) -> dict[str, str | None]:
    """Files that may be trials, in the order of their names, and the one before with the same content; None where there is none."""
    files = sorted(
        p for p in folder.iterdir()
        if p.is_file() and not p.name.startswith(".") and p.suffix.lower() not in _NO_TRIALS
    )  # fmt: skip
    sizes = Counter(p.stat().st_size for p in files)
    first: dict[str, str] = {}
    same: dict[str, str | None] = {}
    for p in files:
        # Files without a byte are told one by one.
        content = _digest(p) if sizes[p.stat().st_size] > 1 and p.stat().st_size else p.name
        same[p.name] = first.get(content)
        first.setdefault(content, p.name)
    return same


def _digest(file: Path) -> str:
    """What stands for the content of a file; that of one which may not be read, its name: its row says why."""
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError:
        return file.name


def coefficients_of(model: Model, estimate: tuple[str, ...] | None) -> dict[str, str]:
    """Return the coefficients that a fleet has columns for, with their units.

    Parameters
    ----------
    model : Model
        The model.
    estimate : tuple of str or None
        What is to be estimated; by default what the model declares so.
    """
    wanted = estimate or tuple(n for n in model.parameters if model[n].quantity.estimated)
    names = dict.fromkeys([*wanted, *published_names(model)])
    return {n: model[n].unit for n in names}


@dataclass(frozen=True)
class FleetRun:
    """One run of a fleet: it reads a file, asks the doctor, and identifies; whatever fails is a row that says so.

    Attributes
    ----------
    folder : str
        Where the files lie; a worker elsewhere has to see it.
    files : tuple of str
        In order.
    settings : FleetSettings
        What is asked of each.
    names : tuple of str
        Coefficients with columns.
    """

    folder: str
    files: tuple[str, ...]
    settings: FleetSettings
    names: tuple[str, ...]

    def __call__(self, rng: np.random.Generator) -> dict[str, Plain]:
        """Return the row of one trial.

        Parameters
        ----------
        rng : numpy.random.Generator
            Says which one; nothing is drawn from it.

        Raises
        ------
        CampaignRequestError
            If the folder is not seen from here.
        """
        if not Path(self.folder).is_dir():
            raise CampaignRequestError(
                f"the worker does not see the folder '{self.folder}'; share it, or run without a cluster."
            )
        file = self.files[run_number(rng)]
        row: dict[str, Plain] = {
            "trial": file,
            "outcome": "",
            "message": "",
            "doctor": NOT_EXAMINED,
            "samples": np.nan,
            "chi_square": np.nan,
        }
        row |= {column: np.nan for n in self.names for column in (n, *(f"{n}_{part}" for part in PARTS[:3]))}
        row |= {f"{n}_{PARTS[3]}": "" for n in self.names}
        try:
            self._fill(row, Path(self.folder) / file)
        except Exception as error:  # one trial does not end a campaign
            row |= {"outcome": FAULT, "message": f"{type(error).__name__}: {error}"}
        return row

    def _fill(self, row: dict[str, Plain], path: Path) -> None:
        asked = self.settings
        ship = _ship(asked, find_model(asked.model))
        try:
            trial = read_trial(path, format=asked.format, window=asked.window)
        except ShipidError as error:
            row |= {
                "outcome": NOT_READ,
                "message": str(error),
                "doctor": _examined(lambda: check_trial(path, ship, asked.format)),
            }
            return
        row["samples"] = len(trial)
        row["doctor"] = _examined(lambda: check_trial(trial, ship))
        try:
            fit = identify(
                find_model(asked.model), [trial], ship=ship, estimate=asked.estimate, starts=asked.starts, seed=asked.search_seed
            )  # fmt: skip
        except ShipidError as error:
            row |= {"outcome": NOT_IDENTIFIED, "message": str(error)}
            return
        bearing = [
            f.finding.kind
            for f in findings_of(fit.ship, fit.fitted, (), fit.model.inputs, fit.identified.method)
            if f.finding.serious and f.bears
        ] + [n.kind for n in fit.warnings if n.kind == SHIP_LENGTH]
        row |= {
            "doctor": ", ".join(dict.fromkeys(bearing)),
            "chi_square": fit.chi_square,
            **_coefficients(fit, self.names),
        }
        row["outcome"] = IDENTIFIED if fit.converged else NOT_CONVERGED
        row["message"] = "" if fit.converged else fit.message


def _examined(examine: Callable[[], Plain]) -> str:
    """Kinds of the serious findings of the doctor, or that it could not read the file either."""
    try:
        return ", ".join(dict.fromkeys(f.kind for f in examine().findings if f.serious))
    except ShipidError:
        return NOT_EXAMINED


def _coefficients(fit: Fit, names: tuple[str, ...]) -> Rows | dict[str, Plain]:
    """Columns of the coefficients; what a search that did not converge ended with is no value."""
    row: dict[str, Plain] = {}
    for name in names:
        found = fit.parameters.get(name)
        if found is None or not fit.converged:
            continue
        low, high = found.ci95 or (None, None)
        row[f"{name}_{PARTS[3]}"] = found.standing
        for column, value in (
            (name, found.value),
            (f"{name}_std", found.std),
            (f"{name}_low", low),
            (f"{name}_high", high),
        ):
            row[column] = np.nan if value is None else value
    return row
