"""Simulated manoeuvres: what the helmsman, the rudder, the sensors and the current do, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from shipid import (
    Component,
    ParameterSet,
    Trial,
    constant,
    find_model,
    find_ship,
    given,
    join,
    output,
    parameter,
    read_trial,
    simulate,
    state,
    write_trial,
)
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ParameterSetError, UnitError, UnknownNameError, UsageError
from shipid.models import DeKeizer, FaultyCompass, PlanarMotion, VanLeeuwenSway, WaveMoment
from shipid.parameters.parameter_set import Value
from shipid.trials.manoeuvres.simulate import NotSailedError

DEG = np.pi / 180


def sail(manoeuvre: str, model: str = "de-keizer", ship: str | ParameterSet = "soesterberg", **options: Plain) -> Trial:
    return simulate(model, ship, manoeuvre, **options)


@pytest.mark.parametrize("side", [1, -1])
def test_zigzag_executes(side: int) -> None:
    """The rudder is ordered over at 20 deg, within the heading turned in one interval of the simulation (a quarter s)."""
    trial = sail(f"zigzag:{20 * side}/20", sampling="0.25 s", heading="70 deg")
    order, swing = trial["delta_order"], trial["psi"] - 70 * DEG
    at = np.flatnonzero(np.diff(order)) + 1
    assert at.size >= 5
    first = trial["t"][at[0]]
    assert first == pytest.approx(226 / 9.5, abs=0.25)
    assert order[at].tolist() == pytest.approx([side * s * 20 * DEG for s in (1, -1, 1, -1, 1, -1, 1, -1)][: at.size])
    late = 0.25 * np.abs(trial["r"]).max()
    for k, i in enumerate(at[1:]):
        passed = side * (-1) ** k * swing[i - 1]
        assert 20 * DEG <= passed <= 20 * DEG + late
    assert np.abs(swing[: at[0]]).max() == 0


def test_turn_with_pull_out() -> None:
    """At 15 deg the rudder is back amidships once the ship has turned by 540 deg, and the ship straightens up."""
    trial = sail("turn:15", sampling="0.25 s")
    order, psi = trial["delta_order"], trial["psi"]
    begin, end = np.flatnonzero(np.diff(order)) + 1
    assert order[begin] == pytest.approx(15 * DEG)
    assert order[end] == 0
    assert 540 * DEG <= psi[end - 1] <= 540 * DEG + 0.25 * trial["r"].max()
    steady = trial["r"][end] * 226 / trial["u"][end]
    assert steady == pytest.approx(1.6 * 15 * DEG, rel=1e-4)  # after 540 deg, dozens of time constants
    assert abs(trial["r"][-1]) < 1e-3 * trial["r"].max()


def test_turn_to_port_through_a_circle() -> None:
    trial = sail("turn:-15/360")
    released = np.flatnonzero(np.diff(trial["delta_order"]))[-1]
    assert -365 * DEG < trial["psi"][released] <= -360 * DEG
    assert trial["y"].min() < -226


def rates_in_spiral(alpha1: float) -> tuple[np.ndarray, np.ndarray]:
    """Rudder and r* at the end of every step of a direct spiral, Norrbin's ship with a3* = 20, K* = 1.6."""
    unit = 226 / 9.5
    values = {
        "a": f"{1.6 / 1.7 / unit**2} 1/s^2",
        "b1": f"{alpha1 / 1.7 / unit} 1/s",
        "b3": f"{20 * unit / 1.7} s/rad^2",
    }
    trial = sail("spiral:10", "norrbin", values=values)
    ends = np.append(np.flatnonzero(np.diff(trial["delta_order"])), len(trial) - 1)[1:]
    return trial["delta"][ends] / DEG, trial["r"][ends] * unit


