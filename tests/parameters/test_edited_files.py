"""Ship files that were edited by hand: what is wrong is named, whatever it is, and what is written is read."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings

import shipid
from shipid.foundation.errors import ParameterSetError, ShipidError
from shipid.parameters.parameter_file import parameter_table
from shipid.parameters.parameter_set import Value

ODD = (
    True,
    0,
    -1,
    10**400,
    -(10**19),
    1e308,
    float("nan"),
    float("inf"),
    "",
    "nan",
    "1 m",
    "\x1b[31m",
    [],
    {},
    [[1]],
    [1, "a"],
    "m" * 300,
)


def mutated(table: Any, chance: random.Random) -> Any:
    """The same with one to three entries changed, at any depth."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        place, key = table, chance.choice(list(table) or [None])
        while key is not None and isinstance(place[key], (dict, list)) and place[key] and chance.random() < 0.85:
            place = place[key]
            key = chance.choice(list(place)) if isinstance(place, dict) else chance.randrange(len(place))
        if key is None:
            continue
        if chance.random() < 0.2:
            del place[key]
        elif chance.random() < 0.15 and isinstance(place, dict):
            place[chance.choice(("value", "model", "a b", "", "ü", 'q"', "unit"))] = chance.choice(ODD)
        else:
            place[key] = chance.choice(ODD)
    return table


@pytest.mark.parametrize("ship", ["soesterberg", "esso-osaka-3m"])
def test_five_hundred_edited_ship_files(tmp_path: Path, ship: str) -> None:
    """Each is refused with one clear error, when it is read or when a model takes its numbers; or it is sound."""
    chance, path, refused = random.Random(5), tmp_path / "ship.toml", 0
    model = shipid.find_model("de-keizer")
    for _ in range(500):
        table = parameter_table(shipid.find_ship(ship))
        path.write_text(tomli_w.dumps(mutated(table, chance)), encoding="utf-8")
        try:
            found = shipid.read_parameter_set(path)
            found.values(model, speed=5.0)
            for name, unit in (("L", "m"), ("speed", "m/s")):
                found.particular(name, unit)
            found.text()
        except ShipidError as error:
            refused += 1
            assert str(error)
            continue
        shipid.write_parameter_set(found, path)
        assert shipid.read_parameter_set(path) == found
    assert refused > 150


#: Names as a user may write them: anything but half a character.
NAMES = st.text(st.characters(exclude_categories=("Cs",)), min_size=1, max_size=12)
HEADS = {"name", "title", "notes", "schema", "identified"}


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=NAMES, section=NAMES.filter(lambda n: n not in HEADS), ship=NAMES, note=st.text(st.characters(exclude_categories=("Cs",)), max_size=30))  # fmt: skip
def test_names_that_need_quotes(tmp_path: Path, name: str, section: str, ship: str, note: str) -> None:
    made = shipid.ParameterSet(ship, note, note, {section: {name: Value(name, 1.5, "m", "assumed", note=note)}})
    path = tmp_path / "ship.toml"
    shipid.write_parameter_set(made, path)
    assert shipid.read_parameter_set(path) == made


@pytest.mark.parametrize("name", sorted(HEADS))
def test_a_model_that_is_called_as_an_entry_of_the_file(tmp_path: Path, name: str) -> None:
    made = shipid.ParameterSet("s", sections={name: {"K": Value("K", 1.5, "1/s", "assumed")}})
    with pytest.raises(ParameterSetError, match=f"a model called '{name}' has no place in a parameter set"):
        shipid.write_parameter_set(made, tmp_path / "ship.toml")


def test_a_ship_file_names_no_model_to_run(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    path = tmp_path / "ship.toml"
    for entry in (
        f"model = '{tmp_path}/own.py:Own'",
        f"['{tmp_path}/own.py:Own']\nK = {{ value = 1, unit = '1/s', source = 'assumed' }}",
    ):
        path.write_text(f"{entry}\n")
        try:
            shipid.read_parameter_set(path).values(shipid.find_model("nomoto"))
        except ParameterSetError as error:
            assert "'model' stands outside a table" in str(error)
    assert not (tmp_path / "ran").exists()
