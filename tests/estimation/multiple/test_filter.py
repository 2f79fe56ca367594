"""The multiple-model filter: records, samples one by one, many runs, several state vectors, and bad input."""

import numpy as np
import pytest

from shipid import InteractingMultipleModel, Mode
from shipid.estimation.errors import CovarianceError, FilterDivergedError, ModeError, NoiseLevelError, TransitionError
from shipid.estimation.multiple.first_state import FirstState
from shipid.estimation.multiple.whitening import polar_to_cartesian, whitened
from shipid.foundation.errors import ShipidError, UnknownNameError, UsageError
from shipid.models import constant_velocity, coordinated_turn, turning_at_unknown_rate

SENSORS = {"x": "85 m", "y": "85 m"}
NOISE = {"ax": "1.8 m/s^2", "ay": "1.8 m/s^2"}
TWO = [[0.95, 0.05], [0.1, 0.9]]


def unequal(**changes):
    """A straight course and a turn at an unknown rate, which has one state more."""
    maps = {("straight", "turning"): {"omega": ("0 deg/s", "3 deg/s")}}
    models = {
        "straight": constant_velocity,
        "turning": Mode(turning_at_unknown_rate, noise={"omega": "0.5 deg/s"}),
    }
    given = {"measured": SENSORS, "noise": NOISE, "maps": maps}
    return InteractingMultipleModel(models, TWO, **(given | changes))


def test_samples_one_by_one_give_what_the_record_gives(track, tracker):
    record, first, _ = track
    gone = {n: c.copy() for n, c in record.items()}
    gone["x"][40:43] = np.nan
    gone["y"][41] = np.nan
    run = tracker().filter(gone, first=first)
    online = tracker().start(first)
    for k in range(80):
        estimate = online.update({n: float(c[k]) for n, c in gone.items()})
        assert estimate.x == pytest.approx(run.x[k], abs=1e-9)
        assert estimate.covariance == pytest.approx(run.covariance[k], rel=1e-12)
        assert estimate.probabilities == pytest.approx(run.probabilities[k], rel=1e-9)
    assert estimate.mode == run.most_probable[79]
    assert estimate["vx"] == run["vx"][79]
    assert estimate.std_of("x") == run.std_of("x")[79]


def test_prediction_then_update_is_one_scan(track, tracker):
    record, first, _ = track
    whole, split = tracker().start(first), tracker().start(first)
    for k in range(30):
        sample = {n: float(c[k]) for n, c in record.items()}
        one = whole.update(sample)
        if k:
            expected = split.predict(sample["t"])
            assert expected.probabilities == pytest.approx(whole.expected.probabilities, rel=1e-9)
            assert expected.shown == pytest.approx(whole.expected.shown, abs=1e-6)
            assert (np.linalg.eigvalsh(expected.covariance) > 0).all()
        other = split.update(sample)
        assert other.x == pytest.approx(one.x, abs=1e-6)
        assert other.covariance == pytest.approx(one.covariance, rel=1e-7, abs=1e-6)


def test_many_runs_are_the_records_one_by_one(track, tracker):
    record, first, _ = track
    rng = np.random.default_rng(3)
    noise = 20 * rng.standard_normal((5, 400, 2))
    x, y = record["x"] + noise[..., 0], record["y"] + noise[..., 1]
    x[2, 100:110] = np.nan
    several = FirstState(first.states, first.mean + rng.standard_normal((5, 4)), first.covariance)
    kalman = tracker()
    runs = kalman.filter_runs({"t": record["t"], "x": x, "y": y}, first=several, threads=2)
    started = kalman.filter_runs({"t": record["t"], "x": x, "y": y}, threads=1)
    for k in range(5):
        own = FirstState(first.states, several.mean[k], first.covariance)
        one = kalman.filter({"t": record["t"], "x": x[k], "y": y[k]}, first=own)
        assert (runs.x[k] == one.x).all()
        assert (runs.covariance[k] == one.covariance).all()
        assert (runs.probabilities[k] == one.probabilities).all()
        alone = kalman.filter({"t": record["t"], "x": x[k], "y": y[k]})
        assert (started.x[k] == alone.x).all()
    assert runs["vx"] == pytest.approx(runs.x[..., runs.states.index("vx")])
    assert runs.std.shape == runs.x.shape


