"""The command line: thin, and it imports what a command needs when the command runs.

Results go to stdout (``--json`` for machines), progress and messages to stderr. Exit codes: 0 done, 2 usage, 3 bad data,
4 no convergence, 70 a fault of shipid itself.
"""

from __future__ import annotations

import os
import re
import sys
import textwrap
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

_CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 110}


class _Variadic(click.Command):
    """A command whose option ``--validate`` takes every following word up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option before each of its values, which is the form click knows."""
        spread: list[str] = []
        taking = False
        for arg in args:
            if arg == "--validate":
                taking = True
                continue
            taking = taking and not (arg.startswith("-") and arg != "-")
            spread += ["--validate", arg] if taking else [arg]
        return super().parse_args(ctx, spread)


@click.group(context_settings=_CONTEXT)
@click.version_option(package_name="shipid", message="shipid %(version)s")
def main() -> None:
    """Identify ships from trials: declare the ship once; everything else is generated.

    \b
    shipid models                                  what there is
    shipid simulate norrbin --ship zeefakkel --manoeuvre zigzag:20/20 --noise standard -o trial.csv
    shipid measure trial.csv                       overshoots, period, advance, transfer, ...
    shipid identify trial.csv --model norrbin --ship zeefakkel --out result
    """


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; errors are one paragraph on stderr, never a traceback."""
    from shipid.declaration.errors import ShipidError

    try:
        main.main(args=None if arguments is None else list(arguments), prog_name="shipid", standalone_mode=False)
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted; nothing was written.", err=True)
        return 130
    except ShipidError as error:
        _say(str(error))
        return error.exit_code
    except BrokenPipeError:
        return 0
    except OSError as error:
        _say(f"{error.filename or 'a file'}: {error.strerror or error}.")
        return 3
    except Exception as error:  # the last line of defence: a fault of ours is said in one paragraph too
        if os.environ.get("SHIPID_DEBUG"):
            raise
        _say(
            f"a fault in shipid itself, {type(error).__name__}: {error}. Set SHIPID_DEBUG=1 to see where, and report it."
        )
        return 70
    return _Exit.code


class _Exit:
    """The exit code of a command that ran through."""

    code = 0


def entry() -> None:
    """Entry point of the installed command."""
    sys.exit(run())


def _say(message: str) -> None:
    width = min(110, max(40, (click.get_text_stream("stderr").isatty() and os.get_terminal_size().columns) or 100))
    click.echo(textwrap.fill(f"shipid: {message}", width, break_long_words=False, break_on_hyphens=False), err=True)


def _print_json(value: Any) -> None:
    import json

    click.echo(json.dumps(value, indent=1, allow_nan=False, ensure_ascii=False))


def _option_format(command: Callable[..., Any]) -> Callable[..., Any]:
    return click.option(
        "--format", "format_", metavar="FILE", help="Trial format file (TOML) for headers without units."
    )(command)


_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
_OVERWRITE = click.option("--overwrite", is_flag=True, help="Replace files that exist.")


@main.command()
@_JSON
def models(as_json: bool) -> None:
    """List models and ships, one line each."""
    from shipid.declaration.catalogue import known_models, known_ships

    found, ships = known_models(), known_ships()
    if as_json:
        _print_json(
            {
                "models": {n: {"about": _about(m), "parameters": list(m.parameters)} for n, m in found.items()},
                "ships": {n: {"about": s.title, "models": list(s.models)} for n, s in ships.items()},
            }
        )
        return
    width = max(map(len, [*found, *ships]))
    click.echo("models")
    for name, model in found.items():
        click.echo(f"  {name:<{width}}  {_about(model)} [{', '.join(model.parameters)}]")
    click.echo("ships")
    for name, ship in ships.items():
        click.echo(f"  {name:<{width}}  {ship.title} [{', '.join(ship.models)}]")


def _about(model: Any) -> str:
    first = (model.components[0].__doc__ or "").strip().partition("\n")[0]
    return str(first)


@main.command()
@click.argument("model")
@_JSON
@click.option("--latex", is_flag=True, help="Print the equations as LaTeX.")
def show(model: str, as_json: bool, latex: bool) -> None:
    """Show a model: quantities, units, equations, sources.

    MODEL is a name (see shipid models) or path/to/file.py:Class.
    """
    from shipid.declaration.catalogue import find_model
    from shipid.declaration.units import pretty
    from shipid.generation.typesetting import typeset

    found = find_model(model)
    equations = typeset(found)
    if latex:
        rows = [e.latex.replace(" = ", " &= ", 1) + f" && \\text{{{e.component}.{e.method}}}" for e in equations]
        click.echo("\\begin{align}\n" + " \\\\\n".join(rows) + "\n\\end{align}")
        return
    if as_json:
        _print_json(
            {
                "model": found.name,
                "quantities": {
                    n: {
                        "kind": "input" if e.quantity.kind == "given" else e.quantity.kind,
                        "unit": e.unit,
                        "meaning": e.quantity.meaning,
                        "component": e.owner.__name__,
                        **{a: e.number(a) for a in ("start", "low", "high", "default") if e.number(a) is not None},
                    }
                    for n, e in found.entries.items()
                },
                "equations": [
                    {"target": e.target, "kind": e.kind, "equation": e.plain, "latex": e.latex, "source": e.source}
                    for e in equations
                ],
            }
        )
        return
    click.echo(f"{found.name}: {_about(found)}\n")
    width = max(map(len, found.entries))
    for kind, title in (
        ("state", "states"),
        ("given", "inputs"),
        ("parameter", "parameters"),
        ("constant", "constants"),
        ("derived", "derived"),
        ("output", "outputs"),
    ):
        names = [n for n in found.entries if found[n].quantity.kind == kind and n != "T"]
        if names:
            click.echo(title)
        for n in names:
            click.echo(f"  {n:<{width}}  {pretty(found[n].unit):<9}  {found[n].quantity.meaning}")
    click.echo("equations")
    for e in equations:
        label = "  (where a parameter set publishes it)" if e.kind == "instead" else ""
        click.echo(f"  {e.plain}{label}\n      {e.component}: {e.source.partition(chr(10))[0]}")


@main.command()
@click.argument("model")
@click.option("--ship", required=True, metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@click.option("--manoeuvre", required=True, metavar="M", help="zigzag:20/20, turn:35, spiral:25, course:60, ...")
@click.option("--speed", metavar="V", help="Speed before the manoeuvre, as in '9 kn'; the ship's own by default.")
@click.option(
    "--noise", default="none", show_default=True, help="none, standard, or a list: 'psi=0.2 deg,r=0.02 deg/s'."
)
@click.option("--seed", default=0, show_default=True, help="Of the noise and the random telegraph.")
@click.option("--duration", metavar="T", help="As in '600 s'; long enough for the manoeuvre by default.")
@click.option("--sampling", metavar="T", help="Sampling interval, as in '1 s'.")
@click.option("--heading", default="0 deg", show_default=True, help="Heading of the approach.")
@click.option("--current", metavar="C", help="As in '3 kn to 30 deg' (or 'from').")
@click.option("--wind", metavar="W", help="As in '10 m/s from 270 deg' (or 'to'); needs a ship with wind coefficients.")
@click.option(
    "--set", "values", multiple=True, metavar="NAME=VALUE", help="Replace a value of the ship, with its unit."
)
@click.option("-o", "--output", metavar="FILE", help="CSV file to write; stdout by default.")
@_OVERWRITE
def simulate(
    model: str,
    ship: str,
    manoeuvre: str,
    speed: str | None,
    noise: str,
    seed: int,
    duration: str | None,
    sampling: str | None,
    heading: str,
    current: str | None,
    wind: str | None,
    values: tuple[str, ...],
    output: str | None,
    overwrite: bool,
) -> None:
    """Simulate a manoeuvre and write it as a trial.

    \b
    zigzag:20/20        rudder and heading angle; zigzag:-20/20 begins to port
    turn:35             turning circle through 540 degrees, with pull-out
    spiral:25           direct spiral          reversed-spiral:0.6  up to r L/U = 0.6
    course:60/15        course change with at most 15 degrees of rudder
    telegraph:10        random telegraph
    """
    from shipid.declaration.catalogue import find_model, find_ship
    from shipid.trials.simulation import simulate as run_simulation
    from shipid.trials.writing import write_trial

    trial = run_simulation(
        find_model(model),
        find_ship(ship),
        manoeuvre,
        speed=speed,
        noise=noise,
        seed=seed,
        duration=duration,
        sampling=sampling,
        heading=heading,
        current=_flow(current, "current"),
        wind=_flow(wind, "wind"),
        values=_assignments(values),
    )
    if output is None:
        click.echo(f"# {trial.source.comment}")
        click.echo(trial.to_frame().to_csv(index=False, lineterminator="\n", float_format="%.10g"), nl=False)
        return
    write_trial(trial, output, overwrite=overwrite, comment=trial.source.comment)
    click.echo(f"{output}: {len(trial)} samples. {trial.source.comment}", err=True)


def _flow(text: str | None, what: str) -> tuple[float, float] | None:
    """Read ``"3 kn to 30 deg"``: speed and direction it flows TO, SI."""
    import math

    from shipid.declaration.errors import UsageError
    from shipid.declaration.units import to_si

    if text is None:
        return None
    match = re.match(r"^\s*(.+?)\s+(to|from)\s+(.+?)\s*$", text)
    if not match:
        raise UsageError(
            f"the {what} '{text}' does not say where it flows: write '3 kn to 30 deg' or '10 m/s from 270 deg'."
        )
    direction = to_si(match.group(3), "rad", f"direction of the {what}")
    turned = math.pi if match.group(2) == "from" else 0.0
    return to_si(match.group(1), "m/s", f"speed of the {what}"), direction + turned


def _assignments(texts: Sequence[str]) -> dict[str, str]:
    from shipid.declaration.errors import UsageError

    result = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise UsageError(f"'{text}' does not say NAME=VALUE with a unit, as in n3='0.4 s^2/deg^2'.")
        result[name.strip()] = value.strip()
    return result


def _window(text: str | None) -> tuple[float, float] | None:
    from shipid.declaration.errors import UsageError

    if text is None:
        return None
    first, sign, second = text.partition(":")
    try:
        if not sign:
            raise ValueError
        return float(first), float(second)
    except ValueError:
        raise UsageError(f"the window '{text}' is not A:B in seconds of the trial's clock, as in 1622:1712.") from None


@main.command()
@click.argument("trial")
@_option_format
@click.option("--window", metavar="A:B", help="Seconds of the trial's own clock. A trial may carry its own: FILE@A:B.")
@click.option("--kind", type=click.Choice(["zig-zag", "turning circle"]), help="Found out by itself by default.")
@click.option("--length", metavar="L", help="Ship length, as in '320 m', for the ratios to it.")
@_JSON
def measure(
    trial: str, format_: str | None, window: str | None, kind: str | None, length: str | None, as_json: bool
) -> None:
    """Measure a zig-zag or a turning circle in the terms of ITTC and IMO."""
    from shipid.trials.measuring import measure as run_measure
    from shipid.trials.reading import read_trial

    measured = run_measure(read_trial(trial, format=format_, window=_window(window)), kind, length=length)
    if not as_json:
        click.echo(repr(measured))
        return
    flat: dict[str, Any] = {"kind": measured.kind, "trial": measured.trial, "execute": measured.execute}
    flat |= {n: getattr(measured, n) for n in ("nominal", "first_side", "side", "track") if hasattr(measured, n)}
    for name, value, unit, _ in measured.quantities():
        key = name if unit == "1" else f"{name}_{unit.replace('/', '_')}"
        flat[key] = list(value) if isinstance(value, tuple) else value
    _print_json(flat)


@main.command(cls=_Variadic)
@click.argument("trials", nargs=-1, required=True, metavar="TRIAL...")
@click.option("--model", required=True, metavar="MODEL", help="A model's name, or path/to/file.py:Class.")
@click.option("--ship", metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@_option_format
@click.option("--window", metavar="A:B", help="For every trial without a window of its own (FILE@A:B).")
@click.option("--estimate", metavar="a,b,..", help="Coefficients to estimate; the model's own choice by default.")
@click.option(
    "--fix", multiple=True, metavar="NAME=VALUE", help="Hold a coefficient, with its unit: n3='0.4 s^2/deg^2'."
)
@click.option("--validate", multiple=True, metavar="TRIAL...", help="Trials to predict that are not fitted.")
@click.option("--signals", metavar="a,b,..", help="Signals to fit: psi, r, u, v, x, y. By default what is measured.")
@click.option("--noise", metavar="LIST", help="Noise levels, 'psi=0.2 deg,r=0.02 deg/s'; estimated by default.")
@click.option("--no-rudder-bias", is_flag=True, help="Believe the rudder: no bias of its own in each trial.")
@click.option("--starts", default=5, show_default=True, help="Number of starting points.")
@click.option("--seed", default=0, show_default=True, help="Of the random starting points.")
@click.option("--out", metavar="DIR", help="Folder for result.json, ship.toml and report.html.")
@_OVERWRITE
@_JSON
def identify(
    trials: tuple[str, ...],
    model: str,
    ship: str | None,
    format_: str | None,
    window: str | None,
    estimate: str | None,
    fix: tuple[str, ...],
    validate: tuple[str, ...],
    signals: str | None,
    noise: str | None,
    no_rudder_bias: bool,
    starts: int,
    seed: int,
    out: str | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Identify a model from one trial or several, jointly.

    Writes result.json, ship.toml (a parameter set every later command takes as --ship) and report.html into DIR.
    """
    from shipid.declaration.catalogue import find_model, find_ship
    from shipid.declaration.errors import UsageError
    from shipid.identification.identify import identify as run_identify
    from shipid.trials.reading import read_trial
    from shipid.trials.simulation import parse_noise

    if starts < 1:
        raise UsageError(f"{starts} starting points are too few: give at least one.")
    folder = _folder(out, overwrite)
    span = _window(window)
    found, known = find_model(model), find_ship(ship) if ship else None

    def read(name: str) -> Any:
        return read_trial(name, format=format_, window=span)

    with _progress(as_json) as tell:
        fit = run_identify(
            found,
            [read(t) for t in trials],
            ship=known,
            estimate=_names(estimate),
            fixed=_assignments(fix),
            signals=_names(signals),
            noise=parse_noise(noise) if noise else None,
            validate=[read(t) for t in validate],
            rudder_bias=not no_rudder_bias,
            starts=starts,
            seed=seed,
            progress=tell,
        )
        if folder is not None:
            tell("writing the report")
            _write(fit, folder)
    if as_json:
        _print_json(fit.to_dict())
    else:
        click.echo(repr(fit))
        if folder is not None:
            click.echo(f"written: {', '.join(str(folder / n) for n in _FILES)}")
    if not fit.converged:
        _say(f"the search did not converge: {fit.message} What it knows is above; do not use it as a ship.")
        _Exit.code = 4


