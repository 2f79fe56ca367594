"""Finding models and ships by name, or by ``path/to/file.py:Class``.

The toolbox imports no ship model: the folder of declarations is opened by name at run time, and a model
file that lies in it is found without being listed anywhere.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.util
import pkgutil
import sys
import traceback
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path
from types import ModuleType
from typing import TypeGuard

from shipid import parts
from shipid.declaration.component import Component, declared_quantities, slug
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.foundation.errors import DeclarationError, ShipidError, UnknownNameError, UsageError, nearest
from shipid.parameters.loading import MEASURES, at_loading
from shipid.parameters.parameter_file import read_parameter_set
from shipid.parameters.parameter_set import NOBODY, ParameterSet
from shipid.parts.planar_motion import PlanarMotion
from shipid.parts.rudder_delay import RudderDelay
from shipid.parts.wind import WindForces, WindMoment, WindPush

_PACKAGE = "shipid.models"
#: What stands at the end of the name of a model that the wind of a log turns and pushes.
IN_WIND = "-wind"
#: What stands at the end of the name of a model whose rudder acts later than it is recorded.
DELAYED = "-delay"
#: What stands at the end of the name of a model whose coefficients depend on the loading, and what makes it.
_LOADED = {f"-{measure}": functools.partial(at_loading, measure=measure) for measure in MEASURES}


def modules() -> list[ModuleType]:
    """Return the model files that came with the installation, imported."""
    package = importlib.import_module(_PACKAGE)
    names = sorted(m.name for m in pkgutil.iter_modules(package.__path__) if not m.name.startswith("_"))
    return [importlib.import_module(f"{_PACKAGE}.{n}") for n in names]


def _parts() -> list[ModuleType]:
    """Return the files of components that every ship joins, imported."""
    return [importlib.import_module(f"{parts.__name__}.{m.name}") for m in pkgutil.iter_modules(parts.__path__)]


def _mentioning(text: str) -> list[ModuleType]:
    """Return the model files whose text holds some words, imported: opening one file is quicker than opening all."""
    package = importlib.import_module(_PACKAGE)
    found = []
    for module in sorted(m.name for m in pkgutil.iter_modules(package.__path__) if not m.name.startswith("_")):
        spec = importlib.util.find_spec(f"{_PACKAGE}.{module}")
        if spec is not None and spec.origin and text in Path(spec.origin).read_text(encoding="utf-8"):
            found.append(importlib.import_module(f"{_PACKAGE}.{module}"))
    return found


@functools.cache
def known_models() -> dict[str, Model]:
    """Return every named model that came with the installation."""
    found = [m for module in modules() for m in vars(module).values() if isinstance(m, Model)]
    return dict(sorted({m.name: m for m in found}.items()))


def known_component(name: str) -> type[Component]:
    """Return a component of the installation by its class name.

    Parameters
    ----------
    name : str
        ``"PlanarMotion"``.

    Raises
    ------
    UnknownNameError
        If there is none.
    """
    for module in _mentioning(f"class {name}("):
        found = vars(module).get(name)
        if _is_component(found):
            return found
    classes = {n: c for m in (*_parts(), *modules()) for n, c in vars(m).items() if _is_component(c)}
    if name not in classes:
        raise UnknownNameError("component", name, classes)
    return classes[name]


def find_model(name: str) -> Model:
    """Return a model by name, or from ``path/to/file.py:Name``.

    A component class is joined with planar motion when it does not state the heading itself.

    Parameters
    ----------
    name : str
        ``"de-keizer"``, or a file and the name of a model or a component class in it. With ``-wind`` after it, any model of yaw is
        joined with the moment and the push of the wind; with ``-delay`` at the end, any that reads the rudder has a dead time of it; with
        ``-draught`` or ``-displacement``, the coefficients of any depend on the loading (`shipid.parameters.loading`).

    Raises
    ------
    UnknownNameError
        If there is no such model; the message offers the nearest.
    DeclarationError
        If the file cannot be loaded, with the line that fails.
    """
    if names_a_file(name):
        ending = next((e for e in (DELAYED, *_LOADED) if name.endswith(e)), None)
        return _from_file(name) if ending is None else _ENDINGS[ending](find_model(name.removesuffix(ending)))
    for module in _mentioning(f'"{name}"'):
        for thing in vars(module).values():
            if isinstance(thing, Model) and thing.name == name:
                return thing
    models = known_models()
    if name in models:
        return models[name]
    for ending, complete in _ENDINGS.items():
        if name.endswith(ending):
            with contextlib.suppress(UnknownNameError):
                model = complete(find_model(name.removesuffix(ending)))
                if model.name == name:
                    return model
    raise UnknownNameError("model", name, models, "A model of your own is given as path/to/file.py:Class.")


@functools.lru_cache(maxsize=64)
def delayed(model: Model) -> Model:
    """Return a model with a dead time of the rudder, or the same where it has one or reads no rudder.

    Parameters
    ----------
    model : Model
        The model.
    """
    if "delta" not in model.inputs or "delta" in model.delays or "delay" in model:
        return model
    return join(model.name + DELAYED, model, RudderDelay)


def in_wind(model: Model) -> Model:
    """Return a model with the moment of the wind, and the forces that it takes; or the same where it has a wind or no yaw for one to act on.

    Parameters
    ----------
    model : Model
        The model.
    """
    if "wind_speed" in model or "r_disturbance" not in model.inputs:
        return model
    name = model.name + IN_WIND
    force = WindForces if "v_disturbance" in model.inputs else WindPush
    pushed = "u_disturbance" in model.inputs
    return known_models().get(name) or join(name, model, WindMoment, *((force,) if pushed else ()))


#: What the name of a model may end in, and what makes that model of the one without it.
_ENDINGS: dict[str, Callable[[Model], Model]] = {DELAYED: delayed, IN_WIND: in_wind, **_LOADED}
#: What `shipid.identify` may add to a model unasked, at the end of its name.
ADDED = (DELAYED, *_LOADED)


def names_a_file(name: str) -> bool:
    """Return whether the name of a model is that of a model file, which is code.

    Parameters
    ----------
    name : str
        As for `find_model`.
    """
    return ".py" in name


def _from_file(name: str) -> Model:
    text, _, attribute = name.rpartition(":")
    if not text or text.endswith(".py") is False:
        text, attribute = (name, "") if name.endswith(".py") else (text, attribute)
    path = Path(text)
    module = _load(path)
    things = {n: t for n, t in vars(module).items() if isinstance(t, Model) or _is_own_component(t, module)}
    if not things:
        raise DeclarationError(f"{path} declares no model: it holds neither a class of Component nor a join(...).")
    if not attribute:
        raise DeclarationError(f"say which model of {path}: {path}:NAME. {nearest('', things)}".strip())
    if attribute not in things:
        raise UnknownNameError(f"model in {path} called", attribute, things)
    return model_of(things[attribute])


def whole_ship(component: type[Component]) -> Model:
    """Return a component joined with planar motion, unless it states the heading itself.

    Parameters
    ----------
    component : type[Component]
        The component.
    """
    heading = declared_quantities(component).get("psi")
    if heading is not None and heading.kind != "given":
        return join(slug(component), component)
    return join(slug(component), component, PlanarMotion)


def model_of(model: Model | type[Component] | str) -> Model:
    """Return the model that an argument of a verb means.

    Parameters
    ----------
    model : Model, component class or str
        A model; a component, which is joined with planar motion where it states no heading; or a name, see `find_model`.

    Raises
    ------
    UsageError
        If it is something else.
    UnknownNameError
        If there is no model of that name.
    """
    if isinstance(model, str):
        return find_model(model)
    if isinstance(model, Model):
        return model
    if _is_component(model):
        return whole_ship(model)
    raise UsageError(
        f"a model is a name such as 'norrbin', a component class or what shipid.join returns, not {_kind(model)}."
    )


def ship_of(ship: ParameterSet | str | Path | None) -> ParameterSet:
    """Return the parameter set that an argument of a verb means.

    Parameters
    ----------
    ship : ParameterSet, str, Path or None
        A set; a name or the path of a file, see `find_ship`; or None for a ship of which nothing is known.

    Raises
    ------
    UsageError
        If it is something else.
    UnknownNameError
        If there is no ship of that name.
    """
    if ship is None:
        return ParameterSet(NOBODY)
    if isinstance(ship, (str, Path)):
        return find_ship(ship)
    if isinstance(ship, ParameterSet):
        return ship
    raise UsageError(
        f"a ship is a name such as 'zeefakkel', the path of a TOML file or a ParameterSet, not {_kind(ship)}."
    )


def _kind(thing: object) -> str:
    return f"the class {thing.__name__}" if isinstance(thing, type) else f"{thing!r:.60}"


def _load(path: Path) -> ModuleType:
    if not path.is_file():
        raise DeclarationError(f"there is no model file {path}. Check the path.")
    spec = importlib.util.spec_from_file_location(f"shipid_model_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        # What a model file prints must not mix with the output of a command.
        with contextlib.redirect_stdout(sys.stderr), _beside(path):
            spec.loader.exec_module(module)
    except ShipidError as error:
        error.args = (f"{path}: {error}",)
        raise
    except (Exception, SystemExit) as error:
        frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == spec.origin]
        line = getattr(error, "lineno", None) or (frames[-1].lineno if frames else 1)
        raise DeclarationError(
            f"the model file {path} fails in line {line}: {type(error).__name__}: {error}. Correct it there."
        ) from None
    return module


@contextlib.contextmanager
def _beside(path: Path) -> Iterator[None]:
    """Let a model file import the files beside it, as it does where Python runs it; behind everything else that is found."""
    folder = str(path.parent.resolve())
    new = folder not in sys.path
    if new:
        sys.path.append(folder)
    try:
        yield
    finally:
        if new and folder in sys.path:
            sys.path.remove(folder)


def _is_component(thing: object) -> TypeGuard[type[Component]]:
    return isinstance(thing, type) and issubclass(thing, Component) and thing is not Component


def _is_own_component(thing: object, module: ModuleType) -> bool:
    return _is_component(thing) and getattr(thing, "__module__", "") == module.__name__


@functools.cache
def _ship_files() -> dict[str, Path]:
    folder = Path(str(resources.files(_PACKAGE).joinpath("ships")))
    return {p.stem: p for p in sorted(folder.glob("*.toml"))}


def known_ships() -> dict[str, ParameterSet]:
    """Return every parameter set that came with the installation."""
    return {n: find_ship(n) for n in _ship_files()}


@functools.cache
def _read_known(name: str) -> ParameterSet:
    return read_parameter_set(_ship_files()[name])


def find_ship(name: str | Path) -> ParameterSet:
    """Return a ship by name, or from the path of a parameter set.

    Parameters
    ----------
    name : str or Path
        ``"zeefakkel"``, or the path of a TOML file (`shipid.parameters.parameter_file.read_parameter_set`).

    Raises
    ------
    UnknownNameError
        If there is no such ship; the message offers the nearest.
    ParameterSetError
        If the file is not a parameter set.
    """
    if str(name) in _ship_files():
        return _read_known(str(name))
    if str(name).endswith(".toml") or Path(name).is_file():
        return read_parameter_set(name)
    raise UnknownNameError(
        "ship", str(name), _ship_files(), "A parameter set of your own is given as path/to/ship.toml."
    )
