"""Results of measuring a manoeuvre: frozen, with units, JSON-able."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import pandas as pd

from shipid.declaration import units


def quantity(unit: str, display: str, meaning: str) -> Any:
    """Return a field that carries the unit inside, the unit shown, and the meaning of a measured quantity."""
    return field(default=None, metadata={"unit": unit, "display": display, "meaning": meaning})


@dataclass(frozen=True, repr=False, kw_only=True)
class Measures:
    """What a manoeuvre amounts to; SI inside, shown in the units of the field.

    Attributes
    ----------
    trial : str
        Name of the trial.
    execute : {"moved", "order"}
        How the execute was read (`shipid.trials.measuring.rudder`).
    """

    kind: ClassVar[str] = "manoeuvre"
    trial: str
    execute: str

    def quantities(self) -> Iterator[tuple[str, Any, str, str]]:
        """Yield name, value in the unit shown (None where not reached), that unit, and meaning."""
        for entry in fields(self):
            if "unit" not in entry.metadata:
                continue
            shown = entry.metadata["display"]
            factor = units.factor(entry.metadata["unit"], shown)
            value = getattr(self, entry.name)
            if isinstance(value, tuple):
                value = tuple(None if v is None else v * factor for v in value)
            elif value is not None:
                value = value * factor
            yield entry.name, value, shown, entry.metadata["meaning"]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values: for every quantity its value (or list), unit and meaning; None where not reached."""
        result: dict[str, Any] = {"kind": self.kind, "trial": self.trial, "execute": self.execute}
        result |= {e.name: getattr(self, e.name) for e in fields(self) if "text" in e.metadata}
        for name, value, unit, meaning in self.quantities():
            plain = list(value) if isinstance(value, tuple) else value
            result[name] = {"value": plain, "unit": unit, "meaning": meaning}
        return result

    def to_frame(self) -> pd.DataFrame:
        """Return one row a number: quantity, value, unit, meaning (NaN where not reached)."""
        rows = []
        for name, value, unit, meaning in self.quantities():
            several = value if isinstance(value, tuple) else (value,)
            for k, single in enumerate(several, start=1):
                label = f"{name}[{k}]" if isinstance(value, tuple) else name
                rows.append((label, float("nan") if single is None else single, unit, meaning))
        return pd.DataFrame(rows, columns=["quantity", "value", "unit", "meaning"])

    def __repr__(self) -> str:
        read = "the order" if self.execute == "order" else "the rudder leaving its plate"
        lines = [f"{self.title} in trial '{self.trial}', executes read from {read}"]
        for name, value, unit, _ in self.quantities():
            if value is None or value == ():
                continue
            shown = "" if unit == "1" else " " + units.pretty(unit)
            several = value if isinstance(value, tuple) else (value,)
            numbers = ", ".join("not reached" if v is None else f"{v:.4g}" for v in several)
            lines.append(f"  {name.replace('_', ' '):<28s} {numbers}{shown}")
        return "\n".join(lines)

    @property
    def title(self) -> str:
        """What the manoeuvre is called."""
        return self.kind


@dataclass(frozen=True, repr=False, kw_only=True)
class ZigZag(Measures):
    """A zig-zag, in the terms of ITTC 7.5-04-02-01. `executes` are the reversals: the second execute and on.

    Entry k of `execute_headings`, `overshoots`, `times_to_check_yaw` and `extreme_headings` belongs to reversal k.
    """

    kind: ClassVar[str] = "zig-zag"
    nominal: str = field(default="", metadata={"text": True})
    """Rudder angle and heading of the zig-zag, such as 20/10, to the nearest 5 deg."""
    first_side: str = field(default="", metadata={"text": True})
    """The side of the first plate measured: starboard or port."""
    rudder: float | None = quantity("rad", "deg", "rudder angle held, median")
    heading: float | None = quantity("rad", "deg", "heading change at the executes, median")
    course: float | None = quantity("rad", "deg", "initial course")
    approach_speed: float | None = quantity("m/s", "m/s", "speed at the first execute")
    first_execute: float | None = quantity("s", "s", "time of the first execute")
    executes: tuple[float | None, ...] | None = quantity("s", "s", "times of the reversals: second execute and on")
    execute_headings: tuple[float | None, ...] | None = quantity(
        "rad", "deg", "heading at each reversal, from the initial course"
    )
    overshoots: tuple[float | None, ...] | None = quantity("rad", "deg", "overshoot angle after each reversal")
    extreme_headings: tuple[float | None, ...] | None = quantity(
        "rad", "deg", "extreme heading after each reversal, from the initial course"
    )
    times_to_check_yaw: tuple[float | None, ...] | None = quantity(
        "s", "s", "from each reversal to the extreme heading"
    )
    period: float | None = quantity("s", "s", "complete cycle: between reversals to the same side, mean")
    reach: float | None = quantity("s", "s", "from the first execute to the return to the initial course")
    initial_turning_time: float | None = quantity("s", "s", "from the first to the second execute")
    initial_turning_distance: float | None = quantity("m", "m", "track between first and second execute")
    initial_turning_ratio: float | None = quantity("1", "1", "that track in ship lengths")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``zig-zag 20/10``."""
        return f"{self.kind} {self.nominal}"


@dataclass(frozen=True, repr=False, kw_only=True)
class TurningCircle(Measures):
    """A turning circle, in the terms of IMO MSC.137(76) 4.2 and ITTC 7.5-04-02-01."""

    kind: ClassVar[str] = "turning circle"
    side: str = field(default="", metadata={"text": True})
    """The side it turns to: starboard or port."""
    track: str = field(default="", metadata={"text": True})
    """Where the track comes from: positions, or speeds and heading."""
    rudder: float | None = quantity("rad", "deg", "rudder angle held, median")
    approach_speed: float | None = quantity("m/s", "m/s", "speed at the execute")
    first_execute: float | None = quantity("s", "s", "time of the execute")
    course: float | None = quantity("rad", "deg", "initial course")
    advance: float | None = quantity("m", "m", "along the initial course, at 90 deg")
    transfer: float | None = quantity("m", "m", "across the initial course, at 90 deg")
    tactical_diameter: float | None = quantity("m", "m", "across the initial course, at 180 deg")
    advance_ratio: float | None = quantity("1", "1", "advance in ship lengths")
    transfer_ratio: float | None = quantity("1", "1", "transfer in ship lengths")
    tactical_diameter_ratio: float | None = quantity("1", "1", "tactical diameter in ship lengths")
    times: tuple[float | None, ...] | None = quantity("s", "s", "from the execute to 90, 180, 270, 360 deg")
    speeds: tuple[float | None, ...] | None = quantity("m/s", "m/s", "speed at 90, 180, 270, 360 deg")
    steady_rate: float | None = quantity("rad/s", "deg/s", "steady rate of turn, size")
    steady_speed: float | None = quantity("m/s", "m/s", "steady speed in the turn")
    steady_drift: float | None = quantity("rad", "deg", "steady drift angle, size")
    steady_diameter: float | None = quantity("m", "m", "steady turning diameter")
    steady_diameter_ratio: float | None = quantity("1", "1", "steady turning diameter in ship lengths")
    speed_loss: float | None = quantity("1", "1", "share of the approach speed lost in the steady turn")
    pull_out_rate: float | None = quantity("rad/s", "deg/s", "rate of turn left after the pull-out, to starboard")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``turning circle to port``."""
        return f"{self.kind} to {self.side}"
