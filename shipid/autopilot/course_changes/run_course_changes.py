"""Nonlinear course changes in batches: rudder limit and rate, loss of speed, wind, waves and current, all runs in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from shipid.autopilot.course_changes.course_measures import CourseMeter
from shipid.autopilot.course_changes.sea_filter import ABOVE, SeaFiltered
from shipid.autopilot.course_changes.weather import Weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.control_law import Measured
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.generation.ensemble import make_ensemble, steps_of
from shipid.parameters.draws import Drawn

#: Length of a run in L/u, and the clock: a fiftieth of L/u, and short enough for the servo and the fastest pole of the ship.
LENGTHS, _PACE, _SERVO, _FASTEST = 40.0, 0.02, 0.8, 0.8
#: A course change is settled within this part of it, and at least half a degree.
_BAND, _LEAST_BAND = 0.02, np.deg2rad(0.5)


@dataclass(frozen=True, eq=False)
class Sailed:
    """What many runs measured; SI, one entry a run, not a number where a run diverged.

    Attributes
    ----------
    speed, change : ndarray
        Of the run: m/s, rad.
    overshoot : ndarray
        Largest heading beyond the one ordered, in rad.
    settling : ndarray
        Time until the heading stays within 2 % of the change, at least half a degree, in s; infinite where it does not.
    mean_error, rms_error, rms_rudder : ndarray
        In rad.
    reversals : ndarray
        Of the rudder, by more than half a degree, a minute.
    travel : ndarray
        Distance the rudder ran, in rad a second.
    cross_track : ndarray
        Width of the track across the new course once the heading is reached, the drift of the current taken out, in m.
    duration : ndarray
        Of the run in s.
    """

    speed: np.ndarray
    change: np.ndarray
    overshoot: np.ndarray
    settling: np.ndarray
    mean_error: np.ndarray
    rms_error: np.ndarray
    rms_rudder: np.ndarray
    reversals: np.ndarray
    travel: np.ndarray
    cross_track: np.ndarray
    duration: np.ndarray

    def at(self, index: int | np.ndarray | slice) -> Sailed:
        """Return one run, or some."""
        return Sailed(**{f.name: np.atleast_1d(getattr(self, f.name)[index]) for f in fields(self)})


def clock_of(pilot: Autopilot, model: Model, speeds: np.ndarray, lengths: float = LENGTHS) -> tuple[np.ndarray, int]:
    """Return the interval of each run in s, and the steps all of them take.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    model : Model
        Its closed loop, with what is joined to it.
    speeds : ndarray, shape (runs,)
        In m/s.
    lengths : float
        Duration in L/u.
    """
    unit_time = np.array([1 / pilot.pace(float(v)) for v in speeds])
    finest = _PACE * unit_time
    if "tau_delta" in model.constants:
        finest = np.minimum(finest, _SERVO * pilot.values(model, float(speeds[0]))["tau_delta"])
    fastest = max(float(np.abs(np.linalg.eigvals(pilot.plants(np.array([v])).A[0])).max()) for v in (max(speeds),))
    if fastest > 0:
        finest = np.minimum(finest, _FASTEST / fastest)
    count = steps_of(int(np.ceil((lengths * unit_time / finest).max())))
    return lengths * unit_time / count, count


def sail(
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
) -> Sailed:
    """Sail course changes, every one a run of its own.

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
        Direction the weather goes to in each run, from the first course, in rad.
    measured_from : float
        Time from which errors and activity are summed, in L/u.
    lengths : float
        Duration in L/u.
    seed : int
        Of the waves.
    filtered : bool
        Whether the autopilot sees heading and rate through its sea filter, set to the frequency of encounter.

    Returns
    -------
    Sailed
    """
    speeds, changes = np.asarray(speeds, dtype=float), np.asarray(changes, dtype=float)
    parts: list[type[Component]] = [CourseMeter, *(weather.components(pilot.model) if weather else ())]
    model = pilot.loop(*parts, measured=SeaFiltered if filtered else Measured)
    varying = ("wave_noise",) if "wave_noise" in model.inputs else ()
    batch = make_ensemble(model, varying)
    system, runs = batch.system, speeds.size
    intervals, count = clock_of(pilot, model, speeds, lengths)
    sides = np.where(changes < 0, -1.0, 1.0)
    begin = measured_from * np.array([1 / pilot.pace(float(v)) for v in speeds])
    own: dict[str, np.ndarray] = {
        "meter_side": sides,
        "meter_band": np.maximum(_BAND * np.abs(changes), _LEAST_BAND),
        "meter_from": begin,
    }
    inputs: dict[str, np.ndarray] = {"u": speeds, "cruise": speeds, "psi_order": changes}
    inputs["loading"] = np.full(runs, float(condition))
    if weather is not None:
        directions = np.zeros(runs) if headings is None else np.asarray(headings, dtype=float)
        inputs |= weather.inputs(directions)
        own |= {n: np.full(runs, v) for n, v in weather.values(pilot, model, condition).items()}
        if filtered:
            own["sea_frequency"] = sea_frequency(pilot, weather, speeds, directions - 0.5 * changes)
    known = _columns(pilot, model, speeds, condition)
    if drawn is not None:
        known |= scaled_draws(drawn, known)
    known |= own | {n: np.broadcast_to(np.asarray(v, dtype=float), (runs,)) for n, v in (values or {}).items()}
    p = np.stack([np.broadcast_to(known[n], (runs,)) for n in system.coefficients])
    defaults = {n: model[n].number("default") or 0.0 for n in system.inputs}
    held = np.stack([np.broadcast_to(inputs.get(n, np.array(defaults[n])), (runs,)) for n in system.inputs])
    start = {n: np.array(model[n].number("start") or 0.0) for n in system.states}
    start |= {"u": speeds, "moving": sides}
    x0 = np.stack([np.broadcast_to(start[n], (runs,)) for n in system.states])
    noise = None
    if varying:
        assert weather is not None
        noise = weather.noise(count, intervals, seed)[None]
    end = dict(zip(system.states, batch(x0, held, p, intervals, count, noise)))
    return _read(end, speeds, changes, intervals * count, begin)


def sea_frequency(pilot: Autopilot, weather: Weather, speeds: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return what the sea filter is set to: the frequency of encounter, but well above that of the heading, in rad/s.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    weather : Weather
        The sea.
    speeds, directions : ndarray, shape (runs,)
        Of the ship in m/s, and where the waves go to from its heading, in rad.
    """
    met = np.abs(weather.wave_frequency - weather.wave_frequency**2 * speeds * np.cos(directions) / 9.81)
    different, place = np.unique(speeds, return_inverse=True)
    natural = np.array([pilot.natural_frequency(float(v)) for v in different])[place]
    return np.asarray(np.maximum(met, ABOVE * natural))


