"""Errors of instruments are estimated where a model joins an instrument that has them."""

from __future__ import annotations

import pytest

import shipid
from shipid.declaration.units import to_si
from shipid.models import DeKeizer, Nomoto, PlanarMotion, VanLeeuwenSway
from shipid.parts.sensors import Compass, FaultyCompass, FaultyGyro, FaultyLog, Gyro, shown_by


@pytest.mark.parametrize(
    ("parts", "truth"),
    [
        ((Compass, FaultyGyro), {"r_bias": "0.02 deg/s", "r_scale": "1.05"}),
        ((FaultyCompass, Gyro), {"tau_compass": "3 s"}),
    ],
)
def test_what_an_instrument_does_to_a_log_is_found_in_it(parts, truth):
    model = shipid.join("with instruments", Nomoto, PlanarMotion, *parts)
    # Without positions an offset of the compass does not show.
    unseen = {"psi_offset": "0 deg"} if FaultyCompass in parts else {}
    settings = {"duration": "300 s", "noise": "psi=0.1 deg,r=0.01 deg/s", "sampling": "0.5 s", "seed": 2}
    trial = shipid.simulate(model, "zeefakkel", "zigzag:20/20", values=truth | unseen, **settings)
    plain = shipid.simulate(shipid.join("without", Nomoto, PlanarMotion), "zeefakkel", "zigzag:20/20", **settings)
    shown = "r" if FaultyGyro in parts else "psi"
    assert abs(trial[shown] - plain[shown]).max() > 10 * 0.0002  # the instrument is in the log
    fit = shipid.identify(model, [trial], ship="zeefakkel", starts=1)
    for name, value in truth.items():
        found = fit.parameters[name]
        assert found.identifiable
        assert abs(found.value - to_si(value, model[name].given_unit, name)) < 3 * found.std
    for name in ("K", "tau"):
        true = shipid.find_ship("zeefakkel").values(model, speed=5.0)[name]
        assert fit.parameters[name].value == pytest.approx(true, rel=0.03)


def test_the_scale_of_a_log_does_not_pull_at_the_speed_before_the_manoeuvre():
    """That speed is read from the same log: believed to half a percent, it pulled the scale to .946 ± .004, and K with it."""
    model = shipid.join("log with a scale", DeKeizer, VanLeeuwenSway, PlanarMotion, FaultyLog)
    settings = {
        "duration": "600 s",
        "noise": "psi=0.1 deg,r=0.01 deg/s,u=0.05 m/s,x=3 m,y=3 m",
        "sampling": "1 s",
        "seed": 2,
    }
    trial = shipid.simulate(model, "soesterberg", "zigzag:20/20", values={"u_scale": "0.93"}, **settings)
    fit = shipid.identify(model, [trial], ship="soesterberg", starts=1)
    found = fit.parameters["u_scale"]
    assert found.identifiable and abs(found.value - 0.93) < 3 * found.std < 0.03


def test_an_instrument_without_errors_shows_the_quantity_itself():
    model = shipid.join("with instruments", Nomoto, PlanarMotion, Compass, FaultyGyro)
    assert shown_by(model, ("psi", "r", "x")) == ("psi", "gyro", "x")
