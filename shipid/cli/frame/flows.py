"""Options for current and wind, and the reading of what they say."""

from __future__ import annotations

import math
import re

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


def flow_of(text: str | None, what: str, unit: str = "m/s") -> tuple[float, float] | None:
    """Return what ``"3 kn to 30 deg"`` says: speed and direction it flows TO, SI; None for none.

    Parameters
    ----------
    text : str or None
        As above, or ``"10 m/s from 270 deg"``.
    what : str
        What flows, for the message.
    unit : str
        Of its size, SI.

    Raises
    ------
    UsageError
        If the text has another form.
    """
    from shipid.declaration.units import Typed, to_si
    from shipid.foundation.errors import UsageError

    if text is None:
        return None
    match = re.match(r"^\s*(.+?)\s+(to|from)\s+(.+?)\s*$", text)
    if not match:
        raise UsageError(
            f"the {what} '{text}' does not say where it flows: write '3 kn to 30 deg' or '10 m/s from 270 deg'."
        )
    direction = to_si(Typed(match.group(3)), "rad", f"direction of the {what}")
    turned = math.pi if match.group(2) == "from" else 0.0
    return to_si(
        Typed(match.group(1)), unit, f"{'speed' if unit == 'm/s' else 'size'} of the {what}"
    ), direction + turned
