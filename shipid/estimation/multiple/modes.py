"""The modes of a multiple-model filter: a model each, with coefficients, constant inputs and noise of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter
from shipid.estimation.errors import ModeError
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.parameters.catalogue import model_of
from shipid.parameters.parameter_set import ParameterSet

#: Settings that name quantities: what is given for all modes goes to those that have the quantity.
_BY_NAME = ("values", "noise", "initial", "start", "inputs", "lost")


@dataclass(frozen=True)
class Mode:
    """A mode: one of the models that may hold.

    Attributes
    ----------
    model : Model, component class or str
        The model.
    ship : ParameterSet or str, optional
        Its coefficients and particulars.
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI.
    inputs : mapping of str to str, optional
        Constant inputs with units, such as the rate of turn of this mode.
    noise : mapping of str to str, optional
        What drives its states and inputs, as for `shipid.ExtendedKalmanFilter`; it goes before what is given for all modes.
    """

    model: Model | type[Component] | str
    ship: ParameterSet | str | None = None
    values: Mapping[str, float] | None = None
    inputs: Mapping[str, Amount] | None = None
    noise: Mapping[str, Amount] | None = None


#: What stands for a mode where a filter is made: a mode, or a model without settings of its own.
ModeLike = Mode | Model | type[Component] | str


def design_modes(models: Mapping[str, ModeLike], common: FilterSettings) -> dict[str, FilterDesign]:
    """Return the design of each mode's filter.

    Parameters
    ----------
    models : mapping of str to Mode or Model
        By name.
    common : FilterSettings
        What holds for all modes; quantities named there go to the modes that have them.

    Raises
    ------
    ModeError
        If there is no mode, or the modes measure in different units.
    UnknownNameError
        If a setting names a quantity that no mode has.
    ShipidError
        For names, units and levels that do not fit.
    """
    if not models:
        raise ModeError(
            "a multiple-model filter needs at least one model, as in models={'straight': constant_velocity}."
        )
    modes = {n: m if isinstance(m, Mode) else Mode(m) for n, m in models.items()}
    found = {n: model_of(m.model) for n, m in modes.items()}
    for setting in _BY_NAME:
        for name in getattr(common, setting) or {}:
            if not any(name in model for model in found.values()):
                known = sorted({n for model in found.values() for n in model.entries})
                raise UnknownNameError(f"quantity of any mode, named in {setting}, called", name, known)
    designs = {n: design_filter(found[n], m.ship, _own(m, found[n], common)) for n, m in modes.items()}
    check_modes(designs)
    return designs


def check_modes(designs: Mapping[str, FilterDesign]) -> None:
    """Raise an error for filters that cannot be the modes of one.

    Parameters
    ----------
    designs : mapping of str to FilterDesign
        The modes.

    Raises
    ------
    ModeError
        If there is none, or they do not read the same sensors, or are made with what a mode has not: a gate, shared noise, a square
        root, a switch.
    """
    if not designs:
        raise ModeError(
            "a multiple-model filter needs at least one model, as in models={'straight': constant_velocity}."
        )
    first = next(iter(designs.values()))
    for name, design in designs.items():
        if (
            design.gate is not None
            or design.layout.joint != design.layout.n
            or design.form != "covariance"
            or design.switchable
        ):
            raise ModeError(
                f"the filter of mode '{name}' is made with a gate, shared noise, a square root or a switch: make it with gate=None and "
                "shared_noise=False, and leave the others out."
            )
        if design.measured != first.measured or (design.r != first.r).any():
            raise ModeError(
                f"mode '{name}' reads {', '.join(design.measured)} and the first mode {', '.join(first.measured)}: modes must read the "
                "same sensors with the same noise."
            )
        for sensor in first.measured:
            if design.model[sensor].unit != first.model[sensor].unit:
                raise ModeError(
                    f"'{sensor}' is measured in {first.model[sensor].unit} by the first mode and in {design.model[sensor].unit} by "
                    f"mode '{name}': modes must read the same sensors."
                )


def _own(mode: Mode, model: Model, common: FilterSettings) -> FilterSettings:
    """The settings of one mode: what is given for all as far as it has the quantities, and its own."""
    chosen: dict[str, Plain] = {
        s: {n: v for n, v in (getattr(common, s) or {}).items() if n in model} for s in _BY_NAME
    }
    for setting in ("values", "inputs", "noise"):
        chosen[setting] = chosen[setting] | dict(getattr(mode, setting) or {})
    # A state that is noise in one model may be an input in another; what is none of both there does not drive it.
    driven = {*model.states, *model.inputs}
    chosen["noise"] = {n: v for n, v in chosen["noise"].items() if n in driven or n in (mode.noise or {})}
    for setting, names in (
        ("initial", model.states),
        ("start", model.states),
        ("inputs", model.inputs),
        ("lost", model.inputs),
    ):
        own = getattr(mode, setting, None) or {}
        chosen[setting] = {n: v for n, v in chosen[setting].items() if n in names or n in own}
    return replace(common, estimated=(), gate=None, shared_noise=False, form="covariance", **chosen)
