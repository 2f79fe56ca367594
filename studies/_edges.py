"""Wild samples in the first, second, last but one and last row of each channel: found, and never answered by another repair."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from _faults import Log

import shipid
from shipid.trials.doctor.findings import Finding

CHANNELS = ("psi", "r", "u", "x", "y", "delta")
ROWS = (0, 1, -2, -1)
#: A wild sample by its size in ranges of the channel; the sign changes from one to the next.
SIZES = (1.0, 3.0, 30.0)
#: What a wild sample is called, and what may stand beside it: a heading that wraps is no repair of numbers.
NAMED = ("outlier", "heading-glitch", "heading-interpolated", "position-jump")


def edge_table(
    trials: list[tuple[shipid.Trial, str]], folder: Path, sizes: tuple[float, ...] = SIZES
) -> dict[str, dict[str, int | list[str]]]:
    """Plant one wild sample at a time.

    Parameters
    ----------
    trials : list of tuple
        Clean trials, each with the name of its ship.
    folder : Path
        For the logs.
    sizes : tuple of float
        Sizes of the wild samples, in ranges of the channel.

    Returns
    -------
    dict
        By channel: how many were planted, how many were found in their row, and the repairs of another kind they drew.
    """
    table: dict[str, dict[str, int | list[str]]] = {}
    for channel in CHANNELS:
        asked, found, others = 0, 0, []
        for k, (trial, ship) in enumerate(trials):
            if not trial.has(channel) or (channel != "u" and float(np.ptp(trial[channel])) == 0):
                continue
            for row in ROWS:
                for s, size in enumerate(sizes):
                    log = Log(trial, ship, k)
                    # The sizes of a steady speed and of a position are those of the number itself.
                    reach = max(
                        float(np.ptp(log[channel])), float(np.abs(log[channel]).max()) if channel == "u" else 0.0
                    )
                    log[channel][row] += size * reach * (-1) ** (k + s + row)
                    path = folder / "edge.csv"
                    log.frame().to_csv(path, index=False, float_format="%.10g")
                    seen = shipid.check_trial(path, ship=ship).findings
                    asked += 1
                    found += any(_names(f, channel, row % log.n) for f in seen)
                    others += [
                        f"{f.kind} of {f.channel}"
                        for f in seen
                        if f.repaired and f.kind not in (*NAMED, "heading-wrap")
                    ]
        table[channel] = {"asked": asked, "found": found, "other repairs": others}
    return table


def _names(finding: Finding, channel: str, row: int) -> bool:
    """Whether a finding names a wild sample of a channel in its row, or in the one beside it."""
    near = finding.rows[0] - 1 <= row <= finding.rows[1] + 1
    return finding.kind in NAMED and channel in finding.channels and near and finding.confidence >= 0.5
