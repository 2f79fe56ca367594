"""The rows of a fleet: how coefficients scatter over the trials, which files are trials, and a worker that does not see them."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.campaign.campaign import Campaign, Measure, generator_of
from shipid.campaign.errors import CampaignRequestError
from shipid.campaign.fleet import PARTS, FleetRun, FleetSettings, fleet_campaign, not_read, trial_files
from shipid.campaign.fleet_result import fleet_result
from shipid.campaign.moments import Statistic
from shipid.campaign.result import CampaignResult
from shipid.campaign.store import open_store
from shipid.trials.logs.writing import write_trial


def result_of_values(folder, values, std):
    """The result of a fleet with these values of K."""
    count = len(values)
    texts = {"trial": np.array([f"t{k}.csv" for k in range(count)]), "outcome": np.array(["identified"] * count)}
    texts |= {"message": np.array([""] * count), "doctor": np.array([""] * count)}
    texts |= {"K_standing": np.array(["determined"] * count)}
    numbers = {"samples": np.full(count, 100.0), "chi_square": np.ones(count), "K": np.array(values, float)}
    numbers |= {f"K_{part}": np.full(count, std) for part in PARTS[:3]}
    measures = {n: Measure("text") for n in texts} | {n: Measure("value", "1/s") for n in numbers}
    store = open_store(
        folder, Campaign("fleet", lambda rng: {}, measures, batch=count), 0, resume=False, overwrite=False, about={}
    )
    store.write(0, range(count), texts | numbers)
    statistics = {n: Statistic(n, m, count, 0) for n, m in measures.items()}
    return fleet_result(CampaignResult("fleet", count, 0, count, statistics, folder, {}), "nomoto", "")


def test_trials_of_one_truth_do_not_differ_more_often_than_one_in_a_hundred(tmp_path):
    rng = np.random.default_rng(0)
    differing = 0
    for k in range(200):
        found = result_of_values(tmp_path / str(k), 0.5 + 0.01 * rng.normal(size=6), 0.01).coefficients["K"]
        differing += found.differs
    assert differing <= 7  # expected 2
    assert found.mean_std == pytest.approx(0.01 / np.sqrt(6))


def test_trials_that_differ_are_told(tmp_path):
    found = result_of_values(tmp_path, [0.40, 0.50, 0.60], 0.01)
    scatter = found.coefficients["K"]
    assert scatter.differs and scatter.scatter == pytest.approx(0.1) and scatter.mean == pytest.approx(0.5)
    assert [w.kind for w in found.warnings] == ["scatter"]


def test_which_files_are_trials(tmp_path):
    for name in ("b.csv", "a.dat", "ship.toml", "readme.md", ".hidden.csv", "page.html"):
        (tmp_path / name).write_text(name)
    (tmp_path / "folder.csv").mkdir()
    assert trial_files(tmp_path) == ["a.dat", "b.csv"] and not_read(tmp_path) == []


def test_what_lies_beside_trials_is_told(tmp_path):
    (tmp_path / "a.csv").write_text("x")
    (tmp_path / "copy.csv").write_text("x")
    for name, file in (("day 2", "b.csv"), ("out", "result.json")):
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_text("x")
    (tmp_path / "dead.csv").symlink_to(tmp_path / "gone.csv")
    assert trial_files(tmp_path) == ["a.csv"]
    told = {n.kind: n for n in not_read(tmp_path)}
    assert told["folders-not-read"].endswith("by itself: day 2.") and told["trial-twice"].endswith("copy.csv of a.csv.")
    assert told["links-to-nothing"].endswith("left out: dead.csv.")
    with pytest.raises(CampaignRequestError, match=r"no trials in .* Folders in it are not read"):
        (tmp_path / "a.csv").unlink()
        (tmp_path / "copy.csv").unlink()
        fleet_campaign(tmp_path, FleetSettings("nomoto"))


def test_a_file_that_may_not_be_read_is_a_row(tmp_path, monkeypatch):
    (tmp_path / "a.csv").write_text("x")

    def refuse(file):
        raise PermissionError(13, "Permission denied", str(file))

    monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    assert fleet_campaign(tmp_path, FleetSettings("nomoto")).most == 1


def test_a_worker_that_does_not_see_the_folder_says_so():
    run = FleetRun("/no/such/folder", ("a.csv",), FleetSettings("nomoto"), ("K",))
    with pytest.raises(CampaignRequestError, match="does not see the folder"):
        run(generator_of(0, 0))


def test_a_row_says_that_the_ship_is_of_another_length(tmp_path):
    trial = shipid.simulate("nomoto", ship="zeefakkel", manoeuvre="zigzag:20/20", noise="standard", seed=1)
    write_trial(trial, tmp_path / "a.csv")
    asked = FleetSettings("nomoto", "zeefakkel", starts=1, values=(("L", "450 m"),))
    found = FleetRun(str(tmp_path), ("a.csv",), asked, ("K", "tau"))(generator_of(0, 0))
    assert "ship-length" in str(found["doctor"])
