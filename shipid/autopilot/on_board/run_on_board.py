"""An autopilot run as on board, with its Kalman filter between the instruments and the control law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from shipid.autopilot.course_changes.course_measures import measure_history
from shipid.autopilot.course_changes.run_course_changes import LENGTHS, PACE, stiffest
from shipid.autopilot.course_changes.weather import CALM, Weather, standard_weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import (
    coefficients_of,
    control_law,
    heading_frequency,
    linear_ship,
    steered_ship,
)
from shipid.autopilot.design.control_law import CourseController
from shipid.autopilot.errors import DesignRequestError
from shipid.autopilot.on_board.filter_in_loop import estimator_of
from shipid.autopilot.on_board.model_reference import (
    CompensatedCourseController,
    IndirectAdaptation,
    PlacedGains,
    ReferenceModel,
    SelectedFeedback,
    first_order_equivalent,
)
from shipid.autopilot.on_board.on_board_runs import Adaptation, Feedback, OnBoardRun, OnBoardRuns
from shipid.autopilot.on_board.sampled_loop import SampledLoop, make_sampled_loop
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import shown, to_display
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.foundation.statistics import plain
from shipid.generation.departure import first_departure
from shipid.parameters.catalogue import model_of
from shipid.parts.helm import DirectRudder
from shipid.parts.manoeuvring_range import manoeuvring_range

ADAPTATIONS: tuple[Adaptation, ...] = get_args(Adaptation)
#: Course changes of a voyage in degrees, one after the other, each back to the first course; zero keeps it.
VOYAGE = (0.0, 10.0, -10.0, 60.0, -60.0)
#: Before the voyage, in L/u: the filter converges while the instruments are fed back, and is fed back for the second half.
_APPROACH = 40.0
#: The reference follows the estimates in so many L/u.
_FOLLOWING = 15.0
#: Where the weather comes from, and the direction it goes to from the first course, in rad.
_FROM, _DIRECTION = "weather from the port bow", np.deg2rad(135.0)
#: Time constant of the filter's waves times their frequency, and the size of its waves over the simulated ones: the filter models
#: narrow-band waves as white noise (Passenier 1989, section 5.3).
_WAVE_TIME, _WAVES = 1.8, 3.0
#: Samples of a history that is kept.
_POINTS = 800


def run_on_board(
    pilot: Autopilot,
    kalman: ExtendedKalmanFilter | Model | type[Component] | str,
    *,
    adaptation: Adaptation = "none",
    changes: Sequence[float] = VOYAGE,
    interval: str | float | None = None,
    weather: Weather | None = None,
    seed: int = 0,
    progress: Callable[[str], object] | None = None,
) -> OnBoardRuns:
    """Run course changes as they run on board: the ship between samples, filter and autopilot on the samples.

    The voyage is run by the instruments and by the filter, in calm and in the standard weather, at the ship's own speed. The
    course changes are measured as those of the judgement are.

    Parameters
    ----------
    pilot : Autopilot
        The design, with a steering machine.
    kalman : ExtendedKalmanFilter, Model, component class or str
        The filter, or its model or the name of one, such as ``"yaw-filter"``: then the sensors are those it declares, it
        starts from the ship's own coefficients, and its waves are three times those of the standard weather.
    adaptation : {"none", "gains", "reference"}
        Gains of the schedule; gains for the ship as the filter estimates it; or gains of a reference that follows the
        estimates slowly, the difference to it compensated by rudder. The last two take the design ``"pole"``, and a
        filter that estimates ``a`` and ``b1``.
    changes : sequence of float
        Course changes in degrees, one after the other, each for 40 L/u; zero keeps the course.
    interval : str or float, optional
        Between two samples, in s or with a unit; a fiftieth of L/u by default.
    weather : Weather, optional
        Wind, waves and current; those of the judgement by default.
    seed : int
        Of waves and sensor noise.
    progress : callable, optional
        Called with a line of text before each part.

    Returns
    -------
    OnBoardRuns

    Raises
    ------
    DesignRequestError
        If the autopilot has no steering machine or holds a rate of turn, or the adaptation does not fit it.
    UnknownNameError
        If there is no such adaptation.
    UsageError
        If the filter does not estimate what the autopilot is fed back.
    UnstatedInputError
        If ship or filter read an input that the voyage does not state and that declares no default.

    Notes
    -----
    Passenier (1989), sections 5.5 and 6.3.2.
    """
    if adaptation not in ADAPTATIONS:
        raise UnknownNameError("adaptation", adaptation, ADAPTATIONS)
    if pilot.actuator is DirectRudder:
        raise DesignRequestError(
            "on board the rudder takes time to follow its order: design the autopilot with a steering machine."
        )
    if pilot.mode == "rate":
        raise DesignRequestError(
            "a voyage changes courses, and this autopilot holds a rate of turn: design it for a course."
        )
    if adaptation != "none" and pilot.design != "pole":
        raise DesignRequestError(
            f"adaptation places two poles, and this autopilot is of design {pilot.design}: take pole."
        )
    tell = progress or (lambda _: None)
    speed = pilot.own_speed
    sampling = PACE / pilot.pace(speed) if interval is None else _seconds(interval)
    weather = weather or standard_weather(pilot.length, pilot.service_speed)
    if not isinstance(kalman, ExtendedKalmanFilter):
        kalman = _filter_of(pilot, model_of(kalman), weather)
    voyage = _Voyage(pilot, kalman, np.deg2rad(np.asarray(changes, dtype=float)), sampling, weather, seed)
    tell("on board, by the instruments")
    plain_loop = _loop(voyage, "none")
    runs = [_run(voyage, plain_loop, "instruments", rough) for rough in (False, True)]
    tell("on board, by the filter")
    filtered_loop = plain_loop if adaptation == "none" else _loop(voyage, adaptation)
    runs += [_run(voyage, filtered_loop, "filter", rough) for rough in (False, True)]
    sensors = {n: shown(s, n, kalman.model[n].unit, 3) for n, s in _sensor_levels(kalman).items()}
    return OnBoardRuns(
        pilot.ship.name, kalman.design.base.name, sensors, sampling, adaptation, tuple(runs), tuple(_warnings(runs))
    )


@dataclass(frozen=True, eq=False)
class _Voyage:
    """The data that all runs share."""

    pilot: Autopilot
    kalman: ExtendedKalmanFilter
    changes: np.ndarray
    interval: float
    weather: Weather
    seed: int

    @property
    def speed(self) -> float:
        return self.pilot.own_speed

    @property
    def ship(self) -> Model:
        """The ship with its steering machine, in weather that may be calm."""
        name, model = f"{self.pilot.model.name}-steered", self.pilot.model
        return join(name, steered_ship(self.pilot), *self.weather.components(model), *manoeuvring_range(model))

    def samples(self, lengths: float) -> int:
        """Samples in a time given in L/u."""
        return max(1, round(lengths / self.pilot.pace(self.speed) / self.interval))


def _seconds(interval: str | float) -> float:
    found = to_si(interval, "s", "the sampling interval") if isinstance(interval, str) else float(interval)
    if not 0 < found < np.inf:
        raise DesignRequestError(f"a sampling interval of {found:g} s is out of range: give one above zero.")
    return found


def _filter_of(pilot: Autopilot, model: Model, weather: Weather) -> ExtendedKalmanFilter:
    """A filter of a model for this ship, its sensors as declared."""
    a, b1 = _first_order(pilot)
    known = {"L": pilot.length, "wave_time": _WAVE_TIME / weather.wave_frequency}
    noise = {"wave_noise": (_WAVES * weather.wave_rate, "rad/s")}
    return ExtendedKalmanFilter(
        model,
        pilot.ship,
        values={n: v for n, v in known.items() if n in model},
        start={n: v for n, v in {"a": a, "b1": b1}.items() if n in model.parameters},
        noise={n: v for n, v in noise.items() if n in model.inputs},
        gate=None,
    )


def _first_order(pilot: Autopilot) -> tuple[float, float]:
    """The ship as one of first order, ``a`` and ``b1``, alike at the natural frequency of the heading."""
    speed = pilot.own_speed
    plant = linear_ship(pilot, [speed]).at(0)
    return first_order_equivalent(plant, heading_frequency(pilot, speed), pilot.pace(speed))


def _sensor_levels(kalman: ExtendedKalmanFilter) -> dict[str, float]:
    return dict(zip(kalman.measured, kalman.design.constants[-len(kalman.measured) :].tolist()))


def _instruments(kalman: ExtendedKalmanFilter, ship: Model) -> tuple[dict[str, tuple[str, ...]], dict[str, str]]:
    """What each instrument shows, as a sum, and under which name the filter finds each sensor and the speed."""
    sums: dict[str, tuple[str, ...]] = {"psi_shown": (), "r_shown": (), "u_shown": ("u",)}
    sums |= {"cruise_shown": ("cruise",), "delta": ("delta",)}
    names = {"u": "u_shown", "cruise": "cruise_shown"}
    for sensor in kalman.measured:
        quantity = kalman.model[sensor].quantity.measures or sensor
        names[sensor] = f"{quantity}_shown"
        sums[names[sensor]] = (*_moved(ship, quantity), f"{sensor}_noise")
    for quantity in ("psi", "r"):
        sums[f"{quantity}_shown"] = sums[f"{quantity}_shown"] or _moved(ship, quantity)
    return sums, names


def _moved(ship: Model, quantity: str) -> tuple[str, ...]:
    """A quantity of the ship, with its part by the waves."""
    return (quantity, f"{quantity}_wave") if f"{quantity}_wave" in ship else (quantity,)


def _loop(voyage: _Voyage, adaptation: Adaptation) -> SampledLoop:
    pilot, kalman, ship = voyage.pilot, voyage.kalman, voyage.ship
    laws: dict[Adaptation, tuple[type[Component], ...]] = {
        "none": (control_law(pilot), pilot.schedule.component),
        "gains": (CourseController, PlacedGains, IndirectAdaptation),
        "reference": (CompensatedCourseController, PlacedGains, ReferenceModel),
    }
    law = join("pilot", SelectedFeedback, *laws[adaptation])
    estimates = {"psi_hat": "psi", "r_hat": "r"}
    if adaptation != "none":
        estimates |= {"a_hat": "a", "b1_hat": "b1"}
        estimates |= {"d_hat": "r_disturbance"} if "r_disturbance" in kalman.model.states else {}
    sums, names = _instruments(kalman, ship)
    first = {"psi": 0.0, "r": 0.0, "u": voyage.speed, "cruise": voyage.speed}
    return make_sampled_loop(
        ship,
        law,
        estimator_of(kalman, names, estimates, first),
        shown=sums,
        outputs=("psi", "x", "y", *ship.guards),
        substeps=max(4, int(np.ceil(voyage.interval / stiffest(pilot, ship, np.array([voyage.speed]))))),
    )


def _coefficients(voyage: _Voyage, loop: SampledLoop) -> np.ndarray:
    pilot, speed = voyage.pilot, voyage.speed
    ship = coefficients_of(pilot, loop.ship, speed) | voyage.weather.values(pilot, loop.ship)
    law = coefficients_of(pilot, loop.pilot, speed)
    if "omega_star" in loop.pilot:
        law |= {"L": pilot.length, "omega_star": heading_frequency(pilot, speed) / pilot.pace(speed)}
        law |= {"damping": pilot.request["damping"], "K_R": pilot.pace(speed) / _FOLLOWING}
    return loop.coefficients(ship, law)


def _run(voyage: _Voyage, loop: SampledLoop, feedback: Feedback, in_weather: bool) -> OnBoardRun:
    approach, each = voyage.samples(_APPROACH), voyage.samples(LENGTHS)
    count = approach + each * voyage.changes.size
    t = voyage.interval * np.arange(count)
    begin = approach + each * np.arange(voyage.changes.size)
    psi_order = np.concatenate([np.zeros(approach), np.repeat(np.cumsum(voyage.changes), each)])
    by_filter = (t >= t[approach // 2]) * float(feedback == "filter")
    rng = np.random.default_rng([voyage.seed, 11])
    inputs: dict[str, float | np.ndarray] = {
        **CALM,
        "u": voyage.speed,
        "cruise": voyage.speed,
        "psi_order": psi_order,
        "loading": 0.0,
        "filtered": by_filter,
        "adapting": 1.0,
        "compensating": by_filter,
        **{f"{n}_noise": s * rng.standard_normal(count) for n, s in _sensor_levels(voyage.kalman).items()},
        "wave_noise": 0.0,
    }
    if in_weather:
        acting = voyage.weather.inputs(np.array([_DIRECTION]))
        inputs |= {n: float(v[0]) for n, v in acting.items()}
        inputs["wave_noise"] = voyage.weather.noise(count, np.array([voyage.interval]), voyage.seed)[:, 0]
    a, b1 = _first_order(voyage.pilot)
    start = loop.start({"u": voyage.speed}, {"a_ref": a, "b1_ref": b1})
    known = {n: v for n, v in inputs.items() if n in loop.inputs}
    run = loop(start, known, _coefficients(voyage, loop), voyage.interval, count)
    departure = first_departure(loop.ship, t, {n: run[n] for n in loop.ship.guards})
    run |= {
        "t": t,
        "psi_order": psi_order,
        **{n: np.broadcast_to(inputs[n], count) for n in ("current_north", "current_east")},
    }
    words = _FROM if in_weather else "calm"
    measured = [
        measure_history({n: v[k : k + each] for n, v in run.items()}, voyage.speed, float(change)).one(0, words)
        for k, change in zip(begin, voyage.changes)
    ]
    if departure is not None:
        # From there on it is no run of a ship, and nothing is measured.
        measured = [c if t[k + each - 1] < departure.time else c.without_measures() for k, c in zip(begin, measured)]
        run = {n: np.where(t < departure.time, column, np.nan) for n, column in run.items()}
    seen = run["psi_hat" if feedback == "filter" else "psi_shown"]
    error = float(np.sqrt(np.mean((seen - run["psi"])[approach:] ** 2)))
    every = max(1, count // _POINTS)
    kept = {n: run[n][::every] for n in ("t", "psi_order", "psi", "delta")}
    return OnBoardRun(
        feedback,
        words,
        tuple(measured),
        plain(to_display(error, "psi")),
        kept,
        None if departure is None else str(departure),
    )


def _warnings(runs: Sequence[OnBoardRun]) -> list[str]:
    found: list[str] = []
    found += [
        Notice(f"on board, by the {r.feedback}, {r.weather}: {r.departure}", "not-sailed", serious=True)
        for r in runs
        if r.departure is not None
    ]
    diverged = [r for r in runs if r.departure is None and any(c.lost for c in r.changes)]
    lost = [f"by the {r.feedback}, {r.weather}" for r in diverged]
    if lost:
        found.append(f"on board: the loop diverged {'; '.join(lost)}. Give a filter tuned for this ship.")
    for shown_run, filtered in zip(runs[:2], runs[2:]):
        if shown_run.error_deg is None or filtered.error_deg is None:
            continue
        if filtered.error_deg > shown_run.error_deg:
            found.append(
                f"on board: the heading of the filter is off by {brief(filtered.error_deg, 2)} deg rms in {filtered.weather}, and that "
                f"of the instruments by {brief(shown_run.error_deg, 2)} deg. Give a filter tuned for this ship."
            )
    return found
