"""Nonlinear course changes in batches: rudder limit and rate, loss of speed, wind, waves and current, all runs in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChanges
from shipid.autopilot.course_changes.course_measures import CourseMeasures, read_measures, settings_of, sides_of
from shipid.autopilot.course_changes.sea_filter import ABOVE, LAG, SeaFiltered
from shipid.autopilot.course_changes.turn_order import RADIUS, TurnOrder
from shipid.autopilot.course_changes.weather import CALM, Weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, heading_frequency, linear_ship
from shipid.autopilot.design.control_law import Measured
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.generation.ensemble import make_ensemble, steps_of
from shipid.generation.simulator import make_simulator
from shipid.parameters.draws import Drawn
from shipid.parts.guard_watch import guard_watch

#: Length of a run in L/u, and the clock: a fiftieth of L/u, and short enough for the servo and the fastest pole of the ship.
LENGTHS, PACE, _SERVO, _FASTEST = 40.0, 0.02, 0.8, 0.8
#: Samples of a history that is kept.
_POINTS = 400


def clock_of(pilot: Autopilot, model: Model, speeds: np.ndarray, lengths: float = LENGTHS) -> tuple[np.ndarray, int]:
    """Return the interval of each run in s, and the steps all of them take.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    model : Model
        Its closed loop, with the components joined to it.
    speeds : ndarray, shape (runs,)
        In m/s.
    lengths : float
        Duration in L/u.
    """
    unit_time = np.array([1 / pilot.pace(float(v)) for v in speeds])
    finest = np.minimum(PACE * unit_time, stiffest(pilot, model, speeds))
    count = steps_of(int(np.ceil((lengths * unit_time / finest).max())))
    return lengths * unit_time / count, count


def stiffest(pilot: Autopilot, model: Model, speeds: np.ndarray) -> float:
    """Return the longest step in s in which servo and ship are integrated well.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    model : Model
        Its closed loop, or the ship with its steering machine.
    speeds : ndarray, shape (runs,)
        In m/s.
    """
    longest = np.inf
    if "tau_delta" in model.constants:
        longest = _SERVO * coefficients_of(pilot, model, float(speeds[0]))["tau_delta"]
    fastest = float(np.abs(np.linalg.eigvals(linear_ship(pilot, [max(speeds)]).A[0])).max())
    return min(longest, _FASTEST / fastest) if fastest > 0 else longest


def run_course_changes(
    pilot: Autopilot,
    speeds: Sequence[float] | np.ndarray,
    changes: Sequence[float] | np.ndarray,
    *,
    condition: int = 0,
    values: Mapping[str, np.ndarray | float] | None = None,
    drawn: Drawn | None = None,
    weather: Weather | None = None,
    headings: Sequence[float] | np.ndarray | None = None,
    measured_from: float = 0.0,
    lengths: float = LENGTHS,
    seed: int = 0,
    filtered: bool = False,
) -> CourseChanges:
    """Run course changes, each one a run of its own.

    An autopilot that holds a rate of turn is ordered to turn by the change on a radius of eight ship lengths.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speeds, changes : sequence of float, shape (runs,)
        Speed before the change in m/s, and the change in rad; zero keeps the course.
    condition : int
        Which load condition.
    values : mapping of str to ndarray or float, optional
        Coefficients that replace those of the ship, SI: one for all, or one a run.
    drawn : Drawn, optional
        Coefficients of the ship drawn from its uncertainty, one draw a run.
    weather : Weather, optional
        Wind, waves and current; calm when not given.
    headings : sequence of float, optional
        Direction the weather goes to in each run, from the first course, in rad; along it by default.
    measured_from : float
        Time from which errors and activity are summed, in L/u.
    lengths : float
        Duration in L/u.
    seed : int
        Of the waves.
    filtered : bool
        Whether heading and rate of turn pass the sea filter, set to the frequency of encounter.

    Returns
    -------
    CourseChanges

    Raises
    ------
    UnstatedInputError
        If the model reads an input that neither the manoeuvre nor the weather states and that declares no default.
    """
    speeds, changes = np.asarray(speeds, dtype=float), np.asarray(changes, dtype=float)
    parts: list[type[Component]] = [
        CourseMeasures,
        *guard_watch(pilot.model),
        *ordering(pilot),
        *(weather.components(pilot.model) if weather else ()),
    ]
    model = closed_loop(pilot, *parts, measured=SeaFiltered if filtered else Measured)
    varying = ("wave_noise",) if "wave_noise" in model.inputs else ()
    intervals, count = clock_of(pilot, model, speeds, lengths)
    begin = measured_from * np.array([1 / pilot.pace(float(v)) for v in speeds])
    own: dict[str, float | np.ndarray] = {**settings_of(changes, begin), **ordered_rate(pilot, speeds)}
    inputs: dict[str, float | np.ndarray] = {
        **CALM,
        "u": speeds,
        "cruise": speeds,
        "psi_order": changes,
        "loading": float(condition),
    }
    noise = None
    if weather is not None:
        directions = np.zeros(speeds.size) if headings is None else np.asarray(headings, dtype=float)
        inputs |= weather.inputs(directions)
        own |= weather.values(pilot, model, condition)
        if filtered:
            own |= sea_settings(pilot, weather, speeds, directions - 0.5 * changes)
        if varying:
            noise = weather.noise(count, intervals, seed)[None]
    known = _coefficients(pilot, model, speeds, condition)
    if drawn is not None:
        known |= scaled_draws(drawn, known)
    start = {"u": speeds, "moving": sides_of(changes)}
    end = make_ensemble(model, varying).run(
        speeds.size, {**known, **own, **(values or {})}, inputs, start, intervals, count, noise
    )
    return read_measures(end, speeds, changes, intervals * count, begin)


def ordering(pilot: Autopilot) -> tuple[type[Component], ...]:
    """Return the component to join to the loop of an autopilot so that it takes ``psi_order``.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
    return (TurnOrder,) if pilot.mode == "rate" else ()


