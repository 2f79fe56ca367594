"""Every source, and what is wrong with what it hears: the core goes on."""

from __future__ import annotations

import asyncio
import json
import math
import socket
from datetime import UTC, datetime, timedelta
from functools import reduce
from operator import xor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import shipid
from shipid.bridge.bridge_settings import BridgeSettings
from shipid.bridge.core.console import SteeringOrder
from shipid.bridge.recorder import Recorder
from shipid.bridge.sources import listened, signalk
from shipid.bridge.sources.line_queue import LineQueue, SplitLines
from shipid.bridge.sources.listened import ListenedSource
from shipid.bridge.sources.radar_targets import target_of
from shipid.bridge.sources.replayed import ReplayedSource
from shipid.bridge.sources.senders import Senders
from shipid.bridge.sources.signalk import SignalKSource, stream_of
from shipid.bridge.sources.simulated import SimulatedSource
from shipid.bridge.sources.source_of import source_of
from shipid.foundation.errors import ShipidError, UsageError
from shipid.trials.logs.nmea.settings import chosen_format

from ..conftest import sail, shown

KNOT = 1852 / 3600


def sentence(text: str) -> bytes:
    return f"${text}*{reduce(xor, text.encode(), 0):02X}\r\n".encode()


def spoken(t: float, *, heading: float = 90.0) -> list[bytes]:
    """What a bridge's instruments say at a time, the ship going east at 10 kn."""
    minutes = t * 10 * KNOT / 1852 / math.cos(math.radians(52))
    lon = f"004{minutes:09.6f}"
    return [
        sentence(f"HETHS,{heading:.2f},A"),
        sentence("TIROT,0.0,A"),
        sentence("VDVBW,10.0,0.1,A,10.1,0.0,A"),
        sentence("AGRSA,2.0,A,,V"),
        sentence("AGROR,3.0,A,,V,B"),
        sentence(f"GPGGA,120000.00,5200.0000,N,{lon},E,4,12,0.8,1.0,M,40.0,M,,"),
        sentence("GPVTG,90.0,T,,M,10.1,N,18.7,K,D"),
        sentence("WIMWV,45.0,R,20.0,N,A"),
        sentence("WIMWV,30.0,T,15.0,N,A"),
        sentence("RATTM,07,2.0,45.0,R,12.0,270.0,T,0.5,10.0,N,FERRY,T,,120000.00,A"),
    ]


@pytest.fixture
def nmea(make_core):
    source = ListenedSource("127.0.0.1", 1, "tcp")
    source._connected = True  # noqa: SLF001 - nothing is connected to here; the lines come from the test
    return source, make_core(source)


def voyage(source, core, seconds, change=lambda line: line):
    until = core.t + seconds
    while core.t < until:
        for line in spoken(core.t):
            kept = change(line)
            if kept:
                source.feed(kept)
        sail(core, 1.0)


def test_every_sentence_is_heard(nmea):
    source, _ = nmea
    for line in spoken(0.0):
        source.feed(line)
    values = source.take(0.4).values
    assert values["psi"] == pytest.approx(math.pi / 2) and values["r"] == 0.0
    assert values["u"] == pytest.approx(10 * KNOT) and values["v"] == pytest.approx(0.1 * KNOT)
    assert values["delta"] == pytest.approx(math.radians(2)) and values["delta_order"] == pytest.approx(math.radians(3))
    assert (values["x"], values["y"]) == (0.0, 0.0)
    assert values["SOG"] == pytest.approx(10.1 * KNOT) and values["COG"] == pytest.approx(math.pi / 2)
    assert values["wind_speed_relative"] == pytest.approx(20 * KNOT)
    # 30 degrees on the bow of a ship on 090: it comes from 120, and blows to 300.
    assert values["wind_direction"] % (2 * math.pi) == pytest.approx(math.radians(300))
    assert source.take(0.8).values == {}


