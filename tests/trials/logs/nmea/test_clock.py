"""When each line was written: stamps of every layout, UTC of the sentences, midnight, and clocks that jump."""

from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

from shipid.trials import errors as e
from shipid.trials.logs import reading
from shipid.trials.logs.nmea.errors import NoTimeError
from shipid.trials.logs.nmea.sentences.lines import stamp_reader

START = datetime(2026, 5, 4, 9, 0)


def dense(trial):
    """The trial at the stamps of its heading (of another column where it has none), the others interpolated."""
    lead = next(name for name in ("psi", *trial.table.columns[1:]) if trial.has(name))
    t, rows = trial["t"], np.isfinite(trial[lead])
    table = trial.table[rows].reset_index(drop=True)
    for name in table:
        there = np.isfinite(trial[name])
        table[name] = np.interp(t[rows], t[there], trial[name][there])
    return replace(trial, table=table)


def read_trial(path, format=None):
    return dense(reading.read_trial(path, format=format))


def at(seconds):
    return START + timedelta(seconds=seconds)


def tag(seconds):
    text = f"s:LOG1,c:{1777885200000 + round(seconds * 1000)}"  # 2026-05-04 09:00:00 UTC
    total = 0
    for character in text:
        total ^= ord(character)
    return f"\\{text}*{total:02X}\\"


@pytest.mark.parametrize(
    "stamp",
    [
        lambda s: f"{at(s):%Y-%m-%dT%H:%M:%S.%f}Z,",
        lambda s: f"{at(s):%Y-%m-%d %H:%M:%S.%f} ",
        lambda s: f"NAV {at(s):%Y/%m/%d %H:%M:%S.%f} SPD ",
        lambda s: f"[{at(s):%Y-%m-%dT%H:%M:%S.%f}+00:00] ",
        lambda s: f"{at(s + 7200):%Y-%m-%dT%H:%M:%S.%f}+02:00 ",
        lambda s: f"{1777885200 + s:.3f};",
        lambda s: f"{1777885200000 + round(s * 1000)} ",
        tag,
    ],
)
def test_dated_stamps(log, stamped, basic, stamp):
    trial = read_trial(log(stamped(*basic, stamp=stamp)), format="nmea")
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.06)
    assert trial["t"][0] == 0 and trial["t"][-1] == pytest.approx(20)
    assert "t = 0 is 2026-05-04 09:00:00.000." in trial.source.notes


def test_stamps_without_a_date_pass_midnight(log, stamped, basic):
    def stamp(s):
        return f"{at(s) + timedelta(hours=14, minutes=59, seconds=50):%H:%M:%S.%f} "

    path = log(stamped(*basic, stamp=stamp))
    trial = read_trial(path, format="nmea")
    assert trial["t"][-1] == pytest.approx(20)
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.06)
    assert "The clock passes midnight once." in trial.source.notes
    assert any("23:59:50.000 of a day that nothing names" in n for n in trial.source.notes)


def test_the_date_of_the_format_file(log, stamped, basic, toml):
    path = log(stamped(*basic, stamp=lambda s: f"{at(s):%H:%M:%S.%f} "))
    trial = read_trial(path, format=toml("[nmea]\ndate = 2024-02-29\n"))
    assert "t = 0 is 2024-02-29 09:00:00.000." in trial.source.notes


def test_a_layout_of_ones_own(log, stamped, basic, toml):
    path = log(stamped(*basic, stamp=lambda s: f"{at(s):%m/%d/%Y,%H:%M:%S.%f},"))
    trial = read_trial(path, format=toml('[nmea]\nstamp = "%m/%d/%Y,%H:%M:%S.%f"\n'))
    assert "t = 0 is 2026-05-04 09:00:00.000." in trial.source.notes
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.06)


