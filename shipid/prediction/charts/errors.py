"""What can be wrong with a chart: one class a cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError


class ChartError(ShipidError):
    """Base of everything that can be wrong with a chart."""


class ChartFileError(ChartError):
    """A file that is no chart, or a damaged one."""


class ChartSizeError(ChartError):
    """A chart that is larger than is read."""