def test_the_spiral_of_an_unstable_ship_has_a_loop() -> None:
    """Norrbin: the branch is left at 3.08 deg, so at 2, 1, .5, 0 deg the way down differs from the way back."""
    rudder, rate = rates_in_spiral(-1.0)
    down, up = (dict(zip(np.round(rudder[s], 3), rate[s])) for s in (slice(0, 15), slice(14, None)))
    assert len(down) == len(up) == 15
    for angle in down:
        if abs(angle) <= 2.0:
            assert down[angle] > 0.15 and up[angle] < -0.15  # r* = 0.129 is where a branch ends
        else:
            assert down[angle] == pytest.approx(up[angle], abs=2e-3)  # 12 L/U after a step
    assert down[0.0] == pytest.approx(np.sqrt(1 / 20), abs=1e-3)
    assert up[0.0] == pytest.approx(-np.sqrt(1 / 20), abs=1e-3)


def test_the_spiral_of_a_stable_ship_has_none() -> None:
    rudder, rate = rates_in_spiral(1.0)
    assert rate[:15] == pytest.approx(rate[:13:-1], abs=2e-3)
    # and lies on a1 r* + a3 r*^3 = K delta
    assert rate + 20 * rate**3 == pytest.approx(1.6 * rudder * DEG, abs=2e-3)


@pytest.mark.parametrize("alpha1", [-1.0, 1.0])
def test_the_reversed_spiral_follows_the_whole_curve(alpha1: float) -> None:
    """H(r*) = K delta also where a direct spiral jumps; 15 L/U after a step, to the lag that is left."""
    unit = 226 / 9.5
    values = {"b1": f"{alpha1 / 1.7 / unit} 1/s", "b3": f"{20 * unit / 1.7} s/rad^2"}
    trial = sail("reversed-spiral:0.3", "norrbin", values=values)
    level = np.concatenate([[1, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0, -0.05, -0.1, -0.2, -0.4, -0.6, -0.8, -1.0]])
    wanted = 0.3 * np.concatenate([level, level[-2::-1]])
    ends = np.searchsorted(trial["t"], unit + 15 * unit * np.arange(1, 30)) - 2
    rate, rudder = trial["r"][ends] * unit, trial["delta"][ends]
    assert rate == pytest.approx(wanted, abs=3e-3)
    assert alpha1 * rate + 20 * rate**3 == pytest.approx(1.6 * rudder, abs=0.01)


def test_course_change() -> None:
    trial = sail("course:60/15", heading="-20 deg")
    assert trial["psi"][0] == pytest.approx(-20 * DEG)
    assert trial["psi"][-1] == pytest.approx(40 * DEG, abs=0.1 * DEG)
    assert np.abs(trial["delta_order"]).max() == pytest.approx(15 * DEG)
    assert np.ptp(trial["psi"]) < 62 * DEG


def test_the_telegraph_is_reproducible() -> None:
    same = [sail("telegraph:10", seed=s, noise="standard")["psi"] for s in (1, 1, 2)]
    assert np.array_equal(same[0], same[1])
    assert not np.array_equal(same[0], same[2])
    trial = sail("telegraph:10", seed=1)
    after = trial["t"] >= 226 / 9.5
    assert set(np.round(trial["delta_order"][after] / DEG, 9)) == {-10.0, 10.0}


def test_the_telegraph_orders_nothing_faster_than_the_rudder_can_go() -> None:
    """At 2.5 deg/s the rudder of Soesterberg takes 14 s from 17.5 deg on one side to 17.5 on the other."""
    for seed in range(3):
        trial = sail("telegraph:17.5", seed=seed, sampling="1 s")
        reversed_at = trial["t"][np.flatnonzero(np.diff(trial["delta_order"])) + 1]
        assert reversed_at.size > 10 and np.diff(reversed_at).min() >= 14.0 - 1.0
        assert np.abs(trial["delta"]).max() == pytest.approx(17.5 * DEG, rel=1e-6)


