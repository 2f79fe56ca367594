"""Options for current and wind; what they say is read by `shipid.trials.manoeuvres.flows`."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import Decorator


def current_option(more: str = "") -> Decorator:
    """Return ``--current``.

    Parameters
    ----------
    more : str
        What else its help says.
    """
    return click.option("--current", metavar="C", help=f"As in '3 kn to 30 deg' (or 'from'){more}.")


def wind_option(more: str = "") -> Decorator:
    """Return ``--wind``.

    Parameters
    ----------
    more : str
        What else its help says.
    """
    return click.option("--wind", metavar="W", help=f"As in '10 m/s from 270 deg' (or 'to'){more}.")
