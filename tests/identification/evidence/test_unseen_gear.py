"""An order that is taken for the rudder: serious where the gear takes a large share of the ship's time constant."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.identification.evidence.unseen_gear import gear_share
from shipid.identification.validation.trial_findings import findings_of
from shipid.parameters.catalogue import ship_of


def ordered(tau, gain=0.08, angle=20.0, rate=3.0, step=0.05):
    """A zig-zag of a first-order ship with a gear, of which the order is logged each second."""
    n = int(600 / step)
    order, rudder, r, psi = (np.zeros(n) for _ in range(4))
    side, limit = 1.0, np.radians(angle)
    for k in range(1, n):
        if side * psi[k - 1] >= limit:
            side = -side
        order[k] = side * limit if k * step >= 20 else 0.0
        rudder[k] = rudder[k - 1] + np.clip(order[k] - rudder[k - 1], -np.radians(rate) * step, np.radians(rate) * step)
        r[k] = r[k - 1] + step * (gain * rudder[k - 1] - r[k - 1]) / tau
        psi[k] = psi[k - 1] + step * r[k]
    every = slice(None, None, int(1 / step))
    noise = np.random.default_rng(1).normal(0, np.radians(0.01), len(r[every]))
    table = {"t": step * np.arange(n)[every], "psi": psi[every], "r": r[every] + noise, "delta": order[every]}
    return shipid.Trial.from_frame(
        pd.DataFrame(table), name="ordered", units={"t": "s", "psi": "rad", "r": "rad/s", "delta": "rad"}
    )


def found(trial, **kinds):
    comparison = SimpleNamespace(trial=trial, samples={"psi": None, "r": None})
    findings = findings_of(ship_of(None), [comparison], [], ("delta",), **kinds)
    return next(f for f in findings if f.finding.kind == "order-not-feedback")


def test_an_order_spoils_a_fit_of_a_quick_ship_without_a_gear():
    trial = ordered(12.0)
    bare = found(trial, geared=False)
    assert bare.finding.serious and "no steering gear" in bare.finding.effect and bare.to_dict()["serious"]
    assert not found(trial, geared=True).finding.serious


def test_the_gear_of_a_slow_ship_does_not_matter():
    assert not found(ordered(100.0), geared=False).finding.serious


def test_the_share_is_half_the_step_over_rate_and_time_constant():
    # 40 deg at 65/28 deg/s take 17.2 s; a ship of 25 m is twice as fast as one of 100 m.
    ship = shipid.find_ship("zeefakkel")
    length = ship.particular("L", "m")
    known = 0.5 * 40 / (65 / 28 * np.sqrt(100 / length)) / 30
    assert gear_share(ordered(30.0, rate=60.0), ship) == pytest.approx(known, rel=0.15)
