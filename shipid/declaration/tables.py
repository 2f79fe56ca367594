"""Tables of TOML files, checked: known keys, kinds of values, numbers with units. Every error names file and entry."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from shipid.declaration.units import to_si
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError, UnitError, nearest

#: No file of this toolbox comes near these bounds [bytes], [tables in tables].
_LARGEST_FILE, _DEEPEST = 1_000_000, 20

_KINDS = {str: "text in quotes", int: "a whole number", float: "a number", bool: "true or false", list: "a list"}


@dataclass(frozen=True)
class Table:
    """A table of a TOML file while it is read.

    Attributes
    ----------
    content : Mapping of str to Plain
        The parsed table.
    file : str
        The file, at the beginning of every message.
    error : type of ShipidError
        The class of its errors.
    name : str
        The table's name as TOML writes it, ``"columns.psi"``; empty for the file itself.
    """

    content: Mapping[str, Plain]
    file: str
    error: type[ShipidError]
    name: str = ""

    @property
    def where(self) -> str:
        """File and table, at the beginning of every message."""
        return f"{self.file}, [{self.name}]" if self.name else self.file

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def __iter__(self) -> Iterator[str]:
        return iter(self.content)

    def fail(self, message: str) -> ShipidError:
        """Return the error that says what is wrong in this table.

        Parameters
        ----------
        message : str
            What is wrong, and what to do.
        """
        return self.error(f"{self.where}: {message}".strip())

    def check_keys(self, known: Iterable[str], required: Iterable[str] = ()) -> None:
        """Refuse a key that is not known, and the lack of one that is required.

        Parameters
        ----------
        known, required : iterable of str
            Keys.

        Raises
        ------
        ShipidError
            Of the class of this table; the message offers the nearest keys.
        """
        known, required = list(known), list(required)
        for key in self.content:
            if key not in known:
                raise self.fail(f"there is no entry '{key}'. {nearest(key, known)}")
        for key in required:
            if key not in self.content:
                raise self.fail(f"'{key}' is missing.")

    def value(self, key: str, kind: type, default: Plain = None) -> Plain:
        """Return a value of one kind, or the default where the key is absent.

        Parameters
        ----------
        key : str
            Its name.
        kind : {str, int, float, bool, list}
            What it has to be; a whole number is a float as well, and a float has to be finite.
        default : Plain
            For an absent key.

        Raises
        ------
        ShipidError
            If it is something else.
        """
        if key not in self.content:
            return default
        value = self.content[key]
        accepted = (int, float) if kind is float else kind
        wrong = not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool)
        if wrong or (kind is float and not is_finite(value)):
            raise self.fail(f"'{key}' is {value!r}, and has to be {_KINDS[kind]}.")
        return float(value) if kind is float else value

    def choice(self, key: str, choices: Iterable[str], default: str | None = None) -> str | None:
        """Return one of several words, or the default where the key is absent.

        Parameters
        ----------
        key : str
            Its name.
        choices : iterable of str
            The words.
        default : str, optional
            For an absent key.

        Raises
        ------
        ShipidError
            If it is none of them.
        """
        choices = list(choices)
        value = self.value(key, str, default)
        if value is not None and value not in choices:
            raise self.fail(f"'{key}' is '{value}'. Write one of {', '.join(choices)}.")
        return None if value is None else str(value)

    def table(self, key: str) -> Table:
        """Return a table inside this one, empty where the key is absent.

        Parameters
        ----------
        key : str
            Its name.

        Raises
        ------
        ShipidError
            If there is something else under the key.
        """
        inside = self.content.get(key, {})
        name = f"{self.name}.{key}" if self.name else key
        if not isinstance(inside, Mapping):
            raise self.fail(f"'{key}' is {inside!r}, and has to be a table [{name}].")
        return Table(inside, self.file, self.error, name)

    def tables(self) -> Iterator[tuple[str, Table]]:
        """Yield the name and the content of each table inside this one, which holds nothing else.

        Yields
        ------
        name : str
            Its name in this table.
        table : Table
            Its content.

        Raises
        ------
        ShipidError
            If there is something else.
        """
        for key in self.content:
            yield key, self.table(key)

    def quantity(self, key: str, unit: str, default: float | None = None, *, positive: bool = False) -> float | None:
        """Return a value with its unit in SI: written ``"0.1 s"`` or ``{ value = 0.1, unit = "s" }``.

        Parameters
        ----------
        key : str
            Its name.
        unit : str
            The SI unit wanted.
        default : float, optional
            For an absent key, SI.
        positive : bool
            Whether it has to be greater than zero.

        Raises
        ------
        ShipidError
            If it has no unit, another unit, is not a finite number, or not greater than zero where it has to be.
        """
        if key not in self.content:
            return default
        raw = self.content[key]
        where = f"{self.where}: '{key}'"
        form = f"'1.0 {unit}' or {{ value = 1.0, unit = '{unit}' }}"
        if isinstance(raw, Mapping):
            if not {"value", "unit"} <= set(raw) or not is_finite(raw["value"]):
                raise self.error(f"{where} is {dict(raw)!r}. Write {form}, with a finite number.")
            raw = (float(raw["value"]), str(raw["unit"]))
        elif isinstance(raw, bool) or not isinstance(raw, (str, int, float)):
            raise self.error(f"{where} is {raw!r}. Write {form}.")
        try:
            value = to_si(raw, unit, where)
        except UnitError as error:
            raise self.error(str(error)) from None
        if positive and not value > 0:
            raise self.error(f"{where} is {self.content[key]!r}, and has to be greater than zero.")
        return value


def read_table(path: Path, what: str, error: type[ShipidError]) -> Table:
    """Read a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What it is, for messages: ``"parameter set"``.
    error : type of ShipidError
        The class of the errors about it.

    Returns
    -------
    Table

    Raises
    ------
    ShipidError
        Of the class `error`, if the file cannot be read or is not valid TOML.
    """
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST_FILE + 1)
        if len(data) > _LARGEST_FILE:
            raise error(f"the {what} {path} is larger than {_LARGEST_FILE} bytes. Check that it is the right file.")
        content = tomllib.loads(data.decode("utf-8-sig").replace("\r\n", "\n"))
    except OSError as failed:
        raise error(f"the {what} {path} cannot be read: {failed.strerror}. Check the path.") from None
    except RecursionError:
        raise error(f"the {what} {path} is nested deeper than {_DEEPEST} tables.") from None
    except ValueError as failed:  # no TOML, no UTF-8, or a whole number of thousands of digits
        hint = "" if path.suffix == ".toml" else f" A {what} is a TOML file: its name ends in .toml."
        raise error(f"the {what} {path} is not valid TOML: {failed}.{hint}") from None
    _check_bounds(content, f"the {what} {path}", error)
    return Table(content, str(path), error)


def _check_bounds(content: Mapping[str, Plain], where: str, error: type[ShipidError]) -> None:
    """Refuse tables in tables without end, and whole numbers that TOML does not have."""
    level: list[Plain] = [content]
    for _ in range(_DEEPEST):
        level = [inner for outer in level for inner in (outer.values() if isinstance(outer, Mapping) else outer)]
        if any(isinstance(value, int) and not -(2**63) <= value < 2**63 for value in level):
            raise error(f"{where} holds a whole number that is larger than TOML has (2^63). Write it as 1e20.")
        level = [value for value in level if isinstance(value, (Mapping, list))]
        if not level:
            return
    raise error(f"{where} is nested deeper than {_DEEPEST} tables.")


def is_finite(number: Plain) -> bool:
    """Return whether a value is a finite number (a truth value is none).

    Parameters
    ----------
    number : Plain
        What TOML or JSON holds.
    """
    return isinstance(number, (int, float)) and not isinstance(number, bool) and math.isfinite(number)
