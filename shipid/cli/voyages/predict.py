"""``shipid predict``: where a ship goes under an order, from a state or from a trial at an instant."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.flows import current_option, wind_option
from shipid.cli.frame.options import (
    format_option,
    input_option,
    model_argument,
    model_given,
    set_option,
    ship_given,
    ship_option,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.numbers import moment

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from shipid.autopilot.design.autopilot import Autopilot
    from shipid.foundation.notices import Notice
    from shipid.prediction.situations.situation import Situation
    from shipid.prediction.tracks.track_predictor import Band
    from shipid.trials.trial import Trial

_TRACK = "track.csv"
#: Names that a state may give beside those of the model, with their units.
_STATE = {"psi": "rad", "u": "m/s", "r": "rad/s", "v": "m/s", "x": "m", "y": "m", "delta": "rad", "cruise": "m/s"}


@click.command()
@model_argument
@ship_option(required=True)
@click.option(
    "--schedule", metavar="FILE", help="The autopilot, a schedule.toml of shipid tune; one is designed by default."
)
@click.option(
    "--from",
    "begin",
    metavar="STATE|TRIAL@T",
    help="A state, 'psi=40 deg,u=9 m/s,r=0.1 deg/s', or a trial at a time in s: nothing later is used. On a straight course at her own speed by default.",
)
@click.option("--heading", type=NumberWithUnit("deg"), help="Heading to steer, as in '75 deg'.")
@click.option("--rudder", type=NumberWithUnit("deg"), help="Rudder angle to hold, as in '20 deg'.")
@click.option(
    "--rate", type=NumberWithUnit("deg/s"), help="Rate of turn to hold, '20 deg/min'; with --heading, that of the turn."
)
@click.option("--route", metavar="FILE", help="The next turn of a route, RTZ or CSV, in place of an order.")
@click.option("--chart", metavar="FILE", help="Drawn below the track: GeoJSON, or a cell of S-57 (extra chart).")
@click.option(
    "--rudder-limit", type=NumberWithUnit("deg"), help="Largest rudder angle; the autopilot's own by default."
)
@click.option("--horizon", default=20.0, show_default=True, metavar="L", help="Length of the track in ship lengths.")
@current_option("; from a trial it is estimated")
@wind_option()
@click.option(
    "--waves",
    metavar="W",
    help="Yaw by waves in the heading and rate of turn of a state, '0.5 deg from 300 deg'; it moves no track.",
)
@click.option(
    "--band", default="linear", show_default=True, metavar="linear|samples|none", help="How the 95 % band is found."
)
@set_option
@input_option
@format_option
@delivered(RESULT, _TRACK, REPORT)
def predict(
    model: str,
    ship: str,
    schedule: str | None,
    begin: str | None,
    heading: str | None,
    rudder: str | None,
    rate: str | None,
    route: str | None,
    chart: str | None,
    rudder_limit: str | None,
    horizon: float,
    current: str | None,
    wind: str | None,
    waves: str | None,
    band: Band,
    values: dict[str, str],
    inputs: dict[str, str],
    format_: str | None,
    delivery: Delivery,
) -> ExitCode:
    """Predict where a ship goes under an order, or at the next turn of a route: her track with its band, stage by stage.

    From a trial, a filter of the ship's own model runs up to the instant and says how sure her state is; where predictions from
    earlier instants were farther off than their bands, the band is widened. The track is in metres to the north and to the east, on
    the position of the trial or from zero.

    \b
    shipid predict de-keizer --ship soesterberg --heading '60 deg'
    shipid predict de-keizer --ship soesterberg --from 'psi=40 deg,u=9 m/s' --rudder '10 deg' --waves '0.5 deg from 300 deg'
    shipid predict de-keizer --ship ship.toml --from trial.csv@300 --rudder '20 deg' --out predicted
    shipid predict de-keizer --ship ship.toml --from trial.csv@300 --route plan.rtz --chart harbour.000 --out predicted
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from dataclasses import replace

    from shipid.foundation.errors import UsageError
    from shipid.foundation.notices import Notice
    from shipid.prediction.charts.read_chart import read_chart
    from shipid.prediction.predict_route import predict_route
    from shipid.prediction.predict_track import predict_track
    from shipid.prediction.routes.read_route import read_route
    from shipid.prediction.routes.shared_origin import shared_origin
    from shipid.prediction.sailing.loop_cycles import loop_cycles
    from shipid.prediction.situations.situation import Situation

    ordered = heading is not None or rudder is not None or rate is not None
    if route is not None and ordered:
        raise UsageError("--route says what to steer: leave out --heading, --rudder and --rate.")
    if route is None and not ordered:
        raise UsageError("predict needs an order: --heading, --rudder, --rate or --route. See shipid predict --help.")
    plan = None if route is None else read_route(route)
    with delivery.progress() as tell:
        trial, at, held, noted = _record(model, begin, format_, inputs, tell)
        pilot = _pilot(model, ship, schedule, values, {**inputs, **held})
        situation, origin, told = _situation(
            pilot, begin, trial, at, current, wind, waves, tell, on_route=plan is not None
        )
        told = [*told, *noted]
        if schedule is not None and rudder is None:
            tell("sailing the schedule")
            known = situation.values if isinstance(situation, Situation) else situation
            told += loop_cycles(pilot, known.get("cruise", known["u"]), inputs={**inputs, **held})
        place = shared_origin(plan, trial)
        # A chart that cannot be drawn is told before the work is done.
        below = None if chart is None else read_chart(chart, _known(place))
        tell("predicting")
        if plan is not None:
            found = predict_route(
                pilot,
                situation,
                plan,
                origin=place,
                rudder_limit=rudder_limit,
                horizon=horizon,
                band=band,
                source=origin,
                warnings=told,
            )
        else:
            found = predict_track(
                pilot,
                situation,
                heading=heading,
                rudder=rudder,
                rate=rate,
                rudder_limit=rudder_limit,
                horizon=horizon,
                band=band,
                origin=origin,
                warnings=told,
            )
        if below is not None:
            notes = [n for n in below.notes if isinstance(n, Notice)]
            found = replace(found, chart=below, warnings=(*found.warnings, *notes))
    return delivery.hand_over(
        found,
        {
            _TRACK: delivery.table(found),
            REPORT: delivery.report(found),
        },
    )