@pytest.mark.parametrize("model", ["de-keizer", "nomoto", "van-leeuwen"])
def test_a_current_shifts_the_track(model: str) -> None:
    """By current times time, to rounding: the current enters the equations of the path as a constant."""
    still = sail("zigzag:20/20", model)
    moved = sail("zigzag:20/20", model, current=("1.5 m/s", "30 deg"))
    t = still["t"]
    np.testing.assert_allclose(moved["x"] - still["x"], 1.5 * np.cos(30 * DEG) * t, rtol=1e-10, atol=1e-8)
    np.testing.assert_allclose(moved["y"] - still["y"], 1.5 * np.sin(30 * DEG) * t, rtol=1e-10, atol=1e-8)
    for name in ("psi", "r", "delta"):
        assert np.array_equal(moved[name], still[name])


@pytest.mark.parametrize(
    ("name", "text", "pair"),
    [
        ("current", "3 kn to 30 deg", ("3 kn", "30 deg")),
        ("waves", "0.3 deg from 40 deg", ("0.3 deg", "220 deg")),
        ("wind", "10 m/s from 270 deg", (10.0, np.pi / 2)),
    ],
)
def test_a_flow_is_said_as_at_the_command_line(name: str, text: str, pair: Plain) -> None:
    said, given = (sail("zigzag:20/20", duration="60 s", **{name: f}) for f in (text, pair))
    for signal in ("x", "y", "psi", "r"):
        np.testing.assert_allclose(said[signal], given[signal], rtol=0, atol=1e-12)
    assert f"{name} {text}" in said.source.comment
    assert f"{name} {'10 m/s to 90 deg' if name == 'wind' else ' to '.join(pair)}" in given.source.comment


def test_a_model_that_reads_the_wind_itself_is_turned_by_it_and_its_log_shows_it() -> None:
    """It was told that no wind acts on it; identified from its log, it would have taken the wind as none."""
    blown = simulate("cubic-wind", "esso-osaka-3m", "zigzag:10/10", duration="60 s", wind="2 m/s from 250 deg")
    assert np.allclose(blown["wind_speed"], 2.0) and np.allclose(blown["wind_direction"], np.deg2rad(70.0))
    calm = simulate("cubic-wind", "esso-osaka-3m", "zigzag:10/10", duration="60 s")
    assert np.abs(blown["r"] - calm["r"]).max() > np.deg2rad(0.05) and not calm.has("wind_speed")


def test_waves_move_a_model_that_has_their_moment() -> None:
    """(2.91): the size is a height, the path is another one, and from ahead there is no moment. They did not act at all."""
    model = join("in a sea", DeKeizer, VanLeeuwenSway, PlanarMotion, WaveMoment)

    def at(waves: str | None) -> Trial:
        moved = {"values": {"H_g": "1e-4 rad/m/s^2"}, "duration": "300 s", "sampling": "1 s"}
        return simulate(model, "soesterberg", "zigzag:0.001/90", waves=waves, **moved)

    quarter, twice, ahead = (at(w) for w in ("2 m from 45 deg", "4 m from 45 deg", "2 m from 0 deg"))
    assert np.std(quarter["r"]) > 0.005 * DEG and np.abs(quarter["y"]).max() > 0.1
    # In proportion to the height, while the heading hardly changes.
    assert np.std(twice["r"]) == pytest.approx(2 * np.std(quarter["r"]), rel=0.05)
    assert np.std(ahead["r"]) < 0.02 * np.std(quarter["r"])
    with pytest.raises(UnitError, match="significant height of the waves needs the unit m"):
        at("0.5 deg from 45 deg")


def test_a_compass_that_lags_begins_on_the_heading_of_the_approach() -> None:
    """It began at north, and its first samples came from there as a jump of the heading."""
    model = join("late compass", DeKeizer, VanLeeuwenSway, PlanarMotion, FaultyCompass)
    late = {"psi_offset": "2 deg", "tau_compass": "3 s"}
    shown = simulate(
        model, "soesterberg", "zigzag:10/10", heading="120 deg", values=late, duration="10 s", sampling="1 s"
    )
    np.testing.assert_allclose(shown["psi"], 122 * DEG, atol=1e-9)


