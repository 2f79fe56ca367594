"""``shipid track``: one command on plots, with what it prints, writes and refuses."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest


@pytest.fixture(scope="module")
def plots(tmp_path_factory):
    """A target that crosses ahead, with clutter, in a table of ranges and bearings; and her true track."""
    folder = tmp_path_factory.mktemp("plots")
    chance = np.random.default_rng(0)
    t = np.arange(0, 150, 3.0)
    north, east = 1500 - 5 * t, 800 - 2 * t
    rows = []
    for k, at in enumerate(t):
        seen = [(north[k], east[k])] if chance.random() < 0.95 else []
        seen += [tuple(z) for z in chance.uniform(-3000, 3000, (chance.poisson(2), 2))]
        for x, y in seen:
            x, y = x + 5 * chance.standard_normal(), y + 5 * chance.standard_normal()
            rows.append((at, np.hypot(x, y), np.rad2deg(np.arctan2(y, x)) % 360))
    table = pd.DataFrame(rows, columns=["t [s]", "range [m]", "bearing [deg]"])
    table.to_csv(folder / "plots.csv", index=False)
    truth = pd.DataFrame({"t [s]": t, "x [m]": north, "y [m]": east, "ship": "Gull"})
    truth.to_csv(folder / "truth.csv", index=False)
    own = pd.DataFrame({"t [s]": t, "x [m]": 0 * t, "y [m]": 0 * t})
    own.to_csv(folder / "own.csv", index=False)
    return folder


def test_the_tracks_of_a_table(call, plots):
    answer = call("track", str(plots / "plots.csv"))
    assert answer.code == 0, answer
    assert "1 confirmed, 1 held at the end" in answer.out and "relative to own ship" in answer.out


@pytest.mark.parametrize("tracker", ["imm", "vs-aimm", "alpha-beta"])
def test_everything_together(call, plots, tmp_path, tracker):
    files = ("--truth", str(plots / "truth.csv"), "--own", str(plots / "own.csv"))
    answer = call("track", str(plots / "plots.csv"), "--tracker", tracker, *files, "--out", str(tmp_path), "--json")
    assert answer.code == 0, answer
    found = json.loads(answer.out)
    assert found["tracker"] == tracker and found["tracks"][0]["status"] == "held"
    assert found["tracks"][0]["state"]["vx"]["value"] == pytest.approx(-5.0, abs=1.0)
    assert found["tracks"][0]["closest_approach"]["motion"] == "closing"
    assert found["score"]["ships"][0]["held"] > 0.85 and found["score"]["false_tracks"] == 0
    frame = pd.read_csv(tmp_path / "tracks.csv")
    assert np.isfinite(frame.to_numpy(float)).all() and len(frame) > 30
    page = (tmp_path / "report.html").read_text()
    assert "Beside the truth" in page and "Gull" in page and "NaN" not in page


def test_a_ship_and_options(call, plots):
    log = str(plots / "plots.csv")
    ship = call("track", log, "--tracker", "vs-aimm", "--ship", "soesterberg", "--position-std", "8 m", "--nearest")
    assert ship.code == 0, ship
    assert call("track", log, "--ship", "soesterberg").code == 2
    assert "Leave the ship out" in call("track", log, "--ship", "soesterberg").err.replace("\n", " ")
    late = json.loads(call("track", log, "--latency", "2 s", "--scan", "3 s", "--json").out)
    assert late["latency"]["radar"]["value"] == 2.0


def test_a_report_without_a_track(call, tmp_path):
    (tmp_path / "one.csv").write_text("t [s],x [m],y [m]\n1,100,200\n")
    answer = call("track", str(tmp_path / "one.csv"), "--out", str(tmp_path / "out"))
    assert answer.code == 0, answer
    assert "no track was confirmed" in answer.out
    assert "No track was confirmed" in (tmp_path / "out" / "report.html").read_text()
    assert pd.read_csv(tmp_path / "out" / "tracks.csv").empty


def test_what_is_refused(call, plots, tmp_path):
    assert call("track", str(tmp_path / "gone.csv")).code == 3
    assert call("track", str(plots / "plots.csv"), "--position-std", "0 m").code == 2
    assert call("track", str(plots / "plots.csv"), "--tracker", "best").code == 2
