"""``shipid predict --route --chart``."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid.prediction.routes.read_route import read_route
from shipid.prediction.sailing.sail_route import sail_route

SHIP = ("predict", "de-keizer", "--ship", "soesterberg")
PLAN = "name,lat [deg],lon [deg],radius [nm],xtd_port [m],xtd_starboard [m]\nA,53.95,7.9,,,\nB,54.00,7.9,0.7,90,90\nC,54.03,7.99,,90,90\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A route, a voyage along it with sensors as usual, a chart, and a trial that says no origin."""
    folder = tmp_path_factory.mktemp("route")
    (folder / "elbe.csv").write_text(PLAN)
    pilot = shipid.design_autopilot("de-keizer", "soesterberg")
    voyage = sail_route(
        pilot, read_route(folder / "elbe.csv"), noise="standard", current=("0.5 m/s", "90 deg"), duration="420 s"
    )
    shipid.write_trial(voyage.trial, folder / "voyage.csv")
    shipid.write_trial(voyage.trial, folder / "nowhere.csv", comment="Simulated")
    ring = [[7.91, 53.97], [7.93, 53.97], [7.93, 53.98], [7.91, 53.98], [7.91, 53.97]]
    chart = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": {"layer": name, "DRVAL1": 2}, "geometry": {"type": kind, "coordinates": c}}
            for name, kind, c in (("LNDARE", "Polygon", [ring]), ("DEPARE", "Polygon", [ring]), ("DEPCNT", "LineString", ring), ("BOYLAT", "Point", ring[0]))
        ],
    }  # fmt: skip
    (folder / "chart.geojson").write_text(json.dumps(chart))
    return folder


def test_the_next_turn_from_a_voyage(call, folder, tmp_path):
    out = tmp_path / "out"
    arguments = (
        "--from",
        f"{folder / 'voyage.csv'}@300",
        "--route",
        str(folder / "elbe.csv"),
        "--chart",
        str(folder / "chart.geojson"),
    )
    answer = call(*SHIP, *arguments, "--out", str(out))
    assert answer.code == 0, answer
    said = " ".join(answer.out.split())
    assert "route 'elbe', next turn at waypoint 2 'B': 60" in said and "53°5" in said and "against the plan" in said
    known = json.loads((out / "result.json").read_text())
    assert (
        known["route"]["waypoint"] == 2 and known["chart"] == "chart" and known["route"]["limits_kept"] in (True, False)
    )
    assert known["route"]["wheel_over"]["time"]["value"] > 60 and known["route"]["warning"] is False
    assert known["route"]["wheel_over_place"]["lat"]["value"] == pytest.approx(53.99, abs=0.01)
    report = (out / "report.html").read_text()
    assert "chart &#39;chart&#39;" in report and "plan" in report and "Not for navigation" in report
    files = {i["name"].rsplit("/", 1)[-1] for i in known["provenance"]["inputs"]}
    assert {"elbe.csv", "chart.geojson", "voyage.csv"} <= files


def test_from_the_first_waypoint_and_from_a_state(call, folder):
    route = ("--route", str(folder / "elbe.csv"))
    first = call(*SHIP, *route, "--current", "2 kn to 90 deg", "--json")
    known = json.loads(first.out)
    assert first.code == 0 and known["origin"] == "the first waypoint"
    assert known["situation"]["psi"]["value"] == pytest.approx(-0.1085, abs=0.005)
    state = call(*SHIP, *route, "--from", "x=3000 m,y=20 m,psi=0 deg,u=9 m/s", "--json")
    assert json.loads(state.out)["route"]["off_track"]["value"] == pytest.approx(20)


def test_what_the_route_leaves_open_is_told(call, tmp_path):
    (tmp_path / "open.csv").write_text("lat,lon,note\n53.95,7.9,x\n54.00,7.9,y\n54.03,7.99,z\n")
    known = json.loads(call(*SHIP, "--route", str(tmp_path / "open.csv"), "--json").out)
    said = " ".join(w["message"] for w in known["warnings"])
    assert (
        "they are degrees" in said
        and "columns that no route has were not read: note" in said
        and "1 waypoint states no turn radius" in said
    )


def test_refusals(refused, folder):
    route = ("--route", str(folder / "elbe.csv"))
    refused(2, [*SHIP, *route, "--heading", "10 deg"], "leave out --heading, --rudder and --rate")
    refused(2, [*SHIP], "needs an order: --heading, --rudder, --rate or --route")
    refused(2, [*SHIP, *route, "--from", f"{folder / 'nowhere.csv'}@300"], "does not say where on the earth")
    refused(
        2, [*SHIP, "--heading", "9 deg", "--chart", str(folder / "chart.geojson")], "nothing says where x and y are 0"
    )
    refused(3, [*SHIP, *route, "--chart", str(folder / "elbe.csv")], "neither GeoJSON nor a cell")
    refused(3, [*SHIP, "--route", str(folder / "chart.geojson")], "chart.geojson")
    refused(3, [*SHIP, "--route", str(folder / "none.rtz")], "there is no file")
