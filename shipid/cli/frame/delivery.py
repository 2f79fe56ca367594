"""How a command hands over its result: printed as text or JSON, and written to a folder, whole or not at all.

The options ``--out``, ``--open``, ``--pdf``, ``--overwrite`` and ``--json`` stand here only. The folder is looked at before the work
is done, and filled after it.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeAlias, TypeVar

import click

from shipid.cli.frame.envelope import envelope, inputs_given, json_text
from shipid.cli.frame.messages import progress, say, typed, warned
from shipid.foundation.aliases import Plain
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.notices import plain_notices
from shipid.foundation.printable import printable

if TYPE_CHECKING:
    from shipid.foundation.result import Result
    from shipid.report.write_report import Reported

#: What writes a file to the path it is given.
Writer: TypeAlias = Callable[[Path], object]
#: A function that becomes a command.
Command = TypeVar("Command", bound=Callable[..., object])
#: Significant digits of a number in a table of estimates.
_DIGITS = 9
#: Where the context of a command keeps itself if JSON is asked for, and whether a result was printed.
ASKED, PRINTED = "shipid.json", "shipid.printed"
#: The files of a result that every command names alike.
RESULT, REPORT = "result.json", "report.html"
_PDF = "report.pdf"
#: Endings of files that are written: a folder is not called so by intent.
_OF_FILES = {".html", ".htm", ".pdf", ".json", ".toml", ".csv"}


def _keep_asked(context: click.Context, _parameter: click.Parameter, asked: bool) -> bool:
    """Keep that JSON is asked for where an error can be told in it."""
    if asked:
        context.meta[ASKED] = context
    return asked


# Eager: it is known before another option is refused.
json_option = click.option("--json", "as_json", is_flag=True, is_eager=True, callback=_keep_asked, help="Print JSON.")
overwrite_option = click.option("--overwrite", is_flag=True, help="Replace files that exist.")
_open_option = click.option("--open", "open_report", is_flag=True, help="Open the report in the browser; with --out.")

_pdf_option = click.option("--pdf", "as_pdf", is_flag=True, help=f"Write {_PDF} too; with --out, needs Chromium.")


class Decorator(Protocol):
    """What gives a command options."""

    def __call__(self, function: Command, /) -> Command:
        """Return the command with them.

        Parameters
        ----------
        function : callable
            The command.
        """


class Deliverable(Protocol):
    """A result in words and in plain values."""

    def text(self) -> str:
        """Return everything the result says, in lines of text."""

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as JSON can hold it."""


