"""What every declaration has to say of itself, and every ship of its numbers."""

import importlib
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from shipid import Component, find_model, find_ship, join
from shipid.declaration import units
from shipid.declaration.component import declared_equations, declared_quantities, slug
from shipid.declaration.joining.unit_check import check_units
from shipid.declaration.scale import Scale, prime_exponents
from shipid.foundation.errors import DeclarationError
from shipid.parameters.catalogue import known_component, known_models, known_ships, modules
from shipid.parameters.parameter_set import PARTICULARS, missing_values
from shipid.parts import current, planar_motion, sensors, steering_machine, waves, wind
from shipid.parts.steering_machine import SteeringMachine
from shipid.parts.wind import Wind

PARTS = [planar_motion, steering_machine, current, wind, waves, sensors]
COMPONENTS = sorted(
    {c for m in (*modules(), *PARTS) for c in vars(m).values() if isinstance(c, type) and issubclass(c, Component)}
    - {Component},
    key=lambda c: c.__name__,
)
SHIPS = sorted(known_ships())
SECTIONS = [(ship, section) for ship in SHIPS for section in find_ship(ship).models]
MODELS = sorted(known_models())
#: Time constants of machinery, which know nothing of ship lengths: R/V Gunnerus showed one lag in seconds at two speeds.
IN_SECONDS = {(n, "t_delta") for n in ("ActuatorLag", "CubicYawLag", "DeKeizerLag", "SlipstreamYawLag")}
IN_SECONDS |= {("FaultyCompass", "tau_compass")}
#: Faults of instruments, which know nothing of ships.
OF_INSTRUMENTS = {("FaultyCompass", "psi_offset"), ("FaultyGyro", "r_bias")}
#: Models that bring a moment by the wind of their own, in the place of `Wind`.
WITH_WIND = {"cubic-wind", "cross-flow-wind"}
#: Declarations for filters and recursions: each holds only what it estimates.
FILTERS = {"yaw-filter", "yaw-filter-seven", "position-filter", "own-ship-filter"}
#: Declarations of other ships as a radar sees them: points that move, and steer nothing.
TARGETS = {
    "constant-velocity",
    "constant-velocity-augmented",
    "coordinated-turn",
    "coordinated-turn-augmented",
    "turning-at-unknown-rate",
    "coordinated-circle-augmented",
}
SHIP_MODELS = [n for n in MODELS if n not in FILTERS | TARGETS]
FAMILIES = ("nomoto", "nomoto-second-order", "norrbin", "bech", "de-keizer", "van-leeuwen", "pershitz")


def test_the_named_models_are_there() -> None:
    assert {*FAMILIES, "davidson-schiff", "pershitz-discrete", "pershitz-track"} <= set(MODELS)


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.__name__)
def test_every_equation_cites_its_source(component: type[Component]) -> None:
    for equation in declared_equations(component).values():
        if equation.quantity.kind == "guard":
            continue  # where a model ends is a statement of this project
        assert re.search(r"\b(19|20)\d\d\b", equation.source), f"{equation.name} ({equation.place}) cites no source"
    assert (component.__doc__ or "").strip()


@pytest.mark.parametrize("component", [c for c in COMPONENTS if {"x", "y"} <= declared_quantities(c).keys()])
def test_north_and_east_are_of_one_size(component: type[Component]) -> None:
    """No direction is preferred: unit and nominal size of both coordinates are the same."""
    model = join("alone", component)
    x, y = model["x"], model["y"]
    assert (x.unit, x.number("nominal")) == (y.unit, y.number("nominal"))


@pytest.mark.parametrize("model", [m for m in SHIP_MODELS if {"r", "r_star", "omega"} & set(find_model(m).states)])
def test_the_track_follows_the_motions_that_make_it(model: str) -> None:
    """The order of the states, in tables and files: what turns the ship first, then where that takes it; units agree."""
    found = find_model(model)
    check_units(found)
    states = list(found.states)
    turning = next(n for n in ("r", "r_star", "omega") if n in states)
    assert states.index(turning) < states.index("x") < states.index("y")


