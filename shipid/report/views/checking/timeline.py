"""The record of a trial along its time: its manoeuvres, and where the findings lie."""

from __future__ import annotations

from typing import TYPE_CHECKING

from markupsafe import Markup

from shipid.declaration.vocabulary import FIELDS
from shipid.report.figures.svg import BLUE, MUTED, ORANGE, RED, WIDTH, svg
from shipid.trials.doctor.findings import Diagnosis, Finding

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Height of a row, and of axis and legend, in inches; and the height of a bar in rows.
_ROW, _REST, _BAR = 0.36, 0.95, 0.26
#: Most rows of findings.
_MOST = 12
#: A bar is at least this part of the record wide: a fault of one sample is to be seen.
_LEAST = 0.006


def timeline(found: Diagnosis, key: str) -> Markup | None:
    """Return the manoeuvres of a record and the spans of its findings as SVG; None where there is neither.

    Parameters
    ----------
    found : Diagnosis
        What was found.
    key : str
        Put before every id.
    """
    rows = [(_words(f), f.spans or (f.seconds,), _colour(f)) for f in found.findings[:_MOST]]
    sailed = [m for m in found.manoeuvres if m.kind != "steady"]
    if sailed:
        words = "manoeuvres: " + ", ".join(dict.fromkeys("zig-zag" if m.kind == "zigzag" else m.kind for m in sailed))
        rows.insert(0, (words, tuple((m.start, m.end) for m in sailed), BLUE))
    if not rows:
        return None
    first = min(a for _, spans, _ in rows for a, _ in spans)
    last = max(b for _, spans, _ in rows for _, b in spans)
    last = max([last, *(m.end for m in found.manoeuvres)])
    first = min([first, *(m.start for m in found.manoeuvres)])
    least = _LEAST * max(last - first, 1e-9)

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        for k, (words, spans, colour) in enumerate(rows):
            ax.broken_barh([(a, max(b - a, least)) for a, b in spans], (k, _BAR), facecolors=colour, edgecolor="none")
            ax.text(0, k - 0.08, words, transform=ax.get_yaxis_transform(), va="bottom", ha="left")
        for colour, label in (
            (BLUE, "manoeuvre"),
            (RED, "spoils a fit"),
            (ORANGE, "to know about"),
            (MUTED, "put right"),
        ):
            if any(c == colour for _, _, c in rows):
                ax.plot([], [], color=colour, linewidth=5, label=label)
        ax.set_ylim(len(rows) - 0.6, -0.5)
        ax.set_xlim(first, max(last, first + least))
        ax.set_yticks([])
        ax.spines["left"].set_visible(False)
        ax.grid(visible=True, axis="x")
        ax.set_xlabel("time [s]")
        handles, labels = ax.get_legend_handles_labels()
        if len(handles) > 1:
            figure.legend(
                handles, labels, loc="upper left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=4,
                columnspacing=1.2, handlelength=1.2,
            )  # fmt: skip

    return svg(draw, (WIDTH, _REST + _ROW * len(rows)), key, f"Where in the record of {found.trial}")


def _words(f: Finding) -> str:
    channels = ", ".join(FIELDS[c].label.lower() if c in FIELDS else c for c in f.channels[:3])
    return f"{f.kind} ({channels}{', …' if len(f.channels) > 3 else ''})"


def _colour(f: Finding) -> str:
    return MUTED if f.handled else RED if f.serious else ORANGE
