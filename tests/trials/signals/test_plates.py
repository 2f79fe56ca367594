import numpy as np
import pytest

from shipid.trials.signals.plates import plates, regular


def rudder(*pieces):
    """A rudder in deg that stays so many samples at each angle, in rad."""
    return np.radians(np.concatenate([np.full(count, float(angle)) for angle, count in pieces]))


def test_plates_of_a_zigzag():
    found = plates(rudder((0, 20), (20, 40), (-20, 60), (20, 60), (0, 50)))
    assert [plate.side for plate in found] == [1, -1, 1]
    np.testing.assert_allclose(np.degrees([plate.angle for plate in found]), [20, -20, 20])
    assert [(plate.first, plate.last) for plate in found] == [(20, 60), (60, 120), (120, 230)]
    # Amidships after the last plate does not shorten its dwell.
    assert [plate.dwell for plate in found] == [1.0, 1.0, 1.0]
    assert found[-1].idle == pytest.approx(50 / 110)
    assert regular(found) == found


def test_hand_steering_to_the_same_side_is_a_plate_of_its_own():
    """10 samples over, 60 amidships, then the zig-zag begins to the same side."""
    found = plates(rudder((0, 20), (20, 10), (0, 60), (20, 40), (-20, 40), (20, 40), (0, 5)))
    assert [(plate.first, plate.last) for plate in found] == [(20, 90), (90, 130), (130, 170), (170, 215)]
    assert [plate.first for plate in regular(found)] == [90, 130, 170]


def test_steering_back_to_the_course_does_not_take_the_place_of_the_plates():
    """The rudder of the way back is followed by a long stretch amidships, which is no plate of it."""
    found = plates(rudder((0, 20), *((side * 20, 60) for side in (-1, 1, -1, 1, -1)), (12.5, 60), (0, 100)))
    assert [plate.first for plate in regular(found)] == [20, 80, 140, 200, 260]


def test_a_rudder_that_is_let_go_is_not_reversed():
    found = plates(rudder((0, 20), (35, 30), (0, 40), (-35, 30), (0, 20)))
    assert len(found) == 2 and len(regular(found)) == 1


def test_a_rudder_that_stays_amidships_has_no_plates():
    assert plates(np.radians(0.1 * np.sin(np.arange(100.0)))) == []
