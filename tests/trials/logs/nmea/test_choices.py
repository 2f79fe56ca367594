"""What a format file says, which source is taken, gaps, rates, and the reference point."""

from pathlib import Path

import numpy as np
import pytest

from shipid.trials.logs.nmea.reading import read_nmea
from shipid.trials.logs.nmea.settings import chosen_format
from shipid.trials.logs.reading import read_trial

ROOT = Path(__file__).resolve().parents[4]
KNOT = 1852 / 3600


@pytest.fixture
def read(log, stamped, toml, dense):
    def run(*sentences, text="", seconds=20.0):
        return dense(
            read_trial(log(stamped(*sentences, seconds=seconds), "trial.nmea"), format=toml("[nmea]\n" + text))
        )

    return run


def steady(text, rate=5):
    return (text, rate)


RSA = steady("IIRSA,5.0,A,-7.0,A", 2)
HDT = steady("HEHDT,30.0,T")


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ('use = "starboard"', 5),
        ('use = "port"', -7),
        ('use = "mean"', -1),
        ('scale = "0.5 deg"', 2.5),
        ('scale = "0.01 rad"', np.degrees(0.05)),
        ('scale = "0.5 deg"\noffset = "1 deg"\nsign = -1', -3.5),
        ('offset = "-2 deg"', 3),
    ],
)
def test_calibration_of_the_rudder(read, text, angle):
    trial = read(HDT, RSA, text="[nmea.rudder]\n" + text)
    assert np.degrees(trial["delta"][0]) == pytest.approx(angle)


def test_calibration_of_the_order(read):
    trial = read(HDT, RSA, steady("IIROR,10.0,A,,V,B"), text='[nmea.order]\nscale = "2 deg"\nsign = -1')
    assert np.degrees(trial["delta_order"][0]) == pytest.approx(-20)
    assert "calibrated: -(2 deg × ROR +0 deg)" in " ".join(trial.source.notes)


def test_an_order_alone_is_a_rudder(read):
    trial = read(HDT, steady("IIROR,10.0,A,,V,B"))
    assert trial.has("delta_order") and not trial.has("delta")


def test_a_rudder_that_turns_the_other_way_is_warned_of(read):
    def heading(t):
        return f"HEHDT,{30 - 20 * np.cos(t / 8):.2f},T"

    rate = (lambda t: f"HEROT,{2.5 * np.sin(t / 8) * 60:.2f},A", 5)
    rudder = (lambda t: f"IIRSA,{-10 * np.cos(t / 8):.2f},A,,V", 5)
    trial = read((heading, 5), rate, rudder, seconds=200)
    assert any(n.startswith("WARNING: positive rudder turns this ship to port") for n in trial.source.notes)
    without = read((heading, 5), rudder, seconds=200)
    assert any(n.startswith("WARNING: positive RSA turns this ship to port") for n in without.source.notes)


def test_the_talker_with_most_values_is_believed(read):
    trial = read(HDT, steady("GPHDT,31.0,T", 1), RSA)
    assert np.degrees(trial["psi"][0]) == pytest.approx(30)
    assert "not used: GPHDT (1 a second" in " ".join(trial.source.notes)


@pytest.mark.parametrize(("source", "heading"), [("GPHDT", 31), ("HDT", 30), ("THS", 32), ("HCHDM", 33)])
def test_the_source_that_is_asked_for(read, source, heading):
    others = steady("GPHDT,31.0,T", 1), steady("HETHS,32.0,A", 1), steady("HCHDM,33.0,M", 10)
    trial = read(HDT, *others, RSA, text=f'[nmea.sources]\npsi = "{source}"')
    assert np.degrees(trial["psi"][0]) == pytest.approx(heading)


def test_true_comes_before_magnetic_unless_asked(read):
    both = HDT, steady("HCHDM,33.0,M", 10), RSA
    assert np.degrees(read(*both)["psi"][0]) == pytest.approx(30)
    text = '[nmea.heading]\nreference = "magnetic"\nvariation = "-2.5 deg"\ncorrection = "0.5 deg"'
    assert np.degrees(read(*both, text=text)["psi"][0]) == pytest.approx(31)


def test_a_source_that_fails_early_is_not_taken(read):
    trial = read(HDT, (lambda t: f"HETHS,99.0,{'A' if t < 3 else 'V'}", 5), RSA)
    assert np.degrees(trial["psi"][-1]) == pytest.approx(30)


@pytest.mark.parametrize(("seconds", "heading"), [(18.0, 30), (16.0, 33)])
def test_ten_values_are_a_signal_and_nine_are_not_where_another_source_has_more(read, seconds, heading):
    slow = steady("HEHDT,30.0,T", 0.5)
    trial = read(slow, steady("HCHDM,33.0,M"), RSA, seconds=seconds)
    assert np.degrees(trial["psi"][0]) == pytest.approx(heading)


