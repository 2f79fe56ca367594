"""The sensors of a filter, how often and in which range they are read, and its inputs."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError, SensorRateError
from shipid.foundation.errors import UnitError, UnknownNameError, UsageError

#: A number with its unit, as a user gives it: ``"0.2 deg"`` or ``(0.2, "deg")``; bare only where it has no dimension.
Amount: TypeAlias = "str | float | tuple[float, str]"


@dataclass(frozen=True, eq=False)
class Instruments:
    """Sensors and inputs of a filter, SI.

    Attributes
    ----------
    model : Model
        The model.
    sensors : tuple of str
        Measured quantities: states, derived quantities or outputs.
    needed : tuple of str
        Inputs that have an influence on what is estimated and measured.
    inputs : mapping of str to float
        Constant values of inputs; they go before what a record holds.
    rates : mapping of str to float
        Seconds between the samples of a sensor, where it is read less often than the record is sampled.
    ranges : mapping of str to tuple of float
        Smallest and largest value a sensor can show.
    lost : mapping of str to float
        Standard deviation of an input while it is missing.
    scale : Scale
        Length and speed of the ship; the speed is used where a record has none.
    biases : mapping of str to float
        What is added to inputs that a record or a sample holds.
    delays : mapping of str to float
        How much later inputs act than a record holds them, in s.
    """

    model: Model
    sensors: tuple[str, ...]
    needed: tuple[str, ...]
    inputs: Mapping[str, float] = field(default_factory=dict)
    rates: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lost: Mapping[str, float] = field(default_factory=dict)
    scale: Scale = field(default_factory=lambda: Scale(None, None))
    biases: Mapping[str, float] = field(default_factory=dict)
    delays: Mapping[str, float] = field(default_factory=dict)

    def quantity_of(self, sensor: str) -> str:
        """Return the quantity a sensor measures: its own name, or what its output is declared to measure.

        Parameters
        ----------
        sensor : str
            A measured quantity.
        """
        return self.model[sensor].quantity.measures or sensor

    def column_of(self, sensor: str, columns: Collection[str]) -> str | None:
        """Return the column that holds what a sensor shows; None if there is none.

        Parameters
        ----------
        sensor : str
            A measured quantity.
        columns : collection of str
            What the record or the sample has.
        """
        return column_of(self.model, sensor, columns)

    def with_quantities(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Return a sample with the measured quantities under their own names beside those of the sensors.

        Parameters
        ----------
        sample : mapping of str to float
            By column, SI.
        """
        result = dict(sample)
        for sensor in self.sensors:
            column = self.column_of(sensor, sample)
            if column is not None:
                result.setdefault(self.quantity_of(sensor), sample[column])
        return result


def column_of(model: Model, name: str, columns: Collection[str]) -> str | None:
    """Return the column that holds what a sensor shows: its own name, or the quantity it measures; None if neither.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The measured quantity.
    columns : collection of str
        What the record has.
    """
    return next((n for n in (name, model[name].quantity.measures) if n and n in columns), None)


def read_rates(sensors: tuple[str, ...], rates: Mapping[str, Amount]) -> dict[str, float]:
    """Return how often sensors are read, in s, from an interval such as ``"2 s"`` or a rate such as ``"0.5 Hz"``.

    Parameters
    ----------
    sensors : tuple of str
        Measured quantities.
    rates : mapping of str to str
        By measured quantity.

    Raises
    ------
    NotMeasurableError
        If a name is not measured.
    SensorRateError
        If an interval is zero or negative, or neither a time nor a frequency.
    """
    result = {}
    for name, value in rates.items():
        _check_measured(name, sensors, "rate")
        seconds = _interval(value, name)
        if not seconds > 0:
            raise SensorRateError(f"'{name}' is to be read every {value}: an interval must be longer than zero.")
        result[name] = seconds
    return result


def _check_measured(name: str, sensors: tuple[str, ...], what: str) -> None:
    if name not in sensors:
        raise NotMeasurableError(
            f"a {what} is given for '{name}', which is not measured. Measured: {', '.join(sensors)}."
        )


def _interval(value: Amount, name: str) -> float:
    try:
        return to_si(value, "s", f"interval of '{name}'")
    except UnitError as refused:
        try:
            frequency = to_si(value, "Hz", f"rate of '{name}'")
        except UnitError:
            raise SensorRateError(f"{refused} Give an interval such as '2 s', or a rate such as '0.5 Hz'.") from None
    return 1 / frequency if frequency > 0 else 0.0


def read_inputs(model: Model, inputs: Mapping[str, Amount]) -> dict[str, float]:
    """Return constant inputs, SI.

    Parameters
    ----------
    model : Model
        The model.
    inputs : mapping of str to str
        By input, with units.

    Raises
    ------
    UnknownNameError
        If a name is no input of the model.
    """
    return _of_inputs(model, inputs, "input of model {} called", "input")


def read_lost(model: Model, lost: Mapping[str, Amount]) -> dict[str, float]:
    """Return the standard deviation of inputs while they are missing, SI.

    Parameters
    ----------
    model : Model
        The model.
    lost : mapping of str to str
        Standard deviations by input, with units.

    Raises
    ------
    UnknownNameError
        If a name is no input of the model.
    NoiseLevelError
        If one is zero or negative.
    """
    result = _of_inputs(model, lost, "input of model {} that can be lost called", "uncertainty of lost")
    for name, level in result.items():
        if not level > 0:
            raise NoiseLevelError(f"the uncertainty of lost '{name}' is {lost[name]}; it must be greater than zero.")
    return result


def _of_inputs(model: Model, given: Mapping[str, Amount], kind: str, what: str) -> dict[str, float]:
    for name in given:
        if name not in model.inputs:
            raise UnknownNameError(kind.format(model.name), name, model.inputs)
    return {n: to_si(v, model[n].given_unit, f"{what} '{n}'") for n, v in given.items()}


def read_ranges(
    model: Model, sensors: tuple[str, ...], ranges: Mapping[str, tuple[Amount, Amount]]
) -> dict[str, tuple[float, float]]:
    """Return the smallest and largest value of sensors, SI.

    Parameters
    ----------
    model : Model
        The model.
    sensors : tuple of str
        Measured quantities.
    ranges : mapping of str to tuple of str
        By measured quantity, with units.

    Raises
    ------
    NotMeasurableError
        If a name is not measured.
    UsageError
        If a range is empty.
    """
    result = {}
    for name, (least, most) in ranges.items():
        _check_measured(name, sensors, "range")
        low, high = (to_si(v, model[name].given_unit, f"range of '{name}'") for v in (least, most))
        if not low < high:
            raise UsageError(f"the range of '{name}' runs from {least} to {most}: it holds no value.")
        result[name] = (low, high)
    return result