@pytest.mark.parametrize(("layout", "scale"), [("seconds", 1), ("milliseconds", 1000)])
def test_counted_stamps(log, stamped, basic, toml, layout, scale):
    path = log(stamped(*basic, stamp=lambda s: f"{round((s + 3) * 1000) * scale / 1000:.10g} "))
    trial = read_trial(path, format=toml(f'[nmea]\nstamp = "{layout}"\n'))
    assert trial["t"][-1] == pytest.approx(20)
    assert "t = 0 is 3.000 s of the logger's clock." in trial.source.notes


def test_whole_seconds_are_spread(log, stamped, basic):
    trial = read_trial(log(stamped(*basic, stamp=lambda s: f"{at(s):%H:%M:%S} ")), format="nmea")
    assert any("whole seconds" in n for n in trial.source.notes)
    # Right to half a second, at half a degree a second, and printed to 0.1 deg.
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.31)
    assert trial.sampling < 0.25


def test_two_devices_that_speak_once_a_second_are_taken_together(log, stamped):
    """Nothing tells how far apart they speak in a second: heading and rudder are not shifted against each other."""
    turning = (lambda t: f"IIRSA,{t:.1f},A,,V", 1)
    text = stamped((lambda t: f"HEHDT,{30 + t:.1f},T", 1), turning, stamp=lambda s: f"{at(s):%H:%M:%S} ")
    trial = reading.read_trial(log(text), format="nmea")
    assert any("right to about a second; sentences of one second are taken together" in n for n in trial.source.notes)
    np.testing.assert_allclose(trial["t"], np.arange(21))
    np.testing.assert_allclose(np.degrees(trial["delta"]), np.degrees(trial["psi"]) - 30, atol=1e-6)


def test_beside_a_device_of_ten_sentences_a_second_the_order_of_lines_tells_the_time(log, stamped):
    text = stamped(
        (lambda t: f"HEHDT,{30 + t:.1f},T", 10),
        (lambda t: f"IIRSA,{t - 0.25:.1f},A,,V", 1),
        stamp=lambda s: f"{at(s):%H:%M:%S} ",
        seconds=20,
    )
    lines = text.splitlines()
    for k in [k for k, line in enumerate(lines) if "RSA" in line][::-1]:  # four headings later: 0.35 s
        lines[k : k + 5] = [*lines[k + 1 : k + 5], lines[k]]
    trial = reading.read_trial(log("\n".join(lines) + "\n"), format="nmea")
    there = np.isfinite(trial["delta"])
    assert np.median(trial["t"][there] % 1) == pytest.approx(0.35, abs=0.11)


def test_without_stamps_devices_are_not_shifted_against_each_other(log, stamped):
    text = stamped(
        (lambda t: f"HEHDT,{30 + t:.1f},T", 1), (lambda t: f"IIRSA,{t:.1f},A,,V", 1), ("GPZDA,090000.00,04,05,2026,00,00", 1),
        stamp=lambda _: "",
    )  # fmt: skip
    trial = reading.read_trial(log(text), format="nmea")
    there = np.isfinite(trial["delta"]) & np.isfinite(trial["psi"])
    assert there.sum() >= 19
    np.testing.assert_allclose(np.degrees(trial["delta"])[there], np.degrees(trial["psi"])[there] - 30, atol=1e-6)


def test_one_sentence_a_second_is_not_spread(log, stamped):
    alternate = (lambda t: "HEHDT,30.0,T" if t % 2 else "IIRSA,5.0,A,,V", 1)
    text = stamped(alternate, seconds=60, stamp=lambda s: f"{at(s):%H:%M:%S} ")
    trial = read_trial(log(text), format="nmea")
    assert not any("spread" in n for n in trial.source.notes)


def test_whole_seconds_are_not_spread_over_a_gap(log, stamped, basic):
    text = stamped(*basic, stamp=lambda s: f"{at(s if s < 10 else s + 300):%H:%M:%S} ")
    trial = read_trial(log(text), format="nmea")
    t = trial["t"]
    assert t[t < 200].max() < 11.5 and np.diff(t).max() > 290
    assert any("has 1 gap," in n for n in trial.source.notes)


