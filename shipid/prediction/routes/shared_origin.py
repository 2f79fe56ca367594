"""Where x and y are 0 for a route and a record together."""

from __future__ import annotations

from shipid.foundation.errors import UsageError
from shipid.prediction.routes.route import Route
from shipid.trials.trial import Trial


def shared_origin(route: Route | None, trial: Trial | None) -> tuple[float, float] | None:
    """Return where x and y are 0: those of a record, where there is one, and otherwise those of the route.

    Parameters
    ----------
    route : Route or None
        The route.
    trial : Trial or None
        The record.

    Returns
    -------
    tuple of float or None
        Latitude and longitude in rad; None where nothing says it.

    Raises
    ------
    UsageError
        If the route is on the earth, and the record does not say where it was.
    """
    if trial is None:
        return None if route is None else route.origin
    if route is not None and route.geographic and trial.source.origin is None:
        raise UsageError(
            f"trial {trial.name} does not say where on the earth its x and y are 0, and the route has latitudes and longitudes: log "
            "positions as latitude and longitude, or write the route in the trial's metres."
        )
    return trial.source.origin
