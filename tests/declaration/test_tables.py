"""Tables of TOML files: what is accepted, and one message for each thing that is wrong."""

from pathlib import Path

import pytest

from shipid.declaration.tables import Table, read_table
from shipid.foundation.errors import ParameterSetError, ShipidError

TABLE = Table(
    {
        "name": "boat",
        "count": 3,
        "size": 2,
        "flag": True,
        "inner": {"x": 1},
        "time": "0.1 min",
        "shift": "-1 s",
        "angle": {"value": 180.0, "unit": "deg"},
        "bare": 4.0,
        "bad": {"value": "a", "unit": "m"},
        "endless": float("inf"),
    },
    "boat.toml",
    ParameterSetError,
)


def test_values_are_what_they_say() -> None:
    assert TABLE.value("name", str) == "boat"
    assert TABLE.value("count", int) == 3
    assert isinstance(TABLE.value("size", float), float)
    assert TABLE.value("absent", int, 7) == 7
    assert TABLE.choice("name", ["boat", "ship"]) == "boat"
    assert TABLE.choice("absent", ["boat"], None) is None
    assert TABLE.table("inner").content == {"x": 1}
    assert TABLE.table("absent").content == {}
    assert TABLE.quantity("time", "s") == pytest.approx(6.0)
    assert TABLE.quantity("angle", "rad") == pytest.approx(3.14159265)
    assert TABLE.quantity("absent", "s", 2.0) == 2.0
    assert [(name, table.content) for name, table in Table({"a": {"x": 1}}, "f.toml", ParameterSetError).tables()] == [
        ("a", {"x": 1})
    ]
    assert "name" in TABLE and next(iter(TABLE)) == "name"


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda t: t.check_keys(["nam", "count"]), r"boat.toml: there is no entry 'name'. Did you mean nam"),
        (lambda t: t.check_keys(list(t), ["other"]), r"'other' is missing"),
        (lambda t: t.value("count", str), r"'count' is 3, and has to be text in quotes"),
        (lambda t: t.value("flag", int), r"'flag' is True, and has to be a whole number"),
        (lambda t: t.value("flag", float), r"'flag' is True, and has to be a number"),
        (lambda t: t.value("endless", float), r"'endless' is inf, and has to be a number"),
        (lambda t: t.value("name", bool), r"has to be true or false"),
        (lambda t: t.choice("name", ["ship"]), r"'name' is 'boat'. Write one of ship"),
        (lambda t: t.table("name"), r"'name' is 'boat', and has to be a table \[name\]"),
        (lambda t: t.table("inner").table("x"), r"boat.toml, \[inner\]: 'x' is 1, and has to be a table \[inner.x\]"),
        (lambda t: list(t.tables()), r"'name' is 'boat', and has to be a table"),
        (lambda t: t.quantity("shift", "s", positive=True), r"'shift' is '-1 s', and has to be greater than zero"),
        (lambda t: t.quantity("bare", "s"), r"'bare' is the bare number 4, with no unit"),
        (lambda t: t.quantity("time", "m"), r"needs the unit m, and min does not fit"),
        (lambda t: t.quantity("bad", "m"), r"with a finite number"),
        (lambda t: t.quantity("flag", "m"), r"'flag' is True. Write '1.0 m'"),
        (lambda t: t.table("inner").value("x", str), r"boat.toml, \[inner\]: 'x' is 1"),
    ],
)
def test_what_is_wrong_is_named(ask, words: str) -> None:
    with pytest.raises(ParameterSetError, match=words):
        ask(TABLE)


def test_files_that_are_no_tables(tmp_path: Path) -> None:
    with pytest.raises(ShipidError, match=r"the plan .* cannot be read: No such file or directory\. Check the path"):
        read_table(tmp_path / "plan.toml", "plan", ShipidError)
    (tmp_path / "plan.toml").write_text("a = ")
    with pytest.raises(ShipidError, match=r"the plan .* is not valid TOML"):
        read_table(tmp_path / "plan.toml", "plan", ShipidError)
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(ShipidError, match=r"A plan is a TOML file: its name ends in \.toml"):
        read_table(tmp_path / "plan.json", "plan", ShipidError)
    (tmp_path / "plan.toml").write_bytes(b"a = '\xff'")
    with pytest.raises(ShipidError, match="is not valid TOML"):
        read_table(tmp_path / "plan.toml", "plan", ShipidError)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = " + "9" * 5000, "is not valid TOML"),
        ("a = 9223372036854775808", r"larger than TOML has \(2\^63\)"),
        ("a = [[1, 18446744073709551616]]", "larger than TOML has"),
        ("a = " + "[" * 100000, "nested deeper than 20 tables"),
        ("a = " + "[" * 30 + "]" * 30, "nested deeper than 20 tables"),
        ("a." * 5000 + "b = 1", "nested deeper than 20 tables|not valid TOML"),
        ("# " + "x" * 1_000_000, "larger than 1000000 bytes"),
    ],
    ids=["long number", "number", "number in a list", "open lists", "lists", "tables", "bytes"],
)
def test_a_file_without_bounds_is_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "boat.toml"
    path.write_text(text)
    with pytest.raises(ParameterSetError, match=words) as caught:
        read_table(path, "parameter set", ParameterSetError)
    assert len(str(caught.value)) < 400


def test_the_largest_whole_number_is_read(tmp_path: Path) -> None:
    path = tmp_path / "boat.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 9223372036854775807\r\nb = -9223372036854775808\r\n")
    assert read_table(path, "parameter set", ParameterSetError).content == {"a": 2**63 - 1, "b": -(2**63)}