@dataclass(frozen=True)
class Delivery:
    """Where the result of a command goes.

    Attributes
    ----------
    as_json : bool
        Whether it is printed as JSON instead of text.
    folder : Path or None
        The folder of ``--out``.
    files : tuple of str
        Names of the files that are written into the folder.
    open_report : bool
        Whether the report is opened in the browser.
    overwrite : bool
        Whether files that exist are replaced.
    inputs : list of dict
        The files the command was given, with the hash of what they held when it began.
    command : str
        The command as it was typed, with the quotes of a shell.
    """

    as_json: bool
    folder: Path | None = None
    files: tuple[str, ...] = ()
    open_report: bool = False
    overwrite: bool = False
    inputs: list[dict[str, Plain]] = field(default_factory=inputs_given)
    command: str = field(default_factory=typed)

    def progress(self) -> AbstractContextManager[Callable[[str], None]]:
        """Return a context manager that shows what is being done; silent where JSON is asked for."""
        return progress(self.as_json)

    def table(self, result: Result) -> Writer:
        """Return what writes the table of a result as CSV, numbers with nine digits.

        Parameters
        ----------
        result : Result
            Its ``to_frame`` is written.
        """

        def write(path: Path) -> None:
            from shipid.foundation.result import csv_of

            path.write_text(csv_of(result.to_frame(), _DIGITS), encoding="utf-8", newline="\n")

        return write

    def report(self, result: Reported, **more: Plain) -> Writer:
        """Return what writes the page of a result, with the command that made it.

        Parameters
        ----------
        result : FilterRun, Fit, Judgement or another result that has a page
            See `shipid.report.write_report`.
        **more
            Further arguments of `shipid.report.write_report`.
        """

        def write(path: Path) -> None:
            from shipid.report.write_report import write_report

            write_report(result, path, command=self.command, **more)

        return write

    def hand_over(self, result: Deliverable, writers: Mapping[str, Writer] | None = None) -> ExitCode:
        """Write the files of a result, print it, and open its report.

        Parameters
        ----------
        result : Deliverable
            Its `text` is printed, or its ``to_dict`` as JSON.
        writers : mapping of str to callable, optional
            What writes the files beside ``result.json``, by name; called only where there is a folder.

        Returns
        -------
        ExitCode
            See `hand_over_parts`.
        """
        return self.hand_over_parts(result.to_dict(), result.text(), writers)

    def hand_over_parts(
        self, data: dict[str, Plain], text: str, writers: Mapping[str, Writer] | None = None
    ) -> ExitCode:
        """Hand over a result that is not one object: see `hand_over`.

        Parameters
        ----------
        data : dict
            What is printed and written as JSON, in the envelope of `shipid.cli.frame.envelope`.
        text : str
            What is printed otherwise.
        writers : mapping of str to callable, optional
            See `hand_over`.

        Returns
        -------
        ExitCode
            `ExitCode.DOUBTFUL` where a warning of the result is serious.

        Raises
        ------
        Exception
            Whatever kept the files from being written; the result is printed before.
        """
        data = self.enveloped(data)
        failed: Exception | None = None
        if self.folder is not None:
            all_writers = {RESULT: _json_writer(data), **(writers or {})}
            if _PDF in self.files:
                all_writers[_PDF] = _print_page
            assert set(all_writers) == set(self.files), "the files written are those that were looked for"
            try:
                with self.progress() as tell:
                    tell("writing the report")
                    _fill(self.folder, {name: all_writers[name] for name in self.files}, self.overwrite)
            except Exception as error:  # a full disk must not cost the result of an hour: it is printed first
                failed = error
        if self.as_json:
            click.echo(json_text(data))
            click.get_current_context().meta[PRINTED] = True
        else:
            click.echo(printable(text))
            if self.folder is not None and failed is None:
                click.echo(f"written: {', '.join(str(self.folder / n) for n in self.files)}")
        if failed is not None:
            raise failed
        if self.open_report and self.folder is not None:
            _open(self.folder / REPORT)
        return ExitCode.DOUBTFUL if any(w["serious"] for w in data["warnings"]) else ExitCode.DONE

    def enveloped(self, data: dict[str, Plain]) -> dict[str, Plain]:
        """Return a result as it is printed as JSON, with what was said while it was made among its warnings.

        Parameters
        ----------
        data : dict
            The result.
        """
        return envelope(data | {"warnings": [*data.get("warnings", []), *plain_notices(warned())]}, self.inputs)


def delivered(
    *files: str, instead: Mapping[str, Sequence[str]] | None = None, replaced_by: str | None = None
) -> Decorator:
    """Return a decorator that gives a command the options of its result; the command gets a `Delivery` as `delivery`.

    Parameters
    ----------
    *files : str
        What the command writes into a folder; without any, the only option is ``--json``.
    instead : mapping of str to sequence of str, optional
        By the name of an option: what the command writes where that option is given.
    replaced_by : str, optional
        An option that lets files be replaced as ``--overwrite`` does.

    Raises
    ------
    UsageError
        When the command runs: if ``--open`` or ``--pdf`` is given without ``--out``, or the folder cannot be used.
    MissingExtraError
        When the command runs: if there is no browser to print a page with.
    """
    *others, last = files or ("",)
    listed = f"{', '.join(others)} and {last}" if others else last
    out_option = click.option("--out", metavar="DIR", help=f"Folder for {listed}.")
    options = [json_option]
    if files:
        options += [overwrite_option, *([_open_option, _pdf_option] if REPORT in files else []), out_option]

    def decorate(function: Command) -> Command:
        @functools.wraps(function)
        def command(
            *arguments: object,
            as_json: bool,
            out: str | None = None,
            open_report: bool = False,
            as_pdf: bool = False,
            overwrite: bool = False,
            **values: object,
        ) -> object:
            expected = next((f for option, f in (instead or {}).items() if values.get(option)), files)
            if open_report and out is None:
                raise click.UsageError("--open opens the report of --out DIR, which is not given.")
            if as_pdf:
                expected = _with_pdf(expected, out)
            overwrite = overwrite or bool(replaced_by and values.get(replaced_by))
            folder = _result_folder(out, expected, overwrite)
            delivery = Delivery(as_json, folder, tuple(expected), open_report, overwrite)
            return function(*arguments, delivery=delivery, **values)

        decorated: Command = functools.reduce(lambda made, option: option(made), options, command)  # type: ignore[assignment]
        return decorated

    return decorate


