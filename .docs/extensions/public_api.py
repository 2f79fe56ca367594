"""Pages of the API, written when the site is built: one page a room, from `shipid.__all__` and the docstrings.

Nothing is listed by hand. A name stands on the page of the room its code lives in, and a result stands on the page of
its room where a public verb returns it. The pages are written to ``generated/``, which is not kept.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from markup import emptied, title
from numpydoc.xref import DEFAULT_LINKS

import shipid

#: Rooms in the order of the work; a room that is not named here follows them.
ROOMS = (
    "declaration",
    "parameters",
    "generation",
    "parts",
    "trials",
    "estimation",
    "identification",
    "criteria",
    "planning",
    "autopilot",
    "prediction",
    "encounter",
    "campaign",
    "export",
    "report",
    "bridge",
)


def _walk() -> Iterator[Any]:
    """Import every module of the toolbox but the ship models and the command line."""
    for found in pkgutil.walk_packages(shipid.__path__, "shipid."):
        if not found.name.startswith(("shipid.models", "shipid.cli", "shipid.__main__")):
            yield importlib.import_module(found.name)


def public_classes() -> list[type]:
    """Return the public classes of the toolbox, in the order of their names.

    Returns
    -------
    list of type
    """
    found = {
        thing
        for module in _walk()
        for key, thing in vars(module).items()
        if inspect.isclass(thing) and thing.__module__ == module.__name__ and not key.startswith("_")
    }
    return sorted(found, key=lambda c: (c.__name__, c.__module__))


def room_of(thing: Any) -> str:
    """Return the room an object lives in: the folder of its module.

    Parameters
    ----------
    thing : class or function
        Anything of shipid.

    Returns
    -------
    str
    """
    return str(thing.__module__).split(".")[1]


def path_of(thing: Any) -> str:
    """Return the name to import an object by: the short one where it is public.

    Parameters
    ----------
    thing : class or function
        Anything of shipid.

    Returns
    -------
    str
    """
    name = thing.__name__
    return f"shipid.{name}" if name in shipid.__all__ else f"{thing.__module__}.{name}"


def results_of(things: Iterable[Any], classes: list[type]) -> list[type]:
    """Return the classes that public functions and methods return, and that their methods return in turn.

    Parameters
    ----------
    things : iterable of class or function
        Where to begin.
    classes : list of type
        The public classes of the toolbox, among which the names of the annotations are looked up.

    Returns
    -------
    list of type
        Without those of `shipid.__all__`.
    """
    by_name: dict[str, list[type]] = defaultdict(list)
    for each in classes:
        by_name[each.__name__].append(each)
    todo = list(things)
    found: set[type] = set()
    while todo:
        for function in _verbs(todo.pop()):
            for word in re.findall(r"\w+", str(function.__annotations__.get("return", ""))):
                named = [c for c in by_name[word] if word in function.__globals__ or len(by_name[word]) == 1]
                new = {kind for c in named for kind in (c, *c.__subclasses__()) if kind in classes} - found
                found |= new
                todo += new
    return sorted((c for c in found if path_of(c).count(".") > 1), key=lambda c: c.__name__)


def _verbs(thing: Any) -> Iterator[Any]:
    """List a function itself, or the public methods of a class; a property is no verb."""
    members = vars(thing).items() if inspect.isclass(thing) else [("", thing)]
    for key, member in members:
        function = getattr(member, "__func__", member)
        if not key.startswith("_") and inspect.isfunction(function):
            yield function


def _summary(names: Iterable[str]) -> str:
    return ".. autosummary::\n   :nosignatures:\n\n" + "".join(f"   {n}\n" for n in names)


def _entry(thing: Any) -> str:
    kind = "autoclass" if inspect.isclass(thing) else "autofunction"
    members = "   :members:\n" if inspect.isclass(thing) else ""
    return f".. {kind}:: {path_of(thing)}\n{members}"


def _room_page(room: str, public: list[Any], results: list[type]) -> str:
    about = inspect.cleandoc(importlib.import_module(f"shipid.{room}").__doc__ or "").partition("\n\n")[0]
    parts = [title(room.capitalize()), about, _summary(map(path_of, public)), *map(_entry, public)]
    if results:
        parts += [title("What is returned", "-"), *map(_entry, results)]
    return "\n".join(f"{part}\n" for part in parts)


def _errors_page(errors: list[Any]) -> str:
    about = (
        "Every error that bad input causes is a `ShipidError`. Its message says what is wrong, where, and what to do. The "
        "command line prints the message and ends with the exit code."
    )
    parts = [title("Errors"), about]
    for code in sorted({e.exit_code for e in errors}):
        parts += [
            title(f"Exit code {code}", "-"),
            *(f".. autoexception:: {path_of(e)}" for e in errors if e.exit_code == code),
        ]
    return "\n".join(f"{part}\n" for part in parts)


def _overview(rooms: dict[str, list[Any]]) -> str:
    about = "Everything in `shipid.__all__`, by the room of the toolbox it belongs to. Results and errors stand on the pages."
    parts = [title("API"), about]
    for room, public in rooms.items():
        parts += [title(room.capitalize(), "-"), _summary(map(path_of, public))]
    pages = "".join(f"   {name}\n" for name in [*rooms, "errors"])
    return "\n".join(f"{part}\n" for part in [*parts, f".. toctree::\n   :hidden:\n\n{pages}"])


def _write_pages(app: Any, config: Any) -> None:
    classes = public_classes()
    things = [getattr(shipid, name) for name in shipid.__all__ if not name.startswith("__")]
    errors = [c for c in classes if issubclass(c, shipid.ShipidError)]
    results = [c for c in results_of(things, classes) if c not in errors]
    order = [*ROOMS, *sorted({room_of(t) for t in things} - set(ROOMS))]
    public = {room: [t for t in things if room_of(t) == room and t not in errors] for room in order}
    public = {room: found for room, found in public.items() if found}
    folder = emptied(Path(app.srcdir) / "generated" / "api")
    for room, found in public.items():
        page = _room_page(room, found, [c for c in results if room_of(c) == room])
        (folder / f"{room}.rst").write_text(page, encoding="utf-8")
    (folder / "errors.rst").write_text(_errors_page(errors), encoding="utf-8")
    (folder / "index.rst").write_text(_overview(public), encoding="utf-8")
    # A class named among the types of a docstring is a link, if it has a place on a page.
    placed = [*(t for t in things if inspect.isclass(t)), *results, *errors]
    config.numpydoc_xref_aliases = {c.__name__: path_of(c) for c in placed}


def _hide_fields(
    app: Any, what: str, name: str, thing: Any, options: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None] | None:
    """Leave out the signature of a class whose docstring names no parameters: a result is made by the toolbox."""
    if signature and what in ("class", "exception") and "Parameters\n" not in (inspect.getdoc(thing) or ""):
        return "", None
    return None


def setup(app: Any) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    DEFAULT_LINKS.clear()  # links to the documentation of Python and NumPy, whose indices need the network
    app.connect("config-inited", _write_pages, priority=400)
    app.connect("autodoc-process-signature", _hide_fields)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