def test_rsa_is_calibrated(tmp_path):
    file = tmp_path / "log.toml"
    file.write_text('[nmea.rudder]\nscale = "0.5 deg"\noffset = "1 deg"\nsign = -1\n')
    source = ListenedSource(None, 1, "tcp", chosen_format(file))
    source.feed(sentence("AGRSA,2.0,A,,V"))
    assert source.take(0.4).values["delta"] == pytest.approx(-math.radians(2))


def test_the_filter_follows_the_sentences(nmea):
    source, core = nmea
    voyage(source, core, 40)
    told = shown(core)
    assert told["own"]["y"] == pytest.approx((core.t - 1) * 10 * KNOT, abs=12) and told["alarms"] == []
    (ship,) = told["targets"]
    # 45 degrees on the starboard bow of a ship on 090.
    bearing = math.atan2(ship["y"] - told["own"]["y"], ship["x"] - told["own"]["x"])
    assert bearing == pytest.approx(math.radians(135), abs=0.05) and ship["speed"] == pytest.approx(12 * KNOT, rel=1e-3)
    assert told["flow"]["wind"]["direction_from"] == pytest.approx(math.radians(120), abs=0.01)


def test_the_true_wind_is_worked_out_of_the_relative_one(nmea):
    source, core = nmea
    voyage(source, core, 30, lambda line: b"" if b",T,15.0" in line else line)
    wind = shown(core)["flow"]["wind"]
    # 20 kn from 45 degrees on the bow of a ship that makes 10 kn to the east.
    north, east = -20 * math.cos(math.radians(135)), -20 * math.sin(math.radians(135)) + 10
    assert not wind["measured"] and wind["speed"] == pytest.approx(math.hypot(north, east) * KNOT, rel=0.02)
    blows_from = (math.atan2(east, north) + math.pi) % (2 * math.pi)
    assert wind["direction_from"] == pytest.approx(blows_from, abs=0.05)


@pytest.mark.parametrize(
    ("kind", "lost"),
    [("THS", "heading"), ("ROT", "rate of turn"), ("VBW", "speed through the water"), ("RSA", "rudder angle"), ("GGA", "position")],
)  # fmt: skip
def test_each_sensor_lost_in_turn(nmea, kind, lost):
    source, core = nmea
    voyage(source, core, 15)
    voyage(source, core, 12, lambda line: b"" if kind.encode() in line else line)
    told = shown(core)
    assert f"sensor lost: {lost}" in [a["text"] for a in told["alarms"]]
    assert told["own"]["y"] == pytest.approx((core.t - 1) * 10 * KNOT, abs=25)


def test_wrong_checksums_are_left_out_and_told(nmea):
    source, core = nmea
    voyage(source, core, 10)
    before = core.own_ship.sensors.age("psi")
    source.feed(b"$HETHS,270.0,A*00\r\n")
    reading = source.take(core.t + 0.1)
    assert "psi" not in reading.values and "checksum" in reading.told[-1] and before < 2


def test_a_jump_of_the_fixes_is_rejected(nmea):
    source, core = nmea
    voyage(source, core, 30)
    jumped = sentence("GPGGA,120000.00,5210.0000,N,00400.0000,E,4,12,0.8,1.0,M,40.0,M,,")
    source.feed(jumped)
    sail(core, 0.4)
    assert abs(shown(core)["own"]["x"]) < 30


