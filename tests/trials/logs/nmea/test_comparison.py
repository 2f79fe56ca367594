"""Other sources of a signal: their delay and their distance are told where the record shows them."""

import numpy as np
import pytest

from shipid.trials.logs.nmea.comparison import _delay, compared
from shipid.trials.logs.nmea.log import Origin
from shipid.trials.logs.nmea.sources import SignalSource


def source(field, t, *values):
    fields = ("lat", "lon") if field == "lat" else (field,)
    return SignalSource(Origin("X"), fields, t, np.column_stack(values), np.arange(len(t)), 0, 0)


def turning(t):
    return 60 * np.sin(t / 9) * np.exp(-t / 200) + 20 * np.sin(t / 4)


T, SLOW = np.arange(0, 180, 0.05), np.arange(0.03, 170, 0.2)


@pytest.mark.parametrize("late", [8.9, 2.0, -3.0])
def test_a_delay_is_told(late):
    taken, other = source("rate", T, turning(T)), source("rate", SLOW, 0.7 * turning(SLOW - late) + 3)
    said = compared(taken, other)
    assert said.startswith("5 a second, ")
    number, way = said.removeprefix("5 a second, ").split(" s ")
    assert float(number) == pytest.approx(abs(late), abs=0.25)
    assert way == ("later" if late > 0 else "earlier")


def test_the_delay_of_a_damped_source_is_a_span():
    rate = np.where(T % 60 < 30, 8.0, -8.0)
    damped = np.convolve(rate, np.exp(-np.arange(0, 60, 0.05) / 6) * 0.05 / 6)[: T.size]
    rng = np.random.default_rng(3)
    said = compared(source("rate", T, rate + rng.normal(size=T.size)), source("rate", SLOW, np.interp(SLOW, T, damped)))
    span, way = said.removeprefix("5 a second, ").split(" s ")
    near, far = (float(number) for number in span.split(" to "))
    # The half of a step is reached after 0.69 time constants.
    assert near < 6 * np.log(2) < far < 8 and way == "later"


def test_sources_that_agree_and_those_that_do_not():
    taken = source("rate", T, turning(T))
    assert compared(taken, source("rate", SLOW, turning(SLOW))) == "5 a second"
    noise = np.random.default_rng(1).normal(size=SLOW.size)
    assert "does not show the same: correlation 0." in compared(taken, source("rate", SLOW, noise))
    assert "does not show the same: correlation 0 at best" in compared(taken, source("rate", SLOW, 0 * noise))
    few = SLOW[:20]
    assert compared(taken, source("rate", few, noise[:20])) == "5 a second"


def test_headings_off_by_an_angle_across_north():
    taken = source("heading", T, (5 + turning(T)) % 360)
    assert compared(taken, source("heading", SLOW, (2.5 + turning(SLOW)) % 360)) == "5 a second, -2.5 deg off"


def test_positions_apart():
    t = np.arange(0, 50, 1.0)
    taken = source("lat", t, 59.5 + 1e-5 * t, np.full_like(t, 10.5))
    other = source("lat", t + 0.5, 59.5 + 1e-5 * (t + 0.5), np.full_like(t, 10.5 + 1e-4))
    # A degree of longitude at 59.5 deg is 56.7 km.
    assert compared(taken, other) == "1 a second, 5.7 m away"
    assert compared(taken, source("lat", t + 100, 59.5 + 1e-5 * t, np.full_like(t, 10.5))) == "1 a second"


def test_numbers_that_overflow_have_no_delay():
    t = np.arange(100.0)
    with np.errstate(all="ignore"):
        (first, best, last), likeness, _ = _delay(1e200 * np.sin(t), np.sin(t), 1.0)
    assert first <= best <= last and likeness == 0
    # Alike to rounding, and not more.
    assert _delay(np.sin(t), np.sin(t), 1.0)[1] <= 1


def test_a_comparison_that_does_not_go_to_the_end_says_so():
    t = np.array([*np.arange(100.0), 1e6])
    said = compared(source("rate", t, np.sin(t)), source("rate", t, np.sin(t)))
    assert "compared over the first 56 h" in said