def _pilot(
    model: str, ship: str, schedule: str | None, values: dict[str, str], inputs: Mapping[str, str | float]
) -> Autopilot:
    """The autopilot: of the schedule, on the model and the ship of the command line; or one by the defaults of ``shipid tune``."""
    from dataclasses import replace

    from shipid.autopilot.design.design_autopilot import design_autopilot
    from shipid.autopilot.design.read_schedule import check_same_ship, read_schedule

    found = model_given(model, inputs)
    known = ship_given(ship, values, found)
    if schedule is None:
        return design_autopilot(found, known)
    designed = read_schedule(schedule, found)
    check_same_ship(schedule, designed, known)
    return replace(designed, model=found, ships=(known,))


def _situation(
    pilot: Autopilot,
    begin: str | None,
    trial: Trial | None,
    at: float | None,
    current: str | None,
    wind: str | None,
    waves: str | None,
    tell: Callable[[str], object],
    *,
    on_route: bool,
) -> tuple[Situation | dict[str, float], str, list[Notice]]:
    from shipid.foundation.errors import UsageError
    from shipid.prediction.following.past_predictions import situation_with_past
    from shipid.prediction.situations.in_waves import in_waves
    from shipid.trials.manoeuvres.flows import flow_inputs

    flows = flow_inputs(current, wind)
    if trial is not None:
        if current is not None:
            raise UsageError("from a trial the current is estimated: leave --current out.")
        if waves is not None:
            raise UsageError("a trial shows its waves itself: leave --waves out.")
        tell("filtering")
        known, told = situation_with_past(pilot, trial, at, flows)
        return known, f"trial {trial.name} at {moment(known.t)} s", told
    # On a route without a state the ship begins at its first waypoint, on the heading that keeps the first leg.
    values = {"u": pilot.own_speed, "r": 0.0, **flows} | ({} if on_route else {"psi": 0.0})
    origin = "the first waypoint" if on_route else "a straight course"
    read: dict[str, float] = {}
    if begin is not None:
        read = _state_of(begin, pilot)
        values |= read
        origin = "the state given"
    return values if waves is None else in_waves(values, read, waves, pilot.length, pilot.own_speed), origin, []


def _known(origin: tuple[float, float] | None) -> tuple[float, float]:
    from shipid.foundation.errors import UsageError

    if origin is None:
        raise UsageError(
            "a chart has latitudes and longitudes, and nothing says where x and y are 0: give a --route with latitudes and longitudes, or "
            "begin from a trial whose positions are such."
        )
    return origin


def _state_of(text: str, pilot: Autopilot) -> dict[str, float]:
    from shipid.cli.frame.typed import levels_of
    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UnknownNameError

    named = (*pilot.model.states, *pilot.model.inputs, *pilot.model.parameters)
    units = {n: pilot.model[n].given_unit for n in named} | _STATE
    values = {}
    for name, value in levels_of(text).items():
        if name not in units:
            raise UnknownNameError("quantity of the ship's state called", name, units)
        values[name] = to_si(value, units[name], f"'{name}' of the state")
    return values


def _record(
    model: str, begin: str | None, format_: str | None, inputs: dict[str, str], tell: Callable[[str], object]
) -> tuple[Trial | None, float | None, dict[str, float], list[Notice]]:
    """The trial that a prediction begins from, its instant, and the inputs that are held as it says; none without a trial."""
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import find_model
    from shipid.prediction.situations.trial_situation import logged_inputs
    from shipid.trials.logs.reading import read_trial

    if begin is None or "=" in begin:
        return None, None, {}, []
    match = re.match(r"^(.+?)(?:@\s*([-+0-9.eE]+)\s*s?)?$", begin.strip(), re.DOTALL)
    if match is None:
        raise UsageError(
            f"'{begin}' is neither a state, as in 'psi=40 deg,u=9 m/s', nor a trial at a time, as in trial.csv@300."
        )
    path, _, tail = begin.strip().rpartition("@")
    if match.group(2) is None and path and format_ is None and ":" not in tail and not Path(begin).exists():
        raise UsageError(f"'{tail}' is no time in s, as in trial.csv@300.")
    tell("reading")
    trial = read_trial(match.group(1), format=format_)
    try:
        at = None if match.group(2) is None else float(match.group(2))
    except ValueError:
        raise UsageError(f"'{match.group(2)}' is no time in s, as in trial.csv@300.") from None
    return trial, at, *logged_inputs(find_model(model), trial, at, inputs)
