"""What kind of file it is, by what it begins with; what is no table is named for what it is."""

from __future__ import annotations

import io
import re
import struct
import zipfile
from enum import StrEnum
from pathlib import Path

from shipid.trials.errors import ForeignFileError


class Kind(StrEnum):
    """A kind of file that is read."""

    TEXT = "text"
    EXCEL = "Excel"
    MATLAB = "MATLAB"
    HDF5 = "HDF5"
    PARQUET = "Parquet"


_HDF5 = b"\x89HDF\r\n\x1a\n"
_EXPORT = "Export the table to CSV, Excel (.xlsx), MATLAB (.mat), HDF5 or Parquet."

#: By what it begins with: what it is, and what to do.
_FOREIGN: tuple[tuple[bytes, str, str], ...] = (
    (b"%PDF", "a PDF document", "A table cannot be read out of it; ask for the log itself."),
    (b"\x89PNG", "a PNG picture", "A table cannot be read out of it; ask for the log itself."),
    (b"\xff\xd8\xff", "a JPEG picture", "A table cannot be read out of it; ask for the log itself."),
    (b"GIF8", "a GIF picture", "A table cannot be read out of it; ask for the log itself."),
    (b"II*\0", "a TIFF picture", "A table cannot be read out of it; ask for the log itself."),
    (b"MM\0*", "a TIFF picture", "A table cannot be read out of it; ask for the log itself."),
    (b"SQLite format 3\0", "an SQLite database", _EXPORT),
    (b"\x7fELF", "a program (ELF)", "Check the path."),
    (b"MZ", "a program for Windows, or a library of it", "Check the path."),
    (b"\xca\xfe\xba\xbe", "a compiled program", "Check the path."),
    (b"\xcf\xfa\xed\xfe", "a program for macOS", "Check the path."),
    (b"\0asm", "a WebAssembly program", "Check the path."),
    (b"#ROSBAG", "a ROS bag", "Export its topics to CSV."),
    (b"\x89MCAP0", "an MCAP recording (ROS 2)", "Export its topics to CSV."),
    (b"MDF     ", "a measurement file of ASAM (MDF)", _EXPORT),
    (b"UnFinMF ", "a measurement file of ASAM (MDF) that was not finished", _EXPORT),
    (b"TDSm", "a measurement file of LabVIEW (TDMS)", _EXPORT),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a document of the old Office", "Save it in the kind of today."),
    (b"{\\rtf", "a document in RTF", "Save the table as CSV."),
    (b"%!PS", "a PostScript document", "A table cannot be read out of it; ask for the log itself."),
    (b"\x93NUMPY", "an array of NumPy (.npy)", "Write it as CSV or Parquet, with names and units."),
    (b"ARROW1", "a Feather file (Arrow)", "Write it as Parquet."),
    (b"ORC", "an ORC file", "Write it as Parquet."),
    (b"Obj\x01", "an Avro file", "Write it as Parquet."),
    (b"CDF\x01", "a NetCDF file of the old kind", "Convert it to NetCDF 4 (HDF5), or to CSV."),
    (b"CDF\x02", "a NetCDF file of the old kind", "Convert it to NetCDF 4 (HDF5), or to CSV."),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "Unpack it and name the log in it."),
    (b"Rar!", "a RAR archive", "Unpack it and name the log in it."),
    (b"\x28\xb5\x2f\xfd", "a file compressed by zstd", "Expand it first."),
    (b"\x04\x22\x4d\x18", "a file compressed by lz4", "Expand it first."),
    (b"RIFF", "a sound or video file (RIFF)", "Check the path."),
    (b"OggS", "a sound or video file (Ogg)", "Check the path."),
    (b"ID3", "a sound file (MP3)", "Check the path."),
    (b"\xd4\xc3\xb2\xa1", "a recording of network traffic (pcap)", _EXPORT),
    (b"\x0a\x0d\x0d\x0a", "a recording of network traffic (pcapng)", _EXPORT),
    (b"HDF", "no HDF5 file", "Check that it was copied completely."),
)
#: By suffix, where it begins like any text.
_SOURCES = {
    ".m": ("a script of MATLAB", "Name the log that it reads, or the .mat file that it writes."),
    ".py": ("a script of Python", "Name the log that it reads or writes."),
    ".md": ("a text with marks (Markdown)", "Name the log itself."),
    ".tex": ("a text for LaTeX", "Name the log itself."),
}
_PICKLE = re.compile(rb"\x80[\x02-\x05](?:\x95|[}\](c)q])")
_OLD_EXCEL = ("Workbook".encode("utf-16-le"), "Book".encode("utf-16-le"))
_MARKUP = re.compile(rb"\s*<(?:!DOCTYPE\s+html|html|head|body)\b", re.IGNORECASE)
_XML = re.compile(rb"\s*<(?:\?xml|[A-Za-z][\w:.-]*(?:\s|>|/))")
_JSON = re.compile(
    rb"\s*(?:\{\s*(?:\"|\}|$)|\[\s*(?:[\[{\]]|\"[^\"\n]*\"\s*[:,\]]\s*(?:$|[\[{\"])|-?[0-9.]+\s*,\s*\n))"
)
_SCRIPT = re.compile(
    rb"\s*(?:#!|(?:%[^\n]*\n\s*)*(?:function\b|classdef\b|clear\s+all|clc\b|close\s+all)|"
    rb"(?:#[^\n]*\n\s*|\"\"\"[^\"]*\"\"\"\s*)*(?:import\s+\w+|from\s+[\w.]+\s+import\b|def\s+\w+\())"
)
_TOML = re.compile(rb"(?m)^\s*\[columns(?:\.\w+)?\]\s*$")


