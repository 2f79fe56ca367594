"""The prediction model follows the yaw filter."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UsageError
from shipid.prediction.following.model_adaptation import ModelAdaptation
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

SEEN = {"psi": "0.1 deg", "r": "0.01 deg/s"}


@pytest.fixture(scope="module")
def voyage(pilot):
    """A turn of 150 degrees by a ship whose gain is 20 % under that of the predictor, with the truth of its track."""
    steered = shipid.design_autopilot("de-keizer", "soesterberg", damping=0.85, rudder_limit="15 deg")
    ordered = {"courses": [(100.0, "150 deg")], "duration": 800.0, "sampling": 0.4, "values": {"K": 1.28}}
    return steered, sail(steered, noise=SEEN, **ordered).table, sail(steered, **ordered).table


def test_the_prediction_corrects_itself_during_the_turn(voyage):
    pilot, seen, truth = voyage
    predictor = TrackPredictor(pilot, model="first-order")
    yaw = shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"), "soesterberg", measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"},
        start={"a": "0.94", "b1": "0.59"},
    ).start()  # fmt: skip
    adaptation = ModelAdaptation(1.6, 1.7)
    off = {}
    places = {int(np.argmax(truth["psi"] >= np.deg2rad(d))): d for d in (20, 70)}
    rows = np.column_stack([seen[["t", "psi", "r"]], truth[["u", "delta"]]])
    for k, (t, psi, r, u, delta) in enumerate(rows[: max(places) + 1]):
        estimate = yaw.update({"t": t, "compass": psi, "gyro": r, "u": u, "way": u, "cruise": 9.5, "delta": delta})
        adaptation.update(t, estimate["a"], estimate["b1"], std={n: estimate.std_of(n) for n in ("a", "b1")})
        if k in places:
            now = truth.iloc[k]
            known = Situation({n: now[n] for n in ("x", "y", "psi", "r", "u", "v", "delta")})
            rest = truth.iloc[k : k + 700]
            for way, one in (("fixed", known), ("adapted", adaptation.situation(known))):
                track = predictor.predict(one, heading="150 deg", band="none")
                off[way, places[k]] = np.abs(track.distance_to(rest["x"].to_numpy(), rest["y"].to_numpy())[0]).max()
    assert off["fixed", 20] > 150
    # Later there is less left to be wrong about, and the filter knows more.
    assert off["adapted", 70] < 0.5 * off["fixed", 70] and off["adapted", 70] < off["adapted", 20]
    assert adaptation.values["K"] / adaptation.values["tau"] == pytest.approx(1.28 / 1.7, rel=0.1)


def test_how_fast_it_follows():
    at_once, never, slowly = (ModelAdaptation(1.6, 1.7, 0.5, following=f) for f in (0.0, np.inf, 100.0))
    for t in np.arange(0.0, 101.0):
        for one in (at_once, never, slowly):
            one.update(t, 0.8, 0.5, 0.6)
    assert at_once.values == pytest.approx({"K": 1.6, "tau": 2.0, "gamma": 0.6}) and at_once.left == (0.0, 0.0)
    assert never.values == pytest.approx({"K": 1.6, "tau": 1.7, "gamma": 0.5})
    assert never.left == pytest.approx((0.8 - 1.6 / 1.7, 0.5 - 1 / 1.7))
    # After its time constant, 1/e of the difference is left.
    assert slowly.b1 - 0.5 == pytest.approx((1 / 1.7 - 0.5) / np.e, rel=1e-9)
    assert slowly.gamma == pytest.approx(0.6 - 0.1 / np.e, rel=1e-9)


def test_estimates_of_no_first_order_ship_leave_the_model_as_it_is():
    adaptation = ModelAdaptation(1.6, 1.7)
    for a, b1 in ((0.9, -0.1), (np.nan, 0.5), (100.0, 0.5)):
        adaptation.update(0.0, a, b1)
        assert adaptation.held and adaptation.values == pytest.approx({"K": 1.6, "tau": 1.7})
    adaptation.update(1.0, 0.9, 0.5)
    assert not adaptation.held and adaptation.values["K"] == pytest.approx(1.8)


def test_the_band_knows_how_sure_the_coefficients_are(first_order):
    adaptation = ModelAdaptation(1.6, 1.7)
    known = Situation({"psi": 0.0, "u": 9.5, "K": 1.0}, ("K", "psi"), np.diag([0.04, 1e-6]))
    adaptation.update(0.0, 0.9, 0.5, 0.55, std={"a": 0.09, "b1": 0.05, "gamma": 0.02})
    found = adaptation.situation(known)
    assert found.uncertain == ("psi", "K", "tau", "gamma")
    assert found.std_of("tau") == pytest.approx(0.2) and found.std_of("gamma") == 0.02
    assert found.std_of("K") == pytest.approx(1.8 * np.hypot(0.1, 0.1)) and found.std_of("psi") == pytest.approx(1e-3)
    wide = first_order.predict(found, heading="60 deg").half_width
    assert wide[-1] > 2 * first_order.predict(known, heading="60 deg").half_width[0]
    adaptation.update(1.0, 0.9, 0.5)
    assert adaptation.situation(known).uncertain == ("psi",)


@pytest.mark.parametrize(
    ("start", "says"), [((0.0, 1.7, 0.0), "no first-order ship"), ((1.6, 1.7, -1.0), "give zero or more")]
)
def test_models_that_are_none(start, says):
    K, tau, following = start
    with pytest.raises(UsageError, match=says):
        ModelAdaptation(K, tau, following=following)
