"""What a running filter has met so far: samples beyond the gate, and the size of its innovations."""

from __future__ import annotations

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.consistency import FITTING, REJECTED_SHARE
from shipid.estimation.recursion.gate import MISSING, REJECTED, TAKEN
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import percent

#: So many samples of a sensor say something.
_ENOUGH = 60


class Tally:
    """The samples of each sensor so far.

    Parameters
    ----------
    design : FilterDesign
        The filter.

    Attributes
    ----------
    shown, rejected : ndarray of int, shape (sensors,)
        Samples that were there, and those beyond the gate.
    squares : ndarray, shape (sensors,)
        Sum of the squared normalised innovations that were taken.
    """

    def __init__(self, design: FilterDesign) -> None:
        self.design = design
        count = len(design.measured)
        self.shown, self.rejected = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
        self.squares = np.zeros(count)

    def add(self, out: np.ndarray) -> None:
        """Count a sample.

        Parameters
        ----------
        out : ndarray
            What the step returned of it.
        """
        brief = self.design.layout.brief
        e, spread, fate = (out[brief[n]] for n in ("e", "S", "fate"))
        self.shown += fate != MISSING
        self.rejected += fate == REJECTED
        taken = fate == TAKEN
        self.squares[taken] += e[taken] ** 2 / spread[taken]

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What speaks against the filter so far, sensor by sensor."""
        said = []
        for name, shown, rejected, squares in zip(self.design.measured, self.shown, self.rejected, self.squares):
            if shown < _ENOUGH:
                continue
            size = squares / max(shown - rejected, 1)
            if rejected > REJECTED_SHARE * shown:
                said.append(
                    Notice(
                        f"{rejected} of {shown} samples of {name} so far ({percent(rejected / shown)}) are beyond the gate: so many "
                        "are rarely wrong, and the noise levels or the model do not fit. Give --measured and --noise, as "
                        "shipid filter TRIAL finds them from a record.",
                        "rejected",
                        serious=True,
                        sensor=name,
                    )
                )
            elif size > FITTING[1]:
                said.append(
                    Notice(
                        f"The innovations of {name} so far are {np.sqrt(size):.1f} times as large as this filter expects them: "
                        "its noise levels are too small, and so are its standard deviations. Give --measured and --noise, as "
                        "shipid filter TRIAL finds them from a record.",
                        "noise-does-not-fit",
                        serious=True,
                        sensor=name,
                    )
                )
        return tuple(said)