def test_wind_turns_the_ship() -> None:
    coefficients = {"N_w": "1e-7 rad/m^2", "F_w": "1e-7 1/m^2"}
    blown = sail("zigzag:10/10", values=coefficients, wind=("15 m/s", "60 deg"), sampling="0.25 s")
    calm = sail("zigzag:10/10", sampling="0.25 s")
    assert np.abs(calm["r"][calm["t"] < 20]).max() == 0
    # On the approach, r' = 2 N_w V_ahead V_aside from the start, less what a quarter second of damping takes.
    ahead, aside = 15 * np.cos(60 * DEG) - 9.5, 15 * np.sin(60 * DEG)
    assert blown["r"][1] / 0.25 == pytest.approx(2e-7 * ahead * aside, rel=0.01)
    # Without the wind in the log, a reader takes it for a calm day.
    np.testing.assert_allclose(blown["wind_speed"], 15.0)
    np.testing.assert_allclose(blown["wind_direction"], 60 * DEG)
    assert not calm.has("wind_speed")
    # and u' = F_w L V_ahead |V|
    assert (blown["u"][1] - 9.5) / 0.25 == pytest.approx(1e-7 * 226 * ahead * np.hypot(ahead, aside), rel=0.01)


def test_the_steering_machine_keeps_its_limits() -> None:
    """Angle to rounding; rate between the samples as well, since the integrator adds up rates within the limit."""
    ship = find_ship("soesterberg")
    trial = sail("zigzag:35/20", ship=ship, values={"delta_max": "20 deg", "delta_rate": "2 deg/s"}, sampling="0.25 s")
    delta = trial["delta"]
    assert np.abs(trial["delta_order"]).max() == pytest.approx(35 * DEG)
    assert 19.9 * DEG < np.abs(delta).max() <= 20 * DEG * (1 + 1e-12)
    rate = np.abs(np.diff(delta)) / 0.25
    assert rate.max() == pytest.approx(2 * DEG, rel=1e-9)


def test_without_a_steering_machine_the_rudder_is_where_it_is_ordered() -> None:
    trial = sail("zigzag:20/20", steering=False)
    assert np.array_equal(trial["delta"], trial["delta_order"])


def test_sampling_and_duration() -> None:
    trial = sail("zigzag:20/20", duration="100 s", sampling=0.5)
    assert trial["t"].tolist() == pytest.approx(np.arange(0, 100.5, 0.5).tolist())
    fine = sail("zigzag:20/20", duration="100 s", sampling="0.25 s")
    np.testing.assert_allclose(trial["psi"], fine["psi"][::2], atol=1e-12)  # one clock of a quarter second
    assert sail("zigzag:20/20").sampling == 1.0
    assert sail("zigzag:20/20", speed="19 kn")["u"][0] == pytest.approx(19 * 1852 / 3600)


def test_published_coefficients_may_be_given() -> None:
    values = {"K": "0.5 1/s", "tau": "31 s", "n3": "0.4 s^2/deg^2"}
    trial = sail("turn:30", "norrbin", "zeefakkel", values=values, steering=False)
    r = trial["r"].max() / DEG
    # n3 r^3 + r = K delta, in degrees per second
    assert 0.4 * r**3 + r == pytest.approx(0.5 * 30, rel=1e-4)


def test_it_says_that_it_is_simulated(tmp_path: Path) -> None:
    trial = sail("zigzag:20/20", noise="psi=0.2 deg", current=("1 m/s", "90 deg"), seed=5, name="first")
    assert trial.source.simulated
    assert trial.name == "first"
    assert sail("zigzag:20/20").name == "de-keizer-zigzag-20-20"
    line = write_trial(trial, tmp_path / "first.csv").read_text().splitlines()[0]
    assert line.startswith("# Simulated, not measured: shipid ")
    for part in ("model de-keizer", "ship soesterberg", "zigzag:20/20", "9.5 m/s", "seed 5", "current 1 m/s to 90 deg"):
        assert part in line


