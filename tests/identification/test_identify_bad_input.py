"""What identify refuses, called from Python: one class a cause, before any search is begun."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.foundation.errors import ParameterSetError, UnitError, UnknownNameError, UsageError
from shipid.generation.simulator import UnstatedInputError
from shipid.identification import identify as module
from shipid.identification.errors import NoAnswerError, NothingToFitError, TrialTooShortError
from shipid.identification.uncertainty.amplitudes import one_sided_notices
from shipid.trials.errors import NoRudderMovementError, NoStretchError, UnknownColumnError


def make_trial(name: str = "made", seconds: float = 200.0, interval: float = 0.5, **columns) -> shipid.Trial:
    """A Nomoto ship under a rudder that swings once in 40 s: K = 0.2 1/s, tau = 10 s, by the trapezium rule."""
    t = np.arange(0, seconds, interval)
    delta = 10 * np.sin(2 * np.pi * t / 40)
    half = interval / 20.0
    r = np.zeros_like(t)
    for k in range(len(t) - 1):
        r[k + 1] = ((1 - half) * r[k] + half * 0.2 * (delta[k] + delta[k + 1])) / (1 + half)
    psi = np.concatenate(([0.0], np.cumsum(0.5 * (r[1:] + r[:-1]) * interval)))
    table = {"t [s]": t, "psi [deg]": psi, "r [deg/s]": r, "delta [deg]": delta} | columns
    return shipid.Trial.from_frame(pd.DataFrame({n: c for n, c in table.items() if c is not None}), name=name)


@pytest.fixture
def refused(monkeypatch):
    """Expect an error of identify, and that nothing was searched for it."""

    def search(*_, **__):
        raise AssertionError("the search was begun")

    monkeypatch.setattr(module, "climb", search)

    def check(error: type[Exception], trials, *words: str, model="nomoto", **options) -> None:
        with pytest.raises(error) as caught:
            shipid.identify(model, trials, **options)
        assert type(caught.value) is error
        message = str(caught.value)
        assert "\n" not in message
        for word in words:
            assert word in message, message

    return check


def in_pieces(trial: shipid.Trial) -> shipid.Trial:
    """Nine seconds with a rudder, nine without, and so on."""
    frame = trial.to_frame().iloc[:144]
    pieces = (np.arange(len(frame)) // 9) % 2 == 0
    frame["delta [deg]"] = frame["delta [deg]"].where(pieces)
    return shipid.Trial.from_frame(frame, name="pieces")


def test_the_trial_itself_is_sound():
    fit = shipid.identify("nomoto", [make_trial()], starts=1)
    assert fit.converged
    # The trapezium rule's own error at half a second is below a thousandth.
    assert fit.parameters["K"].value == pytest.approx(0.2, rel=2e-3)
    assert fit.parameters["tau"].value == pytest.approx(10.0, rel=2e-3)


def test_no_trial(refused):
    refused(UsageError, [], "at least one trial")


def test_unknown_names(refused):
    trial = [make_trial()]
    refused(UnknownNameError, trial, "Did you mean nomoto", model="nomotto")
    refused(UnknownNameError, trial, "Did you mean zeefakkel", ship="zeefakel")
    refused(UnknownNameError, trial, "'tua'", "Did you mean tau", estimate=["K", "tua"])
    refused(UnknownNameError, trial, "'Q'", fixed={"Q": "1 s"})
    refused(UnknownNameError, trial, "'rr'", "Did you mean r", signals=["psi", "rr"])


def test_what_cannot_be_estimated_or_fixed(refused):
    trial = [make_trial()]
    refused(UsageError, trial, "has no parameter left", fixed={"K": "0.2 1/s", "tau": "10 s"})
    refused(UsageError, trial, "'K'", "fixed as well", fixed={"K": "0.2 1/s"}, estimate=["K"])
    refused(UsageError, trial, "'psi'", "state", fixed={"psi": "1 rad"})
    refused(UsageError, trial, "'delta'", "input", fixed={"delta": "1 rad"})
    refused(UnitError, trial, "'K'", "bare number", fixed={"K": 0.2})
    refused(UnitError, trial, "'K'", "m does not fit", fixed={"K": "0.2 m"})
    refused(UnitError, trial, "which angle", model="norrbin", fixed={"n3": "0.4 s^2"})


def test_noise_levels(refused):
    trial = [make_trial()]
    refused(UsageError, trial, "none for r", noise={"psi": "0.2 deg"})
    refused(UsageError, trial, "positive", noise={"psi": "0 deg", "r": "1 deg/s"})
    refused(UnitError, trial, "does not fit", noise={"psi": "0.2 m", "r": "1 deg/s"})


def test_no_rudder(refused):
    steady = make_trial(**{"delta [deg]": 10.0})
    refused(NoRudderMovementError, [make_trial(), steady], "stays at 10 deg")
    refused(UnknownColumnError, [make_trial(**{"delta [deg]": None})], "'delta'")


@pytest.mark.parametrize("name", ["psi [deg]", "r [deg/s]"])
def test_sensor_that_stands_still(refused, name):
    stuck = make_trial("stuck", **{name: 3.0})
    refused(NoAnswerError, [make_trial(), stuck], "stuck", f"'{name.partition(' ')[0]}'")


def test_sensor_that_stands_still_may_be_left_out():
    stuck = make_trial(**{"psi [deg]": 3.0})
    assert shipid.identify("nomoto", [stuck], signals=["r"], starts=1).converged


def test_a_rudder_in_pieces(refused):
    words = ("'pieces'", "The longest stretch without one lasts 4 s", "Samples there in 144 rows: delta 72")
    refused(NoStretchError, [in_pieces(make_trial())], *words)
    refused(NoStretchError, [make_trial()], *words, validate=[in_pieces(make_trial())])


def test_a_rudder_in_pieces_in_a_trial_predicted_later():
    fit = shipid.identify("nomoto", [make_trial()], starts=1)
    with pytest.raises(NoStretchError, match="pieces"):
        fit.validate([in_pieces(make_trial())])


def test_too_short(refused):
    refused(TrialTooShortError, [make_trial(seconds=25)], "24.5 s", "time constant", ship="zeefakkel")


def test_nothing_to_fit(refused):
    blind = make_trial("blind", **{"psi [deg]": None, "r [deg/s]": None, "roll [deg]": 0.0})
    refused(NothingToFitError, [blind], "no trial measures", "roll")
    refused(NothingToFitError, [make_trial(), blind], "trial blind", "'r'", signals=["r"])


def test_what_a_trial_to_predict_lacks(refused):
    unsteered = make_trial("unsteered", **{"delta [deg]": None})
    refused(UnstatedInputError, [make_trial()], "'delta'", "unsteered", validate=[unsteered])


@pytest.mark.parametrize("length", ["0 m", "-45 m"])
def test_length(refused, length):
    trial = make_trial(**{"u [m/s]": 5.0})
    refused(ParameterSetError, [trial], "length L", length, model="de-keizer", ship="zeefakkel", fixed={"L": length})


def test_azimuth_thrusters_are_told_how_they_are_read(refused) -> None:
    """Not only that the rudder is missing: models of yaw read the angle of a thruster as that of a rudder."""
    swung = np.rad2deg(make_trial()["delta"])
    thrusters = make_trial(**{"delta [deg]": None, "azimuth_port [deg]": swung})
    refused(UnknownColumnError, [thrusters], "no column 'delta'", "'azimuth_port', delta in a format file", "sign = -1")
    helm = make_trial(**{"delta [deg]": None, "helm [deg]": swung})
    refused(UnknownColumnError, [helm], "there is nothing to identify. It has t, psi, r, helm.")


def test_a_ship_that_goes_astern_is_told_to_a_model_of_one_speed_ahead():
    """The model takes the speed as one number: nothing else of the record shows that it is no longer that ship."""
    speed = np.where(np.arange(0, 200.0, 0.5) < 120, 5.0, -1.0)
    fit = shipid.identify("nomoto", [make_trial(**{"u [m/s]": speed})], ship="zeefakkel", starts=1)
    (told,) = [n for n in fit.warnings if n.kind == "goes-astern"]
    assert told.serious and str(told).startswith(
        "made: the ship goes astern from 120 s on, and nomoto knows one speed ahead"
    )
    assert str(told) in fit.text()
    ahead = shipid.identify("nomoto", [make_trial(**{"u [m/s]": np.abs(speed)})], ship="zeefakkel", starts=1)
    assert "goes-astern" not in {n.kind for n in ahead.warnings}


def test_turns_to_one_side_say_nothing_of_the_other() -> None:
    """An asymmetric ship passed for one with a rudder bias, sure to hundredths of a degree, and her other side was not named."""
    turn = make_trial(**{"delta [deg]": np.where(np.arange(0, 200.0, 0.5) < 20, 0.0, -10.0)})
    zigzag = make_trial()
    (told,) = one_sided_notices([turn])
    assert (
        "to port only in what was fitted: how the ship turns to starboard is not seen" in str(told) and not told.serious
    )
    assert not one_sided_notices([turn, zigzag]) and not one_sided_notices([])
    fit = shipid.identify("nomoto", [turn], ship="zeefakkel", starts=1)
    assert str(told) in fit.text() and "one-sided" in {n.kind for n in fit.warnings}