@given(st.lists(st.binary(max_size=120), max_size=30), st.booleans())
@settings(max_examples=60, deadline=None)
def test_hostile_bytes_disturb_nothing(pieces, cut):
    source = ListenedSource(None, 1, "tcp")
    whole = b"".join(spoken(0.0))
    source.feed(b"\n".join(pieces))
    if cut:
        source.feed(whole[: len(whole) // 2])
    source.take(0.4)
    source.feed(whole)
    values = source.take(0.8).values
    assert values["psi"] == pytest.approx(math.pi / 2)
    assert all(math.isfinite(v) for v in values.values())


@given(st.text(alphabet="$!,*ABCDEFHMOPRSTVW0123456789.-NKTQ", max_size=100))
@settings(max_examples=200, deadline=None)
def test_hostile_sentences_disturb_nothing(body):
    source = ListenedSource(None, 1, "tcp")
    for kind in ("AGRSA", "GPGGA", "RATTM", "GPRMC", "VDVBW", "WIMWV", "TIROT"):
        source.feed(sentence(f"{kind},{body.replace('$', '').replace('!', '').replace('*', '')}"))
    reading = source.take(0.4)
    assert all(math.isfinite(v) for v in reading.values.values())
    assert all(math.isfinite(t.range + t.bearing) for t in reading.targets)


def test_lines_without_an_end_and_floods_are_bounded():
    queue = LineQueue()
    for _ in range(1000):
        queue.feed(b"x" * 4096, whole=False)
    queue.feed(b"\n$GOOD,1\n", whole=False)
    lines, dropped = queue.take()
    assert lines == ["$GOOD,1"] and dropped == 1
    queue.feed(b"$A,1\n" * 100_000, whole=True)
    lines, dropped = queue.take()
    assert len(lines) == 4000 and dropped == 96_000


def test_a_target_that_cannot_be_is_none():
    good = "$RATTM,07,2.0,45.0,T,12.0,270.0,T,0.5,10.0,N,FERRY,T,,120000.00,A"
    assert target_of(good, 0.0, None).range == 3704.0
    assert target_of(good.replace(",T,12", ",R,12"), 0.0, None) is None  # without a heading
    for wrong in (good.replace(",T,,", ",L,,"), good.replace("2.0", "x"), good[:20], good.replace(",N,", ",X,")):
        assert target_of(wrong, 0.0, 0.0) is None


def test_sentences_arrive_over_udp_and_tcp(make_core):
    async def listen() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        udp = ListenedSource("127.0.0.1", port, "udp")
        await udp.start()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"".join(spoken(0.0)), ("127.0.0.1", port))
            await until(lambda: "psi" in udp.take(0.4).values)
            sender.sendto(b"".join(spoken(0.0)), ("127.0.0.1", port))
            await until(lambda: "psi" in udp.take(0.8).values)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"".join(spoken(0.0)), ("127.0.0.1", port))
            await until(lambda: any("THS comes from 127.0.0.1:" in line for line in udp.take(1.2).told))
        await udp.stop()

        async def speak(_, writer) -> None:
            writer.write(b"".join(spoken(0.0)))
            await writer.drain()
            writer.close()

        server = await asyncio.start_server(speak, "127.0.0.1", 0)
        tcp = ListenedSource("127.0.0.1", server.sockets[0].getsockname()[1], "tcp")
        assert tcp.state == "lost"
        await tcp.start()
        await until(lambda: "psi" in tcp.take(0.4).values)
        server.close()
        await until(lambda: tcp.state == "lost")
        await tcp.stop()

    asyncio.run(listen())


def test_of_two_that_send_one_sentence_over_udp_one_is_heard():
    """Two headings in turn made a heading of neither sensor, and no alarm."""
    now, told = [0.0], []
    senders = Senders(told.append, lambda: now[0])
    kept = {"a:1": [], "b:2": []}
    for second in range(20):
        now[0] = float(second)
        for sender in ("a:1", "b:2") if second < 10 else ("b:2",):
            kept[sender].append(b"HETHS" in senders.kept(sentence("HETHS,90.0,A") + sentence("RATTM,07"), sender))
    # The first that sends again; after it has been silent the other one.
    assert kept["a:1"] == [True] * 10 and kept["b:2"][1:14] == [False] * 13 and kept["b:2"][14:] == [True] * 6
    assert "HETHS comes from a:1 and from b:2: that of a:1 is taken. Let one of them send to another port." in told
    # What a radar sees, other sentences, and what is none are of nobody; a port for each datagram is one sender.
    assert b"TTM" in senders.kept(sentence("RATTM,07"), "a:1") and senders.kept(b"x", "a:1") == b"x"
    for port in range(2000):
        assert senders.kept(sentence("TIROT,0.0,A"), f"c:{port}")


