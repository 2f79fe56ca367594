"""Finding models and ships: by name, by file, and without being listed anywhere."""

import sys
import textwrap
from pathlib import Path

import pytest

from shipid import find_model, find_ship, join, write_parameter_set
from shipid.foundation.errors import DeclarationError, ParameterSetError, UnknownNameError, UsageError
from shipid.models.de_keizer import DeKeizer
from shipid.parameters import catalogue

OWN_SHIP = '''
"""A ship model of a user, in one file."""
import numpy as np

from shipid import Component, given, join, parameter, state
from shipid.models import PlanarMotion


class SineShip(Component):
    """A ship whose damping is a sine."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    K = parameter("1/s", "gain", start=0.1, low=0.01, high=1.0)
    tau = parameter("s", "time constant", start=10.0, low=1.0, high=100.0)

    @r.rate
    def yaw(self):
        """Mine (2024)."""
        return (self.K * np.sin(self.delta) - self.r) / self.tau


whole = join("sine-ship", SineShip, PlanarMotion)
'''


def written(folder: Path, text: str, name: str = "mine.py") -> Path:
    path = folder / name
    path.write_text(textwrap.dedent(text), encoding="utf-8")
    return path


def test_adding_a_ship_model_touches_one_new_file(tmp_path: Path) -> None:
    """The file is written here; nothing else changes, and the class is found, joined and runs."""
    path = written(tmp_path, OWN_SHIP)
    by_class, by_model = find_model(f"{path}:SineShip"), find_model(f"{path}:whole")
    assert by_class.name == by_model.name == "sine-ship"
    assert by_class.states == by_model.states == ("r", "x", "y", "psi")
    assert by_class.parameters == ("K", "tau")
    extended = join("steered", by_class, catalogue.known_component("SteeringMachine"))
    assert "delta_order" in extended.inputs and "delta" not in extended.inputs


