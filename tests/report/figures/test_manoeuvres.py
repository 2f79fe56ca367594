"""Figures of manoeuvres: what cannot be drawn is left out."""

import numpy as np

import shipid
from shipid.report.figures.manoeuvres import manoeuvre_figure
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre
from shipid.trials.trial import Trial


def test_a_circle_whose_heading_never_turns_to_its_side_is_not_drawn():
    turn = Manoeuvre("turn", (np.radians(35.0), np.radians(200.0)))
    trial = shipid.simulate(shipid.find_model("norrbin"), "zeefakkel", turn, sampling="1 s")
    measures = shipid.measure(trial)
    assert manoeuvre_figure(measures, trial, None, "m") is not None
    frame = trial.to_frame()
    frame["psi [deg]"] = 360 - frame["psi [deg]"]
    assert manoeuvre_figure(measures, Trial.from_frame(frame), None, "m") is None


def _drawn(trial):
    """The axes of the turning circle of a trial."""
    return shipid.measure(trial).plot().axes[0]


def _length(artist):
    return np.hypot(np.diff(artist.get_xdata()), np.diff(artist.get_ydata())).sum()


def test_the_track_of_a_circle_is_the_path_of_its_numbers_and_the_fixes_stand_beside_it():
    turn = Manoeuvre("turn", (np.radians(35.0), np.radians(400.0)))
    model = shipid.find_model("de-keizer")
    trial, true = (
        shipid.simulate(model, "soesterberg", turn, sampling="1 s", noise=noise)
        for noise in ({"x": "8 m", "y": "8 m"}, None)
    )
    line, fixes = ({a.get_label(): a for a in _drawn(one).lines} for one in (trial, true))
    assert "position fixes" not in fixes  # they would lie under the line
    fine = np.arange(0.0, true["t"][-1], 0.1)
    sailed = np.stack([np.interp(fine, true["t"], true["y"]), np.interp(fine, true["t"], true["x"])])
    # Both begin at the execute.
    begin = np.interp(shipid.measure(true).first_execute, fine, sailed[1])

    def off(artist):
        east, north = artist.get_xdata(), artist.get_ydata() + begin
        return np.hypot(east[:, None] - sailed[0], north[:, None] - sailed[1]).min(axis=1)

    path, marks = line["track"], line["position fixes"]
    # A parabola through eleven fixes leaves less than half of their scatter; the origin, at the execute, is off by as much.
    assert np.mean(off(path)) < 0.7 * np.mean(off(marks))
    assert _length(path) < 1.1 * _length(fixes["track"])
    assert len(marks.get_xdata()) <= 260


def test_the_track_of_a_circle_is_broken_where_the_positions_have_a_hole():
    turn = Manoeuvre("turn", (np.radians(35.0), np.radians(400.0)))
    frame = shipid.simulate(shipid.find_model("de-keizer"), "soesterberg", turn, sampling="1 s").to_frame()
    full = frame.copy()
    hole = (frame["t [s]"] > 150) & (frame["t [s]"] < 190)
    frame.loc[hole, ["x [m]", "y [m]"]] = np.nan
    path = next(a for a in _drawn(Trial.from_frame(frame)).lines if a.get_label() == "track")
    lost = np.isnan(path.get_xdata())
    assert lost.any() and not lost[0] and not lost[-1]
    # Nothing of the other side of the hole is averaged in: the path up to it is that of the whole record.
    whole = next(a for a in _drawn(Trial.from_frame(full)).lines if a.get_label() == "track")
    apart = np.hypot(path.get_xdata() - whole.get_xdata(), path.get_ydata() - whole.get_ydata())
    assert np.nanmax(apart) < 2.0


def test_the_dimensions_of_a_model_s_circle_have_the_digits_of_the_table():
    """A model of 3 m turned in a circle of 8.66 m, "tactical diameter 9 m"."""
    turn = Manoeuvre("turn", (np.radians(35.0), np.radians(400.0)))
    trial = shipid.simulate(shipid.find_model("norrbin"), "esso-osaka-3m", turn, sampling="0.2 s", speed="0.4 m/s")
    measures, words = shipid.measure(trial), {text.get_text() for text in _drawn(trial).texts}
    for name in ("advance", "transfer", "tactical_diameter"):
        value = getattr(measures, name)
        shown = measures.told(name, value, "m")
        assert value < 100 and shown.startswith(f"{value:.3g}"[:3]) and f"{name.replace('_', ' ')} {shown} m" in words
