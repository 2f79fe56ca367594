"""The manoeuvres that a plan may choose from, and those of them that the ship can sail."""

from __future__ import annotations

from collections.abc import Sequence

from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.identification.uncertainty.information import CandidateManoeuvre, candidate_of
from shipid.planning.planning_problem import PlanningProblem
from shipid.trials.manoeuvres.manoeuvre import KINDS, Manoeuvre
from shipid.trials.manoeuvres.simulate import NotSailedError

#: Candidates by kind of manoeuvre, as `shipid simulate` takes them; spirals take long and are only used on request.
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
#: The default repertoire.
USUAL = ("zigzag", "telegraph", "turn", "course")
#: Length of the turn that shows whether the model has a steady one, in L/U.
_STEADY = 100.0
_TELEGRAPHS = 2


def candidates_of(repertoire: Sequence[str] | None, speeds: Sequence[float], seed: int) -> list[CandidateManoeuvre]:
    """Return the manoeuvres of a repertoire at each speed.

    Parameters
    ----------
    repertoire : sequence of str or None
        Kinds, or manoeuvres; the usual ones by default.
    speeds : sequence of float
        In m/s.
    seed : int
        Of the random telegraphs.

    Raises
    ------
    UnknownNameError
        If a manoeuvre does not exist.
    UsageError
        If there is none.
    """
    texts: list[str] = []
    for name in USUAL if repertoire is None else repertoire:
        kind = name.partition(":")[0].strip()
        if kind not in REPERTOIRE:
            raise UnknownNameError("manoeuvre", kind, KINDS)
        texts += [name.strip()] if ":" in name else REPERTOIRE[kind]
    if not texts:
        raise UsageError("the repertoire is empty: name a kind of manoeuvre, as in zigzag.")
    seeds = {t: range(seed, seed + _TELEGRAPHS) if t.startswith("telegraph") else [seed] for t in texts}
    return [candidate_of(t, v, s) for v in speeds for t in dict.fromkeys(texts) for s in seeds[t]]


def within_limits(
    problem: PlanningProblem, candidates: list[CandidateManoeuvre], warnings: list[str]
) -> list[CandidateManoeuvre]:
    """Leave out rudder angles beyond the ship's limit, and those whose steady turn the model does not have.

    Parameters
    ----------
    problem : PlanningProblem
        The problem.
    candidates : list of CandidateManoeuvre
        The manoeuvres.
    warnings : list of str
        What is left out is added to it.

    Returns
    -------
    list of CandidateManoeuvre
        Those that are left.

    Raises
    ------
    NotSailedError
        If the model sails none.
    UsageError
        If the rudder reaches none.
    """
    limit, name = problem.experiment.limit, problem.experiment.model.name
    angles = sorted({s.rudder for s in candidates if s.rudder is not None})
    beyond = [a for a in angles if a > limit + 1e-9]
    if beyond:
        warnings.append(
            f"rudder angles of {_degrees(beyond)} exceed the {_degrees([limit])} of ship {problem.ship.name} and are "
            "left out."
        )
    lost = [a for a in angles if a not in beyond and not _turns_steadily(problem, a)]
    if lost:
        warnings.append(
            f"turns with {_degrees(lost)} of rudder are {NOT_SAILED} ({name}), which has no steady turn there; they are left out."
        )
    kept = [s for s in candidates if s.rudder is None or s.rudder not in {*beyond, *lost}]
    if not kept:
        kind = NotSailedError if lost else UsageError
        raise kind(f"no manoeuvre of the repertoire can be sailed: {' '.join(warnings)}")
    return kept


def _turns_steadily(problem: PlanningProblem, angle: float) -> bool:
    speed = problem.speeds[0]
    turn = CandidateManoeuvre(Manoeuvre("turn", (angle, 1e9)), speed)
    return problem.experiment.rudder_of(turn, _STEADY * problem.experiment.length / speed, problem.known) is not None


def _degrees(angles: Sequence[float]) -> str:
    shown = ", ".join(f"{to_display(a, 'delta'):g}" for a in angles)
    return f"{shown} {display_unit('delta', 'rad')}"