def test_a_file_in_the_folder_of_models_is_found_without_being_listed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder is a package: a file that lies in it is a model, whoever wrote it."""
    import shipid.models

    written(tmp_path, OWN_SHIP, "sine_ship_of_a_test.py")
    monkeypatch.setattr(shipid.models, "__path__", [*shipid.models.__path__, str(tmp_path)])
    catalogue.known_models.cache_clear()
    try:
        assert find_model("sine-ship").parameters == ("K", "tau")
        assert {"sine-ship", "nomoto"} <= set(catalogue.known_models())
        assert shipid.models.SineShip is catalogue.known_component("SineShip")
    finally:
        vars(shipid.models).pop("SineShip", None)
        monkeypatch.undo()
        catalogue.known_models.cache_clear()
    assert "sine-ship" not in catalogue.known_models()


def test_a_component_that_states_the_heading_is_taken_as_it_is(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        '''
        from shipid import Component, constant, state


        class Turntable(Component):
            """Turns on the spot."""

            psi = state("rad", "heading")
            rate = constant("rad/s", "rate", default="1 deg/s")

            @psi.rate
            def turning(self):
                """Mine (2024)."""
                return self.rate
        ''',
    )
    assert find_model(f"{path}:Turntable").states == ("psi",)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nomotto", r"there is no model 'nomotto'\. Did you mean nomoto.*path/to/file\.py:Class"),
        ("Norrbin", r"Did you mean norrbin\?"),
        ("zzzz", r"there is no model 'zzzz'\. Known: bech, "),
    ],
)
def test_a_misspelt_model_offers_the_nearest(name: str, words: str) -> None:
    with pytest.raises(UnknownNameError, match=words):
        find_model(name)


def test_a_misspelt_ship_and_component_offer_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match=r"there is no ship 'zeefakel'\. Did you mean zeefakkel\?.*ship\.toml"):
        find_ship("zeefakel")
    with pytest.raises(UnknownNameError, match=r"there is no component 'Nomotto'\. Did you mean Nomoto"):
        catalogue.known_component("Nomotto")


def test_a_name_that_is_not_in_the_file_offers_what_is(tmp_path: Path) -> None:
    path = written(tmp_path, OWN_SHIP)
    with pytest.raises(UnknownNameError, match=r"called 'SinShip'\. Did you mean SineShip\?"):
        find_model(f"{path}:SinShip")
    with pytest.raises(
        DeclarationError, match=r"say which model of .*mine\.py: .*mine\.py:NAME\. Known: SineShip, whole"
    ):
        find_model(str(path))
    with pytest.raises(UnknownNameError, match=r"called 'PlanarMotion'"):
        find_model(f"{path}:PlanarMotion")  # imported there, not declared there
    with pytest.raises(DeclarationError, match=r"there is no model file .*nothing\.py"):
        find_model(f"{tmp_path / 'nothing.py'}:SineShip")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import shipid\n1 / 0\n", r"mine\.py fails in line 2: ZeroDivisionError: division by zero"),
        ("x = 1\ny = (\n", r"mine\.py fails in line \d: SyntaxError"),
        ("from shipid.models import Nowhere\n", r"mine\.py fails in line 1: ImportError"),
        (
            "from shipid import Component, state\nclass Bad(Component):\n    x = state('m', 'position')\n",
            r"mine\.py: state 'x' of Bad has no equation",
        ),
    ],
)
def test_a_file_that_raises_says_in_which_line(tmp_path: Path, text: str, words: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(DeclarationError, match=words):
        find_model(f"{path}:Bad")


def test_a_model_file_may_import_the_file_beside_it(tmp_path: Path) -> None:
    written(tmp_path, OWN_SHIP, "beside_it.py")
    path = written(tmp_path, "from shipid import join\nfrom beside_it import SineShip\nboth = join('both', SineShip)\n")
    before = list(sys.path)
    assert find_model(f"{path}:both").name == "both" and sys.path == before


def test_a_ship_may_be_a_file(tmp_path: Path) -> None:
    path = written(tmp_path, '[particulars]\nL = { value = 3, unit = "m", source = "assumed" }\n', "tub.toml")
    assert find_ship(path).particular("L", "m") == 3.0
    assert find_ship(str(path)).name == "tub"
    with pytest.raises(ParameterSetError, match="cannot be read"):
        find_ship(tmp_path / "gone.toml")


def test_the_known_ships_are_the_files_of_the_folder() -> None:
    assert set(catalogue.known_ships()) == {
        "esso-osaka-3m", "gunnerus", "kvlcc2", "kvlcc2-7m", "mariner", "semerdjiev", "soesterberg", "zeefakkel",
    }  # fmt: skip


@pytest.mark.parametrize("thing", [3, None, object, {"K": 1.0}])
def test_an_argument_that_is_no_model_gets_one_message_from_every_verb(thing) -> None:
    with pytest.raises(UsageError, match=r"a model is a name such as 'norrbin', a component class or what shipid.join"):
        catalogue.model_of(thing)


@pytest.mark.parametrize("thing", [3, ["zeefakkel"], {"K": 1.0}])
def test_an_argument_that_is_no_ship_gets_one_message_from_every_verb(thing) -> None:
    with pytest.raises(UsageError, match="a ship is a name such as 'zeefakkel', the path of a TOML file"):
        catalogue.ship_of(thing)


def test_arguments_that_mean_the_same(tmp_path: Path) -> None:
    model, ship = find_model("nomoto"), find_ship("zeefakkel")
    assert catalogue.model_of("nomoto") is catalogue.model_of(model) is model
    assert catalogue.model_of(DeKeizer).name == "de-keizer"
    assert catalogue.ship_of("zeefakkel") is catalogue.ship_of(ship) is ship
    write_parameter_set(ship, tmp_path / "mine.toml")
    assert catalogue.ship_of(tmp_path / "mine.toml").name == "zeefakkel"
    assert catalogue.ship_of(None).sections == {}
