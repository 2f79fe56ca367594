"""The results of a cascade of filters on a record."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipid.estimation.records.run import FilterRun
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.result import Result

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class CascadeRun(Result):
    """A record and the results of the filters of a cascade.

    Attributes
    ----------
    record : str
        Name of the record.
    runs : mapping of str to FilterRun
        By filter, each at its own samples.
    """

    record: str
    runs: Mapping[str, FilterRun]

    def __getitem__(self, name: str) -> FilterRun:
        """Return what one filter made of the record; an unknown name is an `UnknownNameError`."""
        if name not in self.runs:
            raise UnknownNameError("filter of the cascade called", name, self.runs)
        return self.runs[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.runs)

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table at the samples of the first filter; estimates of the others stand until the next."""
        import pandas as pd

        frames = [run.to_frame() for run in self.runs.values()]
        whole = frames[0]
        for other in frames[1:]:
            new = other[["t [s]", *(c for c in other.columns if c not in whole.columns)]]
            whole = pd.merge_asof(whole, new, on="t [s]")
        return whole

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values, free of NaN."""
        return {"record": self.record, "filters": {n: run.to_dict() for n, run in self.runs.items()}}

    def text(self) -> str:
        """Return the result in lines of text."""
        return "\n".join(f"{n}: {run.text()}" for n, run in self.runs.items())