def kind_of(data: bytes, file: Path) -> Kind:
    """Return what kind of file it is.

    Parameters
    ----------
    data : bytes
        What it holds, expanded.
    file : Path
        The file, for messages; its suffix decides for MATLAB files of version 4, which have no mark.

    Returns
    -------
    Kind

    Raises
    ------
    ForeignFileError
        If it is none that is read; the message names what it is and says what to do.
    """
    if data.startswith(b"PAR1"):
        return Kind.PARQUET
    if any(data[at : at + 8] == _HDF5 for at in (0, 512, 1024, 2048, 4096)):
        return Kind.MATLAB if data.startswith(b"MATLAB") else Kind.HDF5
    if data.startswith(b"MATLAB 5.0 MAT-file") or _is_matlab_4(data, file):
        return Kind.MATLAB
    if data.startswith(b"PK\x03\x04"):
        return _office(data, file)
    found = _foreign(data) or _SOURCES.get(file.suffix.lower())
    if found is None and not data.strip(b"\0"):
        found = ("a file of zeros", "The logger or a copy of its file was interrupted: look for another copy.")
    if found is None and _is_binary(data):
        found = ("a binary file of a kind that is not known", _EXPORT)
    if found is not None:
        raise _named(file, *found)
    return Kind.TEXT


def is_utf16(data: bytes) -> str | None:
    """Return the byte order of UTF-16, stated by a mark or seen in the zeros beside plain letters.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    str or None
        The encoding; None where it is another one.
    """
    if data.startswith((b"\xff\xfe\0\0", b"\0\0\xfe\xff")):
        return "utf-32"
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    head = data[:4000]
    even, odd = head[::2], head[1::2]
    if len(odd) < 4:
        return None
    low, high = even.count(0) / len(even), odd.count(0) / len(odd)
    if high > 0.8 and low < 0.05:
        return "utf-16-le"
    return "utf-16-be" if low > 0.8 and high < 0.05 else None


def _named(file: Path, what: str, remedy: str) -> ForeignFileError:
    return ForeignFileError(f"'{file}' is {what}. {remedy}")


def _foreign(data: bytes) -> tuple[str, str] | None:
    """What a file is that is no table, and what to do; None where nothing says so."""
    if data.startswith(b"\xd0\xcf\x11\xe0") and any(mark in data for mark in _OLD_EXCEL):
        return "an Excel workbook of the old kind (.xls)", "Save it as .xlsx, or the sheet as CSV."
    for magic, what, remedy in _FOREIGN:
        if data.startswith(magic) and (not magic.isalnum() or _is_binary(data)):
            return what, remedy
    if data[257:262] == b"ustar":
        return "a tar archive", "Unpack it and name the log in it."
    if _PICKLE.match(data):
        return "a pickle of Python, which can run programs and is never opened", "Write the table as CSV or Parquet."
    head = data[:4096].removeprefix(b"\xef\xbb\xbf")
    if _MARKUP.match(head):
        return "a web page (HTML)", "Save the table as CSV."
    if _XML.match(head):
        return "an XML file", "Save the table as CSV."
    if _JSON.match(head):
        return "a JSON file", "Write its records as CSV, with names and units in the header."
    if _SCRIPT.match(head):
        return "a script", "Name the log that it reads or writes."
    if _TOML.search(data[:65536]):
        return "a format file", "Name it behind --format, and the log that it describes as the trial."
    return None


def _is_binary(data: bytes) -> bool:
    """Whether a file holds what no text holds: control characters in numbers."""
    if is_utf16(data):
        return False
    head = data[:65536].rstrip(b"\0\x1a")
    if not head:
        return True
    kept = head.translate(None, bytes([*range(9), 11, *range(14, 27), *range(28, 32), 127]))
    return len(head) - len(kept) > max(0.02 * len(head), 2) or (len(kept) < len(head) and not {10, 13} & set(head))


def _is_matlab_4(data: bytes, file: Path) -> bool:
    """Whether the first variable of a MATLAB file of version 4 begins here: five whole numbers without a mark."""
    if (file.suffix.lower() != ".mat" and b".mat" not in file.name.lower().encode()) or len(data) < 20:
        return False
    for order in "<>":
        kind, rows, columns, imaginary, length = struct.unpack(order + "5i", data[:20])
        if kind in range(0, 5000) and min(rows, columns) >= 0 and imaginary in (0, 1) and 0 < length <= 64:
            return True
    return False


def _office(data: bytes, file: Path) -> Kind:
    """An Excel workbook among the documents that are zip archives."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = set(archive.namelist())
            mimetype = archive.read("mimetype")[:80] if "mimetype" in names else b""
    except Exception:  # a damaged archive fails in many ways
        raise _named(file, "a damaged zip archive or Excel workbook", "Check that it was copied completely.") from None
    if b"spreadsheet" in mimetype:
        raise _named(file, "a sheet of LibreOffice (.ods)", "Save it as .xlsx, or the sheet as CSV.")
    if "xl/workbook.bin" in names:
        raise _named(file, "a binary Excel workbook (.xlsb)", "Save it as .xlsx, or the sheet as CSV.")
    if any(name.startswith("word/") for name in names):
        raise _named(file, "a document of Word (.docx)", "Save the table as CSV.")
    if any(name.startswith("ppt/") for name in names):
        raise _named(file, "a presentation (.pptx)", "Save the table as CSV.")
    if any(name.startswith("xl/") for name in names):
        return Kind.EXCEL
    raise _named(file, "a document that is packed as a zip archive", "Save the table in it as CSV.")