def zda(t):
    return f"GPZDA,{at(t):%H%M%S.%f},04,05,2026,00,00"


def test_utc_of_the_sentences(log, stamped, basic):
    trial = read_trial(log(stamped((zda, 1), *basic, stamp=lambda s: "")), format="nmea")
    # Lines between two of UTC share the second evenly: right to half of it at worst.
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.3)
    assert any("UTC of GPZDA" in n for n in trial.source.notes)
    assert "t = 0 is 2026-05-04 09:00:00.000." in trial.source.notes


@pytest.mark.parametrize("day", ["00", "99", "9" * 30])
def test_a_day_that_no_month_has_is_no_date(log, stamped, basic, day):
    def dated(t):
        return f"GPZDA,{at(t):%H%M%S.%f},{day},05,2026,00,00"

    trial = read_trial(log(stamped((dated, 1), *basic, stamp=lambda s: "")), format="nmea")
    assert any("UTC of GPZDA" in n for n in trial.source.notes)
    assert not any("2026" in n for n in trial.source.notes)


@pytest.mark.parametrize("dated", [True, False])
def test_utc_passes_midnight(log, stamped, basic, dated):
    def fix(t):
        moment = at(t) + timedelta(hours=14, minutes=59, seconds=50)
        if dated:
            return f"GPRMC,{moment:%H%M%S}.00,A,6327.00000,N,01025.00000,E,9.0,45.0,{moment:%d%m%y},,,A"
        return f"GPGGA,{moment:%H%M%S}.00,6327.00000,N,01025.00000,E,1,9,1.0,5.0,M,40.0,M,,"

    trial = read_trial(log(stamped((fix, 1), *basic, stamp=lambda s: "")), format="nmea")
    assert 19 <= trial["t"][-1] <= 20  # nothing is known after the last UTC
    assert "The clock passes midnight once." in trial.source.notes
    assert any(n.startswith("t = 0 is 2026-05-04 23:59:50") for n in trial.source.notes) is dated


def test_every_midnight_is_counted(log, stamped):
    """A sample every 20 minutes from nine o'clock on: 72 hours pass three midnights."""
    each = ("HEHDT,30.0,T", 1 / 1200), ("IIRSA,5.0,A,,V", 1 / 1200)
    text = stamped(*each, seconds=72 * 3600, stamp=lambda s: f"{at(s):%H:%M:%S.%f} ")
    trial = read_trial(log(text), format="nmea")
    assert trial["t"][-1] == pytest.approx(72 * 3600)
    assert "The clock passes midnight 3 times." in trial.source.notes
    two = read_trial(log(stamped(*each, seconds=48 * 3600, stamp=lambda s: f"{at(s):%H:%M:%S.%f} ")), format="nmea")
    assert "The clock passes midnight 2 times." in two.source.notes


def test_gga_takes_the_date_of_zda(log, stamped, basic):
    def fix(t):
        return f"GPGGA,{at(t):%H%M%S}.00,6327.00000,N,01025.00000,E,1,9,1.0,5.0,M,40.0,M,,"

    trial = read_trial(log(stamped((fix, 1), (zda, 0.2), *basic, stamp=lambda s: "")), format="nmea")
    assert "The date is that of GPZDA." in trial.source.notes
    assert "t = 0 is 2026-05-04 09:00:00.000." in trial.source.notes


def test_stamps_that_are_not_wanted(log, stamped, basic, toml):
    path = log(stamped((zda, 1), *basic, stamp=lambda s: f"{1777885200 + 1000 * s:.3f} "))
    trial = read_trial(path, format=toml('[nmea]\nstamp = "none"\n'))
    assert trial["t"][-1] == pytest.approx(20, abs=0.5)


def test_no_utc_for_a_minute(log, stamped, basic):
    text = stamped((lambda t: zda(t) if t < 20 or t > 80 else "GPXXX,1", 1), *basic, seconds=100, stamp=lambda s: "")
    trial = read_trial(log(text), format="nmea")
    assert np.diff(trial["t"]).max() > 55
    assert any("no time is known" in n for n in trial.source.notes)


