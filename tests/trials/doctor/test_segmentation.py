"""Manoeuvres in simulated and real logs: kinds, angles, ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from shipid.trials.doctor.check_trial import check_trial

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT.parent / "shared" / "data"


def real(campaign, file):
    path = DATA / campaign / file
    if not path.exists():
        pytest.skip(f"the trial data of {campaign} are not on this machine")
    return check_trial(path, format=ROOT / "studies" / "formats" / f"{campaign}.toml")


@pytest.mark.parametrize(
    ("manoeuvre", "rudder", "heading", "side"),
    [("zigzag:20/20", 20, 20, "starboard"), ("zigzag:-10/10", 10, 10, "port"), ("zigzag:20/10", 20, 10, "starboard")],
)
@pytest.mark.parametrize("noise", ["none", "standard"])
def test_zigzag_has_its_angles(simulated, manoeuvre, rudder, heading, side, noise):
    found = [m for m in check_trial(simulated(manoeuvre, noise)).manoeuvres if m.kind == "zigzag"]
    assert len(found) == 1
    assert (found[0].rudder_deg, found[0].heading_deg, found[0].side) == (rudder, heading, side)
    assert found[0].regular


def test_turn_with_pull_out(simulated):
    found = check_trial(simulated("turn:35", "none")).manoeuvres
    assert [m.kind for m in found[:3]] == ["steady", "turn", "pull-out"]
    # Rudder amidships; the course change of a pull-out is not asked for.
    assert (found[2].rudder_deg, found[2].heading_deg, found[2].side) == (0.0, None, found[1].side)


def test_telegraph_is_no_regular_zigzag(simulated):
    found = check_trial(simulated("telegraph:10", "none")).manoeuvres
    assert not any(m.kind == "zigzag" and m.regular for m in found)


def test_the_long_log_of_the_gunnerus():
    found = [m for m in real("gunnerus", "RVG_ManeuveringTests_part1.csv").manoeuvres if m.kind == "zigzag"]
    for start, end, rudder, heading in ((1622, 1712, 10, 10), (1958, 2195, 10, 20), (2690, 2900, 5, 10)):
        best = min(found, key=lambda m: abs(m.start - start) + abs(m.end - end))
        assert abs(best.start - start) < 15 and abs(best.end - end) < 15
        assert (best.rudder_deg, best.heading_deg) == (rudder, heading)


@pytest.mark.parametrize(
    ("campaign", "file", "rudder", "heading"),
    [
        ("kvlcc2-marin", "MARIN_FREE_KVLCC2_zz_20_m.dat", 20, 20),
        ("kvlcc2-marin", "MARIN_FREE_KVLCC2_zz_10_m.dat", 10, 10),
        ("kvlcc2-hsva", "HSVA_CPMC_KVLCC2_Z_20_10_S.dat", 20, 10),
        ("kvlcc2-hsva", "HSVA_CPMC_KVLCC2_Z_35_05.dat", 35, 5),
        ("esso-osaka", "zigzag_31-Jul-2020_13_42_53.csv", 30, 30),
        ("esso-osaka", "zigzag_31-Jul-2020_14_03_39.csv", 20, 20),
    ],
)
def test_zigzags_of_the_campaigns(campaign, file, rudder, heading):
    found = [m for m in real(campaign, file).manoeuvres if m.kind == "zigzag"]
    assert [(m.rudder_deg, m.heading_deg) for m in found] == [(rudder, heading)]


def test_the_turning_circle_of_marin():
    turn, out = real("kvlcc2-marin", "MARIN_FREE_KVLCC2_tc_35_m.dat").manoeuvres[1:3]
    assert (turn.kind, turn.rudder_deg, turn.side) == ("turn", 35, "port")
    assert turn.heading_deg > 650
    assert out.kind == "pull-out"


@pytest.mark.parametrize(
    ("campaign", "file", "kinds"),
    [
        (
            "kvlcc2-marin", "MARIN_FREE_KVLCC2_zz_20_m.dat",
            {"clock-quantised", "clock-repeats", "trailing-empty", "earth-fixed-velocity", "rudder-sign"},
        ),
        ("kvlcc2-hsva", "HSVA_CPMC_KVLCC2_Z_20_10_S.dat", {"earth-fixed-velocity", "rudder-sign"}),
        ("gunnerus", "RVG_ManeuveringTests_part1.csv", {"heading-interpolated", "rudder-sign", "speed-scale"}),
    ],
)  # fmt: skip
def test_traps_the_format_file_puts_right_are_named_as_handled(campaign, file, kinds):
    diagnosis = real(campaign, file)
    assert kinds <= {f.kind for f in diagnosis.findings if f.handled}
    assert not kinds & {f.kind for f in diagnosis.findings if not f.handled}
