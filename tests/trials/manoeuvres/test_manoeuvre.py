"""Manoeuvres by name, and what they come to for a ship."""

import numpy as np
import pytest

from shipid.declaration.component import declared_quantities
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.trials.manoeuvres.manoeuvre import KINDS, Manoeuvre, parse_manoeuvre, plan

DEG = np.pi / 180
ARGUMENTS = {"unit_time": 20.0, "course": 0.5, "limit": 0.6, "seed": 3}


@pytest.mark.parametrize("kind", KINDS)
def test_the_examples_are_read_and_planned(kind: str) -> None:
    example = KINDS[kind][0]
    manoeuvre = parse_manoeuvre(example)
    assert manoeuvre.kind == kind
    assert str(manoeuvre) == example
    made = plan(manoeuvre, **ARGUMENTS)
    assert made.duration > 20.0
    assert plan(manoeuvre, **ARGUMENTS, duration=77.0).duration == 77.0
    assert bool(made.schedule) == ("helm_schedule" in declared_quantities(made.helm))


def test_angles_are_degrees_and_rates_are_not() -> None:
    assert parse_manoeuvre("zigzag:-20/10").numbers == pytest.approx((-20 * DEG, 10 * DEG))
    assert parse_manoeuvre(" turn:12.5 ").numbers == pytest.approx((12.5 * DEG,))
    assert parse_manoeuvre("reversed-spiral:0.6").numbers == (0.6,)


def test_a_misspelt_manoeuvre() -> None:
    with pytest.raises(
        UnknownNameError, match=r"no manoeuvre 'zig-zag'\. Did you mean zigzag\? Write one as zigzag:20"
    ):
        parse_manoeuvre("zig-zag:20/20")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("zigzag", "does not say its numbers. Write it as zigzag:20/20"),
        ("zigzag:", "does not say its numbers"),
        ("turn:hard", "does not say its numbers. Write it as turn:35"),
        ("turn:1e3", "does not say its numbers"),
        ("zigzag:20", "has 1 number. Write"),
        ("zigzag:20/20/20", "has 3 numbers"),
        ("spiral:20/5", "has 2 numbers"),
        ("turn:0", "needs numbers other than zero"),
        ("zigzag:20/-20", "the second positive"),
    ],
)
def test_numbers_that_do_not_fit(text: str, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        parse_manoeuvre(text)


def test_a_schedule_stands_until_the_next_step() -> None:
    made = plan(parse_manoeuvre("course:60"), **ARGUMENTS)
    assert made.scheduled(np.array([0.0, 19.99, 20.0, 100.0])).tolist() == pytest.approx(
        [0.5, 0.5, *[0.5 + 60 * DEG] * 2]
    )
    # A clock that adds up intervals of 0.1 s arrives a rounding early.
    assert made.scheduled(np.array([sum([0.1] * 200)]))[0] == made.schedule[1][1]


def test_a_spiral_goes_down_and_back_up() -> None:
    made = plan(parse_manoeuvre("spiral:25"), **ARGUMENTS)
    begins, levels = (np.array(c) for c in zip(*made.schedule[1:]))
    assert (begins[0], made.schedule[0]) == (20.0, (0.0, 0.0))
    np.testing.assert_allclose(np.diff(begins), 12 * 20.0)
    lowest = int(levels.argmin())
    assert (levels[0], levels[lowest], levels[-1]) == pytest.approx((25 * DEG, -25 * DEG, 25 * DEG))
    assert (np.diff(levels[: lowest + 1]) < 0).all()
    assert (np.diff(levels[lowest:]) > 0).all()
    assert made.duration == pytest.approx(begins[-1] + 12 * 20.0)


def test_the_stages_of_a_spiral_share_the_time_that_is_stated() -> None:
    """Longer stages let an unstable ship settle; a last stage that is long would not."""
    made = plan(parse_manoeuvre("spiral:25"), **ARGUMENTS, duration=20.0 + 29 * 1000.0)
    begins = np.array([t for t, _ in made.schedule[1:]])
    np.testing.assert_allclose(np.diff(begins), 1000.0)
    assert made.duration == pytest.approx(begins[-1] + 1000.0)


def test_a_reversed_spiral_asks_for_rates() -> None:
    made = plan(parse_manoeuvre("reversed-spiral:0.5"), **ARGUMENTS)
    assert max(v for _, v in made.schedule) == pytest.approx(0.5 / 20.0)
    assert made.constants["helm_limit"] == 0.6


def test_a_telegraph_is_random_by_its_seed() -> None:
    manoeuvre = Manoeuvre("telegraph", (0.2,))
    made = [plan(manoeuvre, **ARGUMENTS | {"seed": s}).schedule for s in (3, 3, 4)]
    assert made[0] == made[1]
    assert made[0] != made[2]
    begins, levels = (np.array(c) for c in zip(*made[0][1:]))
    assert set(levels) == {-0.2, 0.2}
    assert (np.abs(np.diff(levels)) == 0.4).all()
    assert np.diff(begins).min() >= 0.3 * 20.0 - 1e-9
    long = plan(manoeuvre, **ARGUMENTS, duration=40000.0).schedule
    # 2 L/U by an exponential law cut off below at 0.3: mean 2.02; the mean of 2000 scatters by 2 %.
    assert np.diff([b for b, _ in long[1:]]).mean() / 20.0 == pytest.approx(2.02, rel=0.08)


def test_course_limits() -> None:
    assert plan(parse_manoeuvre("course:60/15"), **ARGUMENTS).constants["helm_limit"] == pytest.approx(15 * DEG)
    assert plan(parse_manoeuvre("course:60"), **ARGUMENTS).constants["helm_limit"] == 0.6