def _with_pdf(expected: Sequence[str], out: str | None) -> tuple[str, ...]:
    """The files with the printed page; refused before the work is done where nothing can print."""
    from shipid.report.pdf import browser

    if out is None or REPORT not in expected:
        raise click.UsageError("--pdf prints the report of --out DIR, which is not given.")
    browser()
    return (*expected, _PDF)


def _print_page(path: Path) -> None:
    """Print the page that was written beside it."""
    from shipid.report.pdf import write_pdf

    write_pdf(path.with_name(REPORT), path)


def output_file(path: str, overwrite: bool) -> Path:
    """Return the file of ``--output``, refused before the work is done where it cannot be written.

    Parameters
    ----------
    path : str
        The option.
    overwrite : bool
        Whether it may exist.

    Raises
    ------
    UsageError
        If it exists and may not be replaced.
    MissingFileError
        If it is a folder, or its folder does not exist.
    OverwriteError
        If it is a device, a pipe, or a link.
    """
    from shipid.foundation.errors import UsageError
    from shipid.foundation.replacing import check_place

    if Path(path).is_file() and not Path(path).is_symlink() and not overwrite:
        raise UsageError(f"{path} exists already. Choose another --output, or add --overwrite.")
    check_place(Path(path), overwrite)
    return Path(path)


def output_or_stdout(path: str | None, overwrite: bool) -> Path | None:
    """Return the file of an ``--output`` that may be left out, as `output_file`; None for standard output, which ``-`` names too.

    Parameters
    ----------
    path : str or None
        The option.
    overwrite : bool
        Whether it may exist.
    """
    return None if path in (None, "-") else output_file(str(path), overwrite)


def _result_folder(out: str | None, files: Sequence[str], overwrite: bool) -> Path | None:
    from shipid.foundation.errors import UsageError
    from shipid.foundation.replacing import check_kind

    if out is None:
        return None
    folder = Path(out)
    if out == "-":
        raise UsageError(f"--out names a folder, and - is none: it will hold {', '.join(files)}. Give it a name.")
    if folder.suffix.lower() in _OF_FILES and not folder.is_dir():
        raise UsageError(
            f"--out names a folder, and {out} looks like a file. Write --out {folder.with_suffix('')}: it will hold "
            f"{', '.join(files)}."
        )
    for name in files:
        check_kind(folder / name)
    there = [n for n in files if (folder / n).exists()]
    if there and not overwrite:
        raise UsageError(f"{folder} holds {', '.join(there)} already. Choose another --out, or add --overwrite.")
    if folder.is_symlink() and not folder.exists():
        raise UsageError(f"{folder} is a link that leads nowhere; --out wants a folder.")
    nearest = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not nearest.is_dir():
        raise UsageError(f"{nearest} is a file; --out wants a folder.")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise UsageError(f"{nearest} cannot be written to. Choose another --out, or ask for its permissions.")
    return folder


def _fill(folder: Path, writers: Mapping[str, Writer], overwrite: bool) -> None:
    """Write files beside their places first, so that an interruption leaves no half of them."""
    from shipid.foundation.replacing import put_in_place
    from shipid.foundation.scratch import scratch_folder

    folder.mkdir(parents=True, exist_ok=True)
    with scratch_folder(folder) as scratch:
        for name, write in writers.items():
            write(scratch / name)
        put_in_place({scratch / name: folder / name for name in writers}, overwrite)


def _json_writer(data: Plain) -> Writer:
    return lambda path: path.write_text(json_text(data) + "\n", encoding="utf-8")


def _open(report: Path) -> None:
    import webbrowser

    if not webbrowser.open(report.resolve().as_uri()):
        say(f"there is no browser here to open {report} with.")
