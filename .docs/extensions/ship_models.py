"""Pages of the ship models, written when the site is built from what ``shipid show MODEL --json`` says of each.

The pages are written to ``generated/``, which is not kept.
"""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path
from typing import Any

from click.testing import CliRunner
from markup import emptied, indented, plain, table, title
from public_api import public_classes

import shipid
from shipid.cli import main
from shipid.declaration.component import declared_quantities

_KINDS = {
    "state": "States",
    "input": "Inputs",
    "parameter": "Parameters",
    "constant": "Constants",
    "derived": "Derived quantities",
    "output": "Outputs",
}


def _ask(*arguments: str) -> Any:
    return json.loads(CliRunner().invoke(main, [*arguments, "--json"], catch_exceptions=False).stdout)


def _unit(unit: str) -> str:
    return re.sub(r"\^(-?[\d.]+)", r"\\ :sup:`\1`", plain(unit)) if unit != "1" else "\N{EN DASH}"


def _equation(equation: dict[str, Any]) -> str:
    note = " (where a parameter set publishes it instead)" if equation["kind"] == "instead" else ""
    source = plain(equation["source"] + note)
    return f".. math:: {equation['latex']}\n\n.. container:: source\n\n{indented(source)}"


def _model_page(name: str, ships: list[str]) -> str:
    shown = _ask("show", name)
    components = shipid.find_model(name).components
    parts = [f".. _model-{name}:\n", title(name)]
    parts.append("\n".join(f"``{c.__name__}``\n{indented(plain(inspect.getdoc(c) or ''))}\n" for c in components))
    if ships:
        parts.append(f"Ships with coefficients for it: {', '.join(f'``{s}``' for s in ships)}.")
    for kind, heading in _KINDS.items():
        rows = [
            (f"``{key}``", _unit(q["unit"]), plain(q["meaning"]))
            for key, q in shown["quantities"].items()
            if q["kind"] == kind
        ]
        if rows:
            parts += [title(heading, "-"), table(("Name", "Unit", "Meaning"), rows, "15 15 70")]
    parts += [title("Equations", "-"), *map(_equation, shown["equations"])]
    return "\n\n".join(parts) + "\n"


def _descendants(component: type) -> set[type]:
    found: set[type] = set(component.__subclasses__())
    return found.union(*map(_descendants, component.__subclasses__()))


def _other_components(known: dict[str, Any]) -> list[list[str]]:
    """List the components that no named model is joined of, with what each states and what it reads."""
    public_classes()  # imports every file of the toolbox
    joined = {c for name in known["models"] for c in shipid.find_model(name).components}
    homes = ("shipid.models.", "shipid.parts.")
    rows = []
    for each in sorted(_descendants(shipid.Component) - joined, key=lambda c: c.__name__):
        states_something = {q.kind for q in declared_quantities(each).values()} & {"state", "derived", "output"}
        if each.__module__.startswith(homes) and not each.__name__.startswith("_") and states_something:
            model = shipid.join(each.__name__, each)
            stated, read = model.states + model.derived + model.outputs, model.inputs
            about = plain((inspect.getdoc(each) or "").partition("\n\n")[0].replace("\n", " "))
            rows.append(
                [f"``{each.__name__}``", about, *(", ".join(f"``{n}``" for n in names) for names in (stated, read))]
            )
    return rows


def _overview(known: dict[str, Any]) -> str:
    models = [(f":ref:`{name} <model-{name}>`", plain(m["about"])) for name, m in known["models"].items()]
    ships = [
        (f"``{name}``", plain(s["about"]), ", ".join(f"``{m}``" for m in s["models"]))
        for name, s in known["ships"].items()
    ]
    about = (
        "The models that come with shipid, each declared in one file of ``models/``. The command line and "
        "`shipid.find_model` take the names below; ``from shipid.models import Nomoto`` imports a component by its class."
    )
    pages = "".join(f"   {name}\n" for name in known["models"])
    return "\n\n".join(
        [
            title("Ship models"),
            about,
            table(("Model", "What it describes"), models, "30 70"),
            title("Components to join", "-"),
            "What a ship, its environment and its helm may be joined of besides. `shipid.join` connects what a component reads "
            "to what another one states under the same name.",
            table(("Component", "What it describes", "States", "Reads"), _other_components(known), "20 40 20 20"),
            title("Ships", "-"),
            "Parameter sets with the source of every value, for ``--ship`` and `shipid.find_ship`.",
            table(("Ship", "Which", "Models"), ships, "20 45 35"),
            f".. toctree::\n   :hidden:\n\n{pages}",
        ]
    )


def _write_pages(app: Any, config: Any) -> None:
    known = _ask("models")
    folder = emptied(Path(app.srcdir) / "generated" / "models")
    for name in known["models"]:
        ships = [s for s, ship in known["ships"].items() if name in ship["models"]]
        (folder / f"{name}.rst").write_text(_model_page(name, ships), encoding="utf-8")
    (folder / "index.rst").write_text(_overview(known), encoding="utf-8")


def setup(app: Any) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    app.connect("config-inited", _write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
