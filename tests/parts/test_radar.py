"""What a radar shows, and its slopes where it stands."""

import casadi as ca
import numpy as np
import pytest

import shipid
from shipid.models.plot_motion import ConstantVelocity
from shipid.parts.radar import Radar

SHOWN = ["range", "bearing"]


def radar():
    """The generated sensor and its Jacobian, of a position and that of the radar."""
    system = shipid.generate(shipid.join("target on radar", ConstantVelocity, Radar))
    both = [system.expression(SHOWN), ca.jacobian(system.expression(SHOWN), system.x)]
    function = ca.Function("radar", [system.x, system.u, system.p], both)
    p = system.vector(system.coefficients, {"least": 1.0})

    def show(x, y, **at):
        u = system.vector(system.inputs, at, default=0.0)
        z, slope = function([x, y, 0, 0], u, p)
        return z.full().ravel(), slope.full()

    return show


@pytest.mark.parametrize(("north", "east"), [(300.0, 400.0), (-300.0, 400.0), (-5.0, -12.0), (0.0, -7.0)])
def test_range_and_bearing_are_those_of_the_plane(north, east):
    z, slope = radar()(north + 10, east - 20, radar_x=10.0, radar_y=-20.0)
    far = np.hypot(north, east)
    assert z == pytest.approx([far, np.arctan2(east, north)])
    assert slope[0, :2] == pytest.approx([north / far, east / far])
    assert slope[1, :2] == pytest.approx([-east / far**2, north / far**2])


def test_at_the_radar_nothing_is_infinite():
    z, slope = radar()(0.0, 0.0)
    assert z == pytest.approx([1.0, 0.0])
    assert np.isfinite(slope).all()


def test_bearings_wrap_in_a_filter():
    """A ship that passes south of the radar, where the bearing jumps by a turn."""
    model = shipid.join("target on radar", ConstantVelocity, Radar)
    t = np.arange(60.0)
    x, y = -500.0 + 0 * t, 150.0 - 5 * t
    record = {"t": t, "range": np.hypot(x, y), "bearing": np.arctan2(y, x)}
    from shipid.estimation.multiple.first_state import FirstState

    kalman = shipid.InteractingMultipleModel(
        {"straight": model}, [[1.0]], measured={"range": "5 m", "bearing": "0.2 deg"}, model_noise=False
    )
    first = FirstState(("x", "y", "vx", "vy"), np.array([-490.0, 140.0, 0, -4.0]), np.diag([400.0, 400.0, 4.0, 4.0]))
    run = kalman.filter(record, first=first)
    assert np.abs(np.diff(np.unwrap(record["bearing"]))).max() < 0.02 < np.abs(np.diff(record["bearing"])).max()
    assert run["x"][-1] == pytest.approx(x[-1], abs=3.0)
    assert run["y"][-1] == pytest.approx(y[-1], abs=3.0)
