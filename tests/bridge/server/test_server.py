"""The server on a real port: who is let in, what is refused, and that no client disturbs another."""

from __future__ import annotations

import json
import socket
import time
from datetime import UTC, datetime

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import shipid
from shipid.bridge.bridge_settings import BridgeSettings
from shipid.bridge.open_bridge import open_bridge
from shipid.bridge.server.clients import LONGEST_COMMAND, CommandRate, parsed_command
from shipid.bridge.server.guard import HEADERS, is_loopback
from shipid.bridge.server.serve import LONGEST_MESSAGE, listening, reached_at
from shipid.bridge.server.signalk_out import delta_of
from shipid.foundation.errors import UsageError

from ..conftest import sail


def parsed(text):
    def refuse(constant):
        raise AssertionError(constant)

    return json.loads(text, parse_constant=refuse)


def page(port, path="/ws", **more):
    return connect(f"ws://127.0.0.1:{port}{path}", open_timeout=20, **more)


def receive(ws, kind, key=None):
    """The next frame of a kind, and with a key."""
    for _ in range(400):
        told = parsed(ws.recv(timeout=20))
        if told["kind"] == kind and (key is None or key in told):
            return told
    raise AssertionError(f"no {kind} with {key}")


def test_a_client_is_sent_all_and_then_what_changes(serve):
    with page(serve()) as ws:
        first = receive(ws, "snapshot")
        assert {"ship", "own", "settings", "tracks", "past", "alarms"} <= set(first)
        second = receive(ws, "tick")
        assert second["seq"] > first["seq"] and "ship" not in second and "past" not in second
        assert "own" in receive(ws, "tick", "own")


def test_a_trial_comes_back_as_a_track(serve):
    with page(serve()) as ws:
        receive(ws, "tick", "tracks")
        ws.send('{"command":"trial","heading":1.0}')
        assert receive(ws, "reply") == {"kind": "reply", "command": "trial", "ok": True, "message": None}
        track = receive(ws, "tick", "tracks")["tracks"]
        while track["trial"] is None:
            track = receive(ws, "tick", "tracks")["tracks"]
        assert track["trial"]["psi"][-1] == pytest.approx(1.0, abs=0.05)
        ws.send('{"command":"execute"}')
        while "settings" not in (told := receive(ws, "tick")) or told["settings"]["executed"]["heading"] != 1.0:
            pass


@pytest.mark.parametrize(
    "text",
    ["", "x", "[]", "3", '{"command":NaN}', '{"command":"sink"}', "[" * 2000, '{"command":' + '"' * 3, b"\x00\xff"],
)
def test_a_malformed_command_is_answered_and_changes_nothing(serve, text):
    with page(serve()) as ws:
        receive(ws, "snapshot")
        ws.send(text)
        reply = receive(ws, "reply")
        assert reply["ok"] is False and reply["message"]
        ws.send('{"command":"cancel"}')
        assert receive(ws, "reply")["ok"] is True


def test_a_message_that_is_too_long_ends_its_client_and_no_other(serve):
    port = serve()
    with page(port) as other, page(port) as ws:
        receive(ws, "snapshot")
        ws.send('{"command":"' + "x" * LONGEST_MESSAGE + '"}')
        with pytest.raises(ConnectionClosed):
            while True:
                ws.recv(timeout=20)
        receive(other, "tick")
    with pytest.raises(UsageError, match=str(LONGEST_COMMAND)):
        parsed_command('"' + "x" * LONGEST_COMMAND + '"')


@pytest.mark.parametrize("path", ["/ws", "/signalk/v1/stream"])
def test_a_flood_of_commands_is_cut_and_its_client_let_go(serve, path):
    port = serve()
    with page(port) as other, page(port, path) as ws:
        parsed(ws.recv(timeout=20))
        with pytest.raises(ConnectionClosed):
            for _ in range(5000):
                ws.send('{"command":"cancel"}')
            until = time.monotonic() + 30
            while time.monotonic() < until:
                ws.recv(timeout=20)
        receive(other, "tick", "own")


def test_commands_fill_a_bucket():
    rate = CommandRate(0.0)
    assert [rate.allows(0.0) for _ in range(101)] == [True] * 100 + [False]
    assert rate.allows(0.02) and not rate.allows(0.02)


