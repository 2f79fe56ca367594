"""What can be wrong with a route: one class a cause, each message names the file, the waypoint and the remedy."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError


class RouteError(ShipidError):
    """Base of everything that can be wrong with a route."""


class RouteFileError(RouteError):
    """A file that is no route, or a damaged or hostile one."""


class RouteSizeError(RouteError):
    """A file or a route that is larger than is read."""


class WaypointError(RouteError):
    """A waypoint with a value that cannot be."""


class RoutePlaneError(RouteError):
    """A route that does not fit into a plane of local metres."""
