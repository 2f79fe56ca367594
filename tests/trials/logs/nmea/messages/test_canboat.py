"""NMEA 2000 logs in canboat's form: sources and instances, frames that are put together, and lines that are no messages."""

import struct
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.nmea import errors as n
from shipid.trials.logs.reading import read_trial

START = datetime(2026, 5, 4, 9, 0)
DATA = Path(__file__).resolve().parents[6] / "shared" / "data" / "canboat-furuno"


def message(t, pgn, source, data, layout="%Y-%m-%dT%H:%M:%S.%f", end="Z"):
    stamp = (START + timedelta(seconds=t)).strftime(layout)[:-3] + end
    return f"{stamp},3,{pgn},{source},255,{len(data)},{','.join(f'{b:02x}' for b in data)}"


def rate(t, value, source=27):
    return message(t, 127251, source, struct.pack("<BiBH", 0, round(np.radians(value) / 3.125e-8), 0xFF, 0xFFFF))


def heading(t, value, source=7):
    return message(
        t, 127250, source, struct.pack("<BHhhB", 0, round(np.radians(value % 360) * 1e4), 0x7FFF, 0x7FFF, 0xFC)
    )


def rudder(t, position, order=None, instance=0, source=9):
    order = 0x7FFF if order is None else round(np.radians(order) * 1e4)
    return message(
        t, 127245, source, struct.pack("<BBhhH", instance, 0xF8, order, round(np.radians(position) * 1e4), 0xFFFF)
    )


def turning(seconds=30, rate_hz=10):
    """A ship that turns at 1 deg/s through north, its rudder and the order."""
    lines = []
    for k in range(seconds * rate_hz):
        t = k / rate_hz
        lines += [heading(t, 350 + t), rate(t + 0.02, 1.0), rudder(t + 0.04, 5 + 0.1 * t, 10)]
    return lines


def joined(lines):
    return "# format=FAST\n" + "\n".join(lines) + "\n"


def test_a_log_is_recognised_and_read(log, dense):
    whole = read_trial(log(joined(turning()), "log.raw"))
    assert len(whole) == 900 and np.isfinite(whole["psi"]).sum() == 300
    trial = dense(whole)
    assert set(trial.table.columns) == {"t", "psi", "r", "delta", "delta_order"}
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + trial["t"], atol=0.01)
    np.testing.assert_allclose(np.degrees(trial["r"]), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.degrees(trial["delta"]), 5 + 0.1 * (trial["t"] - 0.04), atol=0.01)
    np.testing.assert_allclose(np.degrees(trial["delta_order"]), 10, atol=0.01)
    notes = trial.source.notes
    assert "NMEA 2000." in notes and "t = 0 is 2026-05-04 09:00:00.000." in notes
    assert any(note.startswith("psi: PGN 127250 of source 7, 300 values, 10 a second") for note in notes)
    assert trial.source.comment == "format=FAST" and trial.source.format == "nmea"


def test_sources_are_streams_of_their_own(log, toml, dense):
    lines = turning() + [rate(0.05 + k / 5, 3.0, source=52) for k in range(150)]
    lines.sort()
    path = log(joined(lines))
    trial = dense(read_trial(path))
    np.testing.assert_allclose(np.degrees(trial["r"]), 1.0, atol=1e-5)
    assert any("r: PGN 127251 of source 27" in note and "127251#52" in note for note in trial.source.notes)
    other = dense(read_trial(path, format=toml('[nmea.sources]\nr = "127251#52"\n')))
    np.testing.assert_allclose(np.degrees(other["r"]), 3.0, atol=1e-5)
    with pytest.raises(n.NoSuchSourceError, match="no sentence 127251#5,"):
        read_trial(path, format=toml('[nmea.sources]\nr = "127251#5"\n'))


def test_a_second_rudder_is_an_instance(log, toml):
    lines = [line for k in range(40) for line in (rudder(k, 5), rudder(k, -7, instance=1))]
    path = log(joined(lines))
    assert np.degrees(read_trial(path)["delta"][0]) == pytest.approx(5, abs=0.01)
    other = read_trial(path, format=toml('[nmea.sources]\ndelta = "127245#9.1"\n'))
    assert np.degrees(other["delta"][0]) == pytest.approx(-7, abs=0.01)


def fix(k):
    return struct.pack("<BHIqqqBB", 1, 20577, 10000 * k, 34 * 10**16 + k * 10**11, 10**18, 0, 0x11, 0xFC)


