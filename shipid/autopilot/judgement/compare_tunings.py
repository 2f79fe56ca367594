"""Two tunings side by side: the same numbers of both, and which is better where one is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipid.autopilot.judgement.judgement import Judgement
from shipid.autopilot.judgement.margins import Margins
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import notice_of, plain_notices
from shipid.foundation.numbers import brief, number
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd


#: The quantity that nobody knows where a ship states no uncertainty.
OVER_DRAWS = "least disk margin over the uncertainty"


@dataclass(frozen=True)
class ComparedRow:
    """One quantity of two tunings.

    Attributes
    ----------
    what, unit : str
        The quantity.
    values : tuple of float or None
        Of the first and of the second tuning.
    better : int or None
        0 or 1; None where they are equal, or neither is better.
    """

    what: str
    unit: str
    values: tuple[float | None, float | None]
    better: int | None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {"what": self.what, "unit": self.unit, "values": list(self.values), "better": self.better}


@dataclass(frozen=True, eq=False, repr=False)
class TuningComparison(DrawnResult):
    """Two tunings side by side.

    Attributes
    ----------
    names : tuple of str
        Their names.
    judged : tuple of Judgement
        Both, each for its own ship.
    rows : tuple of ComparedRow
        Their numbers.
    warnings : tuple of str
        Notes for the reader.
    """

    names: tuple[str, str]
    judged: tuple[Judgement, Judgement]
    rows: tuple[ComparedRow, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, free of NaN."""
        return {
            "names": list(self.names),
            "rows": [r.to_dict() for r in self.rows],
            "tunings": [j.to_dict() for j in self.judged],
            "warnings": plain_notices(self.warnings),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the rows as a pandas table."""
        import pandas as pd

        rows = [
            {"what": f"{r.what} [{r.unit}]" if r.unit else r.what, **dict(zip(self.names, r.values))} for r in self.rows
        ]
        return pd.DataFrame(rows).set_index("what")

    def text(self) -> str:
        """Return the result in lines of text."""
        width = max(len(r.what) + len(r.unit) + 3 for r in self.rows)
        lines = ["".ljust(width + 2) + "".join(n[-20:].rjust(22) for n in self.names)]
        for r in self.rows:
            name = f"{r.what} [{r.unit}]" if r.unit else r.what
            cells = "".join(
                ((_nothing(r.what, "-") if v is None else number(v, 4)) + (" *" if r.better == k else "  ")).rjust(22)
                for k, v in enumerate(r.values)
            )
            lines.append(f"  {name.ljust(width)}{cells}")
        return "\n".join([*lines, "  * the better one", *(f"  {w}" for w in self.warnings)])


def _nothing(what: str, otherwise: str) -> str:
    return "not known" if what == OVER_DRAWS else otherwise


def compare_tunings(first: Judgement, second: Judgement, names: tuple[str, str]) -> TuningComparison:
    """Put two tunings side by side.

    Parameters
    ----------
    first, second : Judgement
        The tunings; each is judged on the ship of its own file.
    names : tuple of str
        Their names.

    Returns
    -------
    TuningComparison
    """
    rows: list[ComparedRow] = []
    for what, unit, read, sense in _QUANTITIES:
        a, b = plain(read(first)), plain(read(second))
        better = None
        if what == OVER_DRAWS and None in (a, b):
            # What is not known is no worse.
            sense = 0
        if sense and a is not None and b is not None and a != b:
            better = int((b > a) == (sense > 0))
        elif sense and (a is None) != (b is None):
            better = int(a is None)
        rows.append(ComparedRow(what, unit, (a, b), better))
    warnings = []
    one, two = first.pilot, second.pilot
    if one.ships != two.ships or one.model != two.model:
        warnings.append(
            "two ships: the tunings were designed for different ships or models, and each is judged on its own. Compare designs "
            "of one ship to compare designs."
        )
    if one.service_speed != two.service_speed:
        warnings.append(
            f"two speeds: the ships' own speeds are {brief(one.service_speed)} and {brief(two.service_speed)} m/s."
        )
    for name, judged in zip(names, (first, second)):
        warnings += [notice_of(w).about(name) for w in judged.warnings]
    return TuningComparison(names, (first, second), tuple(rows), tuple(warnings))


def _worst(read: Callable[[Margins], float | None]) -> Callable[[Judgement], float | None]:
    def worst(j: Judgement) -> float | None:
        values = [read(m) for group in (*j.margins, *j.between) for m in group]
        return min((v for v in values if v is not None), default=None)

    return worst


def _gain(name: str) -> Callable[[Judgement], float | None]:
    def gain(j: Judgement) -> float | None:
        return float(getattr(j.pilot.gains(j.pilot.service_speed), name))

    return gain


def _change(name: str, degrees: float, calm: bool = True) -> Callable[[Judgement], float | None]:
    def change(j: Judgement) -> float | None:
        if calm:
            runs = [s for s in j.steps if s.change_deg == degrees and abs(s.speed - j.pilot.own_speed) < 1e-9]
        else:
            runs = [s for s in j.in_weather if s.change_deg == degrees and s.sea_filter]
        values = [getattr(s, name) for s in runs]
        if not values or any(v is None for v in values):
            return None
        return float(max(abs(v) for v in values))

    return change


#: Quantity, unit, how it is read, and whether more (1) or less (-1) is better.
_QUANTITIES: tuple[tuple[str, str, Callable[[Judgement], float | None], int], ...] = (
    ("Kp at the ship's own speed", "", _gain("Kp"), 0),
    ("Kd at the ship's own speed", "s", _gain("Kd"), 0),
    ("Ki at the ship's own speed", "1/s", _gain("Ki"), 0),
    ("least disk margin", "", _worst(lambda m: m.disk), 1),
    (OVER_DRAWS, "", lambda j: min(r.disk_worst for r in j.robust) if all(r.samples for r in j.robust) else None, 1),
    ("least phase margin", "deg", _worst(lambda m: m.phase_deg), 1),
    ("least delay margin", "s", _worst(lambda m: m.delay_s), 1),
    ("least bandwidth", "rad/s", _worst(lambda m: m.bandwidth), 0),
    ("overshoot, 10 deg", "deg", _change("overshoot_deg", 10.0), -1),
    ("overshoot, 60 deg", "deg", _change("overshoot_deg", 60.0), -1),
    ("settling, 10 deg", "s", _change("settling_s", 10.0), -1),
    ("settling, 60 deg", "s", _change("settling_s", 60.0), -1),
    ("rms heading error in weather, at worst", "deg", _change("rms_error_deg", 0.0, calm=False), -1),
    ("steady heading error in weather, at worst", "deg", _change("mean_error_deg", 0.0, calm=False), -1),
    ("rms rudder in weather, at worst", "deg", _change("rms_rudder_deg", 0.0, calm=False), -1),
    ("rudder reversals in weather, at worst", "1/min", _change("reversals", 0.0, calm=False), -1),
)