def ordered_rate(pilot: Autopilot, speeds: np.ndarray) -> dict[str, np.ndarray]:
    """Return the rate of turn of a course change, for an autopilot that holds one.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speeds : ndarray, shape (runs,)
        In m/s.
    """
    return {"turn_rate": speeds / (RADIUS * pilot.length)} if pilot.mode == "rate" else {}


def sea_settings(
    pilot: Autopilot, weather: Weather, speeds: np.ndarray, directions: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the constants of the sea filter, in rad/s.

    The notch is at the frequency of encounter, but well above the natural frequency of the heading, which sets the corner of
    the lag.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    weather : Weather
        The sea.
    speeds, directions : ndarray, shape (runs,)
        Of the ship in m/s, and where the waves go to from its heading, in rad.
    """
    met = weather.encounter(speeds, directions)
    different, place = np.unique(speeds, return_inverse=True)
    natural = np.array([heading_frequency(pilot, float(v)) for v in different])[place]
    return {"sea_frequency": np.maximum(met, ABOVE * natural), "sea_lag": LAG * natural}


def _coefficients(pilot: Autopilot, model: Model, speeds: np.ndarray, condition: int) -> dict[str, np.ndarray]:
    """Coefficients of every run; each speed is looked up once."""
    different, place = np.unique(speeds, return_inverse=True)
    tables = [coefficients_of(pilot, model, float(v), condition) for v in different]
    return {n: np.array([t[n] for t in tables])[place] for n in tables[0]}


def scaled_draws(drawn: Drawn, known: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return draws at the speed of each run: a deviation keeps its share of the coefficient.

    Parameters
    ----------
    drawn : Drawn
        Draws at the ship's own speed, one a run.
    known : mapping of str to ndarray
        The coefficients of the ship at the speed of each run.
    """
    found = {}
    for k, name in enumerate(drawn.names):
        nominal, away = drawn.nominal[k], drawn.values[:, k] - drawn.nominal[k]
        # A coefficient that is zero at the ship's own speed is zero at every speed: its deviation stays as it is.
        found[name] = known[name] + away * (known[name] / nominal if nominal else 1.0)
    return found


def course_histories(
    pilot: Autopilot, speeds: Sequence[float], changes: Sequence[float], condition: int = 0, drawn: Drawn | None = None
) -> dict[str, np.ndarray]:
    """Return heading and rudder against time for course changes in calm, thinned to about 400 samples.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speeds, changes : sequence of float, shape (runs,)
        In m/s and rad.
    condition : int
        Which load condition.
    drawn : Drawn, optional
        Draws of the ship, one a run.

    Returns
    -------
    dict of str to ndarray
        ``t``, ``psi``, ``delta``, each of shape (runs, n), SI.
    """
    model = closed_loop(pilot, *ordering(pilot))
    simulator = make_simulator(model, ("psi", "delta"), hold="zero")
    intervals, count = clock_of(pilot, model, np.asarray(speeds))
    every = max(1, count // _POINTS)
    found: dict[str, list[np.ndarray]] = {"t": [], "psi": [], "delta": []}
    for k, (speed, change) in enumerate(zip(speeds, changes)):
        known = _coefficients(pilot, model, np.array([speed]), condition)
        if drawn is not None:
            known |= scaled_draws(Drawn(drawn.names, drawn.nominal, drawn.values[[k]], drawn.source), known)
        known |= ordered_rate(pilot, np.array([speed]))
        inputs = {
            **CALM,
            "u": speed,
            "cruise": speed,
            "psi_order": change,
            "loading": float(condition),
        }
        run = simulator(
            intervals[k] * np.arange(count), {n: float(v[0]) for n, v in known.items()}, inputs, {"u": speed}
        )
        for name, column in (("t", run.t), *run.columns.items()):
            found[name].append(column[::every])
    return {n: np.array(rows) for n, rows in found.items()}