def test_ten_idle_slow_and_malformed_clients_disturb_nothing(serve):
    port = serve()
    idle = [socket.create_connection(("127.0.0.1", port)) for _ in range(4)]
    half = [socket.create_connection(("127.0.0.1", port)) for _ in range(3)]
    for one in half:
        one.sendall(b"GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ")
    rubbish = socket.create_connection(("127.0.0.1", port))
    rubbish.sendall(b"\x16\x03\x01\x02\x00" * 100)
    # Accepted, and never read again: what they are not sent is skipped, not kept.
    deaf = [page(port, max_queue=1) for _ in range(3)]
    with page(port) as ws:
        first = receive(ws, "snapshot")
        began, sequence = time.monotonic(), first["seq"]
        for _ in range(40):
            sequence = receive(ws, "tick")["seq"]
        assert sequence - first["seq"] >= 39
        assert time.monotonic() - began < 60  # it goes on; how fast it is, the study says
        ws.send('{"command":"trial","heading":0.5}')
        assert receive(ws, "reply")["ok"]
    for one in (*idle, *half, rubbish):
        one.close()
    for one in deaf:
        one.close_socket() if hasattr(one, "close_socket") else one.socket.close()


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1:1", "evil@127.0.0.1", "[::1", ""])
def test_another_host_is_refused(serve, host):
    answer = httpx.get(f"http://127.0.0.1:{serve()}/health", headers={"Host": host})
    assert answer.status_code in (400, 403) and "ok" not in answer.text


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "file://", "http://[", "http://evil.example:{}"]
)
def test_another_origin_is_refused(serve, origin):
    port = serve()
    with pytest.raises(InvalidStatus) as refused, page(port, origin=origin.format(port)):
        pass
    assert refused.value.response.status_code == 403


def test_the_own_page_is_let_in(serve):
    port = serve()
    with page(port, origin=f"http://127.0.0.1:{port}") as ws:
        receive(ws, "snapshot")


def test_every_answer_keeps_the_page_to_itself(serve):
    port = serve(chart={"land": []})
    for path, status in (
        ("/", 200),
        ("/chart.json", 200),
        ("/health", 200),
        ("/nothing", 404),
        ("/static/../../pyproject.toml", 404),
    ):
        answer = httpx.get(f"http://127.0.0.1:{port}{path}")
        assert answer.status_code == status, path
        for name, value in HEADERS.items():
            assert answer.headers[name] == value
        assert "server" not in answer.headers
    assert (
        "default-src 'none'" in HEADERS["Content-Security-Policy"]
        and "unsafe" not in HEADERS["Content-Security-Policy"]
    )
    assert httpx.get(f"http://127.0.0.1:{port}/chart.json").json() == {"land": []}
    assert httpx.get(f"http://127.0.0.1:{port}/health").json() == {"ok": True, "clients": 0}
    page_text = httpx.get(f"http://127.0.0.1:{port}/").text.lower()
    assert "not for navigation" in page_text
    assert httpx.post(f"http://127.0.0.1:{port}/", content=b"x").status_code == 405


def test_a_token_is_asked_for_and_kept_as_a_cookie(serve):
    port = serve(token="secret-é")
    address = f"http://127.0.0.1:{port}"
    for query in ("", "?token=", "?token=wrong", "?token=secret-%C3%A8"):
        assert httpx.get(f"{address}/{query}").status_code == 403
        with pytest.raises(InvalidStatus), page(port, f"/ws{query}"):
            pass
    with page(port, "/ws?token=secret-%C3%A9") as ws:
        receive(ws, "snapshot")


def test_the_page_needs_its_token_once(serve):
    port = serve(token="a;b\u00e9")
    with httpx.Client(base_url=f"http://127.0.0.1:{port}") as client:
        assert client.get("/chart.json").status_code == 403
        answer = client.get("/", params={"token": "a;b\u00e9"})
        assert answer.status_code == 200 and "HttpOnly" in answer.headers["set-cookie"]
        assert client.get("/chart.json").status_code == 200


