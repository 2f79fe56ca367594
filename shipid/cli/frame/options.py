"""Options that several commands have, each with one help text, and the reading of their values."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.completing import complete_file, complete_model, complete_ship
from shipid.cli.frame.delivery import Command, Decorator
from shipid.cli.frame.messages import say
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.cli.frame.typed import Window, assignments, levels_of, names_of, trials_in, window_of

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.parameters.parameter_set import ParameterSet
    from shipid.trials.trial import Trial

_MODEL = "A model's name, or path/to/file.py:Class."
_SHIP = "A ship's name, or the path of a parameter set (TOML)"
_SET = "Replace a value of the ship, with its unit: L='45 m', a coefficient, or one of wind or steering machine."
#: How levels are written, for the help of options that take them.
LEVELS = "'psi=0.2 deg,r=0.02 deg/s'"


def model_given(name: str, inputs: Mapping[str, str | float] | None = None) -> Model:
    """Return the model of a command, the inputs held that its ``--input`` states.

    Parameters
    ----------
    name : str
        A model's name, or path/to/file.py:Class.
    inputs : mapping of str to str or float, optional
        By input, with units or in SI.
    """
    from shipid.parameters.catalogue import find_model
    from shipid.parameters.held_inputs import hold_inputs

    return hold_inputs(find_model(name), inputs or {})


def ship_given(name: str, values: Mapping[str, str], *models: Model) -> ParameterSet:
    """Return the ship of a command, with the values that its ``--set`` states.

    Parameters
    ----------
    name : str
        A ship's name, or the path of a parameter set.
    values : mapping of str to str
        By name, with units.
    *models : Model
        Whose coefficients may be stated, beside the particulars of the ship.
    """
    from shipid.parameters.catalogue import find_ship
    from shipid.parameters.replaced import with_values

    found = find_ship(name)
    return with_values(found, values, models, "stated by --set") if values else found


def ships_given(names: Sequence[str], values: Mapping[str, str], *models: Model) -> list[ParameterSet]:
    """Return the ships of a command that compares several; those of one name, as two files of a ship, are called as they were typed.

    Parameters
    ----------
    names, values, *models
        As for `ship_given`, a name for each ship.
    """
    found = [ship_given(n, values, *models) for n in names]
    called = [s.name for s in found]
    return [replace(s, name=n) if called.count(s.name) > 1 else s for n, s in zip(names, found)]


def optional_ship_given(name: str | None, values: Mapping[str, str], *models: Model) -> ParameterSet | None:
    """Return the ship of a command that needs none, or None.

    Parameters
    ----------
    name : str or None
        As for `ship_given`, or None where no ship is named.
    values : mapping of str to str
        By name, with units.
    *models : Model
        Whose coefficients may be stated.

    Raises
    ------
    UsageError
        If there are values, and no ship.
    """
    from shipid.foundation.errors import UsageError

    if name:
        return ship_given(name, values, *models)
    if values:
        raise UsageError("--set replaces values of a ship: name the ship with --ship.")
    return None


def _read_by(reader: Callable[[str], object]) -> Callable[[click.Context, click.Parameter, str | None], object]:
    """Return click's callback for an option whose value is read by a function, None where it is not given."""
    return lambda _context, _parameter, text: None if text is None else reader(text)


model_argument = click.argument("model", shell_complete=complete_model)
model_option = click.option("--model", required=True, metavar="MODEL", help=_MODEL, shell_complete=complete_model)
optional_model_option = click.option("--model", metavar="MODEL", help=_MODEL, shell_complete=complete_model)
trials_argument = click.argument(
    "trials",
    nargs=-1,
    required=True,
    metavar="TRIAL|FOLDER...",
    callback=lambda _context, _parameter, names: tuple(trial for name in names for trial in trials_in(name)),
    shell_complete=complete_file,
)
format_option = click.option(
    "--format",
    "format_",
    metavar="FILE",
    help="Trial format file (TOML), for headers without units.",
    shell_complete=complete_file,
)
_window_option = click.option(
    "--window",
    metavar="A:B",
    callback=_read_by(window_of),
    help="Seconds of the trial's clock; a trial may carry its own: FILE@A:B.",
)
validate_option = click.option(
    "--validate",
    multiple=True,
    metavar="TRIAL...",
    help="Trials to predict that are not fitted.",
    shell_complete=complete_file,
)
values_option = click.option(
    "--set",
    "--fix",
    "values",
    multiple=True,
    metavar="NAME=VALUE",
    callback=lambda _context, _parameter, texts: assignments(texts),
    help=_SET,
)
set_option = click.option(
    "--set",
    "values",
    multiple=True,
    metavar="NAME=VALUE",
    callback=lambda _context, _parameter, texts: assignments(texts),
    help=_SET,
)
input_option = click.option(
    "--input",
    "inputs",
    multiple=True,
    metavar="NAME=VALUE",
    callback=lambda _context, _parameter, texts: assignments(texts),
    help="Hold an input of the model, with its unit, as in n='2 rps'.",
)
sampling_option = click.option("--sampling", type=NumberWithUnit("s"), help="Sampling interval, as in '1 s'.")
starts_option = click.option(
    "--starts", default=5, show_default=True, type=click.IntRange(1), help="Number of starting points."
)