def test_covariances_of_a_scan_are_taken_as_a_whole(track, tracker):
    """Correlated errors beside the joint update written out."""
    record, first, _ = track
    R = np.array([[9000.0, 5000.0], [5000.0, 4000.0]])
    settings = {"measured": SENSORS, "noise": NOISE, "correlated": True}
    one = InteractingMultipleModel({"straight": constant_velocity}, [[1.0]], **settings)
    run = one.filter({n: c[:3] for n, c in record.items()}, first=first, covariances=R)
    order = [run.states.index(n) for n in ("x", "vx", "y", "vy")]
    x, P = first.mean, first.covariance
    F, H = np.kron(np.eye(2), [[1.0, 1.0], [0.0, 1.0]]), np.kron(np.eye(2), [[1.0, 0.0]])
    gain = np.kron(np.eye(2), [[0.5], [1.0]])
    for k in range(3):
        if k:
            x, P = F @ x, F @ P @ F.T + 1.8**2 * gain @ gain.T
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        x = x + K @ (np.array([record["x"][k], record["y"][k]]) - H @ x)
        P = P - K @ H @ P
        assert run.x[k, order] == pytest.approx(x, abs=1e-6)
        assert run.covariance[k][np.ix_(order, order)] == pytest.approx(P, rel=1e-9, abs=1e-6)
    each = one.filter({n: c[:3] for n, c in record.items()}, first=first, covariances=np.tile(R, (3, 1, 1)))
    assert (each.x == run.x).all()


def test_a_missing_sensor_leaves_the_variance_of_the_other():
    R = np.array([[[4.0, 3.0], [3.0, 9.0]]] * 2)
    variance, below = whitened(R, np.array([[True, True], [False, True]]))
    assert variance == pytest.approx(np.array([[4.0, 9.0 - 9.0 / 4.0], [1.0, 9.0]]))
    assert below.ravel() == pytest.approx([-0.75, 0.0])


def test_polar_plots_in_cartesian_coordinates():
    rng = np.random.default_rng(2)
    n = 200_000
    x, y, _ = polar_to_cartesian(2000 + 30 * rng.standard_normal(n), 0.7 + 0.01 * rng.standard_normal(n), 30.0, 0.01)
    north, east, covariance = polar_to_cartesian(np.array(2000.0), np.array(0.7), 30.0, 0.01)
    assert (north, east) == (pytest.approx(2000 * np.cos(0.7)), pytest.approx(2000 * np.sin(0.7)))
    # Some 1 % by the number of draws, and by the curvature that the first order leaves out.
    assert np.cov(x, y) == pytest.approx(covariance, rel=0.02)


def test_modes_with_different_states(track):
    record, _, truth = track
    run = unequal().filter(record)
    assert run.states == ("x", "y", "vx", "vy")
    assert run.mode("turning")[0].shape == (400, 5)
    assert run.mode("turning")[1].shape == (400, 5, 5)
    error = np.hypot(run["x"] - truth[:, 0], run["y"] - truth[:, 1])
    assert np.sqrt((error[20:] ** 2).mean()) < 85 * np.sqrt(2)
    assert run.probabilities[295:312, 1].mean() > 0.6 > 0.5 > run.probabilities[250:280, 1].mean()
    assert np.rad2deg(run.mode("turning")[0][300:312, 4]).mean() == pytest.approx(5.6, abs=0.7)
    table = run.to_frame()
    assert list(table.columns[:2]) == ["t [s]", "x [m]"]
    assert table["probability_turning [1]"].iloc[300] == run.probabilities[300, 1]
    assert run.quantity("SOG")[0] == pytest.approx(np.hypot(run["vx"], run["vy"]))
    assert run.to_dict()["most_probable"] == run.most_probable[-1]
    assert "probability" in run.text()