@pytest.mark.parametrize("module", modules(), ids=lambda m: m.__name__)
def test_every_file_names_its_family_and_stays_one_idea(module: object) -> None:
    assert len((module.__doc__ or "").split()) > 15
    lines = Path(module.__file__).read_text(encoding="utf-8").splitlines()
    assert len(lines) < 400


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.__name__)
def test_every_parameter_has_a_start_inside_its_bounds(component: type[Component]) -> None:
    if not declared_equations(component):
        return
    model = join("alone", component)
    for name in model.parameters:
        low, start, high = (model[name].number(a) for a in ("low", "start", "high"))
        assert low is not None and start is not None and high is not None, name
        assert low <= start <= high and low < high, name


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.__name__)
def test_every_parameter_says_how_it_scales(component: type[Component]) -> None:
    """Dimensional ones declare the prime system; starred ones the unit of their dimensional form, where it has one.

    What is not of the hull and the water stays in seconds, and is named with its reason in `IN_SECONDS`.
    """
    for name, quantity in declared_quantities(component).items():
        if quantity.kind != "parameter":
            continue
        dimensionless = units.same_dimension(quantity.unit, "1")
        if quantity.prime:
            prime_exponents(quantity.unit)
        elif (component.__name__, name) in IN_SECONDS:
            assert quantity.unit == "s" and not quantity.dimensional
        elif (component.__name__, name) in OF_INSTRUMENTS:
            assert not quantity.dimensional
        else:
            assert dimensionless, f"{name} [{quantity.unit}] declares no prime"
        if quantity.dimensional:
            assert dimensionless and prime_exponents(quantity.dimensional) != (0.0, 0.0), name


@pytest.mark.parametrize("name", SHIP_MODELS)
def test_every_model_steers_the_heading(name: str) -> None:
    model = find_model(name)
    assert {"x", "y", "psi"} <= set(model.states)
    assert model["psi"].quantity.wraps
    assert model.is_sampled == ("T_s" in {q for c in model.components for q in declared_quantities(c)})


def test_every_yaw_model_takes_a_disturbance() -> None:
    """So that wind joins with any of them; the sampled forms of the trackers have none."""
    for name in SHIP_MODELS:
        model = find_model(name)
        open_to_it = "r_disturbance" in model.inputs
        assert open_to_it == (not model.is_sampled and name not in WITH_WIND), name
        assert ("r_disturbance" in model.derived) == (name in WITH_WIND), name


@pytest.mark.parametrize("name", [n for n in SHIP_MODELS if not find_model(n).is_sampled])
def test_everything_that_surrounds_a_ship_joins_with_every_model(name: str) -> None:
    around = ["UniformCurrent", "Wind", "Waves", "SteeringMachine", "Compass", "Gyro", "Log", "PositionSensor"]
    if name in WITH_WIND:
        around.remove("Wind")
    whole = join("whole", find_model(name), *(known_component(c) for c in around))
    assert {"delta_order", "wind_speed", "wind_direction", "current_speed"} <= set(whole.inputs)
    assert not {"r_disturbance", "current_north", "delta", "psi_wave"} & set(whole.inputs)
    assert whole.outputs == ("compass", "gyro", "log", "fix_north", "fix_east")
    for output in whole.outputs:
        declared = whole[output].quantity
        assert declared.measures in whole and declared.noise is not None
        assert units.to_si(declared.noise, declared.unit) > 0