def test_sentences_that_datagrams_cut_are_put_together_by_sender():
    """A serial port on a network sends so many bytes at once: position and speed were taken to be lost."""
    split, whole = SplitLines(), b"".join(spoken(0.0)) * 3
    pieces = [whole[i : i + 37] for i in range(0, len(whole), 37)]
    # Another sender between them ends no line at all, and is not waited for.
    heard = [(split.joined(p, "a:1"), split.joined(b"$HEHDT,90.0,T", "b:2")) for p in pieces]
    assert all(other == b"$HEHDT,90.0,T" for _, other in heard)
    # Of the first datagram it was not known yet that its sender cuts.
    assert b"".join(own for own, _ in heard[1:]) == whole[whole.rindex(b"$", 0, 37) :]
    # What waits is let through when a new sentence begins.
    split.joined(b"$HEHDT,1", "a:1"), split.joined(b"2.0,T*", "a:1")
    assert split.joined(b"$HEROT,1.0,A*00\n", "a:1").startswith(b"$HEHDT,12.0,T*\n$HEROT")


def test_a_connection_on_which_nothing_comes_is_made_anew(monkeypatch):
    monkeypatch.setattr(listened, "_SILENT", 0.1)
    monkeypatch.setattr(listened, "_AGAIN", 0.01)
    connections = []

    async def speak(_, writer) -> None:
        connections.append(writer)
        # A line without an end, and never a word more: the other side has lost its power.
        writer.write(b"x" * 5000 if len(connections) == 1 else b"".join(spoken(0.0)))

    async def listen() -> None:
        server = await asyncio.start_server(speak, "127.0.0.1", 0)
        tcp = ListenedSource("127.0.0.1", server.sockets[0].getsockname()[1], "tcp")
        await tcp.start()
        values, told = {}, []

        def heard() -> bool:
            reading = tcp.take(0.4)
            values.update(reading.values)
            told.extend(reading.told)
            return len(connections) > 1 and "wind_speed" in values

        await until(heard)
        await tcp.stop()
        server.close()
        assert any("nothing came for 0.1 s; it is tried again" in line for line in told)
        assert "psi" in values  # the first line of a new connection counts

    asyncio.run(listen())


def test_why_there_is_no_connection_is_told():
    async def listen() -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        told = []
        for source in (ListenedSource("127.0.0.1", port, "tcp"), SignalKSource(f"ws://127.0.0.1:{port}/")):
            await source.start()
            await until(lambda source=source: told.extend(source.take(0.4).told) or told)
            await source.stop()
            assert "Connection refused; it is tried again" in told.pop() and source.state == "lost"

    asyncio.run(listen())


@pytest.mark.parametrize("host", ["a..b", "x" * 70, "a\0b"])
def test_a_name_that_no_host_has_is_refused(host):
    for make in (lambda: ListenedSource(host, 9, "tcp"), lambda: stream_of(f"ws://{host}:9/")):
        with pytest.raises(UsageError, match="no name of a host"):
            make()


async def until(condition) -> None:
    for _ in range(500):
        if condition():
            return
        await asyncio.sleep(0.01)
    raise AssertionError("it never came")


def test_a_udp_port_that_is_taken_is_refused_before_the_page_opens():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(UsageError, match="cannot be listened to"):
            ListenedSource("127.0.0.1", taken.getsockname()[1], "udp")


DELTA = {
    "context": "vessels.self",
    "updates": [{
        "$source": "x", "timestamp": "2026-01-01T00:00:00Z", "values": [
            {"path": "navigation.headingTrue", "value": 1.0}, {"path": "navigation.rateOfTurn", "value": 0.01},
            {"path": "navigation.speedThroughWater", "value": 5.0}, {"path": "steering.rudderAngle", "value": -0.1},
            {"path": "navigation.position", "value": {"latitude": 52.0, "longitude": 4.0}},
            {"path": "environment.wind.speedTrue", "value": 7.0}, {"path": "environment.wind.directionTrue", "value": 0.0},
            {"path": "propulsion.main.revolutions", "value": 2.0}, {"path": "navigation.courseOverGroundTrue", "value": None},
        ],
    }],
}  # fmt: skip


GREETING = {"name": "x", "self": "vessels.urn:mrn:1", "version": "1.8", "timestamp": "2026-01-01T00:00:01Z"}