_FILES = ("result.json", "ship.toml", "report.html")


def _names(text: str | None) -> list[str] | None:
    return [n.strip() for n in text.split(",") if n.strip()] if text else None


def _folder(out: str | None, overwrite: bool) -> Path | None:
    from shipid.declaration.errors import UsageError

    if out is None:
        return None
    folder = Path(out)
    there = [n for n in _FILES if (folder / n).exists()]
    if there and not overwrite:
        raise UsageError(f"{folder} holds {', '.join(there)} already. Choose another --out, or add --overwrite.")
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder} is a file; --out wants a folder.")
    return folder


def _write(fit: Any, folder: Path) -> None:
    """Write the three files beside their places first, so that an interruption leaves no half of them."""
    import json
    import tempfile

    from shipid.declaration.parameters import write_parameter_set
    from shipid.report.report import write_report

    result = json.dumps(fit.to_dict(), indent=1, allow_nan=False, ensure_ascii=False)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".shipid-") as scratch:
        parts = [Path(scratch) / n for n in _FILES]
        parts[0].write_text(result + "\n", encoding="utf-8")
        write_parameter_set(fit.ship, parts[1])
        write_report(fit, parts[2])
        for part in parts:
            part.replace(folder / part.name)


@contextmanager
def _progress(quiet: bool) -> Any:
    """Show what is being done, on stderr, where somebody is looking."""
    if quiet or not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("reading") as status:
        yield lambda text: status.update(text)
