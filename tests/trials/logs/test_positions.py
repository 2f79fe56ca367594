"""Latitude and longitude of a table become x and y."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.logs.geodesy import to_geographic
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.writing import write_trial
from shipid.trials.source import origin_in
from shipid.trials.trial import Trial

N = 40
T = np.arange(N) * 1.0
X, Y = 5.0 * T, -2.0 * T
LAT, LON = np.degrees(to_geographic(X, Y, (np.radians(59.9), np.radians(-10.6))))


def frame(lat="lat [deg]", lon="lon [deg]", **more):
    return pd.DataFrame({"t [s]": T, lat: LAT, lon: LON, "psi [deg]": 338.2, **more})


@pytest.mark.parametrize(
    "lat, lon",
    [
        ("lat [deg]", "lon [deg]"),
        ("Latitude (deg)", "Longitude (deg)"),
        ("LATITUDE [degrees_north]", "LONGITUDE [degrees_east]"),
        ("latitude", "longitude"),
        ("Breite [°]", "Länge [°]"),
    ],
)
def test_metres_from_the_first_fix(log, lat, lon):
    for trial in (
        Trial.from_frame(frame(lat, lon)),
        read_trial(log(frame(lat, lon).to_csv(index=False, float_format="%.10f"))),
    ):
        np.testing.assert_allclose(trial["x"], X, atol=1e-4)
        np.testing.assert_allclose(trial["y"], Y, atol=1e-4)
        assert set(trial.table) == {"t", "psi", "x", "y"}
        assert any("first fix, latitude 59.9000000, longitude -10.6000000" in note for note in trial.source.notes)
    assert not any(f.kind == "unit" for f in check_trial(log(frame(lat, lon).to_csv(index=False))).findings)


def test_a_format_file_and_radians(log, tmp_path):
    (tmp_path / "f.toml").write_text(
        "[columns.t]\ncolumn = 't'\n[columns.lat]\ncolumn = 'a'\nunit = 'rad'\n[columns.lon]\ncolumn = 'b'\nunit = 'rad'\n"
    )
    table = pd.DataFrame({"t [s]": T, "a": np.radians(LAT), "b": np.radians(LON)})
    np.testing.assert_allclose(read_trial(log(table.to_csv(index=False)), tmp_path / "f.toml")["x"], X, atol=1e-6)


def test_no_fix_is_a_missing_sample():
    table = frame()
    table.loc[:2, ["lat [deg]", "lon [deg]"]] = 0.0
    table.loc[5, "lat [deg]"] = 95.0
    table.loc[7, "lon [deg]"] = np.nan
    trial = Trial.from_frame(table)
    assert np.flatnonzero(np.isnan(trial["x"])).tolist() == [0, 1, 2, 5, 7]
    np.testing.assert_allclose(trial["x"][3:5], X[3:5] - X[3], atol=1e-3)
    assert any("4 fixes that are no place" in note for note in trial.source.notes)


def test_what_stays_as_it_is():
    both = Trial.from_frame(frame(**{"x [m]": T, "y [m]": T}))
    np.testing.assert_array_equal(both["x"], T)
    assert both.unit("lat") == "rad"
    small = frame("lat", "lon")
    small[["lat", "lon"]] = 0.5
    with pytest.raises(e.NoUnitError, match="'lat' says no unit"):
        Trial.from_frame(small)


def test_degrees_and_minutes_in_one_number_are_refused():
    table = frame()
    table["lat [deg]"] = 5954.123
    with pytest.raises(e.ColumnUnitError, match=r"row 0: lat 5954\.123 deg, .*dddmm"):
        Trial.from_frame(table)


def test_where_x_and_y_are_zero_is_kept_and_written(tmp_path):
    path = tmp_path / "voyage.csv"
    rows = "\n".join(f"{k},{53.5 + 1e-5 * k},{8.1 + 1e-5 * k}" for k in range(20))
    path.write_text(f"t [s],lat [deg],lon [deg]\n{rows}\n")
    trial = read_trial(path)
    assert np.rad2deg(trial.source.origin) == pytest.approx([53.5, 8.1])
    assert trial.source.to_dict()["origin"]["lat"] == {"value": pytest.approx(53.5), "unit": "deg"}
    again = read_trial(write_trial(trial, tmp_path / "local.csv"))
    assert again.source.origin == pytest.approx(trial.source.origin, abs=1e-10)
    assert again.table["x"].tolist() == pytest.approx(trial.table["x"].tolist())
    assert read_trial(write_trial(trial, tmp_path / "bare.csv", comment="")).source.origin is None
    assert origin_in("Origin of x and y: latitude 95.0 deg, longitude 8.1 deg (WGS84)") is None