def test_signal_k_deltas_are_heard():
    source = SignalKSource("ws://127.0.0.1:1/")
    source.feed(json.dumps(GREETING))
    source.feed(json.dumps(DELTA))
    values = source.take(0.4).values
    assert values == {
        "psi": 1.0, "r": 0.01, "u": 5.0, "delta": -0.1, "x": 0.0, "y": 0.0, "wind_speed": 7.0, "wind_direction": math.pi,
    }  # fmt: skip
    source.feed(json.dumps(DELTA | {"context": "vessels.urn:mrn:2"}))  # another ship
    assert source.take(0.8).values == {}


def test_the_apparent_wind_of_signal_k_is_heard_and_recorded(tmp_path):
    """It is told by where it comes from, to port below zero, and kept by where it flows to, from the bow."""
    source = SignalKSource("ws://127.0.0.1:1/")
    file = tmp_path / "voyage.csv"
    recorder = Recorder(file, "x", "signalk:ws://pi", simulated=False)
    wind = [("speedApparent", 8.0), ("angleApparent", -0.5)]
    for k in range(12):
        values = [{"path": f"environment.wind.{path}", "value": value} for path, value in wind]
        source.feed(json.dumps({"updates": [{"values": [*values, {"path": "navigation.headingTrue", "value": 1.0}]}]}))
        recorder.add(0.4 * k, source.take(0.4 * k).values)
    recorder.close()
    trial = shipid.read_trial(file)
    assert trial["wind_speed_relative"] == pytest.approx(np.full(12, 8.0))
    assert trial["wind_direction_relative"] == pytest.approx(np.full(12, math.pi - 0.5))


def heading_at(stamp, value=1.0, **update):
    values = [{"path": "navigation.headingTrue", "value": value}]
    return json.dumps({"updates": [{"timestamp": stamp, "values": values, **update}]})


def test_signal_k_that_the_server_has_kept_is_not_heard():
    now = [100.0]
    source = SignalKSource("ws://127.0.0.1:1/", clock=lambda: now[0])
    source.feed(json.dumps(GREETING))

    def heard(text):
        source.feed(text)
        return source.take(0.4)

    old = heard(heading_at("2025-12-31T23:00:01Z"))
    assert old.values == {} and "headingTrue was 3600 s old when it came" in old.told[0] and "clocks" in old.told[0]
    assert heard(heading_at("2026-01-01T00:00:01.000Z")).values == {"psi": 1.0}
    # The last value again is no news, nor is an older one; that of a clock with whole seconds is, where it has changed.
    assert heard(heading_at("2026-01-01T00:00:01.000Z")).values == {}
    assert heard(heading_at("2026-01-01T00:00:00Z", 2.0)).values == {}
    assert heard(heading_at("2026-01-01T02:00:01+02:00", 1.1)).values == {"psi": 1.1}
    # Another source has a clock of its own; no time stamp is none to hold against a value.
    assert heard(heading_at("2026-01-01T00:00:00Z", 1.2, **{"$source": "b"})).values == {"psi": 1.2}
    assert heard(heading_at(None)).values == {"psi": 1.0} and heard(heading_at("today")).values == {"psi": 1.0}
    now[0] += 60.0
    assert heard(heading_at("2026-01-01T00:00:30Z")).values == {}
    assert heard(heading_at("2026-01-01T00:01:00Z")).values == {"psi": 1.0}


def test_a_signal_k_server_without_a_clock_is_held_against_this_one():
    source = SignalKSource("ws://127.0.0.1:1/")
    source.feed(heading_at("2001-01-01T00:00:00Z"))
    assert source.take(0.4).values == {}
    source.feed(heading_at(datetime.now(UTC).isoformat()))
    assert source.take(0.8).values == {"psi": 1.0}


