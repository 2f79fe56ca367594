"""Two devices behind one talker are told apart; one device, however it moves, is not."""

import numpy as np
import pytest

from shipid.trials.logs.reading import read_trial

LAT, LON = 59.5, 10.5
N = 1856.85  # metres a minute of latitude
E = N * np.cos(np.radians(LAT)) * 1.00169


def gga(utc, x, y, talker="GP"):
    return f"{talker}GGA,{utc},59{30 + x / N:09.6f},N,010{30 + y / E:09.6f},E,1,10,0.9,5.0,M,40.0,M,,"


def stamp(t):
    return f"2026-05-04T09:{int(t) // 60:02d}:{t % 60:06.3f}Z "


def utc_of(t):
    return f"09{int(t) // 60:02d}{t % 60:05.2f}"


@pytest.fixture
def receivers(log, sentence):
    """A ship on a curve at 8 m/s with two receivers, the second `apart` metres to starboard of the first."""

    def make(apart=8.0, late=0.3, same_utc=True, lost=(), noise=0.0, stamped=True, turning=0.5, n=120):
        rng = np.random.default_rng(4)
        events = []
        for k in range(n):
            a = np.radians(turning * k)
            w = np.radians(turning)
            x, y = 8 * np.sin(a) / w, 8 * (1 - np.cos(a)) / w
            for device in (0, 1):
                if (k, device) in lost:
                    continue
                east, north = np.cos(a) * apart * device, -np.sin(a) * apart * device
                position = np.array([x + north, y + east]) + rng.normal(0, noise, 2)
                t = k + late * device
                utc = utc_of(k if same_utc else t)
                events.append((t, sentence(gga(utc, *position))))
        events.sort(key=lambda event: event[0])
        text = "".join((stamp(t) if stamped else "") + body + "\n" for t, body in events)
        return log(text, "two.nmea")

    return make


def truth(t, apart=0.0, turning=0.5):
    a, w = np.radians(turning * t), np.radians(turning)
    return 8 * np.sin(a) / w - np.sin(a) * apart, 8 * (1 - np.cos(a)) / w + np.cos(a) * apart


