"""Plots out of every kind of log: the same target in a table, in JSON, in MATLAB, in TTM and in AIS."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError, TargetError
from shipid.encounter.plots.plot_format import read_plot_format
from shipid.encounter.plots.read_plots import read_detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.track import track
from shipid.foundation.errors import MissingExtraError, MissingFileError
from shipid.trials.errors import (
    DamagedFileError,
    EmptyFileError,
    ForeignFileError,
    FormatFileError,
    NonFiniteError,
    NoUnitError,
    UnknownColumnError,
)
from shipid.trials.logs.nmea.sentences.lines import checksum

T = np.arange(0, 120, 3.0)
NORTH, EAST = 1000 - 4 * T, 500 + 3 * T


def table(path: Path, head: str, *columns: np.ndarray) -> Path:
    rows = [",".join(f"{v:.9g}" for v in row) for row in zip(*columns)]
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def is_the_target(found, tolerance: float = 1.0) -> None:
    (one,) = track(found).tracks
    k = -1
    assert one.x[k, :2] == pytest.approx([NORTH[k], EAST[k]], abs=tolerance)
    assert one.x[k, 2:] == pytest.approx([-4.0, 3.0], abs=0.5)


def test_positions(tmp_path):
    found = read_detections(table(tmp_path / "p.csv", "t [s],x [m],y [m]", T, NORTH, EAST))
    is_the_target(found)
    assert found.own is None and not found.relative


def test_ranges_and_bearings_from_own_ship(tmp_path):
    range_, bearing = np.hypot(NORTH, EAST), np.rad2deg(np.arctan2(EAST, NORTH))
    found = read_detections(table(tmp_path / "p.csv", "t [s],range [NM],bearing [deg]", T, range_ / 1852, bearing))
    is_the_target(found)
    assert found.relative


def test_own_ship_from_a_file_of_her_own(tmp_path):
    own = table(tmp_path / "own.csv", "t [s],x [m],y [m]", T, 5 * T, 0 * T)
    north = NORTH - 5 * T
    log = table(
        tmp_path / "p.csv",
        "t [s],range [m],bearing [deg]",
        T,
        np.hypot(north, EAST),
        np.rad2deg(np.arctan2(EAST, north)),
    )
    found = read_detections(log, own=own)
    is_the_target(found)
    (one,) = track(found).tracks
    # Relative motion -9 m/s north, 3 m/s east.
    assert one.approach is not None and one.approach.relative_speed == pytest.approx(math.hypot(9, 3), abs=0.5)


def test_bearings_from_the_bow_of_a_ship_that_turns(tmp_path):
    """The column was refused, and nothing said how such a log is read."""
    psi = np.deg2rad(350 + 2 * T)
    from_bow = np.rad2deg(np.arctan2(EAST, NORTH) - psi) % 360
    log = table(tmp_path / "p.csv", "t [s],range [m],relative_bearing [deg]", T, np.hypot(NORTH, EAST), from_bow)
    fine = np.arange(0, 120, 0.5)
    own = table(tmp_path / "own.csv", "t [s],x [m],y [m],psi [deg]", fine, 0 * fine, 0 * fine, (350 + 2 * fine) % 360)
    is_the_target(read_detections(log, own=own))
    with pytest.raises(EncounterRequestError, match="count from the bow, and nothing says how own ship headed"):
        read_detections(log)


def test_plots_beyond_own_ships_path_have_no_position(tmp_path):
    own = table(tmp_path / "own.csv", "t [s],x [m],y [m]", T[:20], 5 * T[:20], 0 * T[:20])
    log = table(tmp_path / "p.csv", "t [s],range [m],bearing [deg]", T, 1000 + 0 * T, 10 + 0 * T)
    found = read_detections(log, own=own).plots
    (said,) = found.notes
    assert found.span[1] <= T[19] + 5.0 and said.kind == "plots-without-own-ship" and "runs from 0 to 57 s" in said


def test_degrees_and_the_truth(tmp_path):
    lat, lon = 50 + np.rad2deg(NORTH / 6_390_000), 1 + np.rad2deg(EAST / 6_378_137 / math.cos(math.radians(50)))
    log = table(tmp_path / "p.csv", "t [s],lat [deg],lon [deg]", T, lat, lon)
    truth = tmp_path / "truth.csv"
    rows = [f"{t},{a:.9f},{o:.9f},Gull" for t, a, o in zip(T, lat, lon)]
    truth.write_text("\n".join(["t [s],lat [deg],lon [deg],ship", *rows]))
    result = track(read_detections(log, truth=truth))
    assert result.score.ships[0].name == "Gull" and result.score.ships[0].rmse[0] < 1.0
    assert result.plots.origin == pytest.approx((lat[0], lon[0]))


def test_metres_and_degrees_do_not_lie_in_one_frame(tmp_path):
    """Taken for each other, degrees would put every ship within a metre of the origin."""
    lat, lon = 50 + np.rad2deg(NORTH / 6_390_000), 1 + np.rad2deg(EAST / 6_378_137 / math.cos(math.radians(50)))
    degrees = table(tmp_path / "d.csv", "t [s],lat [deg],lon [deg]", T, lat, lon)
    metres = table(tmp_path / "m.csv", "t [s],x [m],y [m]", T, NORTH, EAST)
    both = table(tmp_path / "b.csv", "t [s],x [m],y [m],lat [deg],lon [deg]", T, NORTH + 500, EAST, lat, lon)
    with pytest.raises(EncounterRequestError, match=r"true tracks in .* latitude and longitude, .* not known"):
        read_detections(metres, truth=degrees)
    with pytest.raises(EncounterRequestError, match=r"true tracks in .* origin of their own"):
        read_detections(degrees, truth=metres)
    with pytest.raises(EncounterRequestError, match=r"positions of own ship in .* origin of their own"):
        read_detections(degrees, own=metres)
    # Where the truth has both, that of the plots is taken.
    (gull,) = read_detections(degrees, truth=both).truth
    assert (gull.x[0], gull.y[0]) == pytest.approx((0.0, 0.0), abs=1e-6)
    (gull,) = read_detections(metres, truth=both).truth
    assert (gull.x[0], gull.y[0]) == pytest.approx((NORTH[0] + 500, EAST[0]))


def test_a_column_that_is_not_asked_for_needs_no_unit(tmp_path):
    is_the_target(read_detections(table(tmp_path / "p.csv", "t [s],x [m],y [m],level", T, NORTH, EAST, T)))
    with pytest.raises(NoUnitError, match="'x'"):
        read_detections(table(tmp_path / "q.csv", "t [s],x,y [m]", T, NORTH, EAST))


def test_json_asks_for_a_format(tmp_path):
    (tmp_path / "d.json").write_text('[{"time": 1.0, "position": [1.0, 2.0]}]')
    with pytest.raises(ForeignFileError, match="Describe them in a format file"):
        read_detections(tmp_path / "d.json")


def test_json_as_a_format_file_describes(tmp_path):
    """One plot, several in rows of norths and easts, none, and a sensor that is not named."""
    records = []
    for k, t in enumerate(T):
        here = [10.0 * k, 0.0]
        north, east = NORTH[k] - here[0], EAST[k]
        plot = [north, east] if k % 3 else [[north, 5000.0], [east, 100.0 * k]]
        records.append({"id": 2, "when": t + 1.6e9, "own": here, "z": plot})
        records.append({"id": 7, "when": t + 1.6e9, "own": here, "z": [0.3]})
    records.append({"id": 2, "when": 130.0 + 1.6e9, "own": [0, 0], "z": []})
    (tmp_path / "log.json").write_text(json.dumps(records))
    truth = [[{"who": 1, "when": t + 1.6e9, "at": [x, y, 0]}] for t, x, y in zip(T, NORTH, EAST)]
    (tmp_path / "truth.json").write_text(json.dumps(truth))
    (tmp_path / "f.toml").write_text(
        "[records]\ntime = 'when'\nposition = 'z'\nown = 'own'\nsensor = 'id'\nrelative = true\n"
        "[sensors.radar]\nvalue = 2\nposition_std = '5 m'\nlatency = '0 s'\n"
        "[truth]\ntime = 'when'\nposition = 'at'\nname = 'who'\n"
    )
    found = read_detections(tmp_path / "log.json", format=tmp_path / "f.toml", truth=tmp_path / "truth.json")
    assert len(found.plots) == T.size + sum(1 for k in range(T.size) if k % 3 == 0)
    assert len(found.plots.scans) == T.size + 1 and len(found.plots.scans[-1].z) == 0
    assert found.truth[0].name == "target 1" and found.own is not None
    result = track(found)
    assert result.score.ships[0].held > 0.85 and result.score.ships[0].rmse[0] < 3.0


def test_matlab_as_a_format_file_describes(tmp_path):
    from scipy.io import savemat

    range_, bearing = np.hypot(NORTH, EAST), np.arctan2(EAST, NORTH)
    log = {"azimuth": bearing, "range": range_, "time": 1000 * (T + 40000)}
    savemat(tmp_path / "d.mat", {"detections": log}, oned_as="column")
    lonlat = np.column_stack(
        [1 + np.rad2deg(EAST / 6_378_137 / math.cos(math.radians(50))), 50 + np.rad2deg(NORTH / 6_380_000)]
    )
    ships = np.empty((1, 2), object)
    ships[0, 0] = {"numTime": T + 40000, "geoLonLat": np.tile([1.0, 50.0], (T.size, 1)), "shipName": "OWN  @@"}
    ships[0, 1] = {"numTime": T + 40000, "geoLonLat": lonlat, "shipName": "GULL"}
    savemat(tmp_path / "a.mat", {"tracks": ships}, oned_as="column")
    (tmp_path / "f.toml").write_text(
        "[table]\nstruct = 'detections'\n[columns.t]\ncolumn = 'time'\nunit = 'ms'\n"
        "[columns.range]\ncolumn = 'range'\nunit = 'm'\n[columns.bearing]\ncolumn = 'azimuth'\nunit = 'rad'\n"
        "[sensors.radar]\nrange_std = '5 m'\nbearing_std = '0.5 deg'\n"
        "[truth]\nstruct = 'tracks'\ntime = 'numTime'\nlonlat = 'geoLonLat'\nname = 'shipName'\n[own]\nname = 'OWN'\n"
    )
    a = tmp_path / "a.mat"
    found = read_detections(tmp_path / "d.mat", format=tmp_path / "f.toml", own=a, truth=a)
    assert [p.name for p in found.truth] == ["GULL"] and found.own.name == "OWN"
    # Own ship is one of the true tracks, so that naming the truth is enough.
    alone = read_detections(tmp_path / "d.mat", format=tmp_path / "f.toml", truth=a)
    assert [p.name for p in alone.truth] == ["GULL"] and alone.own.name == "OWN" and not alone.relative
    result = track(alone)
    assert result.score.ships[0].rmse[0] < 12.0  # the sphere of this test is not the ellipsoid
    with pytest.raises(FormatFileError, match="no ship called"):
        text = (tmp_path / "f.toml").read_text().replace("'OWN'", "'GONE'")
        (tmp_path / "g.toml").write_text(text)
        read_detections(tmp_path / "d.mat", format=tmp_path / "g.toml", own=a)
    with pytest.raises(EncounterRequestError, match=r"true tracks in .* latitude and longitude, .* not known"):
        read_detections(tmp_path / "d.mat", format=tmp_path / "g.toml", truth=a)


def sentence(text: str) -> str:
    return f"${text}*{checksum(text)}"


def ttm(k: int, relative: bool = False) -> str:
    range_, bearing = math.hypot(NORTH[k], EAST[k]) / 1852, math.degrees(math.atan2(EAST[k], NORTH[k]))
    bearing = (bearing - 30) % 360 if relative else bearing
    at = int(T[k])
    clock = f"10{at // 60:02d}{at % 60:02d}.00"
    return sentence(f"RATTM,01,{range_:.5f},{bearing:.3f},{'R' if relative else 'T'},9.7,143.1,T,,,N,,T,,{clock},A")


def test_ttm(tmp_path):
    log = tmp_path / "radar.nmea"
    lost = sentence("RATTM,02,1.0,10.0,T,,,T,,,N,,L,,100000.00,A")
    log.write_text("\n".join([lost, *(ttm(k) for k in range(T.size))]))
    found = read_detections(log)
    is_the_target(found, 8.0)
    assert any("1 target lost by the radar left out" in n for n in found.plots.notes)


def test_sentences_that_are_damaged_are_counted_and_others_are_no_table(tmp_path):
    log = tmp_path / "radar.nmea"
    log.write_text("\n".join([*(ttm(k) for k in range(T.size)), ttm(0)[:-2] + "00", ttm(1)[:-2] + "00"]))
    assert any("2 sentences with a wrong checksum left out" in n for n in read_detections(log).plots.notes)
    beside = "!AIVDM,1,1,,A,13u?etPv2;0n:dDPwUM1U1Cb069D,0*24"
    log.write_text("\n".join([*(ttm(k) for k in range(T.size)), beside]))
    assert any("AIS is not tracked beside a radar: 1 of its" in n for n in read_detections(log).plots.notes)
    log.write_text("\n".join(sentence(f"HEHDT,{k}.0,T") for k in range(30)))
    with pytest.raises(EmptyFileError, match="no target with a position"):
        read_detections(log)


def test_ttm_from_the_bow_needs_the_heading(tmp_path):
    log = tmp_path / "radar.nmea"
    bow = [ttm(k, relative=True) for k in range(T.size)]
    log.write_text("\n".join([sentence("HEHDT,30.0,T"), *bow]))
    is_the_target(read_detections(log), 8.0)
    log.write_text("\n".join(bow))
    with pytest.raises(EmptyFileError, match="no target with a position"):
        read_detections(log)


def test_ttm_without_a_time(tmp_path):
    log = tmp_path / "radar.nmea"
    log.write_text("\n".join([sentence("RATTM,01,1.0,10.0,T,,,T,,,N,,T,,,A")] * 4))
    with pytest.raises(NonFiniteError, match="tells the time"):
        read_detections(log)


def ais(tmp_path: Path) -> Path:
    from pyais.encode import encode_dict

    lines = []
    for k, t in enumerate(T):
        lat = 50 + math.degrees(NORTH[k] / 6_390_000)
        lon = 1 + math.degrees(EAST[k] / 6_378_137 / math.cos(math.radians(50)))
        for mmsi, place in ((244000001, (lat, lon)), (244000002, (91.0, 181.0))):
            message = {"type": 1, "mmsi": mmsi, "lat": place[0], "lon": place[1], "speed": 9.7, "course": 143.0}
            stamp = f"2026-01-01T10:{int(t) // 60:02d}:{int(t) % 60:02d}.000Z "
            lines.append(stamp + encode_dict(message, talker_id="AI", sentence_type="VDM")[0])
    log = tmp_path / "log.ais"
    log.write_text("\n".join(lines))
    return log


def test_ais(tmp_path):
    found = read_detections(ais(tmp_path))
    assert found.plots.sensors[0].name == "AIS"
    (one,) = track(found).tracks
    assert one.x[-1, :2] == pytest.approx([NORTH[-1] - NORTH[0], EAST[-1] - EAST[0]], abs=15)
    assert one.x[-1, 2:] == pytest.approx([-4, 3], abs=0.5)


def test_ais_without_its_package(tmp_path, monkeypatch):
    log = ais(tmp_path)
    monkeypatch.setitem(sys.modules, "pyais", None)
    with pytest.raises(MissingExtraError, match=r"shipid\[ais\]"):
        read_detections(log)


def test_what_cannot_be_read(tmp_path):
    log = table(tmp_path / "p.csv", "t [s],x [m],y [m]", T, NORTH, EAST)
    with pytest.raises(MissingFileError, match="is not there"):
        read_detections(tmp_path / "gone.csv")
    (tmp_path / "empty.csv").touch()
    with pytest.raises(EmptyFileError, match="0 bytes"):
        read_detections(tmp_path / "empty.csv")
    with pytest.raises(MissingFileError, match="is a folder"):
        read_detections(tmp_path)
    with pytest.raises(UnknownColumnError, match="no positions of targets"):
        read_detections(table(tmp_path / "q.csv", "t [s],psi [deg]", T, NORTH))
    with pytest.raises(EmptyFileError, match="no plot with a time"):
        read_detections(table(tmp_path / "r.csv", "t [s],x [m],y [m]", T[:3], np.full(3, np.nan), EAST[:3]))
    late = table(tmp_path / "own.csv", "t [s],x [m],y [m]", T + 5000, NORTH, EAST)
    with pytest.raises(EncounterRequestError, match="no plot lies in it"):
        read_detections(log, own=late)
    with pytest.raises(UnknownColumnError, match="no positions of own ship"):
        read_detections(log, own=table(tmp_path / "o.csv", "t [s],psi [deg]", T, NORTH))
    with pytest.raises(UnknownColumnError, match="no true positions"):
        read_detections(log, truth=table(tmp_path / "o2.csv", "t [s],psi [deg]", T, NORTH))
    with pytest.raises(TargetError, match="rising times"):
        ShipPath("Gull", np.zeros(2), np.zeros(2), np.zeros(2))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[records]\ntime = 't'\n", "'position' is missing"),
        ("[records]\ntime = 't'\nposition = 'z'\nlayout = 'columns'\n", "'layout' is 'columns'"),
        ("[records]\ntime = 't'\nposition = 'z'\n[sensors.a]\nrange_std = '5 m'\n", "belong together"),
        ("[records]\ntime = 't'\nposition = 'z'\n[sensors.a]\ndetection = 1.5\n", "probability between"),
        ("[records]\ntime = 't'\nposition = 'z'\n[sensors.a]\nvalue = 1\n[sensors.b]\nvalue = 1\n", "no other sensor"),
        ("[records]\ntime = 't'\nposition = 'z'\n[truth]\ntime = 't'\n", "either position"),
    ],
)
def test_formats_that_cannot_be_meant(tmp_path, text, words):
    (tmp_path / "f.toml").write_text(text)
    with pytest.raises(FormatFileError, match=words):
        read_plot_format(tmp_path / "f.toml")


@pytest.mark.parametrize(
    ("text", "error", "words"),
    [
        ("{", DamagedFileError, "is no JSON"),
        ("{}", FormatFileError, "no list of records"),
        ("[{}]", FormatFileError, "record 0, has no 't'"),
        ('[{"t": "x", "z": []}]', FormatFileError, "is no number"),
    ],
)
def test_json_that_is_not_as_its_format_says(tmp_path, text, error, words):
    (tmp_path / "f.toml").write_text("[records]\ntime = 't'\nposition = 'z'\n[truth]\ntime = 't'\nposition = 'z'\n")
    (tmp_path / "log.json").write_text(text)
    with pytest.raises(error, match=words):
        read_detections(tmp_path / "log.json", format=tmp_path / "f.toml")


def test_a_table_over_midnight_goes_on(tmp_path):
    t = np.arange(86390.0, 86410.0, 1.0)
    rows = "".join(f"{at % 86400},{10 * k},{k}\n" for k, at in enumerate(t))
    (tmp_path / "night.csv").write_text("t [s],x [m],y [m]\n" + rows)
    found = read_detections(tmp_path / "night.csv")
    assert [s.z[0, 0] for s in found.plots] == [10.0 * k for k in range(20)]
    assert found.plots.span == (0.0, 19.0) and any("midnight" in n for n in found.plots.notes)


def test_a_column_of_sensors_that_nothing_tells_apart_is_told(tmp_path):
    def said(*sensors):
        rows = "".join(f"{k},{900 + k},{k},{sensors[k % len(sensors)]}\n" for k in range(9))
        (tmp_path / "plots.csv").write_text("t [s],x [m],y [m],sensor\n" + rows)
        return [n for n in read_detections(tmp_path / "plots.csv").plots.notes if n.kind == "several-sensors"]

    (told,) = said(1, 2)
    assert "2 sensors" in told and "--format" in told
    assert said(1) == []


def test_radians_that_say_deg_are_told(tmp_path):
    def doubted(begin, step):
        rows = "".join(f"{3 * k},{900 + k},{(begin + step * k) % 360:.4f}\n" for k in range(30))
        (tmp_path / "bearing.csv").write_text("t [s],range [m],bearing [deg]\n" + rows)
        return [n for n in read_detections(tmp_path / "bearing.csv").plots.notes if n.kind == "bearing-unit"]

    (said,) = doubted(2.0, 0.1)
    assert "from 0 to 4.9 deg" in said and "may hold rad" in said
    assert doubted(2.0, 0.2) == [] and doubted(-1.0, 0.1) == []


def test_degrees_that_say_rad_are_told(tmp_path):
    (tmp_path / "bearing.csv").write_text(
        "t [s],range [m],bearing [rad]\n" + "".join(f"{k},900,{150 + k}\n" for k in range(9))
    )
    (said,) = [n for n in read_detections(tmp_path / "bearing.csv").plots.notes if n.kind == "bearing-unit"]
    assert said.serious and "25 turns" in said


def test_a_plot_beyond_the_earth_is_left_out(tmp_path):
    (tmp_path / "far.csv").write_text("t [s],x [m],y [m]\n0,1,2\n1,1e300,2\n2,3,4\n")
    found = read_detections(tmp_path / "far.csv")
    assert len(found.plots) == 2 and "plots-beyond" in {n.kind for n in found.plots.notes}


def test_a_log_without_a_plot_says_what_became_of_them(tmp_path):
    (tmp_path / "own.csv").write_text("t [s],range [m],bearing [deg]\n0,0,0\n1,0,0\n")
    with pytest.raises(EmptyFileError, match="2 plots at the position of the sensor itself"):
        read_detections(tmp_path / "own.csv")


def test_times_of_day_in_sentences_go_on_over_midnight(tmp_path):
    lines = []
    for k in range(8):
        at = (86388 + 3 * k) % 86400
        clock = f"{at // 3600:02d}{at % 3600 // 60:02d}{at % 60:02d}.00"
        body = f"RATTM,01,{1 + 0.01 * k:.3f},45.0,T,12.0,20.0,T,1.0,2.0,N,,T,,{clock},A"
        lines.append(f"${body}*{checksum(body)}")
    (tmp_path / "night.nmea").write_text("\n".join(lines))
    assert read_detections(tmp_path / "night.nmea").plots.span == (0.0, 21.0)


def test_ais_takes_the_time_of_the_clock_before_it(tmp_path):
    encode = pytest.importorskip("pyais.encode").encode_dict
    lines = []
    for k in range(4):
        body = f"GPZDA,1200{3 * k:02d}.00,01,06,2024,00,00"
        report = {"type": 1, "mmsi": 244000001, "lat": 52 + 1e-3 * k, "lon": 4.0}
        lines += [f"${body}*{checksum(body)}", *encode(report, talker_id="AI", sentence_type="VDM")]
    (tmp_path / "ais.nmea").write_text("\n".join(lines))
    found = read_detections(tmp_path / "ais.nmea")
    assert [s.t for s in found.plots] == [0.0, 3.0, 6.0, 9.0]


def test_a_wrong_time_of_day_is_no_midnight(tmp_path):
    """One impossible time and one wrong one in a log of TTM: no day is gained, and the wrong plot is left out."""
    lines = [ttm(k) for k in range(T.size)]
    wrong = lines[5].split("*")[0][1:].split(",")
    for clock in ("999999.00", "233000.00"):
        wrong[14] = clock
        lines.insert(6, sentence(",".join(wrong)))
    (tmp_path / "radar.nmea").write_text("\n".join(lines))
    found = read_detections(tmp_path / "radar.nmea")
    assert found.plots.span[1] - found.plots.span[0] == pytest.approx(T[-1] - T[0])
    assert "plots-far-in-time" in {n.kind for n in found.plots.notes}


def test_a_wrong_time_in_a_table_is_left_out(tmp_path):
    t = 36000.0 + T
    t[7] = 80000.0
    log = table(tmp_path / "p.csv", "t [s],x [m],y [m]", t, NORTH, EAST)
    found = read_detections(log)
    assert len(found.plots) == T.size - 1 and found.plots.span[1] == pytest.approx(T[-1] - T[0])


def test_ttm_that_does_not_say_from_where_its_bearing_counts(tmp_path):
    lines = [ttm(k) for k in range(T.size)]
    lines.append(sentence("RATTM,02,1.0,10.0,,,,T,,,N,,T,,100000.00,A"))
    (tmp_path / "radar.nmea").write_text("\n".join(lines))
    found = read_detections(tmp_path / "radar.nmea")
    assert len(found.plots) == T.size and any("neither T nor R left out" in n for n in found.plots.notes)


def test_ais_of_what_is_no_ship_and_of_own_ship(tmp_path):
    """Base station, buoy, aircraft, MMSI 0, long-range and cut messages are left out with their cause; VDO is own ship."""
    from pyais.encode import encode_dict

    others = [
        {"type": 4, "mmsi": 2442000, "lat": 50.0, "lon": 1.0, "year": 2026, "month": 1, "day": 1},
        {"type": 21, "mmsi": 992440000, "lat": 50.0, "lon": 1.0, "name": "BUOY"},
        {"type": 9, "mmsi": 111244000, "lat": 50.0, "lon": 1.0, "alt": 300},
        {"type": 1, "mmsi": 0, "lat": 50.0, "lon": 1.0},
        {"type": 27, "mmsi": 244000003, "lat": 50.0, "lon": 1.0},
    ]
    lines = ais(tmp_path).read_text().splitlines()
    stamp = lines[0].split("!")[0]
    lines += [stamp + text for d in others for text in encode_dict(d, talker_id="AI", sentence_type="VDM")]
    for body in (
        "AIVDM",
        "AIVDM,1",
        "AIVDM,x,1,,A,13,0",
        "AIVDM,1,1,,A,13`l,0",
        "AIVDM,1,1,,A,,0",
        "AIVDM,1,1,,A,~~~~,0",
    ):
        lines.append(f"{stamp}!{body}*{checksum(body)}")
    for k in (0, T.size - 1):
        own = {"type": 1, "mmsi": 244000009, "lat": 50.01, "lon": 1.0}
        front = f"2026-01-01T10:{int(T[k]) // 60:02d}:{int(T[k]) % 60:02d}.000Z "
        lines.append(front + encode_dict(own, talker_id="AI", sentence_type="VDO")[0])
    log = tmp_path / "more.ais"
    log.write_text("\n".join(lines))
    found = read_detections(log)
    assert len(found.plots) == T.size and found.own is not None
    told = " ".join(found.plots.notes)
    for words in (
        "5 AIS messages that cannot be decoded",
        "3 AIS reports of base stations",
        "MMSI 0",
        "1 long-range AIS report",
        "without a position",
    ):
        assert words in told


def test_own_ships_receiver_goes_before_her_ais(tmp_path):
    from pyais.encode import encode_dict

    lines = ais(tmp_path).read_text().splitlines()
    for k in (0, T.size - 1):
        front = f"2026-01-01T10:{int(T[k]) // 60:02d}:{int(T[k]) % 60:02d}.000Z "
        own = {"type": 1, "mmsi": 244000009, "lat": 51.0, "lon": 1.0}
        lines.append(front + encode_dict(own, talker_id="AI", sentence_type="VDO")[0])
        lines.append(front + sentence("GPGLL,5000.6,N,00100.0,E,100000.00,A"))
    log = tmp_path / "both.ais"
    log.write_text("\n".join(lines))
    found = read_detections(log)
    assert found.own is not None and np.ptp(found.own.x) < 1.0


def test_positions_that_stand_for_none_are_left_out(tmp_path):
    lat, lon = 52 + NORTH / 111_120, 4 + EAST / 68_000
    lat[::5], lon[::5] = 91.0, 181.0
    log = table(tmp_path / "p.csv", "t [s],lat [deg],lon [deg]", T, lat, lon)
    found = read_detections(log)
    assert len(found.plots) == T.size - len(T[::5]) and "positions-impossible" in {n.kind for n in found.plots.notes}
    assert np.abs(np.concatenate([s.z for s in found.plots])).max() < 1e4
    table(log, "t [s],lat [deg],lon [deg]", T, 0 * T + 91, 0 * T + 181)
    with pytest.raises(EmptyFileError, match="91 and 181 stand for none"):
        read_detections(log)


def test_ranges_in_miles_and_below_zero(tmp_path):
    rows = "".join(f"{3 * k},{-1 if k == 4 else 1.5},{10 + 0.01 * k}\n" for k in range(9))
    path = tmp_path / "log.csv"
    path.write_text("t [s],range [nm],bearing [deg]\n" + rows)
    found = read_detections(path)
    assert np.hypot(*found.plots.scans[0].z[0]) == pytest.approx(1.5 * 1852)
    assert "1 plot with a range below zero left out." in [str(n) for n in found.plots.notes]
