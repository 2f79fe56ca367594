"""The JSON of every command has one form: what stands around a result, its warnings, its values and its intervals."""

from __future__ import annotations

import hashlib
import json
import re
from numbers import Real
from pathlib import Path

import pytest

import shipid
from shipid.cli.frame.delivery import Delivery
from shipid.cli.registry import COMMANDS
from shipid.foundation.exit_codes import ExitCode

#: Every command that prints JSON, on a zig-zag where it takes a trial; ``{}`` stands for its file.
CALLS = {
    "models": [],
    "show": ["norrbin"],
    "ship": ["zeefakkel"],
    "format": ["{}"],
    "check": ["{}", "--ship", "zeefakkel"],
    "measure": ["{}", "--length", "45 m"],
    "report": ["{}", "--length", "45 m"],
    "identify": ["{}@0:150", "--model", "nomoto", "--ship", "zeefakkel", "--starts", "1", "--validate", "{}@150:279"],
    "compare": ["{}", "--models", "nomoto", "--ship", "zeefakkel", "--starts", "1"],
    "campaign": ["{folder}", "--model", "nomoto", "--ship", "zeefakkel", "--starts", "1"],
    "criteria": ["norrbin", "--ship", "zeefakkel"],
    "filter": ["{}", "--model", "nomoto", "--ship", "zeefakkel"],
    "plan": ["--model", "nomoto", "--ship", "zeefakkel", "--time", "12min", "--draws", "0", "--repertoire", "zigzag"],
    "predict": ["de-keizer", "--ship", "soesterberg", "--from", "psi=10 deg,u=9 m/s", "--heading", "60 deg"],
    "track": ["{}"],
    "tune": ["de-keizer", "--ship", "soesterberg", "--samples", "0", "--speeds", "7,9.5 m/s"],
}
#: Commands whose page is looked at here; those of the others take long, and are written by the tests of their own.
WITH_A_PAGE = {"check", "report", "compare", "criteria", "filter", "plan", "predict", "track"}
SHIP = ("--model", "nomoto", "--ship", "zeefakkel")
HEAD = ["schema_version", "command", "provenance", "warnings"]
#: A key that names an interval in another way.
OTHER_INTERVAL = re.compile(r"(ci|band|interval|conf)_?95$|^(ci|band|interval)$", re.IGNORECASE)

#: Names of numbers that have no dimension: counts as shares and ratios, probabilities, costs, margins as factors.
PURE = {
    "bottom", "chi_square", "confidence", "existence", "complementary", "complementary_peak", "condition_number", "cost", "det", "disk", "disk_5_percent",
    "disk_by_speed", "disk_worst", "effective", "error", "factor", "fit_percent", "ljung_box", "log_likelihood", "matrix", "nis_interval_95",
    "nis_mean", "p_value", "per_parameter", "per_parameter_over_draws", "probability", "probability_of_one_value", "ratio", "runs_away",
    "score", "sensitivity", "sensitivity_peak", "shares", "spread", "std", "weight", "white_p", "widening",
}  # fmt: skip
#: Names of dictionaries whose numbers have no dimension, by the name of what they are of.
PURE_OF = {"gain_over_standard", "measure_weights", "mode_probabilities", "range", "widening"}
#: A key that holds a unit.
UNIT_IN_NAME = re.compile(r"_(deg|rad|m|s|kn|m_s|deg_s|rad_s)$")


def parsed(text: str) -> dict:
    """Read JSON that may not hold NaN or infinity, nor a key twice."""

    def refuse(name: str) -> None:
        raise AssertionError(f"JSON holds {name}")

    def once(pairs: list) -> dict:
        assert len(dict(pairs)) == len(pairs), pairs
        return dict(pairs)

    return json.loads(text, parse_constant=refuse, object_pairs_hook=once)


def check_form(told: dict, command: str) -> None:
    """Assert the form that is documented in `shipid.cli.frame.envelope`."""
    assert list(told)[:4] == HEAD
    assert told["schema_version"] == 2 and told["command"] == command
    assert told["provenance"]["shipid"] == shipid.__version__
    for given in told["provenance"]["inputs"]:
        assert set(given) == {"name", "sha256"} and len(given["sha256"]) == 64
    for warning in told["warnings"]:
        assert next(iter(warning)) == "kind" and re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", warning["kind"]), warning
        assert isinstance(warning["serious"], bool)
        assert isinstance(warning["message"], str) and warning["message"].strip()
    check_values({k: v for k, v in told.items() if k not in HEAD}, command)


def check_values(value: object, where: str) -> None:
    """Assert that values have units, and that intervals have one name and two ends."""
    if isinstance(value, dict):
        if isinstance(value.get("value"), Real | list):
            assert isinstance(value.get("unit"), str), f"{where}: a value without a unit"
        for key, one in value.items():
            assert key.endswith("interval_95") or not OTHER_INTERVAL.search(key), f"{where}: {key}"
            assert not UNIT_IN_NAME.search(key), f"{where}: {key} has its unit in its name"
            if key.endswith("interval_95") and one is not None:
                for ends in one if isinstance(value.get("value"), list) else [one]:
                    if ends is not None:
                        check_ends(ends, f"{where}.{key}")
            if isinstance(one, float) and not (
                value.keys() & {"unit"} or key in PURE or where.rpartition(".")[2] in PURE_OF
            ):
                raise AssertionError(f"{where}.{key}: a number without a unit")
            check_values(one, f"{where}.{key}")
    elif isinstance(value, list):
        for one in value:
            check_values(one, where)


def check_ends(ends: object, where: str) -> None:
    assert isinstance(ends, list) and len(ends) == 2, where
    low, high = ends
    assert low is None or high is None or low <= high, where


