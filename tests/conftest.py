from __future__ import annotations

import pytest

import shipid

NOISE = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "v": "0.1 m/s"}


@pytest.fixture(scope="session")
def sail():
    """Simulate a named model, with sensors for all speeds."""

    def make(model: str, ship: str, manoeuvre: str = "zigzag:20/20", noise=NOISE, **options) -> shipid.Trial:
        return shipid.simulate(shipid.find_model(model), ship, manoeuvre, noise=noise, **options)

    return make


@pytest.fixture(scope="session")
def truth_of():
    """The coefficients a ship has, SI."""

    def values(model: str, ship: str, speed: float | None = None) -> dict[str, float]:
        found = shipid.find_ship(ship)
        return found.values(shipid.find_model(model), speed=speed or found.particular("speed", "m/s"))

    return values