def test_signal_k_goes_out(serve):
    port = serve()
    found = httpx.get(f"http://127.0.0.1:{port}/signalk").json()["endpoints"]["v1"]["signalk-ws"]
    with connect(found, open_timeout=20) as ws:
        assert parsed(ws.recv(timeout=20))["version"].startswith("1.8")
        for _ in range(20):
            delta = parsed(ws.recv(timeout=20))
            values = {v["path"]: v["value"] for v in delta["updates"][0]["values"]}
            if "navigation.speedThroughWater" in values:
                break
        assert values["navigation.speedThroughWater"] == pytest.approx(9.5, abs=0.5)
        assert 0 <= values["navigation.headingTrue"] < 6.2832 and "steering.rudderAngle" in values


def test_what_has_lost_its_sensor_does_not_go_out(make_core):
    core = make_core()
    sail(core, 10)
    sensors = core.own_ship.sensors
    whole = {v["path"] for v in delta_of(core, datetime.now(UTC))["updates"][0]["values"]}
    assert {"navigation.headingTrue", "navigation.speedThroughWaterTransverse"} <= whole
    sensors.take(core.t + 60, {n: sensors.value(n) for n in ("r", "delta")})
    left = {v["path"] for v in delta_of(core, datetime.now(UTC))["updates"][0]["values"]}
    assert left == {"navigation.rateOfTurn", "steering.rudderAngle"}


def test_what_a_bridge_sends_another_reads(serve, pilot):
    import asyncio

    from shipid.bridge.sources.signalk import SignalKSource

    port = serve()

    async def run():
        source = SignalKSource(f"ws://127.0.0.1:{port}/signalk/v1/stream")
        await source.start()
        for _ in range(1000):
            values = source.take(0.0).values
            if "psi" in values:
                break
            await asyncio.sleep(0.02)
        await source.stop()
        return values

    values = asyncio.run(run())
    assert values["u"] == pytest.approx(9.5, abs=0.5) and "delta" in values


def test_a_port_in_use_is_one_clear_line():
    with listening("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(UsageError, match=f"port {port} of 127.0.0.1 is in use already"):
            listening("127.0.0.1", port)
    with pytest.raises(UsageError, match="cannot be used"):
        listening("no-such-host.invalid", 8000)


def test_what_is_this_machine():
    assert all(is_loopback(h) for h in ("127.0.0.1", "localhost", "::1", "[::1]", "127.8.8.8"))
    assert not any(is_loopback(h) for h in ("0.0.0.0", "192.168.0.2", "::", "evil.example", ""))


def test_the_address_holds_the_token_as_a_link_needs_it():
    with open_bridge(BridgeSettings(), "127.0.0.1", 0, token="a&b c") as opened:
        assert opened.address.endswith("/?token=a%26b%20c")


@pytest.mark.parametrize(
    ("host", "routed", "named", "shown"),
    [
        ("0.0.0.0", "192.168.1.7", "127.0.1.1", "192.168.1.7"),
        ("0.0.0.0", None, "10.0.0.4", "10.0.0.4"),
        ("0.0.0.0", None, "127.0.1.1", "0.0.0.0"),
        ("127.0.0.1", "192.168.1.7", "10.0.0.4", "127.0.0.1"),
    ],
)
def test_the_address_that_is_told_can_be_opened_on_a_tablet(monkeypatch, host, routed, named, shown):
    """Nothing but this machine can open http://0.0.0.0:8000/."""
    with listening(host, 0) as listener:

        class Datagrams(socket.socket):
            def connect(self, address):
                if routed is None:
                    raise OSError("the network is unreachable")

            def getsockname(self):
                return routed, 9

        monkeypatch.setattr(socket, "socket", Datagrams)
        monkeypatch.setattr(socket, "getaddrinfo", lambda *a: [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (named, 0))])
        assert reached_at(listener, host) == f"{shown}:{listener.getsockname()[1]}"


def test_a_recording_of_a_replayed_simulation_is_one(tmp_path):
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:10/10", noise="standard", duration="30 s")
    shipid.write_trial(trial, tmp_path / "made.csv")
    settings = BridgeSettings(
        ship="soesterberg", source=f"replay:{tmp_path / 'made.csv'}", record=tmp_path / "kept.csv"
    )
    with open_bridge(settings, "127.0.0.1", 0, token=None):
        pass
    assert (tmp_path / "kept.csv").read_text().startswith("# Simulated, not measured")