def test_write_and_read_back(tmp_path: Path) -> None:
    """Equal to the rounding of degrees and back."""
    trial = sail("zigzag:20/20", noise="standard")
    back = read_trial(write_trial(trial, tmp_path / "run.csv"))
    assert back.source.simulated
    assert ",-0.0," not in (tmp_path / "run.csv").read_text(encoding="utf-8")
    assert set(back.table) == set(trial.table)
    for name in trial.table:
        np.testing.assert_allclose(back[name], trial[name], rtol=1e-14, atol=1e-300)


def without(ship: str, particular: str) -> ParameterSet:
    whole = find_ship(ship)
    sections = {s: {n: v for n, v in c.items() if n != particular} for s, c in whole.sections.items()}
    return ParameterSet(whole.name, sections=sections)


def length(number: float) -> ParameterSet:
    return ParameterSet("toy", sections={"particulars": {
        "L": Value("L", number, "m", "assumed"), "speed": Value("speed", 1.0, "m/s", "assumed")}})  # fmt: skip


@pytest.mark.parametrize(
    ("options", "error", "says"),
    [
        ({"manoeuvre": "zigzig:20/20"}, UnknownNameError, r"no manoeuvre 'zigzig'\. Did you mean zigzag\?"),
        ({"manoeuvre": "zigzag:20"}, UsageError, "has 1 number\\."),
        ({"ship": "sosterberg"}, UnknownNameError, "Did you mean soesterberg"),
        ({"ship": without("soesterberg", "speed")}, ParameterSetError, "has no speed of its own: give one"),
        ({"ship": without("soesterberg", "L")}, ParameterSetError, "has no length L"),
        ({"ship": length(-1.0)}, ParameterSetError, "it must lie between 0.1 m"),
        ({"ship": without("soesterberg", "K_u")}, ParameterSetError, r"needs K_u \[1\], which ship soesterberg"),
        ({"ship": without("soesterberg", "delta_rate")}, ParameterSetError, r"needs delta_rate \[rad/s\]"),
        ({"speed": "0 kn"}, UsageError, "does not steer a ship"),
        ({"speed": "9"}, UnitError, "the speed is the bare number 9"),
        ({"speed": "9 m"}, UnitError, "m does not fit it"),
        ({"duration": "0 s"}, UsageError, "give a duration greater than zero"),
        ({"duration": "-5 s"}, UsageError, "give a duration greater than zero"),
        ({"sampling": "0 s"}, UsageError, "a sampling interval of 0 s does not fit"),
        ({"sampling": "1e5 s"}, UsageError, "does not fit a manoeuvre of"),
        ({"noise": "loud"}, UsageError, "neither none nor standard"),
        ({"noise": "psi=0.2"}, UnitError, "noise on psi is the bare number 0.2"),
        ({"noise": "pis=0.2 deg"}, UnknownNameError, "Did you mean psi"),
        ({"noise": "psi=-0.2 deg"}, UsageError, "a standard deviation is zero or more"),
        ({"values": {"Q": "1 s"}}, UnknownNameError, "called 'Q'"),
        ({"values": {"K_u": "1 s"}}, UnitError, "s does not fit it"),
        ({"values": {"r": "1 rad/s"}}, UsageError, "'r' is a state of model de-keizer, and takes no value"),
        ({"values": {"cruise": "1 m/s"}}, UsageError, "'cruise' is an input"),
        ({"model": "nomoto", "ship": "mariner", "wind": (10.0, 0.0)}, ParameterSetError, r"needs F_w \[1/m²\], N_w"),
        ({"model": "pershitz-track", "ship": "semerdjiev"}, UsageError, "reads no rudder angle 'delta'"),
        ({"model": "pershitz-discrete", "ship": "semerdjiev", "current": (1.0, 0.0)}, UsageError, "a current does not"),
        ({"model": "pershitz-discrete", "ship": "semerdjiev", "wind": (1.0, 0.0)}, UsageError, "a wind does not act"),
        ({"wind": "-5 m/s from 30 deg"}, UsageError, "the speed of the wind is -5 m/s: it is a size, not below zero"),
        ({"current": "100 kn to 30 deg"}, UsageError, "nor above 15 m/s, which no current reaches"),
        ({"waves": "0.3 deg"}, UsageError, "'0.3 deg' does not say where it flows: write '0.5 deg from 300 deg'"),
        ({"waves": "0.3 m from 40 deg"}, UnitError, "heading by the waves"),
        ({"model": "nomoto", "ship": "zeefakkel", "speed": "9 m/s"}, ParameterSetError, "known from 2 to 6.2 m/s"),
    ],
)
def test_what_is_refused(options: dict[str, Plain], error: type[Exception], says: str) -> None:
    arguments = {"model": "de-keizer", "ship": "soesterberg", "manoeuvre": "zigzag:20/20"} | options
    manoeuvre = arguments.pop("manoeuvre")
    with pytest.raises(error, match=says):
        sail(manoeuvre, **arguments)


