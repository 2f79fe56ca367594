"""Missing samples: how many, and holes across which the motion is unknown. A missing sample is no fault by itself."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.numbers import brief, moment, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.filling import GAP

#: A channel of fewer samples is set aside: nothing can be said about it.
_FEWEST = 5
#: From this share on, a channel with missing samples is an empty one with some samples.
_MANY = 0.3
#: The interpolation across a hole may miss the motion by this share of the channel's range.
_TOLERABLE = 0.05


def examine_missing(p: WorkingCopy) -> None:
    """Find channels with missing samples, and holes the motion across which is unknown.

    Parameters
    ----------
    p : WorkingCopy
        The record, its clock in order and its heading unwrapped. Every channel has a number at every stamp afterwards.
    """
    for name in [c for c in p.values if c != "t"]:
        if np.isfinite(p[name]).sum() < min(_FEWEST, len(p)):
            p.sparse[name] = p.values.pop(name)
    if p.sparse:
        names = ", ".join(list(p.sparse)[:10])
        p.add(
            "missing", ",".join(list(p.sparse)[:10]), 0.95, f"{names}: fewer than {_FEWEST} samples",
            "Nothing can be told of a channel of so few samples.", "Leave the column out.", spoils=False,
        )  # fmt: skip
    p.bridge()
    others = []
    for name in [c for c in p.values if c != "t" and p.missing[c].any()]:
        if name not in FIELDS:
            others.append(name)
            continue
        _missing(p, name)
    others = [c for c in others if _share(p, c) > _MANY]
    if others:
        p.add(
            "missing", ",".join(others[:10]), 0.9, f"more than {percent(_MANY)} of the samples of {len(others)} other columns are missing",
            "What is not measured cannot be compared.", "None needed where they are not used.", spoils=False,
        )  # fmt: skip


def _share(p: WorkingCopy, name: str) -> float:
    """Share of the samples that are missing, on the channel's own clock."""
    times = p.t[p.own(name)]
    expected = float(times[-1] - times[0]) / max(p.interval(name), 1e-300) + 1
    return max(0.0, 1 - len(p.own(name)) / min(max(expected, 1.0), float(len(p))))


def _by_chance(share: float, samples: int) -> float:
    """Intervals up to which a silence is no more than chance, where this share of the samples is missing one by one."""
    # A run of k missing samples is expected samples * share^k times: one in a hundred records has one longer than this.
    return 1 + float(np.log(0.01 / samples) / np.log(share)) if 0 < share < 1 else 0.0


def _missing(p: WorkingCopy, name: str) -> None:
    index, usual, share = p.own(name), p.interval(name), _share(p, name)
    times = np.concatenate((p.t[:1], p.t[index], p.t[-1:]))
    lengths = np.diff(times)
    holes = np.flatnonzero(lengths > GAP * usual)
    longest = float(lengths.max()) / (GAP * usual)
    missed = _missed_across(p, name, index, [int(h) for h in holes])
    reach = float(np.ptp(p.measured(name)))
    serious = missed > _TOLERABLE or share > _MANY
    # Among samples that are missing one by one, some stand next to one another by chance.
    if not len(holes) or (not serious and longest < max(1.0, _by_chance(share, len(p)) / GAP)):
        if share > 0.002:
            p.add(
                "missing", name, robust.confidence_of(share, 0.0, 0.004),
                f"{percent(share, 1)} of the samples of {name} are missing, never more than {brief(lengths.max(), 4)} s on end",
                "There are fewer residuals, and none at these samples: nothing is biased by it.",
                "None needed: a missing sample stays missing.", at=np.flatnonzero(p.missing[name]),
                spoils=share > 1 - _MANY,
            )  # fmt: skip
        return
    k = int(holes[np.argmax(lengths[holes])])
    inside = p.blind(name)
    over = (
        f"; it turns meanwhile, and a line across misses about {percent(missed)} of its range"
        if missed > _TOLERABLE
        else ""
    )
    p.add(
        "hole", name, robust.confidence_of(float(lengths[k]) / (GAP * usual), 0.8, 1.6),
        f"{name} is silent {len(holes)} time{'s' * (len(holes) > 1)}, the longest from {moment(times[k])} to {moment(times[k + 1])} s"
        f" ({brief(lengths[k], 4)} s, usually {brief(usual, 4)} s); {percent(share, 1)} of its samples are missing{over}"
        + ("" if reach > 0 else "; it never changes"),
        "What it did meanwhile is unknown: an extreme there is not measured"
        + (", and a simulation cannot be run through it." if name in ("delta", "delta_order") else "."),
        "Use the stretches on either side where it matters (FILE@A:B).", at=np.flatnonzero(inside), spoils=serious,
    )  # fmt: skip


def _missed_across(p: WorkingCopy, name: str, index: np.ndarray, holes: list[int]) -> float:
    """By how much, in shares of the channel's range, a line across its holes may miss it: slopes at the ends, and the rate."""
    t, values = p.t, p[name]
    reach = float(np.ptp(values[index]))
    if reach == 0:
        return 0.0
    worst = 0.0
    for h in holes:
        if h in (0, len(index)):
            continue
        a, b = index[h - 1], index[h]
        length = float(t[b] - t[a])
        before, after = index[max(h - 6, 0) : h], index[h : h + 6]
        if min(len(before), len(after)) < 3:
            continue
        slopes = [float(np.polyfit(t[part] - t[part[0]], values[part], 1)[0]) for part in (before, after)]
        line = float(values[b] - values[a]) / length
        bend = max(abs(slope - line) for slope in slopes)
        # The slope through six samples is known to their noise only.
        bend = max(0.0, bend - 3 * p.noise(name) / (4.2 * p.interval(name)))
        # The cubic that leaves with one slope and arrives with the other departs by 4/27 of slope times length.
        worst = max(worst, 4 / 27 * bend * length / reach)
        jump = abs(float(values[b] - values[a])) / reach
        if name in ("delta", "delta_order") and jump > 0.2:
            worst = max(worst, jump)
        if name == "psi" and p.has("r") and not p.blind("r")[a : b + 1].any():
            turned = robust.integral(t[a : b + 1], p["r"][a : b + 1])
            off = turned - np.interp(t[a : b + 1], [t[a], t[b]], [turned[0], turned[-1]])
            worst = max(worst, float(np.abs(off).max()) / reach)
    return worst
