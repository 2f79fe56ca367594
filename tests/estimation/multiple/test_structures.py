"""Modes whose parameter moves: the augmented ones, and the adaptive grid."""

import numpy as np
import pytest

from shipid import InteractingMultipleModel, Mode
from shipid.estimation.errors import ModeError
from shipid.estimation.multiple.structures import AdaptiveGrid, Displaced
from shipid.models import constant_velocity_augmented, coordinated_turn, coordinated_turn_augmented

RATE = 5.6
STAY = [[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]
BOUNDS = {
    "port": ("-5.6 deg/s", "-1.87 deg/s"),
    "straight": ("0 deg/s", "0 deg/s"),
    "starboard": ("1.87 deg/s", "5.6 deg/s"),
}


def augmented(structure):
    """The augmented tracker of Semerdjiev, Mihaylova and Li (2000)."""
    noise = {"domega": "0.01 rad/s"}
    modes = {
        "port": Mode(coordinated_turn_augmented, inputs={"omega": f"-{RATE} deg/s"}, noise=noise),
        "straight": Mode(constant_velocity_augmented, inputs={"omega": "0 deg/s"}),
        "starboard": Mode(coordinated_turn_augmented, inputs={"omega": f"{RATE} deg/s"}, noise=noise),
    }
    return InteractingMultipleModel(
        modes,
        STAY,
        measured={"x": "85 m", "y": "85 m"},
        probabilities=[0.1, 0.8, 0.1],
        initial={"domega": "0.01 rad/s"},
        structure=structure,
    )


def grid(**changes):
    """The adaptive grid of the same paper."""
    given = {"order": ("starboard", "straight", "port"), "closest": "3.73 deg/s", "widest": "5.6 deg/s"}
    modes = {
        n: Mode(coordinated_turn, inputs={"omega": f"{w} deg/s"})
        for n, w in (("port", -RATE), ("straight", 0.0), ("starboard", RATE))
    }
    return InteractingMultipleModel(
        modes,
        STAY,
        measured={"x": "85 m", "y": "85 m"},
        noise={"ax": "2 m/s^2", "ay": "2 m/s^2"},
        structure=AdaptiveGrid("omega", **(given | changes)),
    )


def test_variable_structure_moves_the_parameter_within_its_bounds(track):
    record, first, _ = track
    run = augmented(Displaced("omega", "domega", BOUNDS)).filter(record, first=first)
    moved = np.rad2deg(run.rows("theta"))
    before = np.rad2deg(run.out[:, run.design.layout.full["theta"]])
    assert moved == pytest.approx(before)
    # The parameter of a scan is that of the one before with its displacement, cut at the bounds.
    places = [d.model.states.index("domega") for d in run.design.designs]
    displaced = np.column_stack([run.rows(f"x{j}")[:, at] for j, at in enumerate(places)])
    own = np.rad2deg(run.parameter - displaced)
    low, high = np.array([-5.6, 0.0, 1.87]), np.array([-1.87, 0.0, 5.6])
    assert (own >= low - 1e-9).all()
    assert (own <= high + 1e-9).all()
    assert own[1:] == pytest.approx(np.clip(np.rad2deg(run.parameter[:-1]), low, high), abs=1e-9)
    # It is not the fixed structure under another name: the mode that holds comes to the rate of the ship.
    turning = slice(300, 314)
    assert np.abs(np.rad2deg(run.parameter[turning, 2]) - RATE).mean() < 1.0
    assert np.ptp(own[:, 2]) > 2.0


def test_fixed_structure_keeps_the_parameter_and_bounds_the_sum(track):
    record, first, _ = track
    run = augmented(Displaced("omega", "domega", BOUNDS, variable=False)).filter(record, first=first)
    free = augmented(Displaced("omega", "domega", variable=False)).filter(record, first=first)
    places = [d.model.states.index("domega") for d in run.design.designs]
    displaced = np.column_stack([run.rows(f"x{j}")[:, at] for j, at in enumerate(places)])
    assert np.rad2deg(run.parameter - displaced) == pytest.approx(np.tile([-RATE, 0.0, RATE], (400, 1)), abs=1e-9)
    # The displacement is cut before it is used, so that it can leave the bounds by one update only.
    assert np.abs(np.rad2deg(displaced[:, 1])).max() < np.abs(np.rad2deg(free.parameter[:, 1])).max()
    assert not np.allclose(run.x, free.x)


def test_the_grid_follows_the_probable_rate(track):
    record, first, _ = track
    run = grid(closest="0.5 deg/s", improbable=0.3).filter(record, first=first)
    theta, mu = np.rad2deg(run.parameter), run.probabilities
    centre = np.clip((mu * theta).sum(axis=1), -RATE, RATE)
    assert theta[1:, 1] == pytest.approx(centre[:-1], abs=1e-9)
    distance = theta[:, 2] - theta[:, 1]
    inside = theta[:, 2] < RATE - 1e-9
    assert (distance[inside] >= 0.5 - 1e-9).all()
    assert (distance <= 5.6 + 1e-9).all()
    # A neighbour that is improbable beside a dominant middle comes closer, and the others stay.
    quiet = (mu[:-1, 1] >= mu[:-1].max(axis=1)) & (mu[:-1, 2] < 0.3) & inside[1:]
    wanted = np.maximum(distance[:-1] / 2, 0.5)
    assert quiet.any()
    assert distance[1:][quiet] == pytest.approx(wanted[quiet], abs=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: augmented(Displaced("omega", "domega", BOUNDS | {"port": ("-5.6 deg/s", "0.5 deg/s")})), "overlap"),
        (lambda: augmented(Displaced("omega", "domega", BOUNDS | {"port": ("-2 deg/s", "-5 deg/s")})), "run from"),
        (
            lambda: augmented(Displaced("omega", "domega", BOUNDS | {"port": ("-3 deg/s", "-1 deg/s")})),
            "outside its bounds",
        ),
        (lambda: augmented(Displaced("omega", "vx2", BOUNDS)), "no state 'vx2'"),
        (lambda: augmented(Displaced("speed", "domega")), "no constant input 'speed'"),
        (
            lambda: augmented(Displaced("omega", "domega", {"left": ("1 deg/s", "2 deg/s")})),
            "mode with bounds called 'left'",
        ),
        (lambda: grid(order=("port", "straight", "starboard")), "must decrease"),
        (lambda: grid(order=("port", "straight", "left")), "three modes"),
        (lambda: grid(closest="6 deg/s"), "closest"),
    ],
)
def test_what_does_not_fit_is_refused(make, message):
    with pytest.raises((ModeError, Exception), match=message) as caught:
        make()
    assert type(caught.value).__module__.startswith("shipid")