@pytest.mark.parametrize("late", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("same_utc", [True, False])
def test_two_receivers_with_one_talker(receivers, toml, late, same_utc):
    path = receivers(late=late, same_utc=same_utc)
    trial = read_trial(path)
    warned = [n for n in trial.source.notes if "2 devices that share a talker" in n]
    assert len(warned) == 1 and warned[0].startswith("WARNING: GPGGA")
    assert "as in 'GPGGA#2'" in warned[0]
    assert float(warned[0].partition("talker, ")[2].split()[0]) == pytest.approx(8, abs=1.5)
    assert any(
        "not used: GPGGA#2 (1 a second, " in n and "GGA of talker GP (stream 1)" in n for n in trial.source.notes
    )
    x, y = truth(trial["t"])
    assert np.hypot(trial["x"] - x + x[0], trial["y"] - y).max() < 0.3  # metres of the chord between two fixes
    other = read_trial(path, format=toml('[nmea.sources]\nposition = "GPGGA#2"\n'))
    assert (
        np.hypot(np.diff(other["x"] - trial["x"][: len(other)]), np.diff(other["y"] - trial["y"][: len(other)])).max()
        < 0.3
    )


def test_a_sentence_that_is_lost_does_not_exchange_the_receivers(receivers):
    lost = {(30, 0), (31, 1), (50, 1), (70, 0), (71, 0)}
    trial = read_trial(receivers(lost=lost))
    x, y = truth(trial["t"])
    off = np.hypot(trial["x"] - x, trial["y"] - y)
    assert np.nanmax(off) < 1.5  # 8 m where one is taken for the other


def test_noise_as_large_as_the_distance(receivers):
    """One UTC has one position: the order within it tells receivers apart where their values do not."""
    trial = read_trial(receivers(apart=6.0, noise=3.0))
    assert any("GPGGA comes from 2 devices" in n for n in trial.source.notes)


def test_without_stamps(receivers):
    trial = read_trial(receivers(stamped=False))
    assert any("GPGGA comes from 2 devices" in n for n in trial.source.notes)


@pytest.mark.parametrize("noise", [0.0, 0.5, 3.0])
@pytest.mark.parametrize("turning", [0.0001, 0.5, 3.0])
def test_one_receiver_is_one(receivers, noise, turning):
    only_one = {(k, 1) for k in range(120)}
    trial = read_trial(receivers(lost=only_one, noise=noise, turning=turning))
    assert not any("devices" in n for n in trial.source.notes)
    assert len(trial) == 120


def test_receivers_beside_each_other_with_talkers_of_their_own(log, sentence):
    text = "".join(
        stamp(k)
        + sentence(gga(utc_of(k), 8 * k, 0))
        + "\n"
        + stamp(k)
        + sentence(gga(utc_of(k), 8 * k, 9, "GN"))
        + "\n"
        for k in range(60)
    )
    trial = read_trial(log(text))
    assert not any("devices" in n for n in trial.source.notes)
    assert any("not used" in n for n in trial.source.notes)


def test_a_fix_that_is_sent_twice_counts_once(log, sentence):
    once = [sentence(gga(utc_of(k), 8 * k, 0)) for k in range(60)]
    text = "".join(f"{stamp(k)}{s}\n{stamp(k + 0.1)}{s}\n" for k, s in enumerate(once))
    trial = read_trial(log(text))
    assert "60 sentences GPGGA repeat the one before with its UTC: they count once." in trial.source.notes
    assert not any("devices" in n for n in trial.source.notes)
    np.testing.assert_allclose(trial["x"], 8 * trial["t"], atol=0.3)


def test_two_compasses_with_one_talker(log, sentence, toml):
    def heading(k):
        return 355 + 8 * np.sin(k / 9)

    text = "".join(
        f"{stamp(k / 2)}{sentence(f'HEHDT,{heading(k) % 360:.1f},T')}\n"
        f"{stamp(k / 2 + 0.1)}{sentence(f'HEHDT,{(heading(k + 0.2) + 2) % 360:.1f},T')}\n"
        for k in range(200)
    )
    path = log(text)
    first = read_trial(path)
    assert any("HEHDT comes from 2 devices that share a talker, 2 deg apart" in n for n in first.source.notes)
    np.testing.assert_allclose(np.degrees(first["psi"]), heading(2 * first["t"]), atol=0.15)
    second = read_trial(path, format=toml('[nmea.sources]\npsi = "HEHDT#2"\n'))
    np.testing.assert_allclose(np.degrees(second["psi"]), heading(2 * (second["t"])) + 2, atol=0.15)


@pytest.mark.parametrize("decimals", [0, 1])
def test_a_compass_of_a_ship_that_hunts_is_one(log, sentence, decimals):
    rng = np.random.default_rng(1)
    text = "".join(
        stamp(k / 5) + sentence(f"HEHDT,{(90 + 3 * np.sin(k / 8) + rng.normal(0, 0.3)) % 360:.{decimals}f},T") + "\n"
        for k in range(400)
    )
    trial = read_trial(log(text))
    assert not any("devices" in n for n in trial.source.notes)


def test_tag_blocks_that_name_their_source(log, sentence, toml):
    def tagged(source, t, body):
        block = f"s:{source},c:{1777885200 + t:.0f}"
        total = 0
        for character in block:
            total ^= ord(character)
        return f"\\{block}*{total:02X}\\{sentence(body)}\n"

    text = "".join(
        tagged("GP0001", k, gga(utc_of(k), 8 * k, 0)) + tagged("GP0002", k, gga(utc_of(k), 8 * k, 1 + 0.5 * k))
        for k in range(60)
    )
    path = log(text)
    assert np.ptp(read_trial(path)["y"]) < 0.1
    chosen = read_trial(path, format=toml('[nmea.sources]\nposition = "GPGGA#GP0002"\n'))
    assert np.ptp(chosen["y"]) == pytest.approx(29.5, abs=0.6)  # whole seconds: right to half of one
    alone = "".join(line + "\n" for line in text.splitlines()[::2])
    assert any("GGA of talker GP, 60 values" in n for n in read_trial(log(alone)).source.notes)


@pytest.mark.parametrize("every", [3, 5])
def test_two_compasses_of_different_rates(log, sentence, every):
    """The slower one speaks between two sentences of the other, which keeps its beat."""

    def heading(k):
        return 355 + 20 * np.sin(k / 15)

    lines = []
    for k in range(240):
        lines.append(stamp(k) + sentence(f"HEHDT,{heading(k) % 360:.1f},T"))
        if k % every == 0:
            lines.append(stamp(k + 0.1) + sentence(f"HEHDT,{(heading(k + 0.1) + 1.5) % 360:.1f},T"))
    trial = read_trial(log("\n".join(lines) + "\n"))
    (warned,) = [n for n in trial.source.notes if "devices" in n]
    assert "HEHDT comes from 2 devices that share a talker, 1.5 deg apart" in warned
    there = np.isfinite(trial["psi"])
    np.testing.assert_allclose(np.degrees(trial["psi"])[there], heading(trial["t"][there]), atol=0.06)


def test_glitches_in_the_place_of_samples_are_no_second_compass(log, sentence):
    lines = [
        stamp(k) + sentence(f"HEHDT,{(355 + 20 * np.sin(k / 15) + 1.5 * (k % 5 == 0)) % 360:.1f},T") for k in range(240)
    ]
    assert not any("devices" in n for n in read_trial(log("\n".join(lines) + "\n")).source.notes)


def test_of_two_rudders_with_one_talker_one_stands_still(log, sentence):
    """Where the rudder that moves goes through the angle of the other, they go on taking turns."""

    def rudder(k):
        return float(np.clip(40 * np.sin(k / 20), -20, 20))

    lines = [stamp(k) + sentence(f"IIRSA,{angle:.1f},A,,V") for k in range(300) for angle in (rudder(k), 0.0)]
    trial = read_trial(log("\n".join(lines) + "\n"))
    assert any("IIRSA comes from 2 devices" in n for n in trial.source.notes)
    np.testing.assert_allclose(np.degrees(trial["delta"]), [rudder(k) for k in trial["t"]], atol=0.06)


def test_two_gyros_do_not_move_the_clock_of_the_rudder(log, sentence):
    """Without stamps a device that speaks twice does so evenly; two that speak once each stand with the others."""
    lines = []
    for k in range(60):
        lines += [
            f"GPZDA,0900{k:02d}.00,04,05,2026,00,00",
            f"HEHDT,{10 + 0.5 * k:.1f},T",
            f"HEHDT,{13 + 0.5 * k:.1f},T",
        ]
        lines += [f"IIRSA,{0.1 * k:.1f},A,,V"]
    trial = read_trial(log("".join(sentence(line) + "\n" for line in lines), "gyros.nmea"))
    psi, delta = (trial["t"][np.isfinite(trial[name])] for name in ("psi", "delta"))
    np.testing.assert_allclose(psi[:50], delta[:50])
