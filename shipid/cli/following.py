"""Samples as they arrive: one line in, one line of estimates out."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING

import click

from shipid.cli.delivery import Delivery, json_text
from shipid.cli.messages import say
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.estimation.online.online_filter import OnlineFilter
    from shipid.foundation.aliases import Plain
    from shipid.parameters.parameter_set import ParameterSet
    from shipid.trials.logs.live.table import LiveSample

#: A log that names its channels one by one is listened to for so long before the filter starts [s].
_LISTEN = 3.0


def follow(
    source: str,
    model: Model,
    ship: ParameterSet | None,
    measured: Mapping[str, str] | None,
    settings: Mapping[str, Plain],
    format_: str | None,
    wait: str,
    delivery: Delivery,
) -> ExitCode:
    """Filter samples as they arrive, and print an estimate for each.

    Parameters
    ----------
    source : str
        A file, or ``-``.
    model : Model
        The model.
    ship, measured, settings
        See `shipid.estimation.kalman.ExtendedKalmanFilter`.
    format_ : str or None
        Trial format file, or ``nmea``.
    wait : str
        Seconds without a new line after which a file is taken to have ended, with its unit.
    delivery : Delivery
        As JSON, an estimate is a line in the envelope of every command, instead of a line of a table.

    Returns
    -------
    ExitCode

    Raises
    ------
    TrialError
        If nothing comes before the source ends, or its header cannot be read.
    """
    from shipid.declaration.units import to_si
    from shipid.trials.logs.live.lines import lines_of
    from shipid.trials.logs.live.reader import LiveLog
    from shipid.trials.logs.nmea.settings import chosen_format

    fmt = chosen_format(format_)
    lines = lines_of(source, to_si(wait, "s", "the wait"), fmt.encoding if fmt else None)
    log = LiveLog(lines, source, fmt, say)
    printer = _Printer(source, delivery)
    heard: list[LiveSample] = []
    online: OnlineFilter | None = None
    for sample in log:
        if online is not None:
            printer.update(online, sample)
            continue
        heard.append(sample)
        if log.settled or sample.values["t"] - heard[0].values["t"] >= _LISTEN:
            online = printer.start(model, ship, measured, settings, log.names, heard)
    if online is None:
        printer.start(model, ship, measured, settings, log.names, heard)
    return ExitCode.DONE


class _Printer:
    """Runs the filter over samples and prints its estimates."""

    def __init__(self, source: str, delivery: Delivery) -> None:
        self.source, self.delivery = source, delivery
        self.names: list[str] = []
        self.channels: tuple[str, ...] = ()
        self.header = ""

    def start(
        self,
        model: Model,
        ship: ParameterSet | None,
        measured: Mapping[str, str] | None,
        settings: Mapping[str, Plain],
        names: tuple[str, ...],
        heard: list[LiveSample],
    ) -> OnlineFilter:
        """Start a filter for the channels there are, and give it the samples that have come."""
        from shipid.estimation.kalman import ExtendedKalmanFilter
        from shipid.estimation.settings.defaults import standard_sensors
        from shipid.generation.reduction import reduced

        self.channels = names
        sensors = standard_sensors(model, names) if measured is None else measured
        kalman = ExtendedKalmanFilter(reduced(model, tuple(sensors)), ship, measured=sensors, **settings)
        self.names = [s for s in kalman.model.states if s not in kalman.parameters.values()] + list(kalman.parameters)
        heads = [f"{p}{n} [{kalman.model[n].unit}]" for n in self.names for p in ("", "std_")]
        self.header = ",".join(["t [s]", *heads, "rejected"])
        online = kalman.start()
        for sample in heard:
            self.update(online, sample)
        return online

    def update(self, online: OnlineFilter, sample: LiveSample) -> None:
        """Give the filter a sample and print the estimate."""
        from shipid.generation.simulator import UnstatedInputError

        try:
            estimate = online.update(sample.values)
        except UnstatedInputError:
            named = [n for n in online.design.model.inputs if n in self.channels]
            lacking = [n for n in named if not math.isfinite(sample.values.get(n, math.nan))]
            if not lacking:
                raise
            say(f"{self.source}, line {sample.line}: no {' and '.join(lacking)} yet; left out.")
            return
        if estimate.refused:
            say(f"{self.source}, line {sample.line}: refused, {estimate.refused}.")
            return
        if self.delivery.as_json:
            click.echo(json_text(self.delivery.enveloped(estimate.to_dict()), indent=None))
        else:
            # With the first estimate: a record that cannot be filtered prints nothing.
            if self.header:
                click.echo(self.header)
                self.header = ""
            numbers = [v for n in self.names for v in (estimate[n], estimate.std_of(n))]
            cells = [f"{v:.9g}" if math.isfinite(v) else "" for v in numbers]
            click.echo(",".join([f"{estimate.t:.9g}", *cells, " ".join(estimate.rejected)]))
        sys.stdout.flush()