def test_a_derived_quantity_serves_as_a_state_of_another_mode():
    """A map with a Jacobian: the heading of a ship's model out of a velocity."""
    from shipid.models import pershitz_track

    maps = {
        ("ship", "point"): {"vx": "V_north", "vy": "V_east"},
        ("point", "ship"): {"psi": "COG", "V_U": "SOG"},
    }
    ship = Mode(pershitz_track, values={"k_v": 1.9}, inputs={"Omega": "0 rad/m"})
    with pytest.raises(UnknownNameError, match="'V_north'"):
        InteractingMultipleModel({"point": constant_velocity, "ship": ship}, TWO, measured=SENSORS, maps=maps)
    maps["ship", "point"] = {"vx": ("5 m/s", "5 m/s"), "vy": ("0 m/s", "5 m/s")}
    kalman = InteractingMultipleModel({"point": constant_velocity, "ship": ship}, TWO, measured=SENSORS, maps=maps)
    t = np.arange(60.0)
    first = FirstState(
        ("x", "y", "vx", "vy", "psi", "V_U"), np.array([0, 0, 3.0, 3.0, 0.8, 4.0]), np.diag([9.0, 9, 9, 9, 0.1, 4])
    )
    run = kalman.filter({"t": t, "x": 4 * t, "y": 3 * t}, first=first)
    x, P = run.mode("ship")
    psi, speed = x[-1, 2], x[-1, 3]
    assert speed == pytest.approx(5.0, abs=0.2)
    assert np.cos(psi - np.arctan2(3, 4)) == pytest.approx(1.0, abs=1e-2)
    assert (np.linalg.eigvalsh(P[-1]) > 0).all()