@pytest.mark.parametrize("name", sorted(WITH_WIND))
def test_wind_joins_no_model_that_has_a_wind_of_its_own(name: str) -> None:
    for order in ((find_model(name), Wind), (Wind, find_model(name))):
        with pytest.raises(DeclarationError) as error:
            join("whole", *order)
        text = str(error.value)
        # What both state first: the relative wind, a moment or a push.
        assert re.search(r"'(wind_\w+|[ru]_disturbance)' is stated twice: by ", text)
        assert re.search(r"(CubicYawInWind|WindMoment|WindForces) \(derived, .*wind\.py:\d+\)", text)
        assert re.search(r"\bWind \(derived, .*wind\.py:\d+\)", text)


def test_every_model_is_told_from_the_others_by_one_line() -> None:
    """The list of models shows the first line of a model's first component."""
    lines = {n: (find_model(n).components[0].__doc__ or "").partition("\n")[0] for n in MODELS}
    assert len(set(lines.values())) == len(MODELS)
    for name, line in lines.items():
        assert len(line.split()) > 4 and line.endswith("."), name
        assert not line.startswith(("The same", "The continuous", "The discrete")), name


@pytest.mark.parametrize("name", SHIPS)
def test_every_ship_has_its_particulars(name: str) -> None:
    ship = find_ship(name)
    assert ship.name == name
    assert ship.title and ship.notes
    for particular, unit in (("L", "m"), ("speed", "m/s"), ("delta_max", "rad"), ("delta_rate", "rad/s")):
        value = ship.particular(particular, unit)
        assert value is not None and value > 0, particular
    assert ship.particular("delta_max", "deg") <= 45


@pytest.mark.parametrize(("name", "section"), SECTIONS)
def test_every_section_of_a_ship_determines_its_model(name: str, section: str) -> None:
    ship = find_ship(name)
    named = {slug(c): c for c in COMPONENTS}
    model = find_model(section) if section in MODELS else join(section, named[section])
    speed = ship.particular("speed", "m/s")
    values = ship.values(model, speed)
    assert missing_values(model, values, name) is None
    assert set(ship.sections[section]) <= set(model.entries), "a name the model does not have"
    length = ship.particular("L", "m")
    for parameter in model.parameters:
        entry = model[parameter]
        low, high = Scale(length, speed).bounds_of(entry)
        assert low <= values[parameter] <= high, parameter


@pytest.mark.parametrize("name", SHIPS)
def test_every_number_of_a_ship_has_a_source_someone_can_look_up(name: str) -> None:
    """A name and a year, a toolbox, a campaign, what it was derived from; or the plain word assumed."""
    known = r"assumed$|\((19|20)\d\d\)|SIMMAN 2008|MSS toolbox|FRT-DS-ESSO|NTNU|MARIN|HSVA|^derived from|eq\. \("
    for section, values in find_ship(name).sections.items():
        for value in values.values():
            assert re.search(known, value.source), f"[{section}] {value.name}: {value.source}"
            assert not re.search(r"[/\\](home|work|tmp|root|Users)[/\\]", value.source + value.note)


def test_every_model_has_a_ship_that_knows_it() -> None:
    sections = {section for _, section in SECTIONS}
    # A filter starts from no knowledge of the ship but its length; a model of components is known by those of its components.
    for name in SHIP_MODELS:
        assert sections & set(find_model(name).known_as), name


@pytest.mark.parametrize("name", SHIPS)
def test_every_ship_steers(name: str) -> None:
    machine = join("machine", SteeringMachine)
    assert set(find_ship(name).values(machine)) == {"delta_max", "delta_rate", "tau_delta"}


def test_zeefakkel_is_tabulated_against_speed() -> None:
    ship, model = find_ship("zeefakkel"), find_model("norrbin")
    for speed, gain, time in ((2.0, 0.15, 33.0), (4.5, 0.435, 32.0), (6.2, 0.83, 43.0)):
        values = ship.values(model, speed)
        assert values["a"] == pytest.approx(gain / time)
        assert values["b1"] == pytest.approx(1 / time)
        # 0.4 s^2/deg^2 is 1313 s^2/rad^2: the angle is what the printed number leaves out.
        assert values["b3"] == pytest.approx(1313.12 / time, rel=1e-5)


