"""A speed that is counted positive astern, beside positions that say where the ship goes."""

from pathlib import Path

import numpy as np

import shipid
from shipid.trials.doctor.repair import fix_trial

TRIAL = Path(__file__).parents[4] / "studies" / "trials" / "container-10-10.csv"


def test_a_speed_counted_astern_is_found_and_turned_round(tmp_path):
    trial = shipid.read_trial(TRIAL)
    assert not [f for f in shipid.check_trial(trial).findings if f.kind == "speed-sign"]
    log = shipid.Trial("astern", trial.table.assign(u=-trial.table["u"]), units=trial.units)
    fixed, found = fix_trial(log, tmp_path / "fixed.csv")
    assert [(f.channel, f.serious) for f in found] == [("u", True)]
    np.testing.assert_allclose(shipid.read_trial(fixed)["u"], trial["u"])


def test_a_northward_speed_of_a_ship_that_sails_south_is_no_speed_astern():
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", heading="180 deg")
    c, s, u, v = np.cos(trial["psi"]), np.sin(trial["psi"]), trial["u"], trial["v"]
    log = shipid.Trial("south", trial.table.assign(u=u * c - v * s, v=u * s + v * c), units=trial.units)
    assert {f.kind for f in shipid.check_trial(log).findings if f.serious} == {"earth-fixed-velocity"}


def test_it_is_no_speed_of_the_earth_where_the_sway_is_logged():
    """Eastward, the sway and the reversed speed are nearer to velocities north and east than to those of a ship that goes ahead."""
    noise = "psi=0.1 deg, u=0.02 m/s, v=0.02 m/s, x=1 m, y=1 m"
    trial = shipid.simulate("cross-flow", "kvlcc2", "zigzag:20/20", heading="90 deg", noise=noise, seed=1)
    log = shipid.Trial("astern", trial.table.assign(u=-trial["u"]), units=trial.units)
    assert {f.kind for f in shipid.check_trial(log).findings if f.serious} == {"speed-sign"}