def test_a_heading_that_a_signal_k_server_keeps_is_an_alarm(make_core):
    now = [0.0]
    source = SignalKSource("ws://127.0.0.1:1/", clock=lambda: now[0])
    source._connected = True  # noqa: SLF001 - nothing is connected to here; the deltas come from the test
    core = make_core(source)
    source.feed(json.dumps(GREETING))
    for second in range(25):
        now[0] = float(second)
        stamp = (datetime(2026, 1, 1, tzinfo=UTC) + timedelta(seconds=second)).isoformat()
        update = json.loads(json.dumps(DELTA))["updates"][0] | {"timestamp": stamp}
        if second > 10:
            del update["values"][0]
            source.feed(heading_at("2026-01-01T00:00:10Z"))
        source.feed(json.dumps({"updates": [update]}))
        sail(core, 1.0)
    told = [a["text"] for a in shown(core)["alarms"]]
    assert "sensor lost: heading" in told and not any("rudder" in t or "no data" in t for t in told)


def test_a_signal_k_server_whose_clock_was_set_back_is_asked_again(monkeypatch):
    from websockets.asyncio.server import serve

    monkeypatch.setattr(signalk, "_NOTHING_NEW", 0.05)
    monkeypatch.setattr(signalk, "_AGAIN", 0.01)
    clocks = iter(["2026-01-01T01:00:00Z", "2026-01-01T00:00:00Z"])

    async def speak(socket_) -> None:
        await socket_.send(json.dumps(GREETING | {"timestamp": next(clocks)}))
        for k in range(1000):
            await socket_.send(heading_at(f"2026-01-01T00:00:{k / 100:06.3f}Z"))
            await asyncio.sleep(0.01)

    async def run() -> None:
        async with serve(speak, "127.0.0.1", 0) as server:
            source = SignalKSource(f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}/")
            await source.start()
            await until(lambda: "psi" in source.take(0.4).values)
            await source.stop()

    asyncio.run(run())


def test_signal_k_in_other_units_is_left_out():
    source = SignalKSource("ws://127.0.0.1:1/")

    def heard(path, value):
        source.feed(json.dumps({"updates": [{"values": [{"path": path, "value": value}]}]}))
        return source.take(0.4)

    assert heard("navigation.headingTrue", 6.2).values == {"psi": 6.2}
    reading = heard("navigation.headingTrue", 123.4)
    assert reading.values == {} and "headingTrue of 123.4 cannot be: Signal K has rad" in reading.told[0]
    # Degrees that could be radians are no better.
    assert heard("navigation.headingTrue", 3.0).values == {}
    assert heard("steering.rudderAngle", -5.0).values == {} and heard("navigation.rateOfTurn", -2.0).values == {}
    assert heard("navigation.speedThroughWater", 4.0).values == {"u": 4.0}


@given(
    st.text(max_size=50) | st.sampled_from(["[", "{}", '{"updates":3}', '{"updates":[{"values":[3]}]}', "[" * 20000])
)
@settings(deadline=None)
def test_hostile_deltas_disturb_nothing(text):
    source = SignalKSource("ws://127.0.0.1:1/")
    source.feed(text)
    hostile = {"path": "navigation.position", "value": {"latitude": 1e9, "longitude": "x"}}
    source.feed(
        json.dumps({"updates": [{"values": [hostile, {"path": [], "value": 1}, {"path": "navigation.headingTrue"}]}]})
    )
    source.feed('{"updates":[{"values":[{"path":"navigation.headingTrue","value":NaN}]}]}')
    assert source.take(0.4).values == {}


def test_a_time_stamp_of_signal_k_that_would_steer_a_terminal_is_told_without():
    source = SignalKSource("ws://127.0.0.1:1/")
    source.feed(heading_at("2020-01-01\x1b10:00:00"))
    (told,) = source.take(0.4).told
    assert "2020-01-01?10:00:00" in told


def test_a_signal_k_server_is_read_and_missed():
    from websockets.asyncio.server import serve

    async def run() -> None:
        async def speak(socket_) -> None:
            await socket_.send(json.dumps(GREETING))
            await socket_.send(json.dumps(DELTA))

        async with serve(speak, "127.0.0.1", 0) as server:
            source = SignalKSource(f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}/")
            assert source.state == "lost"
            await source.start()
            await until(lambda: "psi" in source.take(0.4).values)
            await until(lambda: source.state == "lost")
            await source.stop()

    asyncio.run(run())


