"""What a zig-zag measures."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import ClassVar

from shipid.trials.measuring.results.measures import Measures, quantity, words


@dataclass(frozen=True, repr=False, kw_only=True)
class ZigZag(Measures):
    """A zig-zag, in the terms of ITTC 7.5-04-02-01. `executes` are the reversals: the second execute and on.

    Attributes
    ----------
    kind : str
        ``"zig-zag"``.
    part, columns, beside
        The table of the reversals, see `Measures`.
    nominal : str
        Rudder angle and heading of the zig-zag, such as 20/10, to the nearest 5 deg.
    first_side : {"starboard", "port"}
        The side of the first plate measured.
    doubt : str
        Why it may be no zig-zag, in words; empty where nothing speaks against it.
    heading, period, reach, initial_turning_time, initial_turning_distance, initial_turning_ratio : float or None
        See the meaning of each in `quantities`.
    initial_turning_ability, initial_turning_ability_uncertainty, initial_turning_ability_ratio : float or None
        The track until the heading has changed by the angle of the zig-zag, wherever the rudder was reversed.
    executes : tuple of float or None
        One a reversal.
    execute_headings, overshoots, overshoot_uncertainties, overshoots_moved, overshoots_set_out, extreme_headings, \
times_to_check_yaw : tuple of float or None
        Entry k belongs to reversal k. Where the order was read back from the ramp of the rudder, `overshoots_moved` are those
        after the rudder has left its plate by 15 %: the value of the other reading. Where the order is logged and the rudder sets
        out later, `overshoots_set_out` are those from there; where no steering gear starts so late, the uncertainties hold both.
    """

    kind: ClassVar[str] = "zig-zag"
    part: ClassVar[str] = "reversal"
    columns: ClassVar[Mapping[str, tuple[str, int]]] = {
        "executes": ("execute", 2),
        "execute_headings": ("heading", 2),
        "overshoots": ("overshoot", 2),
        "overshoot_uncertainties": ("±", 2),
        "overshoots_moved": ("rudder moved", 2),
        "overshoots_set_out": ("set out", 2),
        "extreme_headings": ("extreme", 2),
        "times_to_check_yaw": ("check yaw", 2),
    }
    beside: ClassVar[tuple[str, ...]] = ("overshoot_uncertainties", "overshoots_moved", "overshoots_set_out")
    nominal: str = words()
    first_side: str = words()
    doubt: str = ""
    heading: float | None = quantity("rad", "heading change at the executes, median")
    executes: tuple[float | None, ...] | None = quantity("s", "times of the reversals: second execute and on")
    execute_headings: tuple[float | None, ...] | None = quantity(
        "rad", "heading at each reversal, from the initial course"
    )
    overshoots: tuple[float | None, ...] | None = quantity("rad", "overshoot angle after each reversal")
    overshoot_uncertainties: tuple[float | None, ...] | None = quantity(
        "rad", "95 % uncertainty of each: interval of the execute, scatter and sampling of the heading"
    )
    overshoots_moved: tuple[float | None, ...] | None = quantity(
        "rad", "overshoot angle from where the rudder is 15 % off the angle it held"
    )
    overshoots_set_out: tuple[float | None, ...] | None = quantity(
        "rad", "overshoot angle from where the rudder sets out, where that is after the logged order"
    )
    extreme_headings: tuple[float | None, ...] | None = quantity(
        "rad", "extreme heading after each reversal, from the initial course"
    )
    times_to_check_yaw: tuple[float | None, ...] | None = quantity("s", "from each reversal to the extreme heading")
    period: float | None = quantity("s", "complete cycle: between reversals to the same side, mean")
    reach: float | None = quantity("s", "from the first execute to the return to the initial course")
    initial_turning_time: float | None = quantity("s", "from the first to the second execute")
    initial_turning_distance: float | None = quantity("m", "track between first and second execute")
    initial_turning_ratio: float | None = quantity("1", "that track in ship lengths")
    initial_turning_ability: float | None = quantity(
        "m", "track from the first execute until the heading has changed by the angle of the zig-zag"
    )
    initial_turning_ability_uncertainty: float | None = quantity(
        "m", "95 % uncertainty of that track: moment of the order, heading, scatter of the speed"
    )
    initial_turning_ability_ratio: float | None = quantity("1", "that track in ship lengths")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``zig-zag 20/10``."""
        return f"{self.kind} {self.nominal}"

    @property
    def leading_executes(self) -> tuple[float, ...]:
        """Times of the reversals up to the first that is not known [s]."""
        return _leading(self.executes)

    @property
    def leading_overshoots(self) -> tuple[float, ...]:
        """Overshoots up to the first that is not known or not reached [rad]: entry k belongs to leading execute k."""
        return _leading(self.overshoots)[: len(self.leading_executes)]

    def _lines(self, without: Collection[str] = ()) -> list[str]:
        """The quantities, and why an overshoot is not known."""
        why = {key[11:-1]: text for key, text in self.reasons.items() if key.startswith("overshoots[")}
        return [*super()._lines(without), *(f"  overshoot {k:<18s} not known: {text}" for k, text in why.items())]


def _leading(values: tuple[float | None, ...] | None) -> tuple[float, ...]:
    known: list[float] = []
    for value in values or ():
        if value is None:
            break
        known.append(value)
    return tuple(known)