def ship_option(*, required: bool = False, several: str = "") -> Decorator:
    """Return ``--ship``.

    Parameters
    ----------
    required : bool
        Whether it has to be given.
    several : str
        What it means to give it several times, where that is possible; the command gets `ships`.
    """
    if several:
        words = f"{_SHIP}; several times {several}."
        return click.option("--ship", "ships", multiple=True, metavar="SHIP", help=words, shell_complete=complete_ship)
    return click.option("--ship", required=required, metavar="SHIP", help=f"{_SHIP}.", shell_complete=complete_ship)


def speed_option(what: str, more: str = "", *, several: bool = False) -> Decorator:
    """Return ``--speed``.

    Parameters
    ----------
    what : str
        Which speed it is.
    more : str
        What else may be written.
    several : bool
        Whether it may be a list.
    """
    words = f"{what}, as in '9 kn'{more}; the ship's own by default."
    return click.option("--speed", type=NumberWithUnit("m/s", several=several), help=words)


def estimate_option(more: str = "") -> Decorator:
    """Return ``--estimate``.

    Parameters
    ----------
    more : str
        What else may be written.
    """
    words = f"Parameters to estimate; the model's own choice by default{more}."
    return click.option("--estimate", metavar="a,b,..", callback=_read_by(names_of), help=words)


def levels_option(name: str, words: str, variable: str | None = None) -> Decorator:
    """Return an option whose value is a list of levels with their units.

    Parameters
    ----------
    name : str
        As in ``--noise``.
    words : str
        Its help.
    variable : str, optional
        What the command calls it; the name by default.
    """
    names = (name,) if variable is None else (name, variable)
    return click.option(*names, metavar="LIST", callback=_read_by(levels_of), help=words)


def seed_option(of: str) -> Decorator:
    """Return ``--seed``.

    Parameters
    ----------
    of : str
        What is drawn at random.
    """
    return click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help=f"Of {of}.")


class TrialReader:
    """Reads the trials of a command, with its ``--format`` and ``--window``.

    Parameters
    ----------
    format_ : str or None
        Trial format file.
    window : tuple of float or None
        Part of every trial without a window of its own.
    """

    def __init__(self, format_: str | None, window: Window | None) -> None:
        self.format, self.window = format_, window

    def __call__(self, name: str) -> Trial:
        """Return a trial, and pass on what its reading warned of.

        Parameters
        ----------
        name : str
            A file, with or without its own window: ``FILE@A:B``.
        """
        from shipid.trials.logs.reading import read_trial

        trial = read_trial(name, format=self.format, window=self.window)
        for note in trial.source.notes:
            if note.startswith("WARNING"):
                say(f"trial {trial.name}: {note}")
        return trial


def reading(function: Command) -> Command:
    """Return a command with ``--format`` and ``--window``; it gets a `TrialReader` as `read`.

    Parameters
    ----------
    function : callable
        The command.
    """

    @functools.wraps(function)
    def command(*arguments: object, format_: str | None, window: Window | None, **values: object) -> object:
        return function(*arguments, read=TrialReader(format_, window), **values)

    decorated: Command = format_option(_window_option(command))  # type: ignore[assignment]
    return decorated


class Variadic(click.Command):
    """A command whose option ``--validate`` takes every following word up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option before each of its values, which is the form click knows.

        Parameters
        ----------
        ctx : click.Context
            The call.
        args : list of str
            Words of the command line.

        Returns
        -------
        list of str
            What click leaves of them.

        Raises
        ------
        UsageError
            Click's own: if no trial follows the option.
        """
        spread: list[str] = []
        taking = bare = False
        for arg in args:
            if arg == "--validate":
                taking = bare = True
                continue
            taking = taking and not (arg.startswith("-") and arg != "-")
            spread += ["--validate", arg] if taking else [arg]
            bare = bare and not taking
        if bare and not ctx.resilient_parsing:
            raise click.UsageError("--validate names no trial.", ctx)
        return super().parse_args(ctx, spread)