def test_the_stream_of_a_server():
    assert stream_of("http://pi:3000") == "ws://pi:3000/signalk/v1/stream?subscribe=self"
    assert stream_of("wss://pi/x") == "wss://pi/x"
    for wrong in ("pi:3000", "ftp://pi", "ws://", "ws://pi:99999/"):
        with pytest.raises(UsageError, match="no Signal K server"):
            stream_of(wrong)


def test_a_replay_is_heard_and_ends(make_core, pilot):
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:10/10", noise="standard", duration="300 s")
    source = ReplayedSource(trial)
    core = make_core(source)
    sail(core, 299)
    k = int(np.searchsorted(trial["t"], 299))
    told = shown(core)
    assert told["own"]["psi"] == pytest.approx(trial["psi"][k], abs=0.03) and told["time"]["state"] == "running"
    sail(core, 60)
    told = shown(core)
    assert told["time"]["state"] == "ended" and [a["text"] for a in told["alarms"]] == [
        "the replay has ended: this is its last moment"
    ]
    # The filter goes on, and the track of the past does not: nobody saw the ship where it takes her to be.
    sail(core, 30.0)
    count = core.past.count
    sail(core, 60.0)
    assert core.past.count == count
    assert told["own"]["age"] > 50 and "coefficients" not in told["simulation"]


def test_a_ship_that_runs_away_ends_the_simulation(pilot):
    source = SimulatedSource(pilot)
    source.ship._x[:] = np.nan  # noqa: SLF001 - a model of the house does not run away by itself
    assert "runs away" in source.take(0.4).told[0]
    assert source.state == "ended" and source.take(0.8).values == {}


@pytest.mark.parametrize(
    "text",
    ["", "sail", "replay:", "nmea:", "nmea:udp:", "nmea:udp:99999", "nmea:serial:1", "nmea:tcp:10110", "signalk:", "signalk:pi", "simulate:x"],
)  # fmt: skip
def test_a_source_that_is_none_is_refused(pilot, text):
    with pytest.raises(ShipidError):
        source_of(BridgeSettings(source=text), pilot)


def test_the_currents_of_a_simulation_belong_to_one(pilot):
    with pytest.raises(UsageError, match="belong to a simulation"):
        source_of(BridgeSettings(source="signalk:ws://pi/", wind=(1.0, 1.0)), pilot)


def test_a_wind_that_would_not_act_is_refused():
    """Without coefficients of the wind the page would show a wind that does nothing."""
    bare = shipid.design_autopilot("de-keizer", "zeefakkel")
    with pytest.raises(UsageError, match="leave --wind out"):
        source_of(BridgeSettings(wind=(10.0, 0.0)), bare)


def test_the_instruments_show_the_waves(pilot):
    waves = (math.radians(0.5), math.radians(90))
    source, calm = (SimulatedSource(pilot, seed=3, noise=False, waves=w) for w in (waves, None))
    rows = [(source.take(0.4 * k).values, source.now, calm.take(0.4 * k).values) for k in range(1, 4000)]
    shown = np.array([s["psi"] - now["psi"] for s, now, _ in rows])
    # 1600 s of a narrow band in beam seas: some 70 independent samples.
    assert np.std(shown) == pytest.approx(waves[0], rel=0.25)
    assert np.std([s["r"] - now["r"] for s, now, _ in rows]) == pytest.approx(0.6 * waves[0], rel=0.25)
    # The autopilot sees them, and works the rudder.
    assert np.std([now["delta"] for _, now, _ in rows]) > math.radians(0.1) > np.std([c["delta"] for _, _, c in rows])
    source.steer(SteeringOrder("rudder", 0.0, math.radians(20), 0.01, math.radians(5)))
    assert abs(source.take(1600.0).values["psi"] - source.now["psi"]) > 0


def test_the_sensors_have_the_noise_that_the_filter_expects(pilot):
    source = SimulatedSource(pilot, seed=3)
    rows = [source.take(0.4 * k).values["x"] - source.now["x"] for k in range(1, 2000)]
    assert np.std(rows) == pytest.approx(10.0, rel=0.1)
