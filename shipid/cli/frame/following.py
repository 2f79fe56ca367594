"""Samples as they arrive: one line in, one line of estimates out."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import Delivery
from shipid.cli.frame.envelope import json_text
from shipid.cli.frame.messages import say, warn, warned
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.estimation.online.online_filter import OnlineFilter
    from shipid.foundation.aliases import Plain
    from shipid.parameters.parameter_set import ParameterSet
    from shipid.trials.logs.live.reader import LiveLog
    from shipid.trials.logs.live.table import LiveSample

#: A log is listened to for so long [s], and for so many samples, before the filter starts: one wild sample at its beginning is
#: then no first estimate, and a log that names its channels one by one has named them.
_LISTEN, _FIRST = 3.0, 5
#: What a filter has met is looked at every so many samples.
_LOOK = 20


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
    EmptyFileError
        If no sample gives an estimate.
    """
    from shipid.declaration.units import to_si
    from shipid.trials.errors import EmptyFileError
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
        if len(heard) >= _FIRST and (log.settled or sample.values["t"] - heard[0].values["t"] >= _LISTEN):
            online = printer.start(model, ship, measured, settings, log, heard)
    if online is None:
        online = printer.start(model, ship, measured, settings, log, heard)
    if not printer.count:
        raise EmptyFileError(f"'{source}' gave no estimate: each of its samples was left out, for the reasons above.")
    printer.look(online)
    return ExitCode.DOUBTFUL if any(n.serious for n in warned()) else ExitCode.DONE


class _Printer:
    """Runs the filter over samples and prints its estimates."""

    def __init__(self, source: str, delivery: Delivery) -> None:
        self.source, self.delivery = source, delivery
        self.names: list[str] = []
        self.units: dict[str, tuple[str, float]] = {}
        self.count = 0
        self.told: set[str] = set()
        self.channels: tuple[str, ...] = ()
        self.header = ""
        self.model: Model | None = None
        self.ship: ParameterSet | None = None

    def start(
        self,
        model: Model,
        ship: ParameterSet | None,
        measured: Mapping[str, str] | None,
        settings: Mapping[str, Plain],
        log: LiveLog,
        heard: list[LiveSample],
    ) -> OnlineFilter:
        """Start a filter for the channels there are, and give it the samples that have come."""
        from shipid.estimation.kalman import ExtendedKalmanFilter
        from shipid.estimation.online.reached import Reached
        from shipid.estimation.settings.defaults import standard_sensors
        from shipid.generation.reduction import reduced

        self.channels, self.model, self.ship = log.names, model, ship
        sensors = standard_sensors(model, log.names) if measured is None else measured
        kalman = ExtendedKalmanFilter(reduced(model, tuple(sensors)), ship, measured=sensors, **settings)
        self.reached = Reached(kalman.design.instruments.inputs)
        self.names = [s for s in kalman.model.states if s not in kalman.parameters.values()] + list(kalman.parameters)
        self.units = {n: _unit_of(kalman.model, n, log.units) for n in self.names}
        heads = [f"{p}{n} [{self.units[n][0]}]" for n in self.names for p in ("", "std_")]
        self.header = ",".join(["t [s]", *heads, "rejected"])
        online = kalman.start()
        online.look_at([sample.values for sample in heard])
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
        self.reached.add(sample.values)
        self.count += 1
        if self.count % _LOOK == 0:
            self.look(online)
        if self.delivery.as_json:
            data = estimate.to_dict()
            for name, (unit, factor) in self.units.items():
                one = data["estimates"][name]
                one |= {k: None if one[k] is None else one[k] * factor for k in ("value", "std")} | {"unit": unit}
            click.echo(json_text(self.delivery.enveloped(data), indent=None))
        else:
            # With the first estimate: a record that cannot be filtered prints nothing.
            if self.header:
                click.echo(self.header)
                self.header = ""
            numbers = [v * self.units[n][1] for n in self.names for v in (estimate[n], estimate.std_of(n))]
            cells = [f"{v:.9g}" if math.isfinite(v) else "" for v in numbers]
            click.echo(",".join([f"{estimate.t:.9g}", *cells, " ".join(estimate.rejected)]))
        sys.stdout.flush()

    def look(self, online: OnlineFilter) -> None:
        """Say what speaks against the filter so far, each thing once."""
        assert self.model is not None
        for notice in (*online.tally.notices, *self.reached.beyond(self.model, self.ship)):
            about = " ".join(
                [notice.kind, *(str(notice.known[n]) for n in ("sensor", "quantity") if n in notice.known)]
            )
            if about not in self.told:
                self.told.add(about)
                warn(notice)


def _unit_of(model: Model, name: str, stated: Mapping[str, str]) -> tuple[str, float]:
    """The unit in which a quantity is printed, that of the log or the one a reader expects, and the factor to it."""
    from shipid.declaration.units import factor
    from shipid.declaration.vocabulary import display_unit
    from shipid.trials.columns import inside_unit, to_inside

    own = model[name].unit
    if name in stated and inside_unit(name, stated[name]) == own:
        return stated[name], 1 / to_inside(name, stated[name])
    shown = display_unit(name, own)
    return shown, factor(own, shown)
