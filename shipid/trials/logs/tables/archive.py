"""A log in a zip archive: the member that is named, or the only one that can be a log."""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path

from shipid.foundation.errors import nearest
from shipid.trials.errors import ChoiceError, ForeignFileError

#: What a zip archive begins with.
ZIP = b"PK\x03\x04"
#: What macOS packs beside the files.
_ASIDE = ("__MACOSX/", ".DS_Store")
#: Members by which an archive is a document of its own.
_DOCUMENTS = ("[Content_Types].xml", "mimetype")
#: What is packed beside a log, by suffix.
_BESIDE = frozenset(
    (".pdf", ".png", ".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".svg", ".doc", ".docx", ".ppt", ".pptx", ".md", ".html", ".htm", ".toml",
     ".ini", ".m", ".py", ".json", ".xml", ".rtf", ".mp4", ".fig", ".url", ".db")
)  # fmt: skip
_ARRAY = ".npy"


@dataclass(frozen=True)
class Member:
    """A file of an archive, expanded.

    Attributes
    ----------
    kind : str
        How it was packed, for the notes.
    content : bytes
        What it holds; one byte too many where it is too large.
    """

    kind: str
    content: bytes


def in_archive(file: Path, part: str | None) -> tuple[str | None, str | None]:
    """Split what stands behind ``FILE#`` into the member of an archive and the table in it.

    Parameters
    ----------
    file : Path
        The file.
    part : str or None
        ``log.csv``, ``book.xlsx#Sheet2``, or the table of a file that is no archive.

    Returns
    -------
    member : str or None
        The member; None where the file is no archive that has it.
    table : str or None
        What is left of `part`.

    Raises
    ------
    ChoiceError
        If the archive holds several files, and none of that name.
    """
    if part is None:
        return None, None
    try:
        with file.open("rb") as stream:
            if stream.read(4) != ZIP:
                return None, part
            stream.seek(0)
            with zipfile.ZipFile(stream) as archive:
                members = _logs(archive)
    except Exception:  # a damaged archive fails in many ways, and is told when it is opened
        return None, part
    if members is None:
        return None, part
    member, _, table = part.partition("#")
    found = _named(members, member)
    if found is not None:
        return found, table or None
    if len(members) == 1:
        return None, part  # a table of the only file
    raise ChoiceError(f"'{file}' holds no file '{member}'. {nearest(member, members)}".rstrip())


def member_of(data: bytes, file: Path, wanted: str | None, most: int) -> Member | None:
    """Return a file of a zip archive; None for a document that is packed as one.

    Parameters
    ----------
    data : bytes
        The archive.
    file : Path
        The file, for messages.
    wanted : str or None
        The member, as `in_archive` names it; by default the only one that can be a log.
    most : int
        Bytes that are read of it, and one more.

    Returns
    -------
    Member or None

    Raises
    ------
    ForeignFileError
        If the archive is damaged or holds no log, or several and none is named.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = _logs(archive)
            if members is None:
                return None
            name = wanted if wanted is not None else _only(members, file)
            with archive.open(name) as stream:
                content = stream.read(most + 1)
    except ForeignFileError:
        raise
    except Exception:  # a damaged archive fails in many ways, and one with a password in another
        raise ForeignFileError(f"'{file}' is a zip archive that cannot be opened. Unpack it first.") from None
    return Member("zip" if len(members) == 1 else f"zip: '{name}' of {len(members)} files", content)


def _logs(archive: zipfile.ZipFile) -> list[str] | None:
    """The files of an archive; None where it is a document."""
    members = [m.filename for m in archive.infolist() if not m.is_dir() and not m.filename.startswith(_ASIDE)]
    return None if any(name in _DOCUMENTS for name in members) else members


def _named(members: list[str], wanted: str) -> str | None:
    """The member of a name, with its folder or without where that is plain."""
    if wanted in members:
        return wanted
    same = [name for name in members if name.rpartition("/")[2].lower() == wanted.lower()]
    return same[0] if len(same) == 1 else None


def _only(members: list[str], file: Path) -> str:
    """The only member that can be a log."""
    if members and all(name.endswith(_ARRAY) for name in members):
        names = ", ".join(name.removesuffix(_ARRAY) for name in members[:8]) + (", ..." if len(members) > 8 else "")
        raise ForeignFileError(
            f"'{file}' holds arrays of NumPy (.npz): {names}. Write them as one table, CSV or Parquet, with names and units."
        )
    logs = [name for name in members if not _is_beside(name)] or members
    if len(logs) == 1:
        return logs[0]
    names = ", ".join(logs[:5]) + (", ..." if len(logs) > 5 else "")
    how = (
        f"Name one of them behind the file, as in {file}#{logs[0]}." if logs else "Check that it was copied completely."
    )
    raise ForeignFileError(f"'{file}' is a zip archive of {len(logs)} files{': ' * bool(logs)}{names}. {how}")


def _is_beside(name: str) -> bool:
    base = Path(name.lower())
    return base.suffix in _BESIDE or base.stem in (
        "readme",
        "read me",
        "liesmich",
        "license",
        "licence",
        "checksums",
        "md5sums",
    )
