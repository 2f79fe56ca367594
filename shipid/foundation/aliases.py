"""Type aliases for what the type checker cannot know: objects of CasADi and pint, and the content of files."""

from __future__ import annotations

from typing import Any, TypeAlias

#: What an equation runs over: a CasADi expression, a number, an array, or a quantity with a unit.
Expression: TypeAlias = Any
#: A ``casadi.Function``.
CasadiFunction: TypeAlias = Any
#: A unit or a quantity of pint, which ships no types for its dynamic classes.
PintUnit: TypeAlias = Any
#: What JSON or TOML holds: text, numbers, truth values, lists and tables of them.
Plain: TypeAlias = Any
#: A client of dask.distributed, which ships no types for its calls.
DaskClient: TypeAlias = Any
