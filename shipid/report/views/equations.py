"""The equations of a model, as every page of an identified or filtered model ends with them."""

from __future__ import annotations

from markupsafe import Markup

from shipid.declaration.model import Model
from shipid.generation.typesetting.typeset import typeset
from shipid.report.page import Section


def equations_section(model: Model) -> Section:
    """Return the section of the equations, typeset, each with its source.

    Parameters
    ----------
    model : Model
        The model.
    """
    rows = [
        {"plain": e.plain, "mathml": Markup(e.mathml), "source": e.source, "where": f"{e.component}.{e.method}"}
        for e in typeset(model)
    ]
    return Section(
        f"Equations of model {model.name}", "equations.html", {"equations": rows}, short="Equations", folded=True
    )
