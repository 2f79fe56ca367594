"""The campaigns that come with the installation: found by name, and what a craft knows never looks ahead."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.campaign.campaign import generator_of, run_batch
from shipid.campaign.find_campaign import find_campaign, shipped_campaigns, whole
from shipid.campaign.shipped import song_2018 as song


@pytest.mark.parametrize("name", shipped_campaigns())
def test_a_shipped_campaign_runs(name):
    campaign = whole(find_campaign(name))
    rows = run_batch(campaign, 0, [0, 1, 2])
    assert set(rows) == set(campaign.measures)
    alone = run_batch(campaign, 0, [2])
    for measure, column in alone.items():
        np.testing.assert_allclose(column[0], rows[measure][2], rtol=1e-9, err_msg=measure)


def test_the_observed_positions_are_within_the_error_of_the_true_ones():
    truth, seen = song.obstacles(generator_of(0, 0), song.CASES[0])
    assert np.hypot(*np.moveaxis(seen - truth[..., :2], -1, 0)).max() <= song.ERROR
    before = 3 * song.CASES[0].every
    np.testing.assert_allclose(truth[:, before, :2], song.OBSTACLES)
    # The velocities are those of the positions.
    moved = np.diff(truth[..., :2], axis=1) / song.CASES[0].period
    assert np.abs(moved - 0.5 * (truth[:, 1:, 2:] + truth[:, :-1, 2:])).max() < 0.01


@pytest.mark.parametrize("method", [m for m in song.METHODS if m != "truth"])
def test_what_is_known_does_not_look_ahead(method):
    case = song.CASES[1]
    truth, seen = song.obstacles(generator_of(1, 0), case)
    found = song.known(method, case, truth, seen)
    changed = seen.copy()
    changed[:, 3 * case.every + 41 :] += 500.0
    np.testing.assert_allclose(song.known(method, case, truth, changed)[:, :41], found[:, :41], rtol=1e-9)


def test_with_the_truth_hardly_a_domain_is_entered():
    case = song.CASES[0]
    truth = np.stack([song.obstacles(generator_of(5, k), case)[0] for k in range(30)])[:, :, 3 * case.every :]
    found = song.sail(case, truth, truth)
    assert found["entries"].mean() < 0.2
    assert np.nanmax(np.abs(found["track"][:, -1])) != 0
    assert 56 <= np.nanmedian(found["periods"]) <= 58