def test_a_model_that_runs_away() -> None:
    """A cubic damping of the wrong sign: the harder the ship turns, the less holds it back."""
    said = r"turn:35 of ship soesterberg at 9\.5 m/s is not sailed by this model \(van-leeuwen\): it turns faster than any ship"
    with pytest.raises(NotSailedError, match=said) as caught:
        sail("turn:35", model="van-leeuwen", values={"alpha3": "-500"})
    assert caught.value.exit_code == 4


@pytest.mark.parametrize(
    ("model", "ship", "manoeuvre", "values", "reason"),
    [
        ("de-keizer", "soesterberg", "turn:30", {"K_u": "0.9"}, "it keeps less than a fifth"),
        ("de-keizer", "soesterberg", "turn:35", {"K_u": "3"}, "it keeps less than a fifth"),
        ("norrbin", "zeefakkel", "turn:30", {"b3": "-400 s/rad^2"}, "it turns faster than any ship"),
        ("bech", "kvlcc2", "turn:35", {"c3": "-9 1/rad^2"}, "it turns faster than any ship"),
        ("nomoto", "zeefakkel", "turn:30", {}, "it turns faster than any ship"),
    ],
)
def test_a_turn_that_no_ship_makes(model: str, ship: str, manoeuvre: str, values: dict[str, str], reason: str) -> None:
    """Beyond the range of the model the run stays finite, or does not: either way it is no trial."""
    with pytest.raises(NotSailedError, match=rf"is not sailed by this model \({model}\): {reason}.* s after the start"):
        sail(manoeuvre, model=model, ship=ship, values=values)


def test_water_too_shallow_for_a_model_is_not_sailed_with_less_rudder_either() -> None:
    said = (
        "less than 1.2 draughts deep.*, 0 s after the start. No manoeuvre is within its range so: state another value"
    )
    with pytest.raises(NotSailedError, match=said):
        sail("turn:5", model="mmg-shallow", ship="kvlcc2", values={"depth": "24 m"}, duration="60 s")


def test_the_part_before_is_sailed() -> None:
    """A shorter duration keeps the run within the range of the model, as the message says."""
    trial = sail("turn:30", values={"K_u": "0.9"}, duration="150 s")
    assert trial["u"].min() > 0.2 * 9.5
    assert ", K_u 0.9," in trial.source.comment


class Engine(Component):
    """Shaft speed behind a governor."""

    n = state("1/s", "shaft speed, revolutions per second")
    n_order = given("1/s", "ordered shaft speed, revolutions per second")

    @n.rate
    def follow(self) -> Plain:
        """A test."""
        return (self.n_order - self.n) * self.n_order / 10


