"""Planned trials as a page: what to sail and when, what it tells of each coefficient, what that rests on."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from shipid.foundation.numbers import given, number, spread, uncertain
from shipid.planning.leg import Leg
from shipid.planning.plan import Forecast, Plan
from shipid.planning.timetable import SeaRoom, Timetable, clock
from shipid.report.figures.charts import Axes, Line, chart
from shipid.report.page import Page, Row, Section
from shipid.report.typography.quantities import named, shown_field
from shipid.report.views.equations import equations_section
from shipid.report.views.words import boxes, count, listed, sentence, versions_now, with_unit

#: Standard deviations that differ by less are the same.
_ALIKE = 0.05


def plan_page(plan: Plan) -> Page:
    """Return what the page says of a plan.

    Parameters
    ----------
    plan : Plan
        The plan.
    """
    warnings, notes = boxes(plan.warnings, sentence)
    return Page(
        f"Trials to sail for {plan.model.name} of {plan.ship}",
        [("", _answer(plan))],
        [_legs(plan), *_timetable(plan), _forecasts(plan), _grounds(plan), equations_section(plan.model)],
        warnings=warnings,
        cautions=notes,
        footer=versions_now(),
    )


def _answer(plan: Plan) -> list[str]:
    said = [
        f"{sentence(count(len(plan.legs), 'manoeuvre'))} in {clock(plan.duration)}; {clock(plan.time)} are available (minutes and seconds)."
    ]
    gains = [f"of coefficient {n} {_times(f.ratio)}" for n, f in plan.parameters.items() if f.ratio]
    if gains:
        said.append(f"Compared with the standard zig-zags, the standard deviation {listed(gains)}.")
    lost = [n for n, f in plan.parameters.items() if f.std is None]
    if lost:
        said.append(f"Not determined by these trials: {', '.join(lost)}.")
    return said


def _times(gain: float) -> str:
    """How a standard deviation compares, in words."""
    if abs(gain - 1) < _ALIKE:
        return "is as large"
    size, than = (gain, "smaller") if gain > 1 else (1 / gain, "larger")
    return f"is {number(size, 2)} times {than}"


def _legs(plan: Plan) -> Section:
    view = {"legs": [_leg(leg) for leg in plan.legs], "standard": [_leg(leg) for leg in plan.standard]}
    return Section("What to sail", "plan/legs.html", view, short="Manoeuvres")


def _timetable(plan: Plan) -> list[Section]:
    """The orders in their sequence, and the sea room; nothing where the trials could not be simulated."""
    table = plan.timetable
    if table is None:
        return []
    orders: list[Row] = [
        {"time": clock(o.time), "leg": str(o.leg), "action": o.action, "when": o.when} for o in table.orders
    ]
    several = len(table.rooms) > 1
    rooms = [_room(str(k), room) for k, room in enumerate(table.rooms, start=1) if several]
    rooms += [] if table.room is None else [_room("all" if several else "1", table.room)]
    columns = [("At [min:s]", "time", "keep"), ("Manoeuvre", "leg", "n"), ("Order", "action")]
    columns += [("When", "when")] if any(o.when for o in table.orders) else []
    view = {
        "weather": table.weather,
        "columns": columns,
        "orders": orders,
        "rooms": rooms,
        "figure": _orders_figure(table, plan.duration),
    }
    return [Section("Orders to the helm", "plan/timetable.html", view, short="Timetable")]


def _orders_figure(table: Timetable, end: float) -> Markup | None:
    """The rudder that is ordered against time; amidships where a line orders none."""
    how = shown_field("delta")
    given_at = [(o.time, 0.0 if o.rudder is None else o.rudder * how.factor) for o in table.orders]
    if not any(rudder for _, rudder in given_at):
        return None
    times, rudders = np.array([*given_at, (end, 0.0)]).T
    steps = Line("", np.repeat(times / 60, 2)[1:], np.repeat(rudders, 2)[:-1])
    axes = [Axes(f"{how.label} ordered, to starboard", how.unit, [steps])]
    return chart(axes, "time of the plan [min]", "orders", "Rudder orders against time")


def _room(which: str, room: SeaRoom) -> Row:
    sides = ("ahead", "astern", "port", "starboard")
    return {"which": which} | {side: f"{getattr(room, side):.0f} m" for side in sides}


def _leg(leg: Leg) -> Row:
    seed = str(leg.seed) if leg.manoeuvre.startswith("telegraph") else ""
    return {
        "start": clock(leg.start),
        "manoeuvre": leg.manoeuvre,
        "speed": f"{number(leg.speed, 3)} m/s",
        "duration": clock(leg.duration),
        "seed": seed,
    }


def _forecasts(plan: Plan) -> Section:
    rows = [_forecast(plan, f) for f in plan.parameters.values()]
    return Section("What the trials will tell", "plan/forecasts.html", {"rows": rows}, short="Coefficients")


def _forecast(plan: Plan, f: Forecast) -> Row:
    return {
        "named": named(plan.model, f.name),
        "value": with_unit(given(float(f"{f.value:.4g}")) if f.std is None else uncertain(f.value, f.std), f.unit),
        "standard": "stays open" if f.standard_std is None else with_unit(spread(f.value, f.standard_std), f.unit),
        "gain": "" if f.ratio is None else number(f.ratio, 3),
        "determined": f.std is not None,
        "meaning": f.meaning,
    }


def _grounds(plan: Plan) -> Section:
    noise: list[Row] = []
    for name, level in plan.noise.items():
        how = shown_field(name)
        noise.append({"label": how.label, "level": f"{how.number(level, 2)} {how.unit}"})
    over = f"{'the worst' if plan.worst_case else 'the average'} of {plan.draws} draws of the coefficients"
    goal = "the determinant of the information" if plan.criterion == "D" else "the mean relative variance"
    view = {
        "noise": noise,
        "words": f"Chosen from {plan.candidates} candidates by {goal}, over {over if plan.draws else 'the coefficients as they are'}.",
        "samples": f"A sample every {number(plan.sampling, 2)} s; noise that is independent after {number(plan.independent, 2)} s.",
    }
    return Section("What this rests on", "plan/grounds.html", view, folded=True)
