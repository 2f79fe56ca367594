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