def test_the_derived_numbers_of_the_container_follow_from_its_published_ones() -> None:
    ship = find_ship("soesterberg")
    starred, linear = ship.values(find_model("de-keizer")), ship.values(find_model("nomoto"))
    assert linear["K"] == pytest.approx(starred["K"] * 9.5 / 226, rel=1e-5)
    assert linear["tau"] == pytest.approx(starred["tau"] * 226 / 9.5, rel=1e-5)
    published = units.to_si("2.26 m/deg", "m/rad")
    assert starred["gamma"] == pytest.approx(published / 226, rel=1e-3)


def test_the_two_sizes_of_the_kvlcc2_are_one_hull() -> None:
    """The same coefficients, made dimensionless, in full scale and in the model."""
    model, primed = find_model("norrbin"), []
    for name in ("kvlcc2", "kvlcc2-7m"):
        ship = find_ship(name)
        length, speed = ship.particular("L", "m"), ship.particular("speed", "m/s")
        values = ship.values(model, speed)
        primed.append([values[p] / Scale(length, speed).factor(model[p].unit) for p in model.parameters])
    assert primed[0] == pytest.approx(primed[1], rel=1e-3)
    assert primed[0] == pytest.approx([0.470, 0.04, 4.4], rel=1e-3)


def test_declared_names_are_imported_from_the_package() -> None:
    package = importlib.import_module("shipid.models")
    assert package.DeKeizer is known_component("DeKeizer")
    with pytest.raises(AttributeError, match="NoSuchShip"):
        package.NoSuchShip  # noqa: B018


def test_particulars_are_not_taken_for_a_model() -> None:
    assert all(PARTICULARS not in find_ship(s).models for s in SHIPS)


@pytest.mark.parametrize(("name", "section"), [(n, s) for n, s in SECTIONS if s in MODELS and "track" not in s])
@pytest.mark.parametrize("side", [1, -1], ids=["starboard", "port"])
def test_every_ship_turns_to_the_side_of_its_rudder(
    name: str, section: str, side: int, evaluate: Callable[..., dict[str, float]], integrate: Callable[..., Any]
) -> None:
    """Ten degrees of rudder for twenty ship lengths: to the right side, and not faster than a ship can turn."""
    ship, model = find_ship(name), find_model(section)
    length, speed = ship.particular("L", "m"), ship.particular("speed", "m/s")
    values = ship.values(model, speed) | {"delta": side * math.radians(10), "T_s": length / speed / 10}
    values |= {n: speed for n in ("u", "cruise") if n in model.inputs}
    start = {"u": speed} if "u" in model.states else {}
    pace = length / speed
    if model.is_sampled:
        state = dict.fromkeys(model.states, 0.0)
        for _ in range(200):
            sides = evaluate(model, values | state)
            state = {n: sides[n] for n in model.states}
    else:
        run = integrate(model, start, values, seconds=20 * pace, step=pace / 10)
        state = {n: float(record[-1]) for n, record in run.items()}
        sides = evaluate(model, values | state)
    r = state.get("r", sides.get("r", math.nan))
    assert 0.05 < side * r * pace < 1.5
    assert side * state["psi"] > 1.0
    if "v" in sides and "v" in model.derived + model.states:
        v = state.get("v", sides["v"])
        assert side * v < 0  # a ship that turns to starboard sways to port


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.__name__)
def test_spreads_and_sizes_are_greater_than_zero(component: type[Component]) -> None:
    """A standard deviation and a typical size have no sign."""
    for name, quantity in declared_quantities(component).items():
        for attribute in ("spread", "nominal"):
            value = getattr(quantity, attribute)
            if value is not None:
                number = value if isinstance(value, (int, float)) else units.split(value)[0]
                assert number > 0, f"{name}: {attribute} {value}"
