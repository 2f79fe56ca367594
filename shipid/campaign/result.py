"""The result of a campaign: the statistics of each measure over the runs, and where the runs lie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from shipid.campaign.moments import Statistic
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_factor, display_unit
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import counted, estimate, number
from shipid.foundation.result import DrawnResult

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class CampaignResult(DrawnResult):
    """What a campaign found.

    Attributes
    ----------
    name : str
        Of the study.
    runs, seed, batch : int
        Number of runs, seed, and runs in a batch.
    statistics : mapping of str to Statistic
        By measure.
    folder : Path or None
        Where the runs lie (`shipid.campaign.table.read_runs`); None where they were not kept.
    provenance : mapping
        Versions, engine, identity of the study.
    warnings : tuple of Notice
        What limits the statistics.
    """

    name: str
    runs: int
    seed: int
    batch: int
    statistics: Mapping[str, Statistic]
    folder: Path | None
    provenance: Mapping[str, Plain]
    warnings: tuple[Notice, ...] = ()

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON: SI, no NaN."""
        return {
            "campaign": self.name,
            "runs": self.runs,
            "seed": self.seed,
            "batch": self.batch,
            "measures": {n: s.to_dict() for n, s in self.statistics.items()},
            "warnings": plain_notices(self.warnings),
            "provenance": dict(self.provenance),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return one row a measure, as a pandas table."""
        import pandas as pd

        fields = ("runs", "missing", "mean", "mean_interval", "std", "low", "high", "rmse", "rmse_interval")
        rows = [
            {"measure": n, "kind": s.measure.kind, "unit": s.measure.unit, **{f: getattr(s, f) for f in fields}}
            for n, s in self.statistics.items()
        ]
        return pd.DataFrame(rows).set_index("measure")

    def text(self) -> str:
        """Return the result in lines of text."""
        width = max(len(n) for n in self.statistics)
        lines = [f"campaign {self.name}: {counted(self.runs, 'run')}, seed {self.seed}"]
        lines += [f"  {n.ljust(width)}  {summary(s)}" for n, s in self.statistics.items()]
        return "\n".join([*lines, *(f"  warning: {w}" for w in self.warnings)])


def summary(found: Statistic) -> str:
    """Return the statistics of one measure in a line.

    Parameters
    ----------
    found : Statistic
        Of a measure.
    """
    inside = found.measure.unit
    unit, factor = "" if inside == "1" else f" {pretty(display_unit('', inside))}", display_factor("", inside)
    tail = f"; missing in {found.missing} of {found.runs} runs" if found.missing else ""
    if found.texts is not None:
        most = list(found.texts.items())
        return (
            ", ".join(f"{text or '(empty)'}: {count}" for text, count in most[:6])
            + (", ..." if most[6:] else "")
            + tail
        )
    mean = _estimate(found.mean, found.mean_interval, factor) + unit
    if found.measure.kind == "error":
        return f"RMSE {_estimate(found.rmse, found.rmse_interval, factor)}{unit}, mean error {mean}{tail}"
    if found.measure.kind == "nees":
        ends = found.expected_interval
        band = f", consistent ({number(ends[0], 3)} to {number(ends[1], 3)})" if ends else ""
        return f"mean {mean} of {found.measure.degrees} degrees of freedom{band}{tail}"
    if found.measure.kind == "event":
        return f"share {mean}{tail}"
    std, low, high = found.told(factor)
    spread = f", standard deviation {std}{unit}, from {low} to {high}"
    return f"mean {mean}{spread}{tail}"


def _estimate(value: float | None, ends: tuple[float, float] | None, factor: float) -> str:
    shown, between = estimate(value, ends, factor)
    return f"{shown} ({between})" if between else shown
