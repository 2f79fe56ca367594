"""Angles with letters for their sides, and degrees with minutes: read where they can be read in one way."""

import numpy as np
import pandas as pd
import pytest

from shipid import read_trial
from shipid.trials.errors import TextInColumnError
from shipid.trials.logs.drafting.draft import draft_format
from shipid.trials.logs.tables.lettered import read_lettered


@pytest.mark.parametrize(
    ("cells", "values"),
    [
        (("48°30.0'N", "48°30'36\"N"), (48.5, 48.51)),
        (("4°30.0'W", "4 ° 45.0' W", None), (-4.5, -4.75, np.nan)),
        (("33°30.0'S", "33°00.6'S"), (-33.5, -33.01)),
        (("0.5N", "0.1S", "0.0"), (0.5, -0.1, 0.0)),
        (("10.0P", "2,5 S", "0.0P"), (-10.0, 2.5, 0.0)),
        (("SB 5", "BB 7.5", "-"), (5.0, -7.5, np.nan)),
        (("3.0B", "0.0T", "3.0T"), (-3.0, 0.0, 3.0)),
        (("12 STBD", "3 port"), (12.0, -3.0)),
        (("-12.5°", "3.0°"), (-12.5, 3.0)),
        (("52 30.15 N", "N52-30.30", "52°30.45N"), (52.5025, 52.505, 52.5075)),
        (("4 30 36 W", "4-30-36.0W", "4°29'60.00\"W"), (-4.51, -4.51, -4.5)),
    ],
)
def test_sides_and_minutes_are_read(cells, values):
    found = read_lettered(pd.Series(cells, dtype="str"))
    assert found is not None
    np.testing.assert_allclose(found[0], values, rtol=1e-12)


@pytest.mark.parametrize(
    "cells",
    [
        ("12.0S", "3.0S"),  # south, or starboard
        ("045.0T", "046.0T"),  # a true heading
        ("12.0P", "3.0"),  # the second has no side
        ("-12.0P", "3.0S"),  # two signs
        ("48°61.0'N", "48°30.0'N"),  # no minutes
        ("12.0N", "3.0W"),  # two axes
        ("12 5", "12 6"),  # minutes of what
        ("12 5 P", "12 6 S"),
        ("12.3.4 N", "12.3.5 N"),
        ("1.5", "2.5"),
        ("standby", "12.0P"),
        (None, ""),
    ],
)
def test_what_can_be_read_in_two_ways_is_not(cells):
    assert read_lettered(pd.Series(cells, dtype="str")) is None


def test_a_log_of_a_bridge_is_read_and_said(tmp_path):
    log = tmp_path / "log.csv"
    rows = "".join(
        f"14:00:{k:02d};48°{10 + k / 100:.3f}'N;004°{30 - k / 100:.3f}'W;{k / 10}{'PS'[k % 2]};{k / 4}\n"
        for k in range(40)
    )
    log.write_text("Heure UTC;lat [deg];lon [deg];delta [deg];psi [deg]\n" + rows, encoding="utf-8")
    trial = read_trial(log)
    np.testing.assert_allclose(trial["t"], np.arange(40.0))
    np.testing.assert_allclose(np.degrees(trial["delta"][:4]), [0, 0.1, -0.2, 0.3], atol=1e-12)
    np.testing.assert_allclose(np.diff(trial["x"]), 18.5, rtol=0.01)
    notes = "\n".join(trial.source.notes)
    assert "the letters P and S are the sign, P counts negative" in notes and "degrees and minutes" in notes
    assert 'unit = "deg"  # the header says it' in draft_format(log).text
    whole = log.read_text(encoding="utf-8")
    log.write_text(whole.replace("lat [deg]", "lat [rad]"), encoding="utf-8")
    assert "Columns of text were left out: 'lat [rad]'" in "\n".join(read_trial(log).source.notes)
    log.write_text(whole.replace("0.2P", "0.2"), encoding="utf-8")
    with pytest.raises(TextInColumnError, match="is not a number"):
        read_trial(log)


def test_a_rate_of_turn_with_letters(log):
    rows = "".join(f"{k},{abs(k - 10) / 2:.1f} {'P' if k < 10 else 'S'}\n" for k in range(20))
    trial = read_trial(log("t [s],r [deg/min]\n" + rows))
    np.testing.assert_allclose(np.degrees(trial["r"]) * 60, (np.arange(20) - 10) / 2)


def test_places_that_look_like_dates_are_places(log):
    """10 30.2012 N is no 30th of October."""
    rows = "".join(f"{k},10 30.{2012 + k} N,04 12.{1999 + k} E,{k}\n" for k in range(20))
    trial = read_trial(log("t [s],Latitude,Longitude,psi [deg]\n" + rows))
    np.testing.assert_allclose(np.diff(trial["x"]), 0.184, rtol=0.01)