def test_two_courses_are_enough_to_interpolate(read):
    """Both stand inside the trial, and no further apart than the gap that is interpolated."""
    trial = read(HDT, RSA, steady("GPVTG,30.0,T,,M,12.0,N,,K,A", 1 / 20))
    np.testing.assert_allclose(trial["SOG"], 12 * KNOT)


def test_u_is_over_ground_only_where_it_is_asked_for(read):
    both = HDT, RSA, steady("VDVBW,10.0,0.0,A,12.0,1.0,A", 1)
    assert read(*both)["u"][0] == pytest.approx(10 * KNOT)
    asked = read(*both, text='speed = "ground"')
    assert asked["u"][0] == pytest.approx(12 * KNOT) and asked["v"][0] == pytest.approx(KNOT)
    assert "over ground, as the format file asks for" in " ".join(asked.source.notes)
    vtg = steady("GPVTG,60.0,T,,M,12.0,N,,K,A", 1)
    plain = read(HDT, RSA, vtg)
    assert not plain.has("u") and plain["SOG"][0] == pytest.approx(12 * KNOT)
    assert "State speed = 'ground' in [nmea] of a format file" in " ".join(plain.source.notes)
    asked = read(HDT, RSA, vtg, steady("VWVHW,,T,,M,10.0,N,,K", 1), text='speed = "ground"')
    assert asked["u"][0] == pytest.approx(12 * KNOT * np.cos(np.radians(30)))
    assert asked["v"][0] == pytest.approx(6 * KNOT)
    assert "u, v: of SOG, COG and psi, over ground, as the format file asks for" in " ".join(asked.source.notes)


@pytest.mark.parametrize("heading", ["HEHDT,30.0,T", "HCHDM,30.0,M"])
def test_u_over_ground_that_nothing_gives_is_not_u_through_the_water(read, heading):
    sources = [steady("VWVHW,,T,,M,10.0,N,,K", 1)]
    if "HDM" in heading:  # a course is true: it says nothing of the drift beside a magnetic heading
        sources = [steady("GPVTG,60.0,T,,M,12.0,N,,K,A", 1)]
    trial = read(steady(heading), RSA, *sources, text='speed = "ground"')
    assert not trial.has("u")
    assert any(n.startswith("WARNING: the format file asks for u over ground") for n in trial.source.notes)


def test_what_is_left_out(read):
    trial = read(HDT, RSA, steady("HEROT,0.0,A"), text='leave_out = ["r"]')
    assert not trial.has("r")


def test_rate_of_the_other_sign(read):
    trial = read(HDT, RSA, steady("HEROT,6.0,A"), text="[nmea.rate]\nsign = -1")
    assert np.degrees(trial["r"][0]) == pytest.approx(-0.1)


def test_each_signal_keeps_its_own_clock(log, stamped):
    """Rows are the stamps of all signals; nothing is made up between them."""
    path = log(stamped(HDT, RSA, steady("HEROT,6.0,A", 1)))
    trial = read_trial(path, format="nmea")
    t = trial["t"]
    for name, rate in (("psi", 5), ("delta", 2), ("r", 1)):
        np.testing.assert_allclose(t[np.isfinite(trial[name])], np.arange(20 * rate + 1) / rate, atol=1e-3)
    assert len(trial) == 121 and trial.sampling == pytest.approx(
        0.2
    )  # of five and two a second, one stamp in five is common
    assert any(
        n.startswith("Each signal keeps its own clock: a row is a stamp of any of them") for n in trial.source.notes
    )
    assert not any("gap" in n for n in trial.source.notes)


def test_stamps_close_to_each_other_are_one_row(log, stamped):
    text = stamped(HDT, stamp=lambda t: f"2026-05-04T09:00:{t:06.3f}Z ", seconds=20)
    close = stamped(
        steady("HEROT,6.0,A"), stamp=lambda t: f"2026-05-04T09:00:{t + 0.003:06.3f}Z ", seconds=20, comment=""
    )
    apart = stamped(
        steady("IIRSA,5.0,A,,V"), stamp=lambda t: f"2026-05-04T09:00:{t + 0.01:06.3f}Z ", seconds=20, comment=""
    )
    lines = sorted((text + close + apart).splitlines()[1:])
    trial = read_trial(log("\n".join(lines) + "\n"), format="nmea")
    assert len(trial) == 202
    assert np.isfinite(trial["psi"][::2]).all() and np.isfinite(trial["r"][::2]).all()
    assert np.isfinite(trial["delta"][1::2]).all() and np.isnan(trial["delta"][::2]).all()


def test_one_clock_for_all_where_it_is_asked_for(read):
    trial = read(HDT, RSA, text='interval = "0.5 s"')
    assert trial.sampling == pytest.approx(0.5) and np.isfinite(trial["delta"]).all()
    assert trial.source.notes[0] == "NMEA 0183, resampled to 0.5 s by linear interpolation."


