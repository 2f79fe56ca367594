"""The sheet of a trial day against simulations whose numbers are known, and its limits against the sentences of the standard."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

import shipid
from shipid.criteria.measured.measured_criteria import measured_criteria
from shipid.criteria.measured.trial_sheet import trial_sheet
from shipid.foundation.errors import UnitError, UsageError
from shipid.report.write_report import render
from shipid.trials.conditions import Conditions
from shipid.trials.errors import TrialError
from shipid.trials.measuring.measure import measure

LENGTH = "226 m"


@pytest.fixture(scope="module")
def day():
    """Two zig-zags and a turning circle of one ship, as three logs."""
    sailed = {"zigzag:10/10": "ten", "zigzag:-20/20": "twenty", "turn:35": "turn"}
    return [shipid.simulate("de-keizer", ship="soesterberg", manoeuvre=m, name=n) for m, n in sailed.items()]


@pytest.fixture(scope="module")
def sheet(day):
    return trial_sheet(day, length=LENGTH)


def test_every_manoeuvre_is_measured_as_measure_does(day, sheet):
    assert [m.measures.kind for m in sheet.manoeuvres] == ["zig-zag", "zig-zag", "turning circle"]
    for trial, sailed in zip(day, sheet.manoeuvres):
        assert sailed.measures.to_dict() == measure(trial, length=LENGTH).to_dict()
    assert not sheet.not_measured


def test_the_criteria_are_those_that_the_standard_has_for_each_manoeuvre(sheet):
    found = [(row.manoeuvre, row.key) for row in sheet.criteria]
    assert found == [
        (1, "initial_turning"), (1, "first_overshoot_10"), (1, "second_overshoot_10"), (2, "first_overshoot_20"),
        (3, "advance"), (3, "transfer"), (3, "tactical_diameter"),
    ]  # fmt: skip


def test_limits_of_overshoots_follow_the_time_of_a_length(sheet):
    ten = sheet.manoeuvres[0].measures
    time = 226.0 / ten.approach_speed
    rows = {row.key: row for row in sheet.criteria}
    # MSC.137(76) 5.3.3.1: 10 deg below 10 s, 20 deg from 30 s on, (5 + L/V / 2) between.
    assert 10 < time < 30
    assert rows["first_overshoot_10"].limit == pytest.approx(5 + time / 2)
    assert rows["second_overshoot_10"].limit == pytest.approx(17.5 + 0.75 * time)
    assert rows["advance"].value == pytest.approx(sheet.manoeuvres[2].measures.advance / 226.0, rel=0.02)


def altered(measures, **changed):
    return dataclasses.replace(measures, **changed)


@pytest.mark.parametrize(
    ("overshoot", "margin", "verdict"),
    [
        (24.0, 0.5, "within"),
        (25.2, 0.5, "not decided"),
        (24.8, 0.5, "not decided"),
        (26.0, 0.5, "beyond"),
        (26.0, None, "beyond"),
    ],
)
def test_a_limit_inside_the_uncertainty_decides_nothing(sheet, overshoot, margin, verdict):
    own = sheet.manoeuvres[1].measures
    margins = (None if margin is None else np.radians(margin), *own.overshoot_uncertainties[1:])
    changed = altered(own, overshoots=(np.radians(overshoot), *own.overshoots[1:]), overshoot_uncertainties=margins)
    [row] = measured_criteria(1, changed, 226.0)
    assert row.verdict == verdict


@pytest.mark.parametrize(
    ("diameter", "margin", "verdict"), [(4.9, 0.05, "within"), (4.9, 0.2, "not decided"), (5.3, 0.2, "beyond")]
)
def test_a_limit_inside_the_uncertainty_of_a_diameter_decides_nothing(sheet, diameter, margin, verdict):
    own = next(m.measures for m in sheet.manoeuvres if m.measures.kind == "turning circle")
    length = 226.0
    changed = altered(
        own,
        rudder=np.radians(35.0),
        tactical_diameter=diameter * length,
        tactical_diameter_uncertainty=margin * length,
        tactical_diameter_still_water=None,
    )
    rows = {row.key: row for row in measured_criteria(1, changed, length)}
    assert rows["tactical_diameter"].verdict == verdict
    ends = rows["tactical_diameter"].to_dict()["measured"]["interval_95"]
    assert ends == pytest.approx([diameter - margin, diameter + margin])


def test_a_circle_with_little_rudder_is_not_the_one_of_the_standard(sheet):
    own = sheet.manoeuvres[2].measures
    rows = {r.key: r for r in measured_criteria(1, altered(own, rudder=np.radians(20.0)), 226.0)}
    assert rows["advance"].verdict == "not decided" and "20 deg" in rows["advance"].words
    assert rows["transfer"].verdict == "no limit"


def test_drift_is_taken_off_where_the_circle_shows_it(sheet):
    own = sheet.manoeuvres[2].measures
    rows = {r.key: r for r in measured_criteria(1, altered(own, advance_still_water=300.0), 226.0)}
    assert rows["advance"].value == pytest.approx(300 / 226.0) and "drift" in rows["advance"].words


def test_without_a_length_nothing_that_needs_it_is_decided(day):
    bare = trial_sheet(day)
    verdicts = {row.key: row.verdict for row in bare.criteria}
    assert verdicts.pop("first_overshoot_20") == "within"
    assert set(verdicts.values()) == {"not decided"}
    assert "length-unknown" in [w.kind for w in bare.warnings]


def test_a_length_of_the_model_beside_the_track_of_the_ship_is_told(day):
    doubtful = trial_sheet(day[2], length="5 m")
    assert [w.kind for w in doubtful.warnings if w.serious] == ["ship-length", "length-doubtful"]


def test_a_log_that_fails_costs_the_others_nothing(day, tmp_path):
    torn = tmp_path / "torn.csv"
    torn.write_text("t [s],psi [deg]\n0,x\n", encoding="utf-8")
    straight = shipid.Trial.from_frame(day[0].table[["t", "psi", "delta"]].assign(delta=0.0, psi=0.0), name="straight",
                                       units={"t": "s", "psi": "rad", "delta": "rad"})  # fmt: skip
    mixed = trial_sheet([torn, straight, day[0]], length=LENGTH)
    assert [m.number for m in mixed.manoeuvres] == [1]
    assert [one.trial for one in mixed.not_measured] == [str(torn), "straight"]
    [warning] = [w for w in mixed.warnings if w.kind == "not-measured"]
    assert warning.serious
    readable = trial_sheet([straight, day[0]], length=LENGTH)
    assert not any(w.serious for w in readable.warnings), "a log without a manoeuvre does not spoil the others' numbers"
    [nothing] = [w for w in trial_sheet([straight, straight], length=LENGTH).warnings if w.kind == "not-measured"]
    assert nothing.serious, "a sheet without a single number is no sheet"
    with pytest.raises(TrialError):
        trial_sheet(torn)


def test_a_log_of_several_manoeuvres_is_measured_in_parts(day):
    first, second = day[0].table, day[1].table.copy()
    second["t"] += first["t"].iloc[-1] + 60
    for name in ("psi", "x", "y"):
        second[name] += first[name].iloc[-1]
    import pandas as pd

    both = pd.concat([first, second], ignore_index=True)
    units = {name: day[0].unit(name) for name in both.columns}
    found = trial_sheet(shipid.Trial.from_frame(both, name="both", units=units), length=LENGTH)
    assert [m.measures.nominal for m in found.manoeuvres] == ["10/10", "20/20"]
    assert found.manoeuvres[1].measures.overshoots[0] == pytest.approx(
        measure(day[1]).overshoots[0], abs=np.radians(0.3)
    )


def test_what_is_stated_goes_before_the_log_and_logs_that_differ_leave_a_blank(day):
    def stating(trial, **values):
        return dataclasses.replace(trial, source=dataclasses.replace(trial.source, conditions=Conditions(values)))

    logs = [stating(day[0], place="North", depth=40.0, length=226.0), stating(day[1], place="South", depth=40.0)]
    found = trial_sheet(logs, conditions=Conditions({"depth": 60.0}))
    assert found.length == 226.0
    assert found.conditions.shown("depth") == "60 m" and found.conditions.shown("place") is None


def test_the_ship_gives_her_length(day):
    assert trial_sheet(day[0], ship="soesterberg").length == 226.0


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"trials": []}, UsageError, "needs a trial"),
        ({"length": "0 m"}, UsageError, "no ratios"),
        ({"length": "45"}, UnitError, "unit"),
    ],
)
def test_what_cannot_be_asked(day, arguments, error, words):
    with pytest.raises(error, match=words):
        trial_sheet(**{"trials": day[0], **arguments})


def test_the_sheet_is_strict_json_and_a_table(sheet):
    told = json.loads(json.dumps(sheet.to_dict(), allow_nan=False))
    assert told["conditions"]["who"] is None and len(told["criteria"]) == 7
    frame = sheet.to_frame()
    assert set(frame["manoeuvre"]) == {1, 2, 3}


def test_the_page_shows_plots_verdicts_poster_and_blanks(sheet):
    page = render(sheet)
    assert page.count("<svg") == 3
    blanks = sum(v is None for _, v in sheet.conditions.lines()) + sum(e.value is None for e in sheet.form)
    assert page.count('class="blank"') == blanks > 10
    assert (
        "Turning circles for the wheelhouse poster" in page
        and "NaN" not in page
        and "nan" not in page.lower().split(">")
    )
    overshoot = f"{np.degrees(sheet.manoeuvres[1].measures.overshoots[0]):.1f}°"
    assert overshoot in page
    circle = sheet.manoeuvres[2].measures
    assert f"advance {circle.told('advance', circle.advance, 'm')} m" in page


def test_the_form_follows_from_what_is_stated(day):
    """By hand: L/B, B/T, block coefficient, rudder area, trim, depth; and what the standard asks of the surroundings."""
    stated = Conditions(
        {"breadth": 30.0, "draught_forward": 9.0, "draught_aft": 11.0, "displacement": 4.1e7, "rudder_area": 45.2,
         "depth": 35.0, "wind_speed": 11.0}
    )  # fmt: skip
    sheet = trial_sheet(day, length=LENGTH, conditions=stated)
    form = {e.name: e for e in sheet.form}
    speed = np.mean([m.measures.approach_speed for m in sheet.manoeuvres])
    expected = {
        "test_speed": speed, "length_over_speed": 226 / speed, "length_over_breadth": 226 / 30, "breadth_over_draught": 3.0,
        "block_coefficient": 40000 / (226 * 30 * 10), "rudder_area_ratio": 45.2 / 2260, "trim": 2.0, "depth_over_draught": 3.5,
        "beaufort": 6,
    }  # fmt: skip
    assert {n: e.value for n, e in form.items()} == pytest.approx(expected)
    assert [e.name for e in sheet.form if e.met is False] == ["depth_over_draught", "beaufort"]
    [notice] = [n for n in sheet.warnings if n.kind == "surroundings"]
    assert "Water depth / draught 3.5 (more than 4); Beaufort number of the wind 6 (at most 5)" in notice
    page = render(sheet)
    assert page.count('class="no">3.5') == 1 and "Form of MSC/Circ.1053" in page
    assert {e["name"]: e["value"] for e in sheet.to_dict()["form"]} == pytest.approx(expected)
    bare = trial_sheet(day, length=LENGTH)
    assert [e.name for e in bare.form if e.value is not None] == ["test_speed", "length_over_speed"]
    assert not any(n.kind == "surroundings" for n in bare.warnings)


def test_a_circle_with_the_largest_rudder_of_the_ship_is_the_one_of_the_standard(sheet):
    circle = altered(sheet.manoeuvres[2].measures, rudder=np.radians(30.0))
    for largest, verdict in ((None, "not decided"), (30.0, "within"), (45.0, "not decided")):
        rows = measured_criteria(3, circle, 226.0, None if largest is None else np.radians(largest))
        assert next(r for r in rows if r.key == "advance").verdict == verdict
    assert "state largest_rudder" in next(iter(measured_criteria(3, circle, 226.0))).words


def test_a_log_with_speeds_over_ground_only_has_speeds(day):
    """A receiver of positions, a compass and a rudder: the speeds are said to be over the ground."""
    for one in (day[0], day[2]):
        table = one.table.drop(columns=["u"]).assign(SOG=one.table["u"])
        found = measure(dataclasses.replace(one, table=table), length=LENGTH)
        whole = measure(one, length=LENGTH)
        assert found.approach_speed == pytest.approx(whole.approach_speed, rel=1e-4)
        assert any("over the ground" in note for note in found.notes)
        assert not any("over the ground (SOG)" in note for note in whole.notes)
    assert found.speeds == pytest.approx(one["u"][[int(t + found.first_execute) for t in found.times]], rel=0.01)
    assert found.speed_loss is None
    assert found.track == "positions"


def test_a_quantity_or_a_reason_of_several_manoeuvres_is_told_once(day):
    words = render(trial_sheet([day[0], day[0]], length=LENGTH))
    assert "10/10 first overshoot of manoeuvres 1 and 2" in words
    circle = render(trial_sheet(day[2], length=LENGTH))
    assert circle.count("The drift of the circle is not beyond its uncertainty") <= 1


def test_a_loop_that_is_not_known_says_why():
    """Held for 12 L/U a stage, a tanker that is hardly unstable has not settled near the middle."""
    text = trial_sheet([shipid.simulate("norrbin", "kvlcc2", "spiral:20", sampling="5 s")], length=320.0).text()
    assert "loop width not known, loop height not known: the rate of turn had not settled in stage" in text


def test_the_text_says_that_there_are_more_overshoots(sheet):
    several = sheet.manoeuvres[0].measures.overshoots
    assert len(several) > 4 and f"deg (the first 4 of {len(several)}); period" in sheet.text()


def test_why_a_circle_decides_nothing_is_said_once_below_its_first_quantity(day):
    """The same three lines stood below the advance and the tactical diameter of each of four circles."""
    turned = day[2].table.assign(delta=day[2].table["delta"] / 2)
    if "delta_order" in turned:
        turned["delta_order"] /= 2
    one = trial_sheet([dataclasses.replace(day[2], table=turned)], length=LENGTH)
    undecided = [row for row in one.criteria if row.verdict == "not decided"]
    assert len(undecided) == 2 and undecided[0].words == undecided[1].words
    assert render(one).count("The standard turns with 35 deg of rudder") == 1


def test_a_page_says_what_stands_after_plus_or_minus(sheet, day):
    page = render(sheet)
    assert "After ±: the 95 % uncertainty." in page and "± is the 95 % uncertainty." in page
    assert "After ±" not in render(
        trial_sheet([dataclasses.replace(day[2], table=day[2].table.drop(columns=["x", "y"]))], length=LENGTH)
    ), "a reckoned circle has none"
