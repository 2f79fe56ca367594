"""The verb: a ship and a time in, out comes which manoeuvres to sail so that the coefficients come out surest."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from shipid.declaration.model import Model
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.identification.uncertainty.covariance import UNDETERMINED
from shipid.identification.uncertainty.information import Sail, covariance_from, sail_of
from shipid.parameters.catalogue import find_ship
from shipid.parameters.parameter_set import ParameterSet
from shipid.planning.plan import Forecast, Leg, Plan
from shipid.planning.request import Briefing, brief, model_of
from shipid.planning.selection import CRITERIA, Table, choose, value_of
from shipid.trials.manoeuvres.manoeuvre import KINDS, Manoeuvre
from shipid.trials.manoeuvres.simulate import SimulationDivergedError

#: Candidates by kind of manoeuvre, as `shipid simulate` takes them; spirals take long and are sailed when asked for.
REPERTOIRE: dict[str, tuple[str, ...]] = {
    "zigzag": (
        *("zigzag:5/5", "zigzag:10/5", "zigzag:10/10", "zigzag:10/20", "zigzag:15/15", "zigzag:20/10"),
        *("zigzag:20/20", "zigzag:20/40", "zigzag:25/25", "zigzag:30/10", "zigzag:30/30", "zigzag:35/35"),
    ),
    "telegraph": tuple(f"telegraph:{a}" for a in (5, 10, 15, 20, 25, 30, 35)),
    "turn": (*(f"turn:{a}" for a in (5, 10, 15, 20, 25, 30, 35)), "turn:20/180", "turn:30/180"),
    "course": ("course:30/10", "course:60/20", "course:90/30"),
    "spiral": ("spiral:10", "spiral:20", "spiral:30"),
    "reversed-spiral": ("reversed-spiral:0.3", "reversed-spiral:0.6"),
}
#: What is sailed unless something else is asked for.
USUAL = ("zigzag", "telegraph", "turn", "course")
#: What a plan is compared with.
STANDARD = ("zigzag:10/10", "zigzag:20/20")
#: Steady turn by which it is found out whether the model has one, in L/U.
_STEADY = 100.0
_TELEGRAPHS = 2
Progress = Callable[[str], None]


@dataclass(eq=False)
class _Rows:
    """The table as it grows: one row for each manoeuvre and length."""

    sails: list[Sail] = field(default_factory=list)
    durations: list[float] = field(default_factory=list)
    information: list[np.ndarray] = field(default_factory=list)
    runs: list[int] = field(default_factory=list)

    def add(self, sail: Sail, durations: Sequence[float], matrices: np.ndarray) -> list[int]:
        """Add a run of several lengths; matrices has shape (durations, draws, n, n)."""
        first, run = len(self.sails), self.runs[-1] + 1 if self.runs else 0
        self.sails += [sail] * len(durations)
        self.durations += durations
        self.information += list(matrices)
        self.runs += [run] * len(durations)
        return list(range(first, len(self.sails)))


def plan_trials(
    model: Model | str | Any,
    ship: ParameterSet | str,
    time: str | float,
    *,
    speed: str | float | Sequence[str | float] | None = None,
    estimate: Sequence[str] | None = None,
    noise: str | Mapping[str, str | float] = "standard",
    criterion: str = "D",
    worst_case: bool = False,
    repertoire: Sequence[str] | None = None,
    values: Mapping[str, str | float] | None = None,
    sampling: str | float | None = None,
    correlation: str | float | None = None,
    between: str | float | None = None,
    spread: float = 0.2,
    draws: int = 8,
    seed: int = 0,
    progress: Progress | None = None,
) -> Plan:
    """Plan the trials that tell the most about a ship's coefficients within a time.

    Parameters
    ----------
    model : Model, component class or str
        What is going to be identified.
    ship : ParameterSet or str
        What is believed of the ship: particulars, coefficients, and their standard deviations where it holds them.
    time : str or float
        What there is, ``"20 min"`` or in s, steady approaches between manoeuvres included.
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
    spread : float
        Relative standard deviation of a coefficient for which neither the ship nor the declaration holds one.
    draws : int
        How many draws of the coefficients the plan has to be good for, beside the values themselves; draws under which
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
    ShipidError
        For names and values that do not fit, and a time that is too short for any manoeuvre.
    """
    if criterion not in CRITERIA:
        raise UnknownNameError("criterion", criterion, CRITERIA, "D: determinant, A: mean relative variance.")
    setting = brief(
        model_of(model),
        find_ship(ship) if isinstance(ship, str) else ship,
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
    setting = _believable(setting, draws, warnings)
    sails = _within_limits(setting, _candidates(repertoire, setting.speeds, seed), warnings)
    tell = progress or (lambda _: None)
    with threadpool_limits(1, "blas"):
        rows = _Rows()
        pair = _standard(setting, rows, warnings)
        _fill(setting, rows, sails, warnings, tell)
        if not rows.sails:
            raise SimulationDivergedError(
                f"model {setting.question.model.name} with ship {setting.ship.name} runs away in every manoeuvre of the "
                "repertoire, or is too unstable to be followed through it. Check the coefficients, or ask for gentler manoeuvres (--repertoire zigzag:5/5)."
            )
        tell(f"choosing among {len(rows.sails)} candidates")
        table = Table(
            np.array(rows.information),
            np.array(rows.durations),
            np.array([s.speed for s in rows.sails]),
            np.array([setting.gap(s.speed) for s in rows.sails]),
            np.array(rows.runs),
            setting.time,
            criterion,
            worst_case,
        )
        return _result(setting, rows, table, choose(table, [pair]), pair, warnings)


def _candidates(repertoire: Sequence[str] | None, speeds: Sequence[float], seed: int) -> list[Sail]:
    texts: list[str] = []
    for name in USUAL if repertoire is None else repertoire:
        kind = name.partition(":")[0].strip()
        if kind not in REPERTOIRE:
            raise UnknownNameError("manoeuvre", kind, KINDS)
        texts += [name.strip()] if ":" in name else REPERTOIRE[kind]
    if not texts:
        raise UsageError("the repertoire is empty: name a kind of manoeuvre, as in zigzag.")
    seeds = {t: range(seed, seed + _TELEGRAPHS) if t.startswith("telegraph") else [seed] for t in texts}
    return [sail_of(t, v, s) for v in speeds for t in dict.fromkeys(texts) for s in seeds[t]]


def _within_limits(setting: Briefing, sails: list[Sail], warnings: list[str]) -> list[Sail]:
    """Leave out rudder angles beyond the ship's limit, and those whose steady turn the model does not have."""
    limit, name = setting.question.limit, setting.question.model.name
    angles = sorted({s.rudder for s in sails if s.rudder is not None})
    beyond = [a for a in angles if a > limit + 1e-9]
    if beyond:
        warnings.append(
            f"rudder angles of {_degrees(beyond)} exceed the {np.rad2deg(limit):g} deg of ship {setting.ship.name} and are "
            "left out."
        )
    lost = [a for a in angles if a not in beyond and not _turns_steadily(setting, a)]
    if lost:
        warnings.append(
            f"with rudder angles of {_degrees(lost)} model {name} has no steady turn, or loses its way in it; they are left out."
        )
    kept = [s for s in sails if s.rudder is None or s.rudder not in {*beyond, *lost}]
    if not kept:
        kind = SimulationDivergedError if lost else UsageError
        raise kind(f"no manoeuvre of the repertoire can be sailed: {' '.join(warnings)}")
    return kept


