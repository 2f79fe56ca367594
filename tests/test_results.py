"""What every public function returns prints itself in a few lines, and what has a report draws its figures."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import shipid
from shipid.autopilot.judgement.margins import Margins
from shipid.foundation.numbers import unit_of_name
from shipid.foundation.result import LINES, WIDTH, DrawnResult, Result, ResultEntry
from shipid.report import write_report

ROOT = Path(__file__).resolve().parents[1]
TREES = {
    ".".join(p.relative_to(ROOT).with_suffix("").parts): ast.parse(p.read_text(encoding="utf-8"))
    for p in (ROOT / "shipid").rglob("*.py")
}
HOMES = {n.name: (module, n) for module, tree in TREES.items() for n in tree.body if isinstance(n, ast.ClassDef)}
#: How a filter, a model or a search is laid out, and single entries of a result: no results.
LAID_OUT = {
    "BiasSpread", "BiasStanding", "Box", "Buoy", "Campaign", "Contour", "Covariance", "Criterion", "CycleLayout",
    "CycleSettings", "DepthArea", "Entry", "Equation", "Equations", "FirstEstimates", "Hole", "Instruments",
    "Joint", "Judged", "Line", "LoadPart", "Loop", "Measure", "Mode", "ModeMap", "Prior", "Problem", "Quantity", "Record", "RecursionLayout", "Runs", "Solution",
    "Standing", "StateRegression", "StepLayout", "StepSettings", "System", "TrialData", "Typeset",

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


def raw(name: str) -> bool:
    """Whether a class prints its floats with all their digits."""
    kind = loaded(name)
    return kind.__dataclass_params__.repr and any("float" in str(f.type) for f in dataclasses.fields(kind) if f.repr)


#: Settings that a user states, and what a search or a filter hands on: no entries of a result that a person reads.
STATED = {"Gate", "Gust", "LastingSensors", "Leg", "NoiseSource", "Scale", "SolutionAtSpread", "TargetMode"}


def printed_in_full(name: str) -> bool:
    """Whether a class prints every field, arrays and tables included."""
    node = HOMES[name][1]
    if issubclass(loaded(name), Result | ResultEntry) or not any(
        "dataclass" in ast.unparse(d) for d in node.decorator_list
    ):
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


def test_entries_of_a_result_print_in_words():
    """`fit.parameters["K"]` at the end of a cell is a line, and no list of floats of 17 digits."""
    entries = [n for n in reached() if dataclasses.is_dataclass(loaded(n)) and not issubclass(loaded(n), Result)]
    assert {n for n in entries if n not in LAID_OUT | STATED and raw(n)} == set()
    shown = repr(Margins(speed=6.123456789, gain=None, gain_low=None, gain_high=2.0, phase_deg=50.0, delay_s=None, disk=0.123456789,
                         bandwidth=0.2, sensitivity=1.5, complementary=1.2))  # fmt: skip
    assert (
        shown.startswith("Margins: speed 6.12346 m/s, gain None")
        and "disk 0.123457" in shown
        and "phase_deg 50 deg" in shown
    )


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


RESULTS = sorted(n for n in HOMES if issubclass(c := loaded(n), Result) and c not in (Result, DrawnResult))
OF_FIELDS = [n for n in RESULTS if loaded(n).to_frame is Result.to_frame]


def test_every_result_has_a_table_and_is_shown_in_one_way():
    assert len(RESULTS) > 80
    assert [
        n for n in RESULTS if not callable(loaded(n).to_frame) or loaded(n)._repr_html_ is not Result._repr_html_
    ] == []


def stands_in(annotation: str) -> Any:
    """A value of the kind that an annotation names."""
    if "Mapping" in annotation or annotation.startswith("dict"):
        return {"a": 0.5}
    if "ndarray" in annotation:
        return np.ones((3, 2)) if "bool" not in annotation else np.ones(3, dtype=bool)
    if annotation.startswith("tuple[float"):
        return (0.5, 0.5)
    if "float" in annotation:
        return 0.5
    return {"int": 1, "bool": True}.get(annotation, () if annotation.startswith("tuple") else "a word")


@pytest.mark.parametrize("name", OF_FIELDS)
def test_a_table_of_fields_says_the_unit_of_every_number(name):
    kind = loaded(name)
    made = object.__new__(kind)
    for field in dataclasses.fields(kind):
        object.__setattr__(made, field.name, stands_in(str(field.type)))
    numbers = [
        f.name
        for f in dataclasses.fields(kind)
        if not f.name.startswith("_") and isinstance(getattr(made, f.name), float | tuple | np.ndarray)
    ]
    numbers = [n for n in numbers if (v := np.asarray(getattr(made, n))).size and v.dtype == float]
    stated = {n for n in numbers if n in kind.UNITS or unit_of_name(n)}
    assert hasattr(kind, "unit") or "unit" in {f.name for f in dataclasses.fields(kind)} or set(numbers) == stated
    numbers = [n for n in numbers if kind.UNITS.get(n) != ""]
    if not kind.TABLE and not any(isinstance(v, property) and n == "unit" for n, v in vars(kind).items()):
        frame = made.to_frame()
        assert [n for n in numbers if not frame.loc[n, "unit"]] == []
        assert len(Result.text(made).splitlines()) == 1 + len(frame)


@pytest.fixture(scope="module")
def held():
    """The results that a user holds after one short trial, and those that stand in them, by the name of their class."""
    model, ship = shipid.find_model("de-keizer"), shipid.find_ship("soesterberg")
    trial = shipid.simulate(model, ship, "zigzag:20/20", speed="9 kn", duration="400 s", noise="standard", seed=1)
    fit = shipid.identify(shipid.find_model("nomoto"), [trial], ship="soesterberg").validate([trial])
    pilot = shipid.design_autopilot(model, ship, speeds="4:8:2 m/s")
    yaw = shipid.ExtendedKalmanFilter(shipid.find_model("nomoto"), fit.ship, measured={"psi": "0.2 deg"})
    run = yaw.filter(trial)
    wanted: list[Any] = [
        trial, fit, shipid.assess(fit), shipid.check_trial(trial), shipid.trial_sheet([trial]), pilot, pilot.schedule, run,
        *run.innovations.values(), shipid.measure(trial), shipid.predict_track(pilot, {"psi": 0.0, "u": 5.0}, heading="60 deg"),
        ship,
    ]  # fmt: skip
    found: dict[str, Result] = {}
    seen: set[int] = set()
    while wanted:
        value = wanted.pop()
        if id(value) in seen:
            continue
        seen.add(id(value))
        if isinstance(value, Result):
            found[type(value).__name__] = value
        if dataclasses.is_dataclass(value):
            wanted += [getattr(value, f.name) for f in dataclasses.fields(value)]
        elif isinstance(value, Mapping):
            wanted += value.values()
        elif isinstance(value, tuple | list):
            wanted += value[:3]
    return found


def test_an_estimate_is_a_line(held):
    shown = repr(held["Fit"].parameters["K"])
    assert shown == str(held["Fit"].parameters["K"]) and "±" in shown and "\n" not in shown


def test_what_a_user_holds_prints_ten_lines_and_shows_a_table(held):
    assert {"Trial", "Fit", "Identified", "Assessment", "PredictedManoeuvre", "Comparison", "Diagnosis", "TrialSheet", "FormEntry",
            "SheetManoeuvre", "Autopilot", "Schedule", "FilterRun", "Innovations", "Prediction", "PredictedTrack"} <= set(held)  # fmt: skip
    for name, value in held.items():
        lines = repr(value).splitlines()
        assert len(lines) <= LINES and max(map(len, lines)) <= WIDTH, name
        shown = value._repr_html_()
        assert not re.search(r"\bnan\b|object at 0x|<table[^>]*>\s*</table>", shown), name
        assert not re.search(r"[1-9][0-9.]{9,}", re.sub(r"<[^>]*>", " ", shown.partition("<details>")[0])), name
