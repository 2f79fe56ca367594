"""Planning: from a ship and a time to the manoeuvres that determine the coefficients best."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from shipid.declaration.component import Component
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.estimation.standing import UNKNOWN, standing_of
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, counted
from shipid.foundation.statistics import plain
from shipid.identification.uncertainty.information import CandidateManoeuvre, candidate_of, covariance_from
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.planning.leg import Leg
from shipid.planning.plan import Forecast, Plan
from shipid.planning.planning_problem import PlanningProblem, planning_problem
from shipid.planning.repertoire import candidates_of, within_limits
from shipid.planning.selection import CRITERIA, CandidateTable, Criterion, choose, value_of
from shipid.planning.timetable import Surroundings, sailed_timetable
from shipid.trials.manoeuvres.flows import Flow, check_flows, flow_of, number
from shipid.trials.manoeuvres.simulate import NotSailedError, simulate

#: The standard that a plan is compared with.
STANDARD = ("zigzag:10/10", "zigzag:20/20")
#: So long a run, in s, shows whether a ship has all her coefficients.
_GLANCE = 30.0
Progress = Callable[[str], None]


@dataclass(eq=False)
class _Rows:
    """The table as it grows: one row for each manoeuvre and length."""

    candidates: list[CandidateManoeuvre] = field(default_factory=list)
    durations: list[float] = field(default_factory=list)
    information: list[np.ndarray] = field(default_factory=list)
    runs: list[int] = field(default_factory=list)

    def add(self, candidate: CandidateManoeuvre, durations: Sequence[float], matrices: np.ndarray) -> list[int]:
        """Add a run of several lengths; matrices has shape (durations, draws, n, n)."""
        first, run = len(self.candidates), self.runs[-1] + 1 if self.runs else 0
        self.candidates += [candidate] * len(durations)
        self.durations += durations
        self.information += list(matrices)
        self.runs += [run] * len(durations)
        return list(range(first, len(self.candidates)))


def plan_trials(
    model: Model | type[Component] | str,
    ship: ParameterSet | str,
    time: str | float,
    *,
    speed: str | float | Sequence[str | float] | None = None,
    estimate: Sequence[str] | None = None,
    noise: str | Mapping[str, str | float] = "standard",
    criterion: Criterion = "D",
    worst_case: bool = False,
    repertoire: Sequence[str] | None = None,
    values: Mapping[str, str | float] | None = None,
    sampling: str | float | None = None,
    correlation: str | float | None = None,
    between: str | float | None = None,
    heading: str | float = 0.0,
    current: Flow | None = None,
    wind: Flow | None = None,
    spread: float = 0.2,
    draws: int = 8,
    seed: int = 0,
    progress: Progress | None = None,
) -> Plan:
    """Plan the trials that give the most information on a ship's coefficients within a time.

    Parameters
    ----------
    model : Model, component class or str
        The model to identify.
    ship : ParameterSet or str
        Particulars, coefficients, and their standard deviations where the set holds them.
    time : str or float
        The time available, ``"20 min"`` or in s, steady approaches between manoeuvres included.
    speed : str, float or sequence, optional
        Speed of the approach, or several to choose from, with units or in m/s. By default the ship's own, and three
        quarters of it where the coefficients are those of every speed.
    estimate : sequence of str, optional
        Coefficients to estimate; by default all that the model declares as estimated.
    noise : str or mapping
        ``"standard"``, ``"psi=0.2 deg,r=0.02 deg/s"``, or standard deviations per sample by column. What has noise is
        measured.
    criterion : {"D", "A"}
        ``D``: determinant of the information; ``A``: mean relative variance of the coefficients.
    worst_case : bool
        Whether the worst draw of the coefficients counts; by default the average over them does.
    repertoire : sequence of str, optional
        Kinds of manoeuvre, or manoeuvres such as ``"zigzag:20/10"``; by default zig-zags, random telegraphs, turning circles
        and course changes.
    values : mapping of str to str or float, optional
        Values with units that replace those of the ship.
    sampling : str or float, optional
        Sampling interval of the sensors in s; by default that of `simulate`.
    correlation : str or float, optional
        Integrated autocorrelation time of the noise in s, where waves make it correlated: one sample in that time counts.
        By default the noise is white.
    between : str or float, optional
        Steady approach between two manoeuvres in s, and once more where the speed changes; five L/U by default.
    heading : str or float
        Heading of the first approach, for the sea room in a current or a wind, with its unit or in rad.
    current, wind : str or tuple, optional
        Speed and direction it flows TO, with units or in SI, for the timetable and its sea room; the manoeuvres are chosen for
        calm water. Waves move no track: what they do to the measurements is `noise` and `correlation`.
    spread : float
        Relative standard deviation of a coefficient for which neither the ship nor the declaration holds one.
    draws : int
        Number of draws of the coefficients for which the plan is made, beside the values themselves; draws under which
        the standard zig-zags cannot be sailed are drawn anew.
    seed : int
        Of the draws and the random telegraph.
    progress : callable, optional
        Called with a line of text after each stage.

    Returns
    -------
    Plan

    Raises
    ------
    UnknownNameError
        For a name that does not exist: model, ship, coefficient, criterion or manoeuvre.
    UsageError
        If values do not fit together, or no manoeuvre of the repertoire can be sailed.
    NotSailedError
        If the model sails no manoeuvre.
    ParameterSetError
        If the ship lacks its length, its speed or a coefficient.
    TimeTooShortError
        If the time is too short for any manoeuvre.
    """
    if criterion not in CRITERIA:
        raise UnknownNameError("criterion", criterion, CRITERIA, "D: determinant, A: mean relative variance.")
    planned = model_of(model)
    around = Surroundings(number(heading, "rad", "the heading"), flow_of(current, "current"), flow_of(wind, "wind"))
    check_flows(planned, current, wind)
    if wind is not None:
        # A ship without coefficients of the wind is refused before the work is done.
        simulate(planned, ship_of(ship), "turn:5", duration=_GLANCE, wind=wind, values=values)
    problem = planning_problem(
        planned,
        ship_of(ship),
        time,
        speed=speed,
        estimate=estimate,
        noise=noise,
        values=dict(values or {}),
        sampling=sampling,
        correlation=correlation,
        between=between,
        spread=spread,
        draws=draws,
        seed=seed,
    )
    warnings: list[str] = []
    problem = _with_comparable_draws(problem, draws, warnings)
    candidates = within_limits(problem, candidates_of(repertoire, problem.speeds, seed), warnings)
    tell = progress or (lambda _: None)
    with threadpool_limits(1, "blas"):
        rows = _Rows()
        pair = _standard(problem, rows, warnings)
        _fill(problem, rows, candidates, warnings, tell)
        if not rows.candidates:
            raise NotSailedError(
                f"every manoeuvre of the repertoire is {NOT_SAILED} ({problem.experiment.model.name} with ship {problem.ship.name}), or "
                "it is too unstable to be followed through it. Check the coefficients, or ask for gentler manoeuvres (--repertoire zigzag:5/5)."
            )
        tell(f"choosing among {counted(len(rows.candidates), 'candidate')}")
        table = CandidateTable(
            np.array(rows.information),
            np.array(rows.durations),
            np.array([s.speed for s in rows.candidates]),
            np.array([problem.gap(s.speed) for s in rows.candidates]),
            np.array(rows.runs),
            problem.time,
            criterion,
            worst_case,
        )
        return _result(problem, rows, table, choose(table, [pair]), pair, warnings, around)


def _over_draws(problem: PlanningProblem, candidate: CandidateManoeuvre, durations: list[float]) -> np.ndarray | None:
    """Information for each length under each draw, shape (durations, draws, n, n), as far as it can be
    followed in all; None where one does not sail it.
    """
    found = []
    for values in problem.draws:
        matrices = problem.experiment.information(candidate, durations, values, problem.size)
        if matrices is None:
            return None
        found.append(matrices)
    shortest = min(len(m) for m in found)
    return np.stack([m[:shortest] for m in found], axis=1)


def _with_comparable_draws(problem: PlanningProblem, count: int, warnings: list[str]) -> PlanningProblem:
    """Keep so many draws under which the standard zig-zags can be sailed and followed: the others give no comparison."""
    own, *drawn = problem.draws
    candidates, share = _standard_candidates(problem)

    def comparable(values: Mapping[str, float]) -> bool:
        return all(problem.experiment.information(s, [share], values, problem.size) is not None for s in candidates)

    if comparable(own):
        drawn = list(itertools.islice((d for d in drawn if comparable(d)), count))
        if len(drawn) < count:
            warnings.append(
                f"under {len(drawn)} of {len(problem.draws) - 1} draws the standard zig-zags can be sailed; the plan is made "
                f"for those, and {count} were requested."
            )
    return replace(problem, draws=(own, *drawn[:count]))


def _standard_candidates(problem: PlanningProblem) -> tuple[list[CandidateManoeuvre], float]:
    """The standard zig-zags that share the time, and how long each is, in s; the 20/20 alone where it is short."""
    speed = problem.speeds[0]
    share = problem.rounded((problem.time - problem.gap(speed)) / 2, speed)
    if share >= problem.shortest(speed):
        return [candidate_of(text, speed) for text in STANDARD], share
    return [candidate_of(STANDARD[1], speed)], problem.rounded(problem.time, speed)


def _standard(problem: PlanningProblem, rows: _Rows, warnings: list[str]) -> list[int]:
    """Sail the standard pair in the same time; rows of the table, none where the model does not sail it."""
    candidates, share = _standard_candidates(problem)
    if len(candidates) < len(STANDARD):
        warnings.append("the time is too short for both standard zig-zags: the 20/20 alone is the comparison.")
    found = [_over_draws(problem, candidate, [share]) for candidate in candidates]
    for candidate, matrices in zip(candidates, found):
        if matrices is None:
            warnings.append(
                f"the standard {candidate.manoeuvre} is {NOT_SAILED}, or the model is too unstable to be followed through it; "
                "the plan is not compared with it."
            )
            return []
    return [i for candidate, m in zip(candidates, found) if m is not None for i in rows.add(candidate, [share], m)]


def _fill(
    problem: PlanningProblem, rows: _Rows, candidates: list[CandidateManoeuvre], warnings: list[str], tell: Progress
) -> None:
    dropped: list[str] = []
    for k, candidate in enumerate(candidates):
        tell(f"manoeuvre {k + 1} of {len(candidates)}: {candidate.manoeuvre} at {brief(candidate.speed)} m/s")
        lengths = problem.lengths(candidate.speed)
        matrices = _over_draws(problem, candidate, lengths)
        if matrices is None:
            dropped.append(str(candidate.manoeuvre))
        else:
            rows.add(candidate, lengths[: len(matrices)], matrices)
    if dropped:
        warnings.append(
            f"dropped, because they are {NOT_SAILED}, or it is too unstable to be followed, with the values of the ship or one of the "
            f"{len(problem.draws) - 1} draws about them: {', '.join(dict.fromkeys(dropped))}."
        )


def _result(
    problem: PlanningProblem,
    rows: _Rows,
    table: CandidateTable,
    chosen: list[int],
    pair: list[int],
    warnings: list[str],
    around: Surroundings,
) -> Plan:
    experiment = problem.experiment
    warnings += problem.beyond([rows.candidates[i] for i in chosen])
    # In the order to sail: the fastest first, then from gentle to hard.
    chosen = sorted(chosen, key=lambda i: (-table.speed[i], rows.candidates[i].rudder or 0.0, rows.durations[i], i))
    scale = np.outer(problem.size, problem.size)
    planned, usual = (table.information[c].sum(axis=0) for c in (chosen, pair))
    last = [i for i in range(len(rows.runs)) if i + 1 == len(rows.runs) or rows.runs[i + 1] != rows.runs[i]]
    possible = np.isfinite(np.diag(covariance_from(table.information[last].sum(axis=0)[0])))
    covariance = covariance_from(planned[0]) * scale
    std = np.sqrt(np.diag(covariance))
    other = np.sqrt(np.diag(covariance_from(usual[0]) * scale)) if pair else np.full(len(std), np.nan)
    for j, name in enumerate(experiment.estimated):
        standing, why = standing_of(problem.known[name], std[j], size=problem.size[j])
        if not possible[j]:
            standing, why = UNKNOWN, f"no manoeuvre of this repertoire tells, with {_words(experiment.signals)}."
        if standing == UNKNOWN:
            warnings.append(Notice(f"{name} stays undetermined: {why}", "not-determined", name=name))
    count = max(1, int(possible.sum()))
    gains = (value_of(planned[:, None], "D") - value_of(usual[:, None], "D")) * len(possible) if pair else None
    forecasts = {
        n: Forecast(
            n,
            experiment.model[n].unit,
            experiment.model[n].quantity.meaning,
            problem.known[n],
            plain(std[j]),
            plain(other[j]),
        )
        for j, n in enumerate(experiment.estimated)
    }
    legs = _legs(problem, rows, chosen)
    return Plan(
        model=experiment.model,
        ship=problem.ship.name,
        time=problem.time,
        criterion=table.criterion,
        worst_case=table.worst,
        legs=legs,
        standard=_legs(problem, rows, pair),
        parameters=forecasts,
        covariance=covariance,
        det_ratio=None if gains is None else float(np.exp(min(gains[0], 600.0))),
        det_gain=None if gains is None else float(np.exp(gains[0] / count)),
        det_gain_over_draws=None if gains is None else float(np.exp(gains.mean() / count)),
        value=table.of(chosen),
        standard_value=table.of(pair) if pair else None,
        noise=dict(zip(experiment.signals, experiment.sigma.tolist())),
        sampling=problem.sampling,
        independent=1 / experiment.rate,
        draws=len(problem.draws) - 1,
        candidates=len(rows.candidates),
        timetable=sailed_timetable(experiment.model, problem.ship, legs, warnings, around),
        warnings=tuple(warnings),
    )


def _words(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]} measured" if len(names) > 1 else f"{names[0]} measured"


def _legs(problem: PlanningProblem, rows: _Rows, chosen: Sequence[int]) -> tuple[Leg, ...]:
    legs: list[Leg] = []
    for i in chosen:
        candidate, begin = rows.candidates[i], 0.0
        if legs:
            before = legs[-1]
            changes = 1 + (before.speed != candidate.speed)
            begin = before.start + before.duration + changes * problem.gap(candidate.speed)
        legs.append(Leg(str(candidate.manoeuvre), candidate.speed, rows.durations[i], begin, candidate.seed))
    return tuple(legs)