def _turns_steadily(setting: Briefing, angle: float) -> bool:
    speed = setting.speeds[0]
    turn = Sail(Manoeuvre("turn", (angle, 1e9)), speed)
    return setting.question.sail(turn, _STEADY * setting.question.length / speed, setting.known) is not None


def _degrees(angles: Sequence[float]) -> str:
    return f"{', '.join(f'{np.rad2deg(a):g}' for a in angles)} deg"


def _over_draws(setting: Briefing, sail: Sail, durations: list[float]) -> np.ndarray | None:
    """Information for each length under each draw, shape (durations, draws, n, n), as far as it can be
    followed in all; None where it runs away in one.
    """
    found = []
    for values in setting.draws:
        matrices = setting.question.information(sail, durations, values, setting.size)
        if matrices is None:
            return None
        found.append(matrices)
    shortest = min(len(m) for m in found)
    return np.stack([m[:shortest] for m in found], axis=1)


def _believable(setting: Briefing, count: int, warnings: list[str]) -> Briefing:
    """Keep so many draws under which the standard zig-zags can be sailed and followed: the others compare nothing."""
    own, *drawn = setting.draws
    sails, share = _standard_sails(setting)

    def sailed(values: Mapping[str, float]) -> bool:
        return all(setting.question.information(s, [share], values, setting.size) is not None for s in sails)

    if sailed(own):
        drawn = list(itertools.islice((d for d in drawn if sailed(d)), count))
        if len(drawn) < count:
            warnings.append(
                f"under {len(drawn)} of {len(setting.draws) - 1} draws the standard zig-zags can be sailed; the plan is good "
                f"for those, where {count} were asked for."
            )
    return replace(setting, draws=(own, *drawn[:count]))


def _standard_sails(setting: Briefing) -> tuple[list[Sail], float]:
    """The standard zig-zags that share the time, and how long each is, in s; the 20/20 alone where it is short."""
    speed = setting.speeds[0]
    share = setting.rounded((setting.time - setting.gap(speed)) / 2, speed)
    if share >= setting.shortest(speed):
        return [sail_of(text, speed) for text in STANDARD], share
    return [sail_of(STANDARD[1], speed)], setting.rounded(setting.time, speed)


