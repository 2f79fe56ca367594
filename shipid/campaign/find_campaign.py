"""Finding a campaign: by the name of a shipped one, or in a file, ``path/to/file.py:name``."""

from __future__ import annotations

import functools
import hashlib
import importlib
import pkgutil
import sys
import traceback
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

from shipid.campaign import shipped
from shipid.campaign.campaign import Campaign
from shipid.campaign.errors import CampaignDeclarationError
from shipid.foundation.errors import ShipidError, UnknownNameError, nearest


@dataclass(frozen=True)
class CampaignFile:
    """A campaign in a file, as it is sent to a worker: the text travels, so that a worker needs no copy of the file.

    Attributes
    ----------
    path : str
        Where the file lies; what lies beside it can be imported where the worker sees that folder.
    name : str
        Of the campaign in it.
    text : str
        Its content.
    """

    path: str
    name: str
    text: str

    def campaign(self) -> Campaign:
        """Return the campaign that the file declares; its identity is the hash of the file."""
        return _declared(self)


def find_campaign(name: str) -> Campaign | CampaignFile:
    """Return a campaign by name.

    Parameters
    ----------
    name : str
        That of a shipped one, or ``path/to/file.py:name``; a file with one campaign needs no name.

    Returns
    -------
    Campaign or CampaignFile

    Raises
    ------
    UnknownNameError
        If there is none; the message offers the nearest.
    CampaignDeclarationError
        If the file cannot be loaded, with the line that fails.
    """
    if ".py" not in name:
        known = shipped_campaigns()
        if name not in known:
            raise UnknownNameError(
                "campaign",
                name,
                known,
                "A campaign of your own is given as path/to/file.py:name, trials as their folder.",
            )
        return known[name]
    text, colon, attribute = name.rpartition(":")
    if not colon or not text.endswith(".py"):
        text, attribute = name, ""
    path = Path(text)
    try:
        content = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text in UTF-8"
        raise CampaignDeclarationError(f"the campaign file {path} cannot be read: {reason}. Check the path.") from None
    found = _campaigns_in(_module(str(path.absolute()), content))
    if not attribute and len(found) == 1:
        attribute = next(iter(found))
    if not attribute:
        hint = nearest("", found) if found else "It declares no campaign: shipid.Campaign(...)."
        raise CampaignDeclarationError(f"say which campaign of {path}: {path}:NAME. {hint}".strip())
    if attribute not in found:
        raise UnknownNameError(f"campaign in {path} called", attribute, found)
    return CampaignFile(str(path.absolute()), attribute, content)


def shipped_campaigns() -> dict[str, Campaign]:
    """Return the campaigns that come with the installation, by name."""
    modules = [importlib.import_module(f"{shipped.__name__}.{m.name}") for m in pkgutil.iter_modules(shipped.__path__)]
    return {c.name: c for m in modules for c in _campaigns_in(m).values()}


def whole(campaign: Campaign | CampaignFile) -> Campaign:
    """Return the campaign itself.

    Parameters
    ----------
    campaign : Campaign or CampaignFile
        What was found.
    """
    return campaign.campaign() if isinstance(campaign, CampaignFile) else campaign


def _campaigns_in(module: ModuleType) -> dict[str, Campaign]:
    return {n: t for n, t in vars(module).items() if isinstance(t, Campaign)}


@functools.lru_cache(maxsize=8)
def _declared(file: CampaignFile) -> Campaign:
    found = _campaigns_in(_module(file.path, file.text))[file.name]
    return replace(found, identity=hashlib.sha256(file.text.encode()).hexdigest())


@functools.lru_cache(maxsize=8)
def _module(path: str, text: str) -> ModuleType:
    """Run a file; its name is that of the text, so that what it declares has one home on every worker."""
    name = f"shipid_campaign_{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    module = ModuleType(name)
    module.__file__ = path
    sys.modules[name] = module
    folder = str(Path(path).parent)
    if folder not in sys.path:
        sys.path.append(folder)
    try:
        exec(compile(text, path, "exec"), module.__dict__)
    except ShipidError as error:
        error.args = (f"{path}: {error}",)
        raise
    except (Exception, SystemExit) as error:
        frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == path]
        line = getattr(error, "lineno", None) or (frames[-1].lineno if frames else 1)
        raise CampaignDeclarationError(
            f"the campaign file {path} fails in line {line}: {type(error).__name__}: {error}. Correct it there."
        ) from None
    return module
