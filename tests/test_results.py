"""What every public function returns prints itself in a few lines, and what has a report draws its figures."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

import shipid
from shipid.foundation.result import DrawnResult, Result
from shipid.report import write_report

ROOT = Path(__file__).resolve().parents[1]
TREES = {
    ".".join(p.relative_to(ROOT).with_suffix("").parts): ast.parse(p.read_text(encoding="utf-8"))
    for p in (ROOT / "shipid").rglob("*.py")
}
HOMES = {n.name: (module, n) for module, tree in TREES.items() for n in tree.body if isinstance(n, ast.ClassDef)}
#: How a filter, a model or a search is laid out, and single entries of a result: no results.
LAID_OUT = {
    "BiasSpread", "BiasStanding", "Box", "Buoy", "Campaign", "Contour", "Covariance", "Criterion", "CriterionSide", "CycleLayout",
    "CycleSettings", "DepthArea", "Entry", "Equation", "Equations", "Finding", "FirstEstimates", "Hole", "Instruments",
    "Joint", "Judged", "Line", "LoadPart", "Loop", "Measure", "Mode", "ModeMap", "Prior", "Problem", "Quantity", "Record", "RecursionLayout", "Runs", "Solution",
    "Standing", "StateRegression", "StepLayout", "StepSettings", "StructureError", "System", "TrialData", "Typeset", "UnseenDirection",
    "Value", "Waypoint",
}  # fmt: skip
SCALAR = re.compile(
    r"(str|float|int|bool|None|Literal\[[^\]]*\]|tuple\[(float|int)( \| None)?, (float|int)( \| None)?\]|[| ])*"
)


def names(annotation: ast.expr | None) -> set[str]:
    return set(re.findall(r"\w+", ast.unparse(annotation))) if annotation is not None else set()


def reached() -> list[str]:
    """Classes that public functions return, and those that stand in them."""
    found: dict[str, None] = {}
    wanted: list[str] = []
    for value in (getattr(shipid, name) for name in shipid.__all__ if name != "__version__"):
        node = next(n for n in TREES[value.__module__].body if getattr(n, "name", None) == value.__name__)
        wanted += [value.__name__] if isinstance(node, ast.ClassDef) else sorted(names(node.returns))
    while wanted:
        name = wanted.pop()
        if name in found or name not in HOMES or name.startswith("_"):
            continue
        found[name] = None
        for part in HOMES[name][1].body:
            if isinstance(part, ast.FunctionDef) and not part.name.startswith("_"):
                wanted += sorted(names(part.returns))
            elif isinstance(part, ast.AnnAssign):
                wanted += sorted(names(part.annotation))
    return sorted(found)


def loaded(name: str) -> type:
    return getattr(importlib.import_module(HOMES[name][0]), name)


def printed_in_full(name: str) -> bool:
    """Whether a class prints every field, arrays and tables included."""
    node = HOMES[name][1]
    if issubclass(loaded(name), Result) or not any("dataclass" in ast.unparse(d) for d in node.decorator_list):
        return False
    shown = [f for f in node.body if isinstance(f, ast.AnnAssign) and "repr=False" not in ast.unparse(f)]
    own = {"__repr__", "__str__"} & {f.name for f in node.body if isinstance(f, ast.FunctionDef)}
    return not own and not all(SCALAR.fullmatch(ast.unparse(f.annotation)) for f in shown)


def test_the_results_are_found():
    assert {"Fit", "FilterRun", "Prediction", "TrialSheet", "MultipleModelRun", "Voyage", "Comparison"} <= set(
        reached()
    )


def test_no_result_prints_its_arrays():
    assert {n for n in reached() if printed_in_full(n)} - LAID_OUT == set()


def test_no_dataclass_prints_instead_of_the_result():
    """A dataclass makes a ``repr`` of its own where it is not told that there is one."""
    wrong = [n for n in HOMES if issubclass(c := loaded(n), Result) and "__repr__" in vars(c) and c is not Result]
    assert wrong == []


def test_no_result_speaks_in_angle_brackets():
    """What is printed to a person is a sentence, and no Python object: the text of a result begins with a word."""
    wrong = []
    for name, (module, node) in HOMES.items():
        told = next((f for f in node.body if isinstance(f, ast.FunctionDef) and f.name == "text"), None)
        if (
            told is not None
            and issubclass(loaded(name), Result)
            and re.search(r"""f?["']<[a-zA-Z{]""", ast.unparse(told))
        ):
            wrong.append(f"{module}.{name}")
    assert wrong == []


def test_what_has_a_report_draws_its_figures():
    views = vars(write_report)["_VIEWS"]
    drawn = {n for n in HOMES if DrawnResult in loaded(n).__bases__}
    assert drawn == {n for n in views if n in HOMES}


@pytest.mark.parametrize(
    "name",
    ["Prediction", "PredictedTrack", "Tracking", "CampaignResult", "FleetResult", "Criteria", "TrialSheet", "MultipleModelRun",
     "MultipleModelRuns", "FilterRun", "Smoothed", "CascadeRun", "RecursiveIdentification", "OnlineEstimate", "Fit", "Ranking",
     "Comparison", "Posterior", "Profile", "Plan", "Autopilot", "Judgement", "TuningComparison", "OnBoardRuns", "Measures",
     "Diagnosis", "Trial", "Route", "Voyage", "Situation", "ClosestApproach", "Avoidance", "TrackingScore", "WhichShip",
     "Observability", "RecordLevels", "ParameterSet", "Linearisation"],
)  # fmt: skip
def test_a_result_has_a_table(name):
    assert callable(loaded(name).to_frame)