def test_transition_probabilities_hold_for_their_interval(track, tracker):
    record, first, _ = track
    # Every third scan, with the chain over one second: over three seconds it is its third power.
    slow = {n: c[::3] for n, c in record.items()}
    powers = InteractingMultipleModel(
        {
            n: Mode(d.base, inputs={k: (v, "rad/s") for k, v in d.instruments.inputs.items()})
            for n, d in tracker().design.modes.items()
        },
        np.linalg.matrix_power(np.array([[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]), 3),
        measured=SENSORS,
        noise=NOISE,
        probabilities=[0.1, 0.8, 0.1],
    ).filter(slow, first=first)
    run = tracker(per="1 s").filter(slow, first=first)
    assert run.x == pytest.approx(powers.x, abs=1e-6)
    assert run.probabilities == pytest.approx(powers.probabilities, abs=1e-9)


def test_hypotheses_merge_to_their_mixture(track, tracker):
    record, first, _ = track
    one = tracker().start(first)
    for k in range(10):
        one.update({n: float(c[k]) for n, c in record.items()})
    one.predict(10.0)
    hit, missed = one.copy(), one.copy()
    hit.update({"t": 10.0, "x": float(record["x"][10]), "y": float(record["y"][10])})
    assert not np.allclose(hit.estimate.x, missed.estimate.x)
    one.merge([hit, missed], [0.7, 0.3])
    a, b, both = hit.estimate, missed.estimate, one.estimate
    mean = 0.7 * a.x + 0.3 * b.x
    spread = sum(w * (e.covariance + np.outer(e.x - mean, e.x - mean)) for w, e in ((0.7, a), (0.3, b)))
    assert both.x == pytest.approx(mean, abs=1e-6)
    assert both.covariance == pytest.approx(spread, rel=1e-8, abs=1e-6)
    assert both.probabilities == pytest.approx(0.7 * a.probabilities + 0.3 * b.probabilities, rel=1e-9)
    assert both.t == 10.0
    with pytest.raises(UsageError, match="sum to 1"):
        one.merge([hit, missed], [0.7, 0.7])


def test_single_plot_and_no_plot():
    kalman = unequal()
    run = kalman.filter({"t": np.array([0.0]), "x": np.array([10.0]), "y": np.array([20.0])})
    assert run.x[0, :2] == pytest.approx([10.0, 20.0])
    assert np.isfinite(run.std).all()
    lost = {"t": np.arange(50.0), "x": np.full(50, np.nan), "y": np.full(50, np.nan)}
    lost["x"][:2] = lost["y"][:2] = 1.0
    gone = kalman.filter(lost)
    assert np.isfinite(gone.x).all()
    assert (np.diff(gone.std[5:, 0]) > 0).all()
    online = kalman.start()
    with pytest.raises(UsageError, match="without a sample"):
        online.predict(1.0)
    online.update({"t": 0.0, "x": 1.0, "y": 2.0})
    with pytest.raises(UsageError, match="before the last one"):
        online.update({"t": -1.0, "x": 1.0, "y": 2.0})
    with pytest.raises(UsageError, match="needs its time"):
        online.update({"x": 1.0, "y": 2.0})
    with pytest.raises(CovarianceError, match="correlated=True"):
        online.update({"t": 1.0, "x": 1.0, "y": 2.0}, np.array([[2.0, 1.0], [1.0, 2.0]]))


def make(models=None, transition=TWO, **settings):
    """A filter with settings that may be wrong."""
    models = {"a": constant_velocity, "b": constant_velocity} if models is None else models
    return InteractingMultipleModel(models, transition, **({"measured": SENSORS, "noise": NOISE} | settings))


@pytest.mark.parametrize(
    ("attempt", "error", "message"),
    [
        (lambda: make(transition=[[0.9, 0.2], [0.1, 0.9]]), TransitionError, "sum to 1.1: a row must sum to 1"),
        (lambda: make(transition=[[1.1, -0.1], [0.1, 0.9]]), TransitionError, "between 0 and 1"),
        (lambda: make(transition=[[1.0]]), TransitionError, r"shape \(1, 1\)"),
        (lambda: make(transition="stay"), TransitionError, "not a table of numbers"),
        (lambda: make(probabilities=[0.5, 0.6]), TransitionError, "sum to 1"),
        (lambda: make(per="0 s"), ModeError, "longer than zero"),
        (lambda: make(models={}), ModeError, "at least one model"),
        (lambda: make(fading=0.9), ModeError, "fading of 0.9"),
        (lambda: make(merging="best"), UnknownNameError, "'best'"),
        (lambda: make(measured={"x": "0 m", "y": "1 m"}), NoiseLevelError, "greater than zero"),
        (lambda: make(noise={"az": "1 m/s^2"}), UnknownNameError, "named in noise, called 'az'"),
        (lambda: make(led={"vx": "c"}), UnknownNameError, "leads 'vx' called 'c'"),
        (lambda: make(led={"w": "a"}), ModeError, "no such state"),
        (lambda: unequal(maps={}), ModeError, "has a state 'omega'"),
        (lambda: unequal(maps={("straight", "bend"): {}}), UnknownNameError, "'bend'"),
        (lambda: unequal(maps={("straight", "turning"): {"omega": "SOG"}}), ModeError, "in rad/s"),
        (lambda: unequal(maps={("straight", "turning"): {"w": "SOG"}}), UnknownNameError, "'w'"),
        (lambda: FirstState(("x",), np.zeros(1), np.zeros((1, 1))), CovarianceError, "not positive definite"),
        (lambda: FirstState(("x", "y"), np.zeros(2), np.array([[1, 0.5], [0, 1]])), CovarianceError, "not symmetric"),
        (lambda: FirstState(("x",), np.array([np.nan]), np.eye(1)), CovarianceError, "not finite"),
        (lambda: FirstState(("x",), np.zeros(2), np.eye(1)), CovarianceError, "needs 1 values"),
    ],
)
def test_what_does_not_fit_is_refused(attempt, error, message):
    with pytest.raises(error, match=message):
        attempt()


def test_records_that_do_not_fit_are_refused(track, tracker):
    record, first, _ = track
    kalman = tracker()
    with pytest.raises(ShipidError, match="no such column"):
        kalman.filter({"t": record["t"], "x": record["x"]})
    with pytest.raises(CovarianceError, match="have the shape"):
        kalman.filter(record, covariances=np.eye(3))
    with pytest.raises(UnknownNameError, match="mode called 'left'"):
        kalman.filter(record, first=first).mode("left")
    far = FirstState(first.states, np.full(4, 1e300), first.covariance * 1e200)
    with pytest.raises(FilterDivergedError, match="diverges"):
        kalman.filter(record, first=far)
    both = {n: np.tile(c, (2, 1)) for n, c in record.items() if n != "t"} | {"t": record["t"]}
    with pytest.raises(UsageError, match="lack the column 'y'"):
        kalman.filter_runs({n: c for n, c in both.items() if n != "y"})
    with pytest.raises(UsageError, match=r"shape \(runs, samples\)"):
        kalman.filter_runs(record)
    with pytest.raises(UsageError, match="3 first states"):
        kalman.filter_runs(both, first=FirstState(first.states, np.zeros((3, 4)), first.covariance))
    with pytest.raises(UsageError, match="covariances have the shape"):
        kalman.filter_runs(both, covariances=np.ones((3, 400, 2, 2)))
    with pytest.raises(FilterDivergedError, match="2 of 2 runs"):
        kalman.filter_runs(both, first=far)
    turn = InteractingMultipleModel({"turn": coordinated_turn}, [[1.0]], measured=SENSORS, noise=NOISE)
    with pytest.raises(ShipidError, match="omega"):
        turn.filter(record)