def test_an_engine_is_recorded_where_a_sensor_shows_it() -> None:
    model = join("with an engine", *find_model("norrbin").components, Engine)
    asked: Plain = {"inputs": {"n_order": 2.0}, "duration": 60.0}
    bare = simulate(model, "zeefakkel", "zigzag:20/20", **asked)
    assert bare["n"][-1] == pytest.approx(2.0, rel=1e-3) and bare["n"][0] < 0.1
    assert not simulate(model, "zeefakkel", "zigzag:20/20", noise="standard", **asked).has("n")
    shown = simulate(model, "zeefakkel", "zigzag:20/20", noise="psi=0.2 deg,n=0.5 rpm", **asked)
    assert np.std(shown["n"] - bare["n"]) == pytest.approx(0.5 / 60, rel=0.2)


class Bubble(Component):
    """An instrument of the user's own."""

    r = given("rad/s", "rate of turn")
    per_rate = constant("s", "angle for each rate of turn", default=2.0)
    bubble = output("rad", "inclinometer")

    @bubble.equals
    def reading(self) -> Plain:
        """A test."""
        return self.per_rate * self.r


def test_an_output_of_its_own_is_recorded_where_noise_gives_it_a_sensor() -> None:
    model = join("with an inclinometer", *find_model("nomoto").components, Bubble)
    shown = simulate(model, "zeefakkel", "zigzag:20/20", noise="psi=0.2 deg,bubble=0.1 deg")
    assert shown.unit("bubble") == "rad"
    assert np.std(shown["bubble"] - 2 * shown["r"]) == pytest.approx(0.1 * DEG, rel=0.1)
    assert not simulate(model, "zeefakkel", "zigzag:20/20", noise="standard").has("bubble")


class Machine(Component):
    """A steering machine with a time constant, and no limits."""

    delta = state("rad", "rudder angle, positive turns to starboard")
    delta_order = given("rad", "rudder order, positive turns to starboard")
    T_d = parameter("s", "time constant of the machine", start=2.0, low=0.1, high=30.0)

    @delta.rate
    def move(self) -> Plain:
        """A test."""
        return (self.delta_order - self.delta) / self.T_d


def test_a_model_with_a_steering_machine_of_its_own_is_steered_by_the_order() -> None:
    """It was refused as one that reads no rudder, though the guide says that such a part joins."""
    model = join("steered", *find_model("nomoto").components, Machine)
    trial = simulate(model, "zeefakkel", "zigzag:20/20", values={"T_d": "3 s"}, sampling="0.5 s")
    order, rudder = trial["delta_order"], trial["delta"]
    first = int(np.flatnonzero(order)[0])
    assert rudder[first + 6] / order[first] == pytest.approx(1 - np.exp(-1), rel=0.02)


class DepthPlane(Component):
    """What no rudder steers."""

    q = state("rad/s", "pitch rate")
    stern = given("rad", "angle of the stern planes")
    lag = parameter("s", "time constant", start=3.0)

    @q.rate
    def pitch(self) -> Plain:
        """A test."""
        return self.stern / self.lag**2


def test_a_model_that_no_rudder_steers_is_told_what_to_do() -> None:
    with pytest.raises(
        UsageError, match=r"no rudder angle 'delta'.*'delta_order'.*derived from one delta.*shipid identify"
    ):
        simulate(join("submarine", DepthPlane, PlanarMotion), "zeefakkel", "zigzag:20/20")


def test_no_ship_is_told_as_such() -> None:
    for more in ({}, {"speed": "9 kn"}):
        with pytest.raises(ParameterSetError, match=r"ship=.soesterberg. in Python") as told:
            simulate("de-keizer", None, "zigzag:20/20", **more)
        assert "unnamed" not in str(told.value)