def test_nothing_is_interpolated_across_a_gap(read):
    heading = (lambda t: "HEHDT,30.0,T" if t <= 20 or t >= 26 else "GPXXX,1", 5)
    trial = read(heading, RSA, seconds=60, text='interval = "0.2 s"')
    t = trial["t"]
    assert not ((t > 20.001) & (t < 25.999)).any()
    notes = " ".join(trial.source.notes)
    assert "29 samples were left out because psi has gaps of more than 1 s" in notes
    assert "The clock has 1 gap, the longest from 20 to 26 s" in notes
    assert np.diff(read(heading, RSA, seconds=60, text='interval = "0.2 s"\ngap = "7 s"')["t"]).max() == pytest.approx(
        0.2
    )


def test_a_signal_that_is_mostly_missing_is_left_out(read):
    wind = (lambda t: "WIMWV,30.0,R,10.0,N,A" if t < 10 else "GPXXX,1", 1)
    trial = read(HDT, RSA, wind, seconds=60, text='interval = "0.2 s"')
    assert not trial.has("wind_speed_relative") and trial["t"][-1] == pytest.approx(60)
    assert any(
        n.startswith("WARNING: wind was left out: it is known for 15 % of the time only") for n in trial.source.notes
    )


def test_headings_are_unwrapped_before_they_are_interpolated(read):
    trial = read((lambda t: f"HEHDT,{(355 + 10 * t) % 360:.1f},T", 1), RSA, text='interval = "0.1 s"')
    np.testing.assert_allclose(np.degrees(trial["psi"]), 355 + 10 * trial["t"], atol=1e-6)


def test_the_antenna_goes_round_midship(read):
    """A ship that turns on the spot: midship stays where it is, though the antenna sails a circle."""
    rate = 2.0  # deg/s
    x_a, y_a = 30.0, -4.0
    lat0, lon0 = 63.45, 10.416666667
    n = 6378137 / np.sqrt(1 - 0.00669437999014 * np.sin(np.radians(lat0)) ** 2)
    m = n**3 * (1 - 0.00669437999014) / 6378137**2

    def antenna(t):
        a = np.radians(rate * t)
        return x_a * np.cos(a) - y_a * np.sin(a), x_a * np.sin(a) + y_a * np.cos(a)

    def gga(t):
        north, east = antenna(t)
        lat, lon = lat0 + np.degrees(north / m), lon0 + np.degrees(east / n / np.cos(np.radians(lat0)))
        return f"GPGGA,090000.00,63{60 * (lat - 63):09.6f},N,010{60 * (lon - 10):09.6f},E,4,9,1.0,5.0,M,40.0,M,,"

    def vtg(t):
        a, w = np.radians(rate * t), np.radians(rate)
        north, east = w * (-x_a * np.sin(a) - y_a * np.cos(a)), w * (x_a * np.cos(a) - y_a * np.sin(a))
        return f"GPVTG,{np.degrees(np.arctan2(east, north)) % 360:.3f},T,,M,{np.hypot(north, east) / KNOT:.4f},N,,K,A"

    sentences = (lambda t: f"HEHDT,{rate * t % 360:.3f},T", 5), RSA, (gga, 5), (vtg, 5), steady(f"HEROT,{60 * rate},A")
    trial = read(*sentences, text='[nmea.antenna]\nx = "30 m"\ny = "-4 m"')
    assert np.ptp(trial["x"]) < 0.01 and np.ptp(trial["y"]) < 0.01
    assert trial["SOG"].max() < 0.01
    without = read(*sentences[:-1], text='[nmea.antenna]\nx = "30 m"\ny = "-4 m"')  # the heading's slope instead of ROT
    assert without["SOG"].max() < 0.01
    assert np.ptp(read(*sentences)["x"]) > 4


def test_a_repeated_time_counts_once(log, stamped):
    text = stamped(HDT, RSA)
    lines = text.splitlines()
    lines.insert(10, next(line for line in reversed(lines[:10]) if "HEHDT" in line))
    trial = read_trial(log("\n".join(lines) + "\n"), format="nmea")
    assert "1 with a time that repeats were left out" in " ".join(trial.source.notes)


def test_windows(log, stamped, toml):
    path = log(stamped(HDT, RSA), "trial.nmea")
    trial = read_trial(f"{path}@5:10", format="nmea")
    assert trial.name == "trial@5:10" and trial["t"][0] == pytest.approx(5)
    named = toml("[windows]\nturn = [5, 10]\n[nmea]\n")
    assert len(read_trial(f"{path}@turn", format=named)) == len(trial)


def test_a_format_is_passed_on(log, stamped, toml):
    path = log(stamped(HDT, RSA))
    fmt = chosen_format(toml('ship = "zeefakkel"\n[nmea]\n'))
    assert read_trial(path, format=fmt).ship == "zeefakkel"
    raw, comments = read_nmea(path, chosen_format("NMEA"))
    assert comments == ("sea trial",) and raw.stated["psi"] == "deg"


def test_the_example_format_is_read():
    fmt = chosen_format(ROOT / "studies" / "formats" / "nmea-example.toml")
    assert fmt.rudder.stated and fmt.sources["psi"] == "HEHDT" and fmt.step == 0.2
