"""Devices that share a talker are told apart as their sentences come, as in the whole log."""

import numpy as np
import pytest

from shipid.trials.logs.live.reader import LiveLog
from shipid.trials.logs.reading import read_trial


def summed(text):
    total = 0
    for character in text:
        total ^= ord(character)
    return f"${text}*{total:02X}"


def two_gyros(slow, apart=2.0, seconds=60, kind="HDT", noise=0.02):
    """Gyros under one talker, the second `apart` degrees off and `slow` times a second, the first five times."""
    rng, events = np.random.default_rng(3), []
    for rate, shift, late in ((5, 0.0, 0.0), (slow, apart, 0.07)):
        for k in range(int(seconds * rate)):
            t = k / rate + late
            value = 100 + 8 * np.sin(0.1 * t) + shift + rng.normal(0, noise)
            events.append((t, summed(f"HE{kind},{value:.2f},T")))
    return "".join(f"2026-05-04T09:00:{t:06.3f}Z {text}\n" for t, text in sorted(events) if t < seconds)


@pytest.fixture
def toml(log):
    return lambda text: log(text, "logger.toml")


def live(text, fmt=None):
    told = []
    return [s.values for s in LiveLog(text.splitlines(keepends=True), "log", fmt, told.append)], told


@pytest.mark.parametrize("slow", [5, 1])
@pytest.mark.parametrize("which", [1, 2])
def test_two_gyros_with_one_talker(log, toml, slow, which):
    text = two_gyros(slow)
    fmt = None if which == 1 else toml('[nmea.sources]\npsi = "HEHDT#2"\n')
    trial = read_trial(log(text, "two.nmea"), fmt)
    samples, told = live(text, fmt)
    assert sum("WARNING: HEHDT comes from 2 devices that share a talker, 2 deg apart" in line for line in told) == 1
    late = [s for s in samples if s["t"] > 30.01]
    found = {round(s["t"], 3): np.degrees(s["psi"]) for s in late if "psi" in s}
    shift = 2.0 * (which - 1)
    assert len(found) == (149 if which == 1 else 30 * slow)
    for t, psi in found.items():
        assert psi == pytest.approx(100 + 8 * np.sin(0.1 * t) + shift, abs=0.15)
    whole = trial.table[(trial["t"] > 30.01 - min(samples[0]["t"], 0)) & np.isfinite(trial["psi"])]
    assert len(found) == pytest.approx(len(whole), abs=1)


def test_one_gyro_with_glitches_is_one(log):
    """A wild value now and then is no second device."""
    wild = set(np.random.default_rng(1).integers(0, 300, 20).tolist())
    lines = [summed(f"HEHDT,{100 + (30 if k in wild else 0) + 0.1 * k:.2f},T") for k in range(300)]
    text = "".join(f"2026-05-04T09:{k // 300:02d}:{k / 5 % 60:06.3f}Z {line}\n" for k, line in enumerate(lines))
    samples, told = live(text)
    assert len(samples) == 300
    assert not any("share a talker" in line for line in told)


def test_what_a_tag_block_names_is_a_device_of_its_own():
    """The first that is heard is followed; they are not mixed."""

    def tagged(source, t, value):
        block = f"s:{source},c:{1777885200 + t}"
        total = 0
        for character in block:
            total ^= ord(character)
        return f"\\{block}*{total:02X}\\{summed(f'HEHDT,{value:.1f},T')}\n"

    text = "".join(tagged("GY0001", k, 10.0) + tagged("GY0002", k, 50.0) for k in range(30))
    samples, _ = live(text)
    assert {round(np.degrees(s["psi"])) for s in samples if "psi" in s} == {10}
