"""The source of a bridge by what the command line says of it."""

from __future__ import annotations

from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.bridge_settings import BridgeSettings
from shipid.bridge.core.source import SampleSource
from shipid.bridge.sources.listened import ListenedSource
from shipid.bridge.sources.replayed import ReplayedSource
from shipid.bridge.sources.signalk import SignalKSource
from shipid.bridge.sources.simulated import SimulatedSource, has_wind
from shipid.foundation.errors import UsageError
from shipid.prediction.following.wheel_over import TrackLeg
from shipid.trials.logs.nmea.settings import NmeaFormat, chosen_format
from shipid.trials.logs.reading import read_trial
from shipid.trials.manoeuvres.flows import check_flows


def source_of(
    settings: BridgeSettings,
    pilot: Autopilot,
    origin: tuple[float, float] | None = None,
    begin: TrackLeg | None = None,
) -> SampleSource:
    """Return the source of a bridge.

    Parameters
    ----------
    settings : BridgeSettings
        What the bridge is opened with.
    pilot : Autopilot
        The autopilot, with the ship.
    origin : tuple of float, optional
        Latitude and longitude in rad of x = y = 0.
    begin : TrackLeg, optional
        Where a simulated ship begins; at the origin on course 000 by default.

    Raises
    ------
    UsageError
        If there is no such source.
    """
    kind, _, rest = settings.source.partition(":")
    if kind != "simulate" and any(f is not None for f in (settings.current, settings.wind, settings.waves)):
        raise UsageError("--current, --wind and --waves belong to a simulation.")
    if kind == "simulate" and not rest:
        calm = (0.0, 0.0)
        check_flows(pilot.model, settings.current, settings.wind)
        if settings.wind is not None and not has_wind(pilot):
            raise UsageError(
                f"ship {pilot.ship.name} states no coefficients of the wind, N_w and F_w of a table [wind], so a wind does not act on "
                "her: leave --wind out."
            )
        leg = begin or TrackLeg(0.0, 0.0, 0.0)
        return SimulatedSource(
            pilot,
            seed=settings.seed,
            heading=leg.course,
            place=(leg.x, leg.y),
            current=settings.current or calm,
            wind=settings.wind or calm,
            waves=settings.waves,
        )
    if kind == "replay" and rest:
        return ReplayedSource(read_trial(rest, format=settings.format))
    if kind == "signalk" and rest:
        return SignalKSource(rest, origin)
    if kind == "nmea" and rest:
        return _nmea(rest, settings, origin)
    raise UsageError(
        f"there is no source '{settings.source}': write simulate, replay:TRIAL, nmea:udp:PORT, nmea:tcp:HOST:PORT or signalk:URL."
    )


def _nmea(rest: str, settings: BridgeSettings, origin: tuple[float, float] | None) -> ListenedSource:
    protocol, _, address = rest.partition(":")
    host, _, port = address.rpartition(":")
    if (
        protocol not in ("udp", "tcp")
        or not port.isdigit()
        or not 0 < int(port) < 65536
        or (protocol == "tcp" and not host)
    ):
        raise UsageError(f"'nmea:{rest}' is no source: write nmea:udp:PORT or nmea:tcp:HOST:PORT.")
    fmt = chosen_format(settings.format)
    if fmt is not None and not isinstance(fmt, NmeaFormat):
        raise UsageError(f"the format {settings.format} has no table [nmea].")
    return ListenedSource(host.strip("[]") or None, int(port), protocol, fmt, origin)
