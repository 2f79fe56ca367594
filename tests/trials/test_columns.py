import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shipid.declaration import units
from shipid.declaration.vocabulary import FIELDS
from shipid.trials import columns
from shipid.trials.errors import ColumnUnitError


@pytest.mark.parametrize(
    ("text", "name", "unit"),
    [
        ("psi [deg]", "psi", "deg"),
        ("psi[deg]", "psi", "deg"),
        ("psi (deg)", "psi", "deg"),
        ('"psi [deg]"', "psi", "deg"),
        ("  r [deg/s] ", "r", "deg/s"),
        ("psi", "psi", None),
        ("thrust 2 [kN]", "thrust 2", "kN"),
        ("psi/deg", "psi", "deg"),
        ("r / (deg/s)", "r", "deg/s"),
        ("t in s", "t", "s"),
        ("u in nds", "u", "nds"),
        ("x/L", "x/L", None),
        ("Rudder (port +) [deg]", "Rudder (port +)", "deg"),
        ("Heading (true) (deg)", "Heading (true)", "deg"),
        ("psi/2", "psi/2", None),
    ],
)
def test_header_is_split_into_name_and_unit(text, name, unit):
    assert columns.split_header(text) == (name, unit)


@given(st.sampled_from(sorted(FIELDS)))
def test_header_round_trip(name):
    column = FIELDS[name]
    assert columns.split_header(columns.header(name, column.display)) == (name, column.display)


@pytest.mark.parametrize("column", FIELDS.values(), ids=lambda c: c.name)
def test_vocabulary_units_are_units_and_fit_their_display(column):
    assert columns.to_inside(column.name, column.unit) == pytest.approx(1.0)
    assert columns.to_inside(column.name, column.display) > 0
    assert units.same_dimension(column.unit, columns.spelt(column.display))


@pytest.mark.parametrize(
    ("name", "unit", "factor"),
    [
        ("psi", "deg", math.pi / 180),
        ("psi", "°", math.pi / 180),
        ("psi", "Grad", math.pi / 180),
        *((("psi", word, math.pi / 180)) for word in ("degrés", "grados", "gradi", "graus", "grader", "graden", "度")),
        ("r", "grados/segundo", math.pi / 180),
        ("r", "gradi/minuto", math.pi / 180 / 60),
        ("r", "度/分", math.pi / 180 / 60),
        ("u", "nœuds", 1852 / 3600),
        ("x", "mètres", 1.0),
        ("psi", "Degrees", math.pi / 180),
        ("r", "grad/min", math.pi / 180 / 60),
        ("r", "DEG/MIN", math.pi / 180 / 60),
        ("U", "Knoten", 1852 / 3600),
        ("U", "Kts", 1852 / 3600),
        ("U", "m s-1", 1.0),
        ("n", "U/min", 1 / 60),
        ("n", "Umdr./min", 1 / 60),
        ("thrust", "kN", 1000.0),
        ("U", "kn", 1852 / 3600),
        ("n", "rpm", 1 / 60),
        ("n", "rev/s", 1.0),
        ("n", "rps", 1.0),
        ("n", "RPM", 1 / 60),
        ("psi", "Deg", math.pi / 180),
        ("torque", "Nm", 1.0),
        ("torque", "kNm", 1000.0),
        ("t", "min", 60.0),
        ("fuel", "kg/h", 1 / 3600),
    ],
)
def test_factor_to_inside(name, unit, factor):
    assert columns.to_inside(name, unit) == pytest.approx(factor)


@pytest.mark.parametrize(
    ("name", "unit"),
    [("psi", "m"), ("psi", "1"), ("r", "1/s"), ("n", "rad/s"), ("n_order", "deg/s"), ("u", "furlong/")],
)
def test_unit_that_does_not_fit_is_refused_with_a_remedy(name, unit):
    with pytest.raises(ColumnUnitError, match=rf"'{name}'(.|\n)*Correct the header, as in '{name} \["):
        columns.to_inside(name, unit)


def test_other_columns_take_the_coherent_unit():
    assert columns.inside_unit("fuel", "kg/h") == "kg/s"
    with pytest.raises(ColumnUnitError, match="fuel"):
        columns.inside_unit("fuel", "litres per fortnite")


@pytest.mark.parametrize("name", ["n", "n_order", "n_port"])
@pytest.mark.parametrize(
    ("unit", "factor"), [("rps", 1), ("1/s", 1), ("Hz", 1), ("rev/s", 1), ("rpm", 1 / 60), ("rev/min", 1 / 60)]
)
def test_revolutions_have_one_meaning(name, unit, factor):
    """Two revolutions a second are 2 in every spelling and under every name."""
    assert columns.to_inside(name, unit) == pytest.approx(factor, rel=1e-12)