def test_every_command_is_here():
    assert set(CALLS) == set(COMMANDS) - {"simulate", "bridge", "completion"}  # a trial, a page, and a script


@pytest.fixture
def words(monkeypatch) -> list[str]:
    """What a command would have printed without ``--json``."""
    printed: list[str] = []
    whole = Delivery.hand_over_parts

    def hand_over_parts(self, data, text, writers=None):
        printed.append(text)
        return whole(self, data, text, writers)

    monkeypatch.setattr(Delivery, "hand_over_parts", hand_over_parts)
    return printed


@pytest.mark.parametrize("command", CALLS)
def test_the_form_of_a_command(command, call, zigzag, tmp_path, words, raw_numbers):
    """Of its JSON; and the numbers of its text and of its page are for a reader."""
    if command == "track":
        # Plots once a second: five times as many take five times as long and are no other tracks.
        comment, header, *rows = zigzag.read_text().splitlines()
        zigzag = tmp_path / "plots.csv"
        zigzag.write_text("\n".join([comment, header, *rows[::5]]) + "\n")
    arguments = [a.replace("{}", str(zigzag)).replace("{folder}", str(zigzag.parent)) for a in CALLS[command]]
    out = ["--out", tmp_path / "out"] if command in WITH_A_PAGE else []
    answer = call(command, *arguments, "--json", *out)
    assert answer.code == ExitCode.DONE, answer
    (text,) = words
    pages = [p.read_text(encoding="utf-8") for p in tmp_path.glob("out/report.html")]
    assert len(pages) == bool(out)
    for shown in (text, *pages):
        assert raw_numbers(shown) == []
    told = parsed(answer.out)
    check_form(told, command)
    if "{}" in "".join(CALLS[command]):
        hashed = hashlib.sha256(Path(zigzag).read_bytes()).hexdigest()
        assert told["provenance"]["inputs"] == [{"name": str(zigzag), "sha256": hashed}]


@pytest.mark.parametrize(
    ("arguments", "code", "kind"),
    [
        (["measure", "nothing.csv"], ExitCode.BAD_DATA, "missing-file"),
        (["filter", "--follow", "nothing.csv", *SHIP], ExitCode.BAD_DATA, "missing-file"),
        (
            ["plan", *SHIP[:1], "norrbin", *SHIP[2:], "--set", "b3=-40000 s/rad^2", "--time", "12min", "--draws", "0"],
            ExitCode.NO_CONVERGENCE,
            "not-sailed",
        ),
    ],
)
def test_an_error_has_the_form_too(call, arguments, code, kind):
    answer = call(*arguments, "--json")
    told = parsed(answer.out)
    check_form(told, arguments[0])
    assert answer.code == code == told["error"]["exit_code"]
    assert told["error"]["kind"] == kind and told["error"]["message"].split() == answer.said.split()[1:]
    assert told["warnings"] == [{"kind": kind, "serious": True, "message": told["error"]["message"]}]


def test_a_fault_has_the_form_too(call, monkeypatch, zigzag):
    def fault(*_: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("shipid.cli.identification.filter._filter", fault)
    answer = call("filter", zigzag, *SHIP, "--json")
    told = parsed(answer.out)
    check_form(told, "filter")
    assert answer.code == ExitCode.FAULT == told["error"]["exit_code"] and told["error"]["kind"] == "zero-division"


def test_a_usage_error_prints_nothing(refused):
    refused(2, ["filter", "log.csv", "--model", "no-such-model", "--json"], "no-such-model")


def test_a_result_that_could_not_be_written_is_printed_once(call, zigzag, tmp_path, monkeypatch):
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("shipid.cli.frame.delivery._fill", full)
    answer = call("filter", zigzag, *SHIP, "--json", "--out", tmp_path / "out")
    assert answer.code == ExitCode.BAD_DATA and "error" not in parsed(answer.out)


def test_the_file_is_what_is_printed(call, zigzag, tmp_path):
    out = tmp_path / "out"
    answer = call("filter", zigzag, "--model", "nomoto", "--ship", "zeefakkel", "--json", "--out", out)
    assert (out / "result.json").read_text(encoding="utf-8") == answer.out


def test_each_line_of_a_followed_log_has_the_form(call, zigzag):
    answer = call("filter", "--follow", zigzag, "--wait", "0.1 s", "--model", "nomoto", "--ship", "zeefakkel", "--json")
    lines = answer.out.splitlines()
    assert len(lines) > 1000
    for line in lines[:3] + lines[-3:]:
        check_form(parsed(line), "filter")


@pytest.mark.parametrize(
    "wrong",
    [{"a": {"value": 1.0}}, {"a": {"ci95": [1, 2]}}, {"a": {"interval_95": [2, 1]}}, {"band": [1, 2]}, {"t": 1.5}],
)
def test_another_form_is_noticed(wrong):
    with pytest.raises(AssertionError):
        check_values(wrong, "result")


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("rms nan deg", "not a number"),
        ("bias -0.0 deg", "signed zero"),
        ("p 2.6e-74", "by rounding"),
        ("0.123456789 m", "digits"),
    ],
)
def test_a_raw_number_is_noticed(text, what, raw_numbers):
    (found,) = raw_numbers(text)
    assert what in found
    assert raw_numbers("1594.3 ± 0.0060, −0.5 deg, 10-0.5, 2026-11-29, shipid 0.1.0") == []


def test_a_finding_of_the_doctor_is_a_warning(call, changed, column):
    path = changed(column("delta", lambda value, row: str(-float(value))))
    answer = call("check", path, "--json")
    told = parsed(answer.out)
    check_form(told, "check")
    assert answer.code == ExitCode.BAD_DATA
    found = {w["kind"]: w for w in told["warnings"]}
    assert found["rudder-sign"]["serious"] and found["rudder-sign"]["trial"] == "log"
