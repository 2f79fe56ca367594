from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.figure import Figure

import shipid
from shipid.foundation.errors import UsageError
from shipid.report.figures.svg import collected, svg
from shipid.report.write_report import render


def test_a_fit_draws_the_figures_of_its_report(fit):
    figure = fit.plot("against time second")
    assert isinstance(figure, Figure) and len(figure.axes) >= 3
    measured = next(line for line in figure.axes[0].lines if line.get_label() == "measured")
    second = fit.validation[0].trial
    psi = np.degrees(second["psi"])
    assert np.isin(np.round(measured.get_ydata(), 9), np.round(psi, 9)).all()
    assert isinstance(fit.plot(), Figure)
    assert fit.plot("TRACK").axes[0].get_xlabel() == "east [m]"


def test_a_notebook_shows_a_figure_without_pyplot_and_the_settings_stay(fit):
    before = dict(rcParams)
    picture = shipid.plot(fit, "track")._repr_png_()
    assert picture.startswith(b"\x89PNG") and dict(rcParams) == before


def test_a_trial_draws_its_signals_and_its_track(fit):
    trial = fit.fitted[0].trial
    figure = trial.plot()
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    assert titles[0] == "Heading [deg]" and titles[-1] == "Rudder angle [deg]"
    assert [line.get_label() for line in figure.axes[-1].lines] == ["rudder", "order"]
    line = trial.plot("track").axes[0].lines[0]
    assert set(np.round(line.get_xdata(), 6)) <= set(np.round(trial["y"], 6))
    page = render(trial)
    assert page.count("<svg") == 2 and "Trial first" in page


def test_a_trial_with_one_signal_has_no_track(fit):
    trial = fit.fitted[0].trial
    one = dataclasses.replace(trial, table=trial.table[["t", "delta"]])
    assert len(one.plot().axes) == 1
    with pytest.raises(UsageError, match=r"no figure of this Trial is called 'track'. There are: Against time"):
        one.plot("track")


def test_a_figure_that_is_not_there_is_refused_with_those_that_are(fit):
    with pytest.raises(
        UsageError, match=r"no figure of this Fit is called 'moon'. There are: .*Track, north up, trial"
    ):
        fit.plot("moon")
    with pytest.raises(UsageError, match=r"is called '7'"):
        fit.plot(7)


def test_a_report_without_a_figure_says_so(fit):
    trial = fit.fitted[0].trial
    bare = dataclasses.replace(trial, table=trial.table[["t"]])
    with pytest.raises(UsageError, match="the report of this Trial has no figure"):
        bare.plot()


def test_a_diagnosis_draws_its_manoeuvres_and_findings_along_the_time(fit):
    trial = fit.fitted[0].trial
    wrong = dataclasses.replace(trial, table=trial.table.assign(delta=-trial.table["delta"]))
    (axes,) = shipid.check_trial(wrong).plot().axes
    words = [text.get_text() for text in axes.texts]
    assert words[0] == "manoeuvres: zig-zag" and any("rudder-sign" in w for w in words[1:])
    assert axes.get_xlim() == pytest.approx((trial["t"][0], trial["t"][-1]))
    assert "Where in the record" in render([shipid.check_trial(trial), shipid.check_trial(wrong)])


def test_collected_figures_are_not_drawn():
    def draw(figure):
        raise AssertionError("nobody looks at it")

    with collected() as found:
        assert "<svg" in svg(draw, (4.0, 3.0), "a", "A figure")
    assert found["a"].title == "A figure"
    with pytest.raises(AssertionError):
        svg(draw, (4.0, 3.0), "a", "A figure")


def test_a_fit_is_a_system_of_python_control_at_the_speed_that_is_asked_for(fit):
    system = fit.to_control(inputs=["delta"], outputs=["psi", "r"])
    sailed = fit.ship.joint[fit.model.name].belongs_to
    slow = fit.to_control(f"{sailed / 2} m/s", inputs=["delta"], outputs=["psi", "r"])
    assert list(system.output_labels) == ["psi", "r"] and list(system.input_labels) == ["delta"]
    # Both equations of the model count time in lengths sailed: half the speed, half of each pole.
    assert np.allclose(np.sort(slow.poles().real), np.sort(system.poles().real) / 2, rtol=1e-6)
    with pytest.raises(shipid.ShipidError, match="the speed"):
        fit.to_control("60 m")
    for speed in ("0 kn", "-3 kn"):
        with pytest.raises(UsageError, match="on no straight course: give a speed greater than zero"):
            fit.to_control(speed)


def test_the_gain_of_a_rate_of_turn_is_finite(fit):
    """What a rate of turn does not depend on, the position and the heading, is no state of its system."""
    system = fit.to_control(inputs=["delta"], outputs=["r"])
    assert not {"x", "y", "psi"} & set(system.state_labels)
    gain = float(system.dcgain())
    sailed, length = fit.ship.joint[fit.model.name].belongs_to, fit.ship.particular("L", "m")
    assert gain == pytest.approx(fit.parameters["K"].value * sailed / length, rel=1e-6)


def test_without_a_speed_of_trials_or_ship_one_is_asked_for(fit):
    ship = dataclasses.replace(
        fit.ship, sections={n: v for n, v in fit.ship.sections.items() if n != "particulars"}, joint={}
    )
    with pytest.raises(UsageError, match="neither the trials nor the ship say a speed"):
        dataclasses.replace(fit, ship=ship).to_control()


@pytest.mark.parametrize(
    ("manoeuvre", "axis"),
    [("zigzag:20/20", "time since the first execute [s]"), ("turn:20", "to starboard of the initial course [m]")],
)
def test_a_measured_manoeuvre_draws_its_plot(manoeuvre, axis):
    trial = shipid.simulate("norrbin", "zeefakkel", manoeuvre, noise="standard")
    measures = shipid.measure(trial)
    assert measures.record is not None and "record" not in measures.to_dict()
    assert measures.plot().axes[-1].get_xlabel() == axis
    assert sum("record" in str(row) for row in measures.to_frame()["quantity"]) == 0
    page = render(measures)
    assert measures.title.lower() in page.lower() and page.count("<svg") == 1
    with pytest.raises(UsageError, match="has no figure"):
        dataclasses.replace(measures, record=None).plot()
