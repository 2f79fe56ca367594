"""A rate of turn held, as a mode of the same design."""

from __future__ import annotations

import control
import numpy as np
import pytest

import shipid
from shipid.autopilot.course_changes.run_course_changes import run_course_changes
from shipid.autopilot.course_changes.turn_order import RADIUS
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, to_control
from shipid.autopilot.design.control_law import RateController
from shipid.autopilot.errors import DesignRequestError
from shipid.foundation.errors import UnknownNameError
from shipid.generation.simulator import make_simulator
from shipid.generation.system import generate

U = 9.5


@pytest.fixture(scope="module")
def turning():
    return shipid.design_autopilot("de-keizer", "soesterberg", mode="rate", omega_n=0.05, damping=0.8, speeds=[U])


def test_the_poles_of_the_rate_loop(turning):
    """Two poles placed; against the eigenvalues of the declared loop with a rudder at once."""
    at_once = shipid.design_autopilot(
        "de-keizer", "soesterberg", mode="rate", omega_n=0.05, damping=0.8, speeds=[U], actuator=None
    )
    model = closed_loop(at_once)
    known = coefficients_of(at_once, model, U) | {"u": U, "cruise": U}
    poles = shipid.linearise(model, known, ["r", "rate_integral"], ["r_order"]).poles
    np.testing.assert_allclose(sorted(poles.imag), [-0.03, 0.03], rtol=1e-10)
    np.testing.assert_allclose(poles.real, -0.04, rtol=1e-10)
    np.testing.assert_allclose(sorted(turning.poles[0][0].imag), [-0.03, 0.03], rtol=1e-10)


def test_a_rate_is_held(turning):
    """Behind the steering machine, with the speed lost in the turn: 0.3 deg/s kept to a thousandth after a while."""
    model = closed_loop(turning)
    run = make_simulator(model, ("r", "delta"), hold="zero")(
        0.4 * np.arange(2000), coefficients_of(turning, model, U), {"cruise": U, "r_order": np.deg2rad(0.3)}, {"u": U}
    )
    assert run["r"][-1] == pytest.approx(np.deg2rad(0.3), rel=1e-3)
    assert np.abs(run["delta"]).max() <= turning.rudder_limit + 1e-9
    assert to_control(turning, U)(1e-7j)[1, 0] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(
    ("which", "order", "seen"), [("integral", "psi_order", ["psi", "r"]), ("turning", "r_order", ["r"])]
)
def test_the_controller_and_the_ship_connected_by_names_are_the_loop(which, order, seen, request):
    """python-control connects the two; poles of the loop that is declared as one model."""
    pilot = request.getfixturevalue(which)
    controller, ship = pilot.to_control("8 m/s", "controller"), pilot.to_control("8 m/s", "ship")
    assert controller.input_labels == [order, *seen]
    joined = control.interconnect([controller, ship], inputs=[order], outputs=["psi", "r", "delta"])
    loop = pilot.to_control("8 m/s")
    np.testing.assert_allclose(np.sort_complex(joined.poles()), np.sort_complex(loop.poles()), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(joined(0.03j), loop(0.03j), rtol=1e-9)
    assert pilot.to_control("15.55 kn", "controller").D[0, 0] == pytest.approx(controller.D[0, 0], rel=1e-4)


def test_the_nonlinear_controller_orders_no_more_than_its_limit(integral):
    law = integral.to_control(of="controller", nonlinear=True)
    at = {"psi_order": 2.0, "u": 8.0}
    found = law.output(0.0, [0.0], [at.get(n, 0.0) for n in law.input_labels])
    assert float(found[0]) == pytest.approx(integral.rudder_limit)
    with pytest.raises(UnknownNameError, match="controller, loop, ship"):
        integral.to_control(of="plant")


def test_the_integral_of_the_rate_stands_at_the_limit():
    """Kd = 30 s, limit 0.3 rad: an error of 0.009 rad/s is summed, one of 0.011 asks for more than the limit and is not."""
    system = generate(shipid.join("rate", RateController))
    known = {"gain_Kd": 30.0, "gain_Kp": 1.0, "rudder_limit": 0.3, "r_seen": 0.002}
    for side in (1, -1):
        for error, summed in ((0.009, 0.009), (0.011, 0.0)):
            at = known | {"r_order": 0.002 + side * error, "rate_integral": 0.0}
            x, u, p = (system.vector(n, at) for n in (system.states, system.inputs, system.coefficients))
            assert float(system.right_hand_side(x, u, p)) == pytest.approx(side * summed)


def test_a_turn_ends_on_its_course(turning):
    """The rate is ordered until its integral is the course change: the heading ends there, no sooner than the radius allows."""
    for change in np.deg2rad([40.0, -40.0]):
        found = run_course_changes(turning, [U], [change], lengths=60.0)
        assert np.isfinite(found.settling[0])
        assert found.settling[0] > 0.9 * abs(change) * RADIUS * turning.length / U


def test_a_rate_design_is_judged_and_read_again(turning, tmp_path):
    judged = shipid.judge(turning, samples=0)
    course = shipid.judge(
        shipid.design_autopilot("de-keizer", "soesterberg", design="pole", omega_n=0.05, damping=0.8, speeds=[U]),
        samples=0,
    )
    assert [m.disk for m in judged.margins[0]] == [m.disk for m in course.margins[0]]
    assert any(w.startswith("rate of turn: the heading is not fed back") for w in judged.warnings)
    assert judged.to_dict()["mode"] == "rate" and "soesterberg (de-keizer), rate, pole" in turning.text()
    shipid.write_schedule(turning, tmp_path / "s.toml")
    text = (tmp_path / "s.toml").read_text()
    assert "delta_order = Kd (r_order - r) + Kp integral(r_order - r)" in text
    assert shipid.read_schedule(tmp_path / "s.toml").mode == "rate"
    (tmp_path / "s.toml").write_text(text.replace('mode = "rate"\n', ""))
    assert shipid.read_schedule(tmp_path / "s.toml").mode == "course"


def test_modes_that_are_none():
    with pytest.raises(UnknownNameError, match="no mode 'track'"):
        shipid.design_autopilot("de-keizer", "soesterberg", mode="track")
    with pytest.raises(DesignRequestError, match="has an integral of its own"):
        shipid.design_autopilot("de-keizer", "soesterberg", mode="rate", design="pid")