def frames(data, sequence):
    data = bytes([len(data)]) + data
    pieces = [data[k : k + 7] for k in range(0, len(data), 7)]
    return [bytes([sequence << 5 | k]) + piece.ljust(7, b"\xff") for k, piece in enumerate(pieces)]


def test_frames_are_put_together(log):
    whole = read_trial(log(joined([message(k, 129029, 3, fix(k)) for k in range(30)]), "fast.raw"))
    lines = [message(k, 129029, 3, frame) for k in range(30) for frame in frames(fix(k), k % 8)]
    plain = read_trial(log(joined(lines), "plain.raw"))
    assert len(whole) == 30 and np.ptp(whole["x"]) == pytest.approx(29 * 1e-5 * 110922, rel=1e-3)
    np.testing.assert_array_equal(plain["x"], whole["x"])


def test_a_lost_frame_costs_its_message_only(log):
    lines = [message(k, 129029, 3, frame) for k in range(30) for frame in frames(fix(k), k % 8)]
    size = len(frames(fix(0), 0))
    del lines[10 * size + 2], lines[20 * size]
    trial = read_trial(log(joined(lines)))
    assert any("PGN 129029 of source 3, 28 values" in note for note in trial.source.notes)


def test_not_available_is_missing(log):
    lines = turning()
    lines += [message(t + 0.05, 128259, 35, b"\xff" * 8) for t in range(30)]
    trial = read_trial(log(joined(sorted(lines))))
    assert not trial.has("u")


def test_what_is_no_message_is_counted(log):
    lines = turning()
    lines[7] = lines[7][:-2]  # its last byte is cut
    short = rate(0.0, 1.0).split(",")
    lines[10] = ",".join([*short[:5], "4", *short[6:10]])  # half a message: ones in a signed field would be a number
    lines[20] = "garbage \x00\x01"
    lines[21] = lines[21].replace("2026-05-04", "2026-05-94")
    lines[30:30] = [message(1.0, 130842, 52, b"\x00" * 29)] * 4
    trial = read_trial(log(joined(lines)))
    assert "4 lines were left out as broken (not a whole message): 9, 12, 22, 23." in trial.source.notes
    assert "Sentences that are not read: PGN 130842 (4)." in trial.source.notes


@pytest.mark.parametrize(("layout", "end"), [("%Y-%m-%d-%H:%M:%S.%f", ""), ("%Y-%m-%d %H:%M:%S.%f", "")])
def test_stamps_of_older_forms(log, layout, end):
    data = struct.pack("<BiBH", 0, 10**6, 0xFF, 0xFFFF)
    trial = read_trial(log(joined([message(k / 10, 127251, 3, data, layout, end) for k in range(50)])))
    assert trial["t"][-1] == pytest.approx(4.9)
    assert "t = 0 is 2026-05-04 09:00:00.000." in trial.source.notes


def test_mostly_broken_and_empty(log):
    lines = turning()
    with pytest.raises(n.BrokenLogError, match="lines are broken, the first in lines 902, 903, 904"):
        read_trial(log(joined([*lines, *["2026"] * 1000])), format="nmea")
    with pytest.raises(n.NoSignalError, match=r"Seen were PGN 130842 \(9\)"):
        read_trial(log(joined([message(k, 130842, 52, b"\x00" * 29) for k in range(9)])))
    with pytest.raises(e.ClockError, match="the clock jumps back"):
        read_trial(log(joined([rate(k if k < 20 else k - 5, 1.0) for k in range(40)])))


@pytest.mark.parametrize("name", ["furuno-130842-wide-turn", "furuno-130842-figure8-fast"])
def test_the_recordings_of_a_pleasure_craft(name, toml):
    path = DATA / f"{name}.raw"
    if not path.exists():
        pytest.skip("the recordings are not on this machine")
    trial = read_trial(path)
    notes = " ".join(trial.source.notes)
    assert "r: PGN 127251 of source 27" in notes and "20 a second" in notes and "127251#52" in notes
    assert trial.has("x", "y", "r", "u", "SOG", "COG", "phi") and not trial.has("psi") and not trial.has("delta")
    low = 1 - np.nanmedian(trial["u"]) / np.nanmedian(trial["SOG"])
    assert 0.1 < low < 0.35  # the log is low
    damped = read_trial(path, format=toml('[nmea.sources]\nr = "127251#52"\n'))
    assert "PGN 127251 of source 52" in " ".join(damped.source.notes)
