"""Values of options that have a dimension: a number with its unit, checked before anything is read or computed."""

from __future__ import annotations

from typing import Any

import click


class NumberWithUnit(click.ParamType):  # type: ignore[type-arg]
    """The value of an option, a number with its unit; the unit it is in shows in the help.

    Parameters
    ----------
    unit : str
        A unit of its dimension, as the toolbox computes in.
    several : bool
        Whether it may be a list of values separated by commas, each with its unit.
    """

    name = "quantity"

    def __init__(self, unit: str, *, several: bool = False) -> None:
        self.unit, self.several = unit, several

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return how the value is written: ``'NUMBER s'``.

        Parameters
        ----------
        param : click.Parameter
            The option.
        ctx : click.Context, optional
            The call.
        """
        return f"'NUMBER {self.unit}'"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:  # noqa: ANN401
        """Return the text as it was given, refused where its unit is missing or does not fit.

        Parameters
        ----------
        value : str
            As in ``"9 kn"``.
        param : click.Parameter or None
            The option.
        ctx : click.Context or None
            The call.

        Raises
        ------
        UsageError
            With what to type instead.
        """
        if ctx is not None and ctx.resilient_parsing:
            return str(value)  # a shell asks what may come next: nothing is read or computed
        from shipid.declaration.units import to_si
        from shipid.foundation.errors import UnitError, UsageError

        option = param.opts[0] if param is not None else "the value"
        for part in str(value).split(",") if self.several else [str(value)]:
            try:
                to_si(part, self.unit, option)
            except UnitError as error:
                raise UsageError(str(error)) from None
        return str(value)
