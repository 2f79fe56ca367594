"""What a regression expects of a ship: values with their scatter, or the reason why there are none."""

from __future__ import annotations

import json

import pytest

from shipid.parameters.catalogue import find_ship
from shipid.parameters.hull.estimates import hull_estimates
from shipid.parameters.hull.regressions import REGRESSIONS, SOURCE, scatter_of
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value

UNITS = {"L": "m", "B": "m", "T": "m", "nabla": "m^3", "C_b": "1"}
#: Near the middle of the range.
FORM = {"L": 120.0, "B": 20.0, "T": 7.0, "C_b": 0.7}


def ship(**particulars) -> ParameterSet:
    values = {n: Value(n, v, UNITS[n], "assumed") for n, v in particulars.items()}
    return ParameterSet("tender", sections={PARTICULARS: values})


def test_estimates_are_those_of_the_regression_with_its_scatter():
    found = hull_estimates(ship(**FORM)).found
    assert set(found) == set(REGRESSIONS)
    scale, deep, wide = -3.141592653589793 * (7 / 120) ** 2, 20 / 7, 20 / 120
    sway = scale * (1 + 0.4 * 0.7 * deep)
    assert found["Y_v"].value == pytest.approx(sway, rel=1e-12)
    # Without coupled masses q21 is -Y_v / (m - Y_vdot).
    added = scale * (1 + 0.16 * 0.7 * deep - 5.1 * wide**2)
    assert found["q21"].value == pytest.approx(-sway / (2 * 0.7 * 20 * 7 / 120**2 - added), rel=1e-12)
    for name, one in found.items():
        assert one.std == pytest.approx(abs(one.value) * scatter_of(name), rel=1e-12) and one.std > 0


def test_the_displacement_gives_the_block_coefficient():
    by_volume = {n: v for n, v in FORM.items() if n != "C_b"} | {"nabla": 0.7 * 120 * 20 * 7}
    one, other = hull_estimates(ship(**FORM)).found, hull_estimates(ship(**by_volume)).found
    assert [e.value for e in other.values()] == pytest.approx([e.value for e in one.values()], rel=1e-12)


@pytest.mark.parametrize(
    ("left_out", "missing"), [(("B",), ("B",)), (("C_b",), ("C_b or nabla",)), (("L", "T"), ("L", "T"))]
)
def test_without_a_particular_there_is_none(left_out, missing):
    found = hull_estimates(ship(**{n: v for n, v in FORM.items() if n not in left_out}))
    assert not found.found and found.missing == missing and not found.beyond
    (line,) = found.lines()
    assert line.endswith(f"nothing, as the ship does not state {', '.join(missing)}")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"B": 40.0}, "L/B of ship tender is 3, and the regression is used from 4.97 to 7.64."),
        ({"T": 3.0}, "B/T of ship tender is 6.67, and the regression is used from 2.2 to 3.41."),
        ({"C_b": 0.4}, "C_b of ship tender is 0.4, and the regression is used from 0.506 to 0.914."),
        ({"C_b": 0.0}, "C_b of ship tender is 0, and"),
        ({"B": 0.0}, "Length, beam and draught of ship tender are not all greater than zero."),
        ({"T": -1.0}, "Length, beam and draught of ship tender are not all greater than zero."),
    ],
)
def test_outside_the_range_there_is_none_and_a_sentence(changed, words):
    found = hull_estimates(ship(**FORM | changed))
    assert not found.found and not found.missing and found.beyond.startswith(words)
    (line,) = found.lines()
    assert found.beyond in line and found.to_dict()["beyond"] == found.beyond


def test_lines_and_plain_values_hold_source_scatter_and_range():
    found = hull_estimates(ship(**FORM))
    lines = found.lines()
    assert SOURCE in lines[0] and len(lines) == len(REGRESSIONS) + 2
    assert lines[1].split()[0] == "Y_v" and "±" in lines[1] and "L/B 5 to 7.6" in lines[-1]
    data = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert data["found"]["r31"]["value"] == found.found["r31"].value and data["source"] == SOURCE
    assert data["beyond"] is None and data["missing"] == [] and data["range"]["C_b"][0] == pytest.approx(0.9 * 0.562)


def test_ship_files_state_what_the_regression_reads():
    assert hull_estimates(find_ship("kvlcc2")).found.keys() == REGRESSIONS.keys()
    # The same hull at another scale: rounded particulars differ by a percent.
    one, other = (hull_estimates(find_ship(s)).found["r31"].value for s in ("kvlcc2", "kvlcc2-7m"))
    assert other == pytest.approx(one, rel=0.02)
    assert hull_estimates(find_ship("esso-osaka-3m")).found
    assert hull_estimates(find_ship("gunnerus")).beyond.startswith("L/B of ship gunnerus is 3.53")
    assert hull_estimates(find_ship("zeefakkel")).missing == ("B", "T", "C_b or nabla")
