"""Numbers beside their units."""

from __future__ import annotations

from shipid.foundation.numbers import columns_of, with_units


def test_the_unit_leaves_the_name():
    told = with_units(
        {
            "settling_s": 12.0,
            "speed_m_s": [3.0],
            "rate_deg_s": None,
            "rudder_deg": 5.0,
            "track_m": 2.0,
            "omega_rad_s": 1.0,
        }
    )
    assert told == {
        "settling": {"value": 12.0, "unit": "s"},
        "speed": {"value": [3.0], "unit": "m/s"},
        "rate": {"value": None, "unit": "deg/s"},
        "rudder": {"value": 5.0, "unit": "deg"},
        "track": {"value": 2.0, "unit": "m"},
        "omega": {"value": 1.0, "unit": "rad/s"},
    }


def test_a_name_without_a_unit_stays_or_is_told_one():
    assert with_units({"speed": 3.0, "gain": 2.0}, speed="m/s") == {"speed": {"value": 3.0, "unit": "m/s"}, "gain": 2.0}


def test_a_row_of_a_table():
    assert columns_of({"speed": {"value": 3.0, "unit": "m/s"}, "gain": 2.0}) == {"speed [m/s]": 3.0, "gain": 2.0}
