"""Stretches of a log without a plot: what sailed through them was not seen, and its track may go on with another target."""

from __future__ import annotations

import numpy as np

from shipid.encounter.plots.plots import Plots
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import counted

#: A silence is so many times as long as scans usually lie apart.
_SILENT = 10.0


def silences(tracks: list[TargetTrack], plots: Plots, patience: float) -> list[Notice]:
    """Return a notice where no sensor showed a plot for longer than a track may be unseen, and tracks go on behind it.

    A scan without plots does not stand in a log, so that nothing there says that a target was missed.

    Parameters
    ----------
    tracks : list of TargetTrack
        All tracks.
    plots : Plots
        What they were made of.
    patience : float
        Time after its last plot at which a lost track ends, s.

    Returns
    -------
    list of Notice
        None or one.
    """
    t = np.unique([scan.t for scan in plots.scans if len(scan.z)])
    if len(t) < 3:
        return []
    apart = np.diff(t)
    silent = np.flatnonzero(apart > max(patience, _SILENT * float(np.median(apart))))
    over = [one.number for one in tracks if any(one.t[0] <= t[k] and one.t[-1] >= t[k + 1] for k in silent)]
    if not over:
        return []
    longest = silent[np.argmax(apart[silent])]
    shown = ", ".join(map(str, over[:10])) + (", ..." if len(over) > 10 else "")
    which = f"track {shown} was" if len(over) == 1 else f"tracks {shown} were"
    of = "" if len(silent) == 1 else f", the longest of {counted(len(silent), 'silence', 'silences')}"
    return [
        Notice(
            f"no plot for {apart[longest]:.0f} s, from {t[longest]:.0f} to {t[longest + 1]:.0f} s{of}: {which} not seen there, and nothing but "
            "the motion before says that the target behind it is the same.",
            "silent-log",
            serious=True,
            tracks=over,
            seconds=float(apart[longest]),
        )
    ]
