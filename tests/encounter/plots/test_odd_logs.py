"""Logs as they come: two ships with one number, positions of another coast, ranges in two units, own ship's path with holes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.plots import Sensor, make_plots
from shipid.encounter.plots.read_plots import read_detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.track import track
from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.nmea.sentences.lines import checksum

T = np.arange(0, 120, 3.0)
NORTH, EAST = 1000 - 4 * T, 500 + 3 * T
RANGE, BEARING = np.hypot(NORTH, EAST), np.rad2deg(np.arctan2(EAST, NORTH))


def table(path: Path, head: str, *columns: np.ndarray) -> Path:
    path.write_text("\n".join([head, *(",".join(f"{v:.9g}" for v in row) for row in zip(*columns))]) + "\n")
    return path


def plots(path: Path, range_: np.ndarray = RANGE) -> Path:
    return table(
        path, "t [s],range [m],bearing [deg]", np.resize(T, range_.size), range_, np.resize(BEARING, range_.size)
    )


def kinds(found) -> dict[str, str]:
    return {n.kind: n for n in found.plots.notes if hasattr(n, "kind")}


def ais(path: Path, *ships) -> Path:
    """Ships report themselves every 3 s: each a function of the time and the number of the scan to latitude, longitude, MMSI."""
    from pyais.encode import encode_dict

    lines = []
    for k, t in enumerate(T):
        for ship in ships:
            lat, lon, mmsi = ship(t, k)
            message = {"type": 1, "mmsi": mmsi, "lat": lat, "lon": lon}
            stamp = f"2026-01-01T10:{int(t) // 60:02d}:{int(t) % 60:02d}.000Z "
            lines.append(stamp + encode_dict(message, talker_id="AI", sentence_type="VDM")[0])
    path.write_text("\n".join(lines))
    return path


def first(t, k):
    return 52 + 6 * t / 111_270, 4.0, 244000001


def second(t, k):
    return 52.03 - 5 * t / 111_270, 4.03, 244000001


def test_two_ships_with_one_number_are_two_tracks(tmp_path):
    found = read_detections(ais(tmp_path / "log.ais", first, second))
    assert len(track(found).tracks) == 2
    assert "244000001 (79 times)" in kinds(found)["ais-jumps"]


def test_what_one_ship_says_twice_counts_once(tmp_path):
    log = ais(tmp_path / "log.ais", first)
    log.write_text("\n".join(line for line in log.read_text().splitlines() for _ in range(2)))
    found = read_detections(log)
    assert len(found.plots) == T.size and "ais-jumps" not in kinds(found)


def test_exchanged_positions_are_left_out(tmp_path):
    found = read_detections(
        ais(tmp_path / "log.ais", first, lambda t, k: (4.0, 52.0, 2) if k % 4 == 0 else (52, 4.02, 2))
    )
    assert "10 positions more than 1000 km from most others left out: latitude and" in kinds(found)["positions-far"]
    assert np.abs(np.concatenate([s.z for s in found.plots])).max() < 1e4
    # As many here as there: nothing says which are wrong.
    found = read_detections(ais(tmp_path / "log.ais", first, lambda t, k: (4.0, 52.0, 2)))
    assert len(found.plots) == 2 * T.size and "ships of a whole ocean" in kinds(found)["positions-far"]


def test_ranges_in_two_units_are_told(tmp_path):
    assert "range-unit" not in kinds(read_detections(plots(tmp_path / "log.csv")))
    mixed = np.where(T < 60, RANGE, RANGE / 1852)
    assert (
        "may mix metres and kilometres or nautical miles"
        in kinds(read_detections(plots(tmp_path / "log.csv", mixed)))["range-unit"]
    )
    miles = plots(tmp_path / "log.csv", 3 * RANGE / 1852)
    assert "may hold nautical miles or kilometres" in kinds(read_detections(miles))["range-unit"]
    # A pier beside the ship, and a target far away.
    pier = np.concatenate([RANGE, 25 + 0.1 * RANGE / RANGE.max()])
    assert "range-unit" not in kinds(read_detections(plots(tmp_path / "log.csv", pier)))


def test_own_ships_path_with_a_hole_or_a_jump_is_told(tmp_path):
    t = np.arange(0, 120, 1.0)
    log = plots(tmp_path / "log.csv")
    hole = (t < 30) | (t > 90)
    own = table(tmp_path / "own.csv", "t [s],x [m],y [m]", t[hole], 5 * t[hole], 0 * t[hole])
    assert (
        "no positions from 29 to 91 s" in (said := kinds(read_detections(log, own=own))["own-ship-gap"])
        and said.serious
    )
    table(own, "t [s],x [m],y [m]", t, 5 * t + 3000 * (t == 50), 0 * t)
    assert "jumps 2 times, by 3005 m at 50 s" in kinds(read_detections(log, own=own))["own-ship-jumps"]
    table(own, "t [s],x [m],y [m]", t, 5 * t, 0 * t)
    assert not kinds(read_detections(log, own=own))


def test_own_ship_is_carried_on_a_little_and_no_farther():
    path = ShipPath("own ship", np.arange(30.0), 6 * np.arange(30.0), 0 * np.arange(30.0))
    assert path.at(np.array([-2.0, 32.0, 99.0]))[:, 0] == pytest.approx([-12, 192, 204])


def sentence(text: str) -> str:
    return f"${text}*{checksum(text)}"


def radar(path: Path, fixed) -> Path:
    lines = []
    for k, t in enumerate(T):
        clock = f"10{int(t) // 60:02d}{int(t) % 60:02d}.00"
        if fixed(k):
            lines.append(sentence(f"GPGLL,52{60 * 5 * t / 111_270:07.4f},N,00400.0,E,{clock},A"))
        lines.append(sentence(f"RATTM,01,{RANGE[k] / 1852:.5f},{BEARING[k]:.3f},T,,,T,,,N,,T,,{clock},A"))
    path.write_text("\n".join(lines))
    return path


def test_fixes_of_own_ship_that_stop_or_fail_for_a_while(tmp_path):
    found = read_detections(radar(tmp_path / "log.nmea", lambda k: k < 25))
    assert found.own is not None and found.own.t[-1] == 72 and len(found.plots) == 26
    assert "runs from 0 to 72 s" in kinds(found)["plots-without-own-ship"]
    found = read_detections(radar(tmp_path / "log.nmea", lambda k: not 10 < k < 30))
    assert kinds(found).keys() == {"own-ship-gap"} and len(found.plots) == T.size
    # Too few to count from: the plots are relative to her.
    found = read_detections(radar(tmp_path / "log.nmea", lambda k: k < 2))
    assert found.relative and "not used" in kinds(found)["own-ship-unknown"] and len(found.plots) == T.size


def test_the_truth_of_another_clock_or_of_ships_without_names(tmp_path):
    log = table(tmp_path / "log.csv", "t [s],x [m],y [m]", T, NORTH, EAST)
    truth = table(tmp_path / "truth.csv", "t [s],x [m],y [m]", T + 36000, NORTH, EAST)
    with pytest.raises(
        EncounterRequestError, match="run from 36000 to 36117 s after the first plot, and no plot lies in them"
    ):
        read_detections(log, truth=truth)
    # A minute apart: each position is where another one was.
    table(truth, "t [s],x [m],y [m]", T + 60, NORTH, EAST)
    said = {w.kind: w for w in track(read_detections(log, truth=truth)).warnings}
    assert said["truth-apart"].serious and "another clock" in said["truth-apart"]
    both = np.tile(T, 2), np.concatenate([NORTH, NORTH + 900]), np.tile(EAST, 2)
    table(truth, "t [s],x [m],y [m]", *both)
    with pytest.raises(EncounterRequestError, match="those of several ships: 40 lie more than 100 m"):
        read_detections(log, truth=truth)
    with pytest.raises(EncounterRequestError, match="those of several ships"):
        read_detections(log, own=truth)
    table(truth, "t [s],x [m],y [m],vessel", *both, np.repeat([1, 2], T.size))
    assert len(read_detections(log, truth=truth).truth) == 2
    assert math.isclose(read_detections(log, truth=truth).truth[1].x[0], 1900)


def targets(path: Path, *sentences) -> Path:
    """A log of sentences every 3 s: each a function of the time to what stands between ``$`` and ``*``."""
    stamp = "2026-01-01T10:{:02d}:{:02d}.000Z "
    path.write_text(
        "\n".join(
            stamp.format(int(t) // 60, int(t) % 60) + sentence(text) for t in T for s in sentences if (text := s(t))
        )
        + "\n"
    )
    return path


def target(t: float, status: str = "T", of: str = "T", turn: float = 0.0) -> str:
    k = int(np.searchsorted(T, t))
    return f"RATTM,01,{RANGE[k] / 1852:.4f},{(BEARING[k] - turn) % 360:.2f},{of},,,T,,,N,,{status},,,A"


def test_a_target_that_the_radar_has_lost_is_not_held(tmp_path):
    found = read_detections(targets(tmp_path / "a.nmea", lambda t: target(t, "T" if t < 60 else "L")))
    assert len(found.plots) == 20 and found.plots.span[1] == T[-1]
    result = track(found)
    assert [one.status for one in result.tracks] == ["ended"] or [one.status for one in result.tracks] == ["lost"]
    assert any("20 targets lost by the radar" in str(n) for n in found.plots.notes)
    # Where another target is seen, it is not missed at the time of the lost one.
    other = targets(
        tmp_path / "b.nmea",
        lambda t: target(t, "T" if t < 60 else "L"),
        lambda t: "RATTM,02,1.000,300.0,T,,,T,,,N,,T,,,A",
    )
    assert all(len(scan.z) for scan in read_detections(other).plots)


def test_own_ship_on_the_date_line(tmp_path):
    def fix(t: float) -> str:
        if t % 2:
            return ""
        east = 179.9995 + 1e-5 * t
        side, lon = ("E", east) if east < 180 else ("W", 360 - east)
        return f"GPGGA,,1000.0000,S,{int(lon):03d}{60 * (lon % 1):07.4f},{side},1,08,1.0,0.0,M,0.0,M,,"

    # A plot between two fixes, on both sides of the line, lies beside her.
    found = read_detections(targets(tmp_path / "a.nmea", fix, lambda t: target(t)))
    assert "own-ship-jumps" not in kinds(found) and found.own is not None
    away = [math.dist(scan.z[0], scan.own) for scan in found.plots]
    assert np.allclose(away, RANGE, atol=2.0)
    assert max(np.hypot(scan.own[0], scan.own[1]) for scan in found.plots) < 200


def test_ais_on_the_date_line_does_not_jump(tmp_path):
    pytest.importorskip("pyais")
    at = lambda t, k: (52 + 6 * t / 111_270, (179.999 + 2e-5 * t + 180) % 360 - 180, 244000001)  # noqa: E731
    assert "ais-jumps" not in kinds(read_detections(ais(tmp_path / "a.nmea", at)))


def test_bearings_from_the_bow_by_a_magnetic_compass(tmp_path):
    compass = lambda t: "HCHDG,35.0,2.0,E,3.0,E"  # noqa: E731
    found = read_detections(targets(tmp_path / "a.nmea", compass, lambda t: target(t, of="R", turn=40.0)))
    place = np.array([scan.z[0] for scan in found.plots])
    assert np.allclose(place, np.stack([NORTH, EAST], axis=1), atol=2.0)
    magnetic = targets(tmp_path / "b.nmea", lambda t: "HCHDM,35.0,M", lambda t: target(t, of="R"))
    with pytest.raises(EmptyFileError, match="40 targets with a bearing from the bow and no true heading before it"):
        read_detections(magnetic)


def test_bearings_that_stand_for_none(tmp_path):
    bearing = BEARING.copy()
    bearing[10:15] = 511.0
    found = read_detections(table(tmp_path / "a.csv", "t [s],range [m],bearing [deg]", T, RANGE, bearing))
    assert len(found.plots) == 35 and "511 deg or more" in kinds(found)["bearings-impossible"]
    onward = table(tmp_path / "b.csv", "t [s],range [m],bearing [deg]", T, RANGE, 350 + 3.0 * np.arange(40))
    assert len(read_detections(onward).plots) == 40
    none = targets(tmp_path / "c.nmea", lambda t: target(t) if t % 9 else "RATTM,01,99.99,999.9,T,,,T,,,N,,T,,,A")
    assert len(read_detections(none).plots) == 26


def test_two_clocks_that_do_not_overlap(tmp_path):
    late = T + np.where(np.arange(40) % 2, 3600.0, 0.0)
    found = read_detections(table(tmp_path / "a.csv", "t [s],range [m],bearing [deg]", late, RANGE, BEARING))
    notice = kinds(found)["two-clocks"]
    assert notice.serious and "go back 19 times" in notice
    halves = np.concatenate([T[:20], T[20:] + 3600.0])
    assert "two-clocks" not in kinds(
        read_detections(table(tmp_path / "b.csv", "t [s],range [m],bearing [deg]", halves, RANGE, BEARING))
    )


def test_lines_that_are_no_sentences_are_counted(tmp_path):
    log = targets(tmp_path / "a.nmea", lambda t: target(t))
    log.write_text(log.read_text().replace(",N,,T", ",N,Möwe,T"), encoding="utf-8")
    with pytest.raises(EmptyFileError, match="40 lines that are no whole sentences"):
        read_detections(log)


def test_plots_of_no_sensor_and_a_scan_without_a_time():
    found = make_plots(np.arange(3.0), 100 + np.arange(3.0), np.zeros(3), sensor=np.array([0, 1, 7]))
    assert len(found) == 1 and any("2 plots of a sensor that is not described" in n for n in found.notes)
    with pytest.raises(EncounterRequestError, match="its scan a time above zero"):
        Sensor(period=float("nan"))
