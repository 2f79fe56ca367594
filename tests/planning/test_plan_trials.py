"""Information of a manoeuvre before it is sailed, and the choice of manoeuvres within a time."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.identification.uncertainty.information import candidate_of, covariance_from, eliminate, gather
from shipid.parameters.catalogue import find_model, find_ship
from shipid.planning.planning_problem import TimeTooShortError, planning_problem
from shipid.planning.selection import CandidateTable, choose, value_of
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre
from shipid.trials.manoeuvres.simulate import NotSailedError

_WILD = {"values": {"K": "0.5 1/s", "tau": "-0.02 s", "n3": "0 s^2/rad^2"}}
QUICK = {"draws": 2, "repertoire": ["zigzag:10/10", "zigzag:20/10", "zigzag:30/30", "telegraph:20", "turn:20"]}


def problem_of(model: str, ship: str, time: str = "15 min", **changed):
    usual = {
        **dict.fromkeys(("speed", "estimate", "sampling", "correlation", "between")),
        **{"noise": "standard", "values": {}, "spread": 0.2, "draws": 0, "seed": 0},
    }
    return planning_problem(find_model(model), find_ship(ship), time, **{**usual, **changed})


def planned(model: str = "norrbin", ship: str = "zeefakkel", time: str = "15 min", **options):
    return shipid.plan_trials(model, ship, time, **{**QUICK, **options})


@pytest.fixture(scope="module")
def plan():
    return planned()


@pytest.mark.parametrize(
    ("model", "ship", "text"),
    [
        ("norrbin", "zeefakkel", "zigzag:20/20"),
        ("de-keizer", "soesterberg", "telegraph:10"),
        ("nomoto", "mariner", "turn:15"),
    ],
)
def test_information_is_that_of_identification(model, ship, text):
    """The same record, noise and unknowns: the Cramer-Rao bound of `identify` at the truth."""
    asked = problem_of(model, ship)
    experiment, candidate = asked.experiment, candidate_of(text, asked.speeds[0])
    interval, speed = experiment.interval(candidate.speed), candidate.speed
    delta = experiment.rudder_of(candidate, 600.0, asked.known)
    t = np.arange(delta.size) * interval
    inputs = {"u": speed, "cruise": speed, "delta": delta}
    run = experiment.simulator(t, asked.known, inputs, {"u": speed, "psi": 0.0})
    columns = {"t": t, "delta": delta, **run.columns}
    units = {n: FIELDS[n].unit for n in columns}
    trial = shipid.Trial.from_frame(pd.DataFrame(columns), name="clean", units=units)
    noise = {n: (s, units[n]) for n, s in zip(experiment.signals, experiment.sigma)}
    fit = shipid.identify(model, [trial], ship=ship, noise=noise, signals=experiment.signals, starts=1)
    assert fit.converged and fit.estimated == experiment.estimated
    solution = fit.identified.solution
    # Of the samples alone: what is believed beforehand is no information of the trial.
    _, jacobian = replace(solution.problem, prior=None).residuals(solution.q)
    norms = np.linalg.norm(jacobian, axis=0)
    count = len(fit.estimated)
    whole = np.linalg.inv((jacobian / norms).T @ (jacobian / norms)) / np.outer(norms, norms)
    sampled = replace(experiment, rate=1 / interval)
    mine = sampled.information(candidate, [600.0], asked.known, np.ones(count))[0]
    # The search ends within its tolerance of the truth, not at it.
    assert np.sqrt(np.diag(covariance_from(mine))) == pytest.approx(np.sqrt(np.diag(whole[:count, :count])), rel=1e-3)


def test_steady_turn_of_nomoto_in_closed_form():
    """psi = psi0 + K delta (t - tau) once the ship turns: a straight line, whose slope is known with sigma sqrt(12/(N T^2))."""
    asked = problem_of("nomoto", "zeefakkel", estimate=["K"], noise="psi=0.2 deg", values={"tau": "0.5 s"})
    experiment = replace(asked.experiment, biases=(), rate=1.0, initial=("psi",))
    rudder, speed = np.deg2rad(10), 5.0
    turn = candidate_of("turn:10/100000", speed)
    gain = 3000.0
    info = experiment.information(turn, [gain], asked.known, np.ones(1))[0, 0, 0]
    begin = 45.0 / speed + 1.0  # the approach of one L/U, then the rudder takes 10 deg/s
    line = gain - begin
    # Zero before the turn, a slope of delta after it, and an unknown level: the variance of that broken line about its mean.
    mean, square = rudder * line**2 / 2 / gain, rudder**2 * line**3 / 3 / gain
    expected = gain * (square - mean**2) / np.deg2rad(0.2) ** 2
    # The servo's lag and tau delay the line by about a second in three thousand.
    assert info == pytest.approx(expected, rel=5e-3)


def test_schur_complement_is_the_block_of_the_inverse():
    rng = np.random.default_rng(1)
    jacobian = rng.standard_normal((200, 7)) * np.array([1, 10, 0.1, 1e3, 1, 1e-3, 5])
    kept = eliminate(jacobian, 3)
    assert np.linalg.inv(kept) == pytest.approx(np.linalg.inv(jacobian.T @ jacobian)[:3, :3], rel=1e-8)


def test_nuisances_that_cannot_be_told_apart_count_once():
    rng = np.random.default_rng(2)
    jacobian = rng.standard_normal((100, 4))
    doubled = np.column_stack([jacobian, jacobian[:, 3], np.zeros(100)])
    assert eliminate(doubled, 2) == pytest.approx(eliminate(jacobian, 2), rel=1e-9)
    assert eliminate(jacobian, 4) == pytest.approx(jacobian.T @ jacobian)


def test_lengths_of_one_run_are_runs_of_their_own():
    rng = np.random.default_rng(3)
    slope = rng.standard_normal((2, 5, 90))
    for end, triangle in zip((20, 55, 90), gather(slope, (20, 55, 90))):
        part = slope[:, :, :end].transpose(0, 2, 1).reshape(-1, 5)
        assert triangle.T @ triangle == pytest.approx(part.T @ part)
    asked = problem_of("norrbin", "zeefakkel")
    for text in ("zigzag:20/20", "telegraph:20"):
        both = asked.experiment.information(candidate_of(text, 5.0), [200.0, 400.0], asked.known, asked.size)
        alone = asked.experiment.information(candidate_of(text, 5.0), [200.0], asked.known, asked.size)
        assert both[0] == pytest.approx(alone[0], rel=1e-9)
        assert np.linalg.eigvalsh(both[1] - both[0]).min() >= -1e-9 * np.trace(both[1]), "more samples tell no less"


def test_matrices_of_trials_add():
    """Two trials with unknowns of their own: eliminating all nuisances at once is the sum of the parts."""
    rng = np.random.default_rng(4)
    a, b = rng.standard_normal((60, 5)), rng.standard_normal((80, 5))
    joint = np.zeros((140, 8))
    joint[:60, :5], joint[60:, :2], joint[60:, 5:] = a, b[:, :2], b[:, 2:]
    assert eliminate(joint, 2) == pytest.approx(eliminate(a, 2) + eliminate(b, 2))


def test_covariance_is_infinite_where_nothing_is_known():
    matrix = covariance_from(np.array([[4.0, 0, 0], [0, 1, 1], [0, 1, 1]]))
    assert matrix[0, 0] == pytest.approx(0.25)
    assert np.isinf(np.diag(matrix)[1:]).all()
    assert np.isinf(np.diag(covariance_from(np.zeros((2, 2))))).all()


def test_criteria_in_closed_form():
    information = np.stack([np.diag([100.0, 25.0]), np.diag([4.0, 1.0])])
    assert value_of(information, "D") == pytest.approx((np.log(2500) + np.log(4)) / 4, abs=1e-5)
    assert value_of(information, "A", worst=True) == pytest.approx(-np.log((0.25 + 1) / 2), abs=1e-5)
    with pytest.raises(UnknownNameError, match="criterion"):
        value_of(information, "E")


def table_of(seed: int, time: float) -> CandidateTable:
    rng = np.random.default_rng(seed)
    halves = rng.standard_normal((12, 2, 3, 3)) * rng.uniform(0.1, 3, (12, 1, 1, 1))
    speed = np.repeat([5.0, 4.0], 6)
    return CandidateTable(
        halves @ halves.swapaxes(-1, -2),
        rng.uniform(5, 12, 12),
        speed,
        np.repeat([2.0, 2.5], 6),
        np.arange(12) // 3,
        time,
    )


@pytest.mark.parametrize("seed", range(8))
def test_choice_fits_the_time_and_comes_near_the_best_of_all(seed):
    table = table_of(seed, 30.0)

    def every(chosen, first):
        yield chosen
        for c in range(first, 12):
            if table.total(chosen)[c] <= table.time:
                yield from every([*chosen, c], c)

    best = max(table.of(c) for c in every([], 0) if c)
    chosen = choose(table, [])
    assert table.total(chosen[:-1])[chosen[-1]] <= table.time + 1e-6
    # Exchange is a local search; of 3 dimensions per coefficient it loses little.
    assert table.of(chosen) >= best - 0.05


def test_time_of_a_choice():
    table = table_of(0, 100.0)
    d = table.duration
    assert table.total([])[3] == pytest.approx(d[3])
    assert table.total([0])[3] == pytest.approx(d[0] + 2.0 + d[3])
    # A slower manoeuvre waits for the ship to slow down: its approach counts twice.
    assert table.total([0, 1])[7] == pytest.approx(d[0] + 2.0 + d[1] + 2 * 2.5 + d[7])
    assert table.total([7])[0] == pytest.approx(d[0] + 2 * 2.5 + d[7])


def test_choice_is_no_worse_than_what_it_begins_with():
    for seed in range(5):
        table = table_of(seed, 40.0)
        assert table.of(choose(table, [[5, 11]])) >= table.of([5, 11])


def test_a_plan(plan):
    assert plan.duration <= plan.time + 1e-6
    assert plan.value >= plan.standard_value
    assert plan.det_gain > 1 and plan.det_gain == pytest.approx(plan.det_ratio ** (1 / 3))
    assert [leg.manoeuvre for leg in plan.standard] == ["zigzag:10/10", "zigzag:20/20"]
    usual = plan.standard[-1]
    assert usual.start + usual.duration == pytest.approx(plan.time, abs=2.0)
    for leg in (*plan.legs, *plan.standard):
        assert str(parse_manoeuvre(leg.manoeuvre)) == leg.manoeuvre
    gaps = [b.start - a.start - a.duration for a, b in zip(plan.legs, plan.legs[1:])]
    assert gaps == pytest.approx([45.0] * len(gaps)), "five L/U"
    text = plan.text()
    for word in ("norrbin", "zeefakkel", "psi, r", "determinant", plan.legs[0].manoeuvre, "b3"):
        assert word in text
    large = dataclasses.replace(plan, det_ratio=1220.0).text()
    assert "(1220 in all)" in large, "no power of ten as programs write it"
    assert list(plan.to_frame()["start [s]"]) == [leg.start for leg in plan.legs]


@pytest.mark.parametrize(
    "options", [{"criterion": "A"}, {"worst_case": True}, {"draws": 0}, {"repertoire": ["zigzag:5/5"]}]
)
def test_a_plan_is_never_worse_than_the_standard_in_its_own_criterion(options):
    found = planned(**options)
    assert found.value >= found.standard_value - 1e-9


def test_more_time_tells_no_less():
    values = [planned(time=f"{t} min").value for t in (6, 9, 15, 25)]
    assert values == sorted(values)


def test_the_seed_decides(plan):
    assert planned().to_dict() == plan.to_dict()
    assert planned(seed=5).to_dict() != plan.to_dict()


def test_plain_values(plan):
    plain = json.loads(json.dumps(plan.to_dict(), allow_nan=False))
    assert plain["plan"][0]["start"]["value"] == 0 and plain["plan"][0]["manoeuvre"] == plan.legs[0].manoeuvre
    assert set(plain["gain_over_standard"]) == {"det", "a", "b1", "b3"}
    assert plain["gain_over_standard"]["b3"] == pytest.approx(
        plain["parameters"]["b3"]["standard_std"] / plain["parameters"]["b3"]["std"]
    )


def test_correlated_noise_and_sampling_count():
    white = planned(draws=0, sampling="1 s")
    wavy = planned(draws=0, sampling="1 s", correlation="4 s")
    for name, forecast in white.parameters.items():
        assert wavy.parameters[name].standard_std == pytest.approx(2 * forecast.standard_std, rel=1e-6)
    assert planned(draws=0, sampling="5 s", correlation="4 s").independent == 5.0


def test_speeds_of_a_model_that_is_scaled():
    found = planned(
        "de-keizer", "soesterberg", "40 min", draws=0, speed=["9.5 m/s", "12 kn"], repertoire=["zigzag:10/10"]
    )
    assert {leg.speed for leg in found.legs} <= {9.5, 12 * 1852 / 3600}
    assert problem_of("de-keizer", "soesterberg").speeds == (9.5, 7.125)
    assert problem_of("norrbin", "zeefakkel").speeds == (5.0,)


def test_a_coefficient_nothing_shows_is_said():
    found = planned(
        "de-keizer", "soesterberg", noise="psi=0.2 deg,r=0.02 deg/s,u=0.1 m/s", repertoire=["zigzag"], draws=0
    )
    assert found.parameters["gamma"].std is None and found.parameters["gamma"].ratio is None
    assert any(w.startswith("gamma stays undetermined: no manoeuvre") for w in found.warnings)
    assert found.det_gain > 1
    assert "stays open beside stays open" in found.text()


def test_a_coefficient_that_stays_open_is_said():
    found = planned(
        "nomoto", "zeefakkel", "2 min", noise="psi=90 deg", correlation="60 s", draws=0, repertoire=["zigzag:5/5"]
    )
    assert any("stays undetermined: its standard deviation is" in w for w in found.warnings)


def test_what_is_left_out_is_said():
    found = planned(repertoire=["zigzag:35/35", "zigzag:20/20"])
    assert any("35 deg exceed the 30 deg of ship zeefakkel" in w for w in found.warnings)
    assert all(leg.manoeuvre == "zigzag:20/20" for leg in found.legs if leg not in found.standard)
    found = planned(
        "de-keizer", "soesterberg", repertoire=["turn:30", "zigzag:10/10"], draws=0, values={"K_u": "0.9 1"}
    )
    assert any("turns with 30 deg of rudder are not sailed by this model (de-keizer)" in w for w in found.warnings)
    # A course change holds an unstable ship on a course, where a run of the model over the rudder leaves her.
    found = planned("bech-surge", "kvlcc2-7m", repertoire=["course:90/30", "zigzag:10/10"], draws=0, speed="1.178 m/s")
    assert not any(leg.manoeuvre.startswith("course") and leg.duration > 300 for leg in found.legs)


def test_a_short_time_is_compared_with_one_zigzag():
    found = planned(time="2 min")
    assert [leg.manoeuvre for leg in found.standard] == ["zigzag:20/20"]
    assert any("too short for both" in w for w in found.warnings)


@pytest.mark.parametrize(
    ("error", "options", "words"),
    [
        (TimeTooShortError, {"time": "10 s"}, ("too short", "takes 72 s", "zeefakkel")),
        (UsageError, {"time": "1e6 min"}, ("5000 times", "a part of it")),
        (UsageError, {"time": -5.0}, ("greater than zero",)),
        (UnknownNameError, {"model": "norbin"}, ("norrbin",)),
        (UnknownNameError, {"ship": "zeefakel"}, ("zeefakkel",)),
        (UnknownNameError, {"criterion": "E"}, ("criterion", "D")),
        (UnknownNameError, {"repertoire": ["zigzg"]}, ("zigzag",)),
        (UnknownNameError, {"estimate": ["b4"]}, ("'b4'", "b3")),
        (UsageError, {"estimate": []}, ("no parameter of model",)),
        (UsageError, {"repertoire": []}, ("repertoire is empty",)),
        (UsageError, {"repertoire": ["turn:35"]}, ("can be sailed", "30 deg")),
        (UsageError, {"noise": "none"}, ("without noise",)),
        (UsageError, {"noise": "x=10 m"}, ("without noise",)),
        (UsageError, {"speed": "4 m/s,5 m/s"}, ("one speed",)),
        (UsageError, {"spread": 0.0}, ("no prior",)),
        (UsageError, {"values": {"psi": "1 rad"}}, ("'psi'", "no coefficient")),
        (UsageError, {"model": "pershitz-track", "ship": "semerdjiev"}, ("no rudder",)),
        (ParameterSetError, {"model": "pershitz"}, ("q21", "zeefakkel", "[pershitz]")),
        (NotSailedError, _WILD, ("can be sailed", "no steady turn")),
        (
            NotSailedError,
            {**_WILD, "repertoire": ["reversed-spiral"]},
            ("every manoeuvre of the repertoire is not sailed by this model",),
        ),
    ],
)
def test_refusals(error, options, words):
    with pytest.raises(error) as caught:
        planned(**options)
    for word in words:
        assert word in str(caught.value)


def test_a_ship_without_length_or_speed():
    ship = find_ship("zeefakkel")
    for lost, word in (("L", "length"), ("speed", "--speed")):
        particulars = {n: v for n, v in ship.sections["particulars"].items() if n != lost}
        with pytest.raises(ParameterSetError, match=word):
            planned(ship=replace(ship, sections={**ship.sections, "particulars": particulars}))


def test_without_the_standard_nothing_is_compared():
    found = planned("de-keizer", "soesterberg", values={"K": "5 1", "K_u": "0.9 1"}, repertoire=["zigzag:5/5"], draws=1)
    assert found.standard == () and found.det_gain is None and found.to_dict()["gain_over_standard"]["det"] is None
    assert any("not compared with it" in w for w in found.warnings)
    assert "no standard" in found.text()
    json.dumps(found.to_dict(), allow_nan=False)


def test_draws_that_cannot_sail_the_standard_are_drawn_anew(monkeypatch):
    wide = {"spread": 1.5, "draws": 12, "repertoire": ["zigzag:5/5"]}
    found = planned("de-keizer", "soesterberg", **wide)
    assert found.standard and found.draws == 12
    monkeypatch.setattr("shipid.planning.planning_problem.SPARE_DRAWS", 1)
    found = planned("de-keizer", "soesterberg", **wide)
    assert found.standard and 0 < found.draws < 12, "with a wide prior some De Keizer ships lose their way in a 20/20"
    assert any(f"under {found.draws} of 12 draws the standard zig-zags can be sailed" in w for w in found.warnings)
