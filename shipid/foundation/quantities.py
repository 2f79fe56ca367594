"""Numbers beside their units, as a result hands them over: one form in every ``to_dict`` and every JSON."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.foundation.aliases import Plain

#: How the name of an attribute ends that is not SI or says its unit for another reason; the longer ending goes first.
_ENDINGS = {"_rad_s": "rad/s", "_deg_s": "deg/s", "_m_s": "m/s", "_deg": "deg", "_m": "m", "_s": "s"}


def quantity(value: Plain, unit: str) -> dict[str, Plain]:
    """Return a value beside its unit: ``{"value": 12.0, "unit": "s"}``.

    Parameters
    ----------
    value : float, list of float or None
        The number; None where it is not known.
    unit : str
        Its unit.
    """
    return {"value": value, "unit": unit}


def with_units(values: Mapping[str, Plain], **units: str) -> dict[str, Plain]:
    """Return plain values with the unit beside the number instead of in its name.

    Parameters
    ----------
    values : mapping of str to plain values
        ``settling_s`` becomes ``settling`` with the unit s; a name that ends in no unit stays.
    **units : str
        Units of names that do not say them.
    """
    found: dict[str, Plain] = {}
    for name, value in values.items():
        base, unit = _split(name)
        unit = units.get(name, unit)
        found[base] = value if unit is None else quantity(value, unit)
    return found


def columns_of(values: Mapping[str, Plain]) -> dict[str, Plain]:
    """Return a row of a table: a number beside its unit becomes a column ``name [unit]``.

    Parameters
    ----------
    values : mapping of str to plain values
        As `with_units` returns them.
    """
    return {
        (f"{n} [{v['unit']}]" if _is_quantity(v) else n): v["value"] if _is_quantity(v) else v
        for n, v in values.items()
    }


def _split(name: str) -> tuple[str, str | None]:
    for ending, unit in _ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending), unit
    return name, None


def _is_quantity(value: Plain) -> bool:
    return isinstance(value, Mapping) and set(value) == {"value", "unit"}