def _standard(setting: Briefing, rows: _Rows, warnings: list[str]) -> list[int]:
    """Sail the standard pair in the same time; rows of the table, none where the model runs away."""
    sails, share = _standard_sails(setting)
    if len(sails) < len(STANDARD):
        warnings.append("the time is too short for both standard zig-zags: the 20/20 alone is the comparison.")
    found = [_over_draws(setting, sail, [share]) for sail in sails]
    for sail, matrices in zip(sails, found):
        if matrices is None:
            warnings.append(
                f"the model runs away in the standard {sail.manoeuvre}, or is too unstable to be followed through it, so there "
                "is nothing to compare the plan with."
            )
            return []
    return [i for sail, m in zip(sails, found) if m is not None for i in rows.add(sail, [share], m)]


def _fill(setting: Briefing, rows: _Rows, sails: list[Sail], warnings: list[str], tell: Progress) -> None:
    dropped: list[str] = []
    for k, sail in enumerate(sails):
        tell(f"manoeuvre {k + 1} of {len(sails)}: {sail.manoeuvre} at {sail.speed:.3g} m/s")
        lengths = setting.lengths(sail.speed)
        matrices = _over_draws(setting, sail, lengths)
        if matrices is None:
            dropped.append(str(sail.manoeuvre))
        else:
            rows.add(sail, lengths[: len(matrices)], matrices)
    if dropped:
        warnings.append(
            f"dropped, because the model runs away, loses its way or is too unstable to be followed, with the values of the ship or one of the "
            f"{len(setting.draws) - 1} draws about them: {', '.join(dict.fromkeys(dropped))}."
        )


def _result(
    setting: Briefing, rows: _Rows, table: Table, chosen: list[int], pair: list[int], warnings: list[str]
) -> Plan:
    question = setting.question
    # In the order to sail: the fastest first, then from gentle to hard.
    chosen = sorted(chosen, key=lambda i: (-table.speed[i], rows.sails[i].rudder or 0.0, rows.durations[i], i))
    scale = np.outer(setting.size, setting.size)
    planned, usual = (table.information[c].sum(axis=0) for c in (chosen, pair))
    last = [i for i in range(len(rows.runs)) if i + 1 == len(rows.runs) or rows.runs[i + 1] != rows.runs[i]]
    possible = np.isfinite(np.diag(covariance_from(table.information[last].sum(axis=0)[0])))
    covariance = covariance_from(planned[0]) * scale
    std = np.sqrt(np.diag(covariance))
    other = np.sqrt(np.diag(covariance_from(usual[0]) * scale)) if pair else np.full(len(std), np.nan)
    for j, name in enumerate(question.estimated):
        if not possible[j]:
            warnings.append(
                f"{name} stays undetermined whatever is sailed of this repertoire, with {_words(question.signals)}."
            )
        elif std[j] > UNDETERMINED * setting.size[j]:
            share = std[j] / setting.size[j]
            warnings.append(
                f"{name} stays undetermined: its standard deviation is {share:.0%} of its size after this plan."
            )
    count = max(1, int(possible.sum()))
    gains = (value_of(planned[:, None], "D") - value_of(usual[:, None], "D")) * len(possible) if pair else None
    forecasts = {
        n: Forecast(
            n,
            question.model[n].unit,
            question.model[n].quantity.meaning,
            setting.known[n],
            _finite(std[j]),
            _finite(other[j]),
        )
        for j, n in enumerate(question.estimated)
    }
    return Plan(
        model=question.model,
        ship=setting.ship.name,
        time=setting.time,
        criterion=table.criterion,
        worst_case=table.worst,
        legs=_legs(setting, rows, chosen),
        standard=_legs(setting, rows, pair),
        parameters=forecasts,
        covariance=covariance,
        det_ratio=None if gains is None else float(np.exp(min(gains[0], 600.0))),
        det_gain=None if gains is None else float(np.exp(gains[0] / count)),
        det_gain_over_draws=None if gains is None else float(np.exp(gains.mean() / count)),
        value=table.of(chosen),
        standard_value=table.of(pair) if pair else None,
        noise=dict(zip(question.signals, question.sigma.tolist())),
        sampling=setting.sampling,
        independent=1 / question.rate,
        draws=len(setting.draws) - 1,
        candidates=len(rows.sails),
        warnings=tuple(warnings),
    )


def _finite(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def _words(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]} measured" if len(names) > 1 else f"{names[0]} measured"


def _legs(setting: Briefing, rows: _Rows, chosen: Sequence[int]) -> tuple[Leg, ...]:
    legs: list[Leg] = []
    for i in chosen:
        sail, begin = rows.sails[i], 0.0
        if legs:
            before = legs[-1]
            changes = 1 + (before.speed != sail.speed)
            begin = before.start + before.duration + changes * setting.gap(sail.speed)
        legs.append(Leg(str(sail.manoeuvre), sail.speed, rows.durations[i], begin, sail.seed))
    return tuple(legs)
