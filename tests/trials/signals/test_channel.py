import numpy as np
import pandas as pd
import pytest

from shipid.trials.signals.channel import channel_of, spikes_of
from shipid.trials.trial import Trial


def trial_of(t, y, name="psi [deg]"):
    return Trial.from_frame(pd.DataFrame({"t [s]": t, name: y}))


def test_holes_of_a_channel():
    t = np.arange(0, 60.0)
    y = 0.5 * t
    y[20:30] = np.nan
    y[40:43] = np.nan
    channel = channel_of(trial_of(t, y), "psi")
    # Three missing samples make an interval of 4 s: five usual ones are a hole.
    assert channel.holes == ((19.0, 30.0),)
    assert channel.hole(25.0) == (19.0, 30.0) and channel.hole(19.0 - 1e-6) is None
    assert channel.hole(10.0, 20.0) == (19.0, 30.0) and channel.hole(25.0, longest=12.0) is None


def test_short_holes_are_bridged_by_a_cubic():
    t = np.arange(0, 100.0)
    y = 0.001 * (t - 50) ** 3 + 0.1 * t
    holed = y.copy()
    holed[45:53] = np.nan
    channel = channel_of(trial_of(t, holed), "psi")
    assert channel.bridged(5.0) is channel
    filled = channel.bridged(10.0)
    assert filled.holes == ()
    np.testing.assert_allclose(np.degrees(filled.y), y, atol=1e-6)
    np.testing.assert_allclose(filled.t, t)


def test_a_sensor_that_writes_on_change_has_no_hole_where_it_holds():
    t = np.arange(0, 200, 0.1)
    y = np.round(20 * np.sin(2 * np.pi * np.clip(t - 50, 0, None) / 100))
    written = np.concatenate(([True], np.diff(y) != 0))
    sparse = np.where(written, y, np.nan)
    channel = channel_of(trial_of(t, sparse), "psi")
    assert channel.holes == () and np.degrees(channel.grain) == pytest.approx(1.0)
    # It holds its value until it is next written.
    assert np.degrees(np.interp(30.0, channel.t, channel.y)) == 0.0
    # The same sensor, silent while the value changes by more than a digit, has a hole.
    sparse[(t > 70) & (t < 90)] = np.nan
    assert len(channel_of(trial_of(t, sparse), "psi").holes) == 1


def test_spikes_are_found_and_peaks_are_none():
    t = np.arange(0, 200.0)
    y = 30 * np.sin(2 * np.pi * t / 60)
    assert not spikes_of(y).any()
    assert not spikes_of(y[::6]).any()  # ten samples a period
    y[[50, 51, 120]] += [90.0, 90.0, -40.0]
    np.testing.assert_array_equal(np.flatnonzero(spikes_of(y)), [50, 51, 120])
    channel = channel_of(trial_of(t, y), "psi")
    assert channel.spikes == (50.0, 51.0, 120.0) and len(channel.t) == 197