def test_a_clock_that_jumps_back_is_named(log, stamped, basic):
    text = stamped(*basic, stamp=lambda s: f"{at(s if s < 10 else s - 4):%Y-%m-%dT%H:%M:%S.%f} ")
    with pytest.raises(e.ClockError, match=r"line 72: the clock jumps back by 3\.8 s against line 71"):
        read_trial(log(text), format="nmea")


def test_utc_that_jumps_back_is_named(log, stamped, basic):
    text = stamped((lambda t: zda(t if t < 10 else t - 5), 1), *basic, stamp=lambda s: "")
    with pytest.raises(e.ClockError, match=r"line 82: the clock jumps back by 4 s .*UTC of GPZDA"):
        read_trial(log(text), format="nmea")


def test_utc_that_jumps_back_by_less_than_a_second_is_named(log, stamped, basic):
    """By 0.5 s, after 0.2 s between two of them."""
    text = stamped((lambda t: zda(t if t < 10 else t - 0.5), 5), *basic, stamp=lambda s: "")
    with pytest.raises(e.ClockError, match=r"the clock jumps back by 0\.3 s .*UTC of GPZDA"):
        read_trial(log(text), format="nmea")


def test_one_source_that_runs_back_a_little_is_named(log, stamped, basic):
    text = stamped(*basic).replace("09:00:08.000Z $HEHDT", "09:00:07.700Z $HEHDT")
    with pytest.raises(e.ClockError, match="stamps of HEHDT"):
        read_trial(log(text), format="nmea")


def test_sources_that_overtake_each_other_are_sorted(log, stamped, basic):
    text = stamped(*basic).replace("09:00:08.000Z $IIRSA", "09:00:07.950Z $IIRSA")
    trial = read_trial(log(text), format="nmea")
    assert any("another order" in n for n in trial.source.notes)


def test_sentences_without_a_stamp_have_the_one_before(log, stamped, basic):
    lines = stamped(*basic).splitlines()
    lines[20] = lines[20].split(" ", 1)[1]
    trial = read_trial(log("\n".join(lines) + "\n"), format="nmea")
    assert "1 sentence without a stamp has that of the line before." in trial.source.notes


def test_no_time_at_all(log, stamped, basic):
    with pytest.raises(NoTimeError, match=r"ZDA, RMC, GGA or GLL.*HEHDT \(101\)"):
        read_trial(log(stamped(*basic, stamp=lambda s: "")), format="nmea")


@pytest.mark.parametrize(
    ("front", "layout"),
    [
        ("2026-02-30T10:00:00 ", "iso"),
        ("25:00:00 ", "hh:mm:ss"),
        ("x ", "seconds"),
        ("99/99/2026 10:00 ", "%d/%m/%Y %H:%M"),
    ],
)
def test_what_is_no_stamp(front, layout):
    assert stamp_reader(layout)(front) is None


@pytest.mark.parametrize("wrong", ["09:00:03.000", "09:00:19.000", "23:00:08.000", "01:00:08.000"])
@pytest.mark.parametrize("dated", [True, False])
def test_a_stamp_that_was_garbled_is_not_used(log, stamped, basic, wrong, dated):
    """The checksum of a sentence does not cover what the logger wrote before it."""
    text = stamped(*basic, stamp=lambda s: f"{at(s):{'%Y-%m-%dT' if dated else ''}%H:%M:%S.%f}"[:-3] + " ")
    lines = text.splitlines()
    k = next(k for k, line in enumerate(lines) if "09:00:08.000 $IIRSA" in line)
    lines[k] = lines[k].replace("09:00:08.000", wrong)
    trial = read_trial(log("\n".join(lines) + "\n"), format="nmea")
    note = f"1 stamp lies before or behind both of the neighbours and was not used, the first in line {k + 1}."
    assert note in trial.source.notes
    assert trial["t"][-1] == pytest.approx(20) and not any("midnight" in n for n in trial.source.notes)
