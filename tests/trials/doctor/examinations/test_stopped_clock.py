"""A clock that stopped for good: it is told, and the few rows before it are all there is to examine."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from shipid.cli import run
from shipid.trials.doctor.check_trial import check_trial


def written(tmp_path, t):
    rng = np.random.default_rng(1)
    n = len(t)
    order = 20.0 * np.sign(np.sin(np.arange(n) / 12))
    frame = pd.DataFrame(
        {
            "t [s]": t,
            "psi [deg]": np.cumsum(order) / 30 + rng.normal(0, 0.1, n),
            "r [deg/s]": rng.normal(0, 0.5, n),
            "delta [deg]": np.full(n, 5.0),
            "delta_order [deg]": order,
        }
    )
    path = tmp_path / "log.csv"
    frame.to_csv(path, index=False)
    return path


@pytest.mark.parametrize(
    "t", [np.minimum(np.arange(181.0), 5.0), np.r_[0.0, np.full(180, 360.0)], np.r_[np.arange(90.0), np.full(91, 90.0)]]
)
@pytest.mark.parametrize("fix", [False, True])
def test_a_clock_that_stopped_is_told_and_breaks_nothing(tmp_path, monkeypatch, t, fix):
    path = written(tmp_path, t)
    monkeypatch.chdir(tmp_path)
    assert run(["check", "log.csv", *(["--fix", "-o", "fixed.csv"] if fix else [])]) not in (1, 70)
    found = check_trial(path)
    [repeats] = [f for f in found.findings if f.kind == "clock-repeats"]
    assert repeats.count == np.sum(np.diff(t) == 0)
    assert "clock-quantised" not in [f.kind for f in found.findings]
    assert repeats.fix is None, "no clock is made up for rows whose time nobody knows"


def test_a_clock_that_starts_again_and_stops_leaves_one_row_and_breaks_nothing(tmp_path):
    found = check_trial(written(tmp_path, np.r_[np.arange(6.0), np.full(175, 1e-300)]))
    assert {"clock-unsorted", "clock-repeats", "short"} <= set(found.kinds)


def test_a_channel_on_a_clock_that_jumps_has_the_interval_of_its_steps_forward(tmp_path):
    """The median of its steps is zero, and a hole is longer than any number of times nothing."""
    path = tmp_path / "log.csv"
    rows = [f"{t},{10 + k * 1.7 % 3},{'' if k == 0 else k % 2}" for k, t in enumerate([2, 3, 8, 6, 5, 7, 7])]
    path.write_text("\n".join(["t [s],psi [deg],delta [deg]", *rows]) + "\n")
    assert "short" in check_trial(path).kinds