def _columns(pilot: Autopilot, model: Model, speeds: np.ndarray, condition: int) -> dict[str, np.ndarray]:
    """Coefficients of every run; each speed is looked up once."""
    different, place = np.unique(speeds, return_inverse=True)
    tables = [pilot.values(model, float(v), condition) for v in different]
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
        # A coefficient that is nought at the ship's own speed is so at every speed: its deviation stays as it is.
        found[name] = known[name] + away * (known[name] / nominal if nominal else 1.0)
    return found


def _read(
    end: Mapping[str, np.ndarray], speeds: np.ndarray, changes: np.ndarray, duration: np.ndarray, begin: np.ndarray
) -> Sailed:
    good = np.isfinite(np.stack(list(end.values()))).all(axis=0)
    span = duration - begin
    settled = end["settled"] + duration / 1e9
    # Outside the band until the very end: it never settled.
    settling = np.where(end["settled"] > 0.98 * duration, np.inf, settled)
    found = {
        "overshoot": np.maximum(end["overshoot"], 0.0),
        "settling": settling,
        "mean_error": end["sum_error"] / span,
        "rms_error": np.sqrt(np.maximum(end["sum_error_square"], 0.0) / span),
        "rms_rudder": np.sqrt(np.maximum(end["sum_rudder_square"], 0.0) / span),
        "reversals": end["reversals"] / span * 60.0,
        "travel": end["travel"] / span,
        "cross_track": np.where(end["reached"] > 0.5, end["off_most"] - end["off_least"], np.inf),
    }
    return Sailed(
        speed=speeds, change=changes, duration=duration, **{n: np.where(good, v, np.nan) for n, v in found.items()}
    )
