"""What a user says of sensors and inputs, read: how often, in which range, which values, how unsure where they are lost."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError, SensorRateError
from shipid.foundation.errors import UnitError, UnknownNameError, UsageError


def read_rates(model: Model, sensors: tuple[str, ...], rates: Mapping[str, str | float]) -> dict[str, float]:
    """Read how often sensors are read: an interval such as ``"2 s"`` or a rate such as ``"0.5 Hz"``; in s.

    Parameters
    ----------
    model : Model
        The model.
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
        if name not in sensors:
            raise NotMeasurableError(
                f"a rate is given for '{name}', which is not measured. Measured: {', '.join(sensors)}."
            )
        seconds = _interval(value, name)
        if not seconds > 0:
            raise SensorRateError(f"'{name}' is to be read every {value}: an interval is longer than zero.")
        result[name] = seconds
    return result


def _interval(value: str | float, name: str) -> float:
    try:
        return to_si(value, "s", f"interval of '{name}'")
    except UnitError as refused:
        try:
            frequency = to_si(value, "Hz", f"rate of '{name}'")
        except UnitError:
            raise SensorRateError(f"{refused} Give an interval such as '2 s', or a rate such as '0.5 Hz'.") from None
    return 1 / frequency if frequency > 0 else 0.0


def read_inputs(model: Model, inputs: Mapping[str, str | float]) -> dict[str, float]:
    """Read constant inputs, SI.

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
    for name in inputs:
        if name not in model.inputs:
            raise UnknownNameError(f"input of model {model.name} called", name, model.inputs)
    return {n: to_si(v, model[n].unit, f"input '{n}'") for n, v in inputs.items()}


def read_lost(model: Model, lost: Mapping[str, str | float]) -> dict[str, float]:
    """Read how unsure inputs are while they are missing, SI.

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
    result = {}
    for name, value in lost.items():
        if name not in model.inputs:
            raise UnknownNameError(f"input of model {model.name} that can be lost called", name, model.inputs)
        result[name] = to_si(value, model[name].unit, f"uncertainty of lost '{name}'")
        if not result[name] > 0:
            raise NoiseLevelError(f"the uncertainty of lost '{name}' is {value}; it is greater than zero.")
    return result


def read_ranges(
    model: Model, sensors: tuple[str, ...], ranges: Mapping[str, tuple[str, str]]
) -> dict[str, tuple[float, float]]:
    """Read the smallest and largest value of sensors, SI.

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
        if name not in sensors:
            raise NotMeasurableError(
                f"a range is given for '{name}', which is not measured. Measured: {', '.join(sensors)}."
            )
        low, high = (to_si(v, model[name].unit, f"range of '{name}'") for v in (least, most))
        if not low < high:
            raise UsageError(f"the range of '{name}' runs from {least} to {most}: it holds no value.")
        result[name] = (low, high)
    return result
