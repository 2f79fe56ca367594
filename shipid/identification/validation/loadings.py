"""Trials at several loadings under one set of coefficients: what there is to say of it."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.foundation.notices import Notice
from shipid.trials.conditions import Conditions, different_loadings

#: Kind of the notice.
LOADINGS = "loadings"


def loading_notices(stated: Mapping[str, Conditions]) -> list[Notice]:
    """Return a notice where trials state different loadings, and nothing where those that state any agree.

    Parameters
    ----------
    stated : mapping of str to Conditions
        By trial.
    """
    found = different_loadings(stated)
    if found is None:
        return []
    words = (
        f"the trials state different loadings, and one set of coefficients stands for all of them: {found}. It is an "
        "average of different ships: fit each loading alone, and compare the coefficients."
    )
    return [Notice(words, LOADINGS)]
