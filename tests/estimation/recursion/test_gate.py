"""What a step does with a sample: gates, patience, stuck sensors, angles that wrap, parameters that hold still."""

from typing import Any

import numpy as np
import pytest

from shipid.estimation.records.smoother import smooth
from shipid.estimation.recursion.gate import MISSING, REJECTED, TAKEN

SENSORS = {"psi": 0.01, "r": 5e-4}
TRUE = {"log_K": np.log(0.07), "log_tau": np.log(40.0), "K": 0.07, "psi": 0.4}


def sailed(hand: Any, t: np.ndarray, swing: Any, **first: float) -> dict[str, np.ndarray]:
    levels = hand.kalman.design.r
    x0 = np.array([(TRUE | first).get(s, 0.0) for s in hand.states])
    return hand.sail(t, {"delta": swing(t)}, x0, levels, np.random.default_rng(8))[0]


def fates(run: Any, sensor: str) -> np.ndarray:
    return run.rows("fate")[:, run.design.measured.index(sensor)]


def test_outliers_are_rejected_as_if_they_were_missing(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0)
    record = sailed(hand, np.arange(100) * 0.7, swing)
    clean = {n: c.copy() for n, c in record.items()}
    at = [20, 47, 80]
    record["psi"][at] += [0.5, -1.0, 3.0]
    clean["psi"][at] = np.nan
    run, without = hand.kalman.filter(record), hand.kalman.filter(clean)
    assert np.array_equal(run.x, without.x) and np.array_equal(run.std, without.std)
    assert run.log_likelihood == without.log_likelihood and np.array_equal(run.nis, without.nis)
    assert list(np.flatnonzero(fates(run, "psi") == REJECTED)) == at and np.all(fates(run, "r") == TAKEN)
    told = run.innovations["psi"]
    assert told.rejected == 3 and told.t.size == 100 and np.count_nonzero(~told.taken) == 3
    assert without.innovations["psi"].t.size == 97 and np.all(fates(without, "psi")[at] == MISSING)


def test_the_gate_is_as_wide_as_it_says(setup: Any, swing: Any) -> None:
    """One sample just inside, one just outside so many standard deviations of its innovation, on both sides."""
    hand = setup("yaw", {"psi": 0.01}, density={"r": 1e-4}, gate=3.0)
    record = sailed(hand, np.arange(30) * 0.7, swing)
    told = hand.kalman.filter(record).innovations["psi"]
    expected, width = record["psi"][20] - told.values[20], 3 * np.sqrt(told.variances[20])
    for off, fate in ((0.999, TAKEN), (1.001, REJECTED), (-0.999, TAKEN), (-1.001, REJECTED)):
        record["psi"][20] = expected + off * width
        assert fates(hand.kalman.filter(record), "psi")[20] == fate


def test_none_takes_in_all(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=None)
    record = sailed(hand, np.arange(50) * 0.7, swing)
    record["psi"][20] += 1.0
    run = hand.kalman.filter(record)
    assert np.all(fates(run, "psi") == TAKEN)
    # Nothing is remembered for a gate that is not there.
    assert run.start.size == hand.kalman.design.layout.carried["P"].stop


def test_patience(setup: Any, swing: Any) -> None:
    """A sensor that keeps saying something else, and changes while it does, is right in the end."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0, patience="7 s")
    t = np.arange(100) * 0.7
    record = sailed(hand, t, swing)
    record["psi"][40:] += 0.5
    run = hand.kalman.filter(record)
    refused = np.flatnonzero(fates(run, "psi")[:80] == REJECTED)
    # Ten intervals of 0.7 s make the seven seconds; the one that completes them is believed.
    assert list(refused) == list(range(40, 49))
    assert abs(run["psi"][-1] - record["psi"][-1]) < 0.05
    # A sensor that shows something every third sample waits as long, by the clock.
    record["psi"] = np.where(np.arange(100) % 3 == 0, record["psi"], np.nan)
    refused = np.flatnonzero(fates(hand.kalman.filter(record), "psi")[:80] == REJECTED)
    assert list(refused) == [42, 45, 48]


def test_patience_is_counted_anew(setup: Any, swing: Any) -> None:
    """One good sample in between, and the waiting starts again; a missing one does not end it."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0, patience="7 s")
    record = sailed(hand, np.arange(100) * 0.7, swing)
    record["psi"][40:70] += 0.5
    record["psi"][47] -= 0.5
    run = hand.kalman.filter(record)
    assert list(np.flatnonzero(fates(run, "psi")[40:60] == REJECTED)) == [*range(7), *range(8, 17)]
    record["psi"][47] = np.nan
    run = hand.kalman.filter(record)
    assert list(np.flatnonzero(fates(run, "psi")[40:60] == REJECTED)) == [*range(7), 8]


def test_a_stuck_sensor_is_never_right(setup: Any, swing: Any) -> None:
    """A value that repeats is refused for as long as it does, and taken in as soon as it moves again."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0, patience="7 s")
    t = np.arange(200) * 0.7
    record = sailed(hand, t, swing)
    record["psi"][60:160] = record["psi"][60]
    run = hand.kalman.filter(record)
    verdict = fates(run, "psi")
    first = int(np.argmax(verdict[60:] == REJECTED)) + 60
    # The ship turns to and fro by a few degrees: the compass is found out within the half swing, and stays so.
    assert first < 90 and np.mean(verdict[first:160] == REJECTED) > 0.9
    assert np.all(verdict[162:] == TAKEN)
    free = hand.kalman.filter(record | {"psi": np.where((t >= t[61]) & (t < t[160]), np.nan, record["psi"])})
    assert abs(run["psi"][-1] - free["psi"][-1]) < free.std_of("psi")[-1]


def test_a_stuck_log_that_stays_plausible(setup: Any) -> None:
    """A speed that hardly changes: no gate finds a log that is stuck, but noise that repeats itself to the last digit does."""
    hand = setup("surge", {"log": 0.1}, density={"u": 0.02}, gate=5.0, patience="10 s")
    t = np.arange(300.0)
    record, truth = hand.sail(
        t, {"thrust": np.full(300, 0.3)}, np.array([5.0]), np.array([0.1]), np.random.default_rng(3)
    )
    record["log"][150:250] = record["log"][149]
    run = hand.kalman.filter(record)
    verdict = fates(run, "log")
    assert np.all(verdict[:159] == TAKEN) and np.all(verdict[160:250] == REJECTED) and np.all(verdict[250:] == TAKEN)
    assert np.abs((run.x - truth) / run.std)[160:].max() < 4


def test_a_coarse_sensor_is_not_stuck(setup: Any, swing: Any) -> None:
    """A compass of whole degrees repeats itself on a straight course, also after turns, and is taken in all the same."""
    hand = setup("yaw", {"psi": 0.01, "r": 5e-4}, density={"r": 1e-5}, gate=5.0)
    t = np.arange(300) * 0.7
    record = sailed(hand, t, lambda t: np.where(t < 100, 0.1 * np.sin(t / 10), 0.0))
    record["psi"] = np.deg2rad(np.round(np.rad2deg(record["psi"])))
    assert np.count_nonzero(np.diff(record["psi"]) == 0) > 100
    run = hand.kalman.filter(record)
    assert run.innovations["psi"].rejected == 0


@pytest.mark.parametrize("turns", [0, 1, -3])
def test_angles_wrap(setup: Any, swing: Any, turns: int) -> None:
    """A heading that crosses south, shown within a turn, gives the estimate of one shown unwrapped."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0)
    record = sailed(hand, np.arange(150) * 0.7, lambda t: np.full(t.size, 0.4), psi=2.5)
    assert record["psi"].max() > np.pi + 0.3
    whole = hand.kalman.filter(record)
    wrapped = record["psi"] + 2 * np.pi * turns
    wrapped = (wrapped + np.pi) % (2 * np.pi) - np.pi
    run = hand.kalman.filter(record | {"psi": wrapped})
    assert np.all(fates(run, "psi") == TAKEN)
    assert run.x == pytest.approx(whole.x, abs=1e-12)
    online = hand.kalman.start()
    estimates = [online.update({n: c[k] for n, c in (record | {"psi": wrapped}).items()}) for k in range(150)]
    assert [e["psi"] for e in estimates] == pytest.approx(list(run["psi"]), abs=1e-12)


def test_an_output_wraps_with_what_it_measures(setup: Any) -> None:
    hand = setup("waved", {"compass": 0.01, "r": 1e-3})
    assert list(hand.kalman.design.step_settings.wraps) == [True, False]


def test_ranges(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, ranges={"r": ("-1 deg/s", "1 deg/s")})
    record = sailed(hand, np.arange(50) * 0.7, swing)
    record["r"][[10, 20, 30]] = [0.02, -0.02, 0.01745]
    run = hand.kalman.filter(record)
    told = run.innovations["r"]
    assert (told.limited, told.rejected, told.t.size) == (2, 0, 48)
    assert run.to_dict()["innovations"]["r"]["out_of_range"] == 2


def test_held_parameters_are_considered(setup: Any, swing: Any) -> None:
    """Adaptation off is Schmidt's filter: the parameter keeps its value and variance, and its uncertainty still counts.

    By formula, with dense matrices: the optimal gain with the parameter's row set to zero, and Joseph's form.
    """
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, estimated=["K"], log=(), switchable=True)
    kalman = hand.kalman
    record = sailed(hand, np.arange(120) * 0.7, swing)
    adapt = (np.arange(120) // 25) % 2 == 0
    run = kalman.filter(record, adapt=adapt)
    intervals, u, z = hand.rows(record)
    R = np.diag([0.01**2, 0.0005**2])
    n = kalman.design.layout.n
    x = run.start[kalman.design.layout.carried["x"]].copy()
    P = np.diag(run.start[kalman.design.layout.carried["P"]][np.cumsum(np.arange(1, n + 1)) - 1])
    i = run.states.index("K")
    for k, T in enumerate(intervals):
        if k:
            F = hand.transition(x, u[k - 1], u[k], T)
            P = F @ P @ F.T + hand.noise(x, u[k - 1], u[k], T, F)
            x = hand.advance(x, u[k - 1], u[k], T)
        # Sensor by sensor, as joint gains with a row of zeros are another filter.
        H = hand.sensitivity(x, u[k])
        e = z[k] - hand.shown(x, u[k])
        moved = np.zeros(n)
        for j in range(2):
            gain = P @ H[j] / (H[j] @ P @ H[j] + R[j, j])
            if not adapt[k]:
                gain[i] = 0.0
            left = np.eye(n) - np.outer(gain, H[j])
            P = left @ P @ left.T + R[j, j] * np.outer(gain, gain)
            moved = moved + gain * (e[j] - H[j] @ moved)
        x = x + moved
        std = np.sqrt(np.diag(P))
        assert np.all(np.abs(run.x[k] - x) <= 1e-9 * std)
        assert np.all(np.abs(run.covariance[k] - P) <= 1e-9 * np.outer(std, std))
    held = ~adapt[1:]
    assert np.all(np.diff(run["K"])[held] == 0) and np.all(np.diff(run.std_of("K"))[held] == 0)


def test_held_throughout_is_as_unsure_as_it_says(setup: Any, swing: Any) -> None:
    """A wrong gain that is never adapted: the errors stay within what the filter says, where a fixed one would lie."""
    hand = setup("yaw", SENSORS, density={"r": 1e-5}, estimated=["K"], log=(), switchable=True, start={"K": "0.05 1/s"},
                 initial={"K": "0.02 1/s"})  # fmt: skip
    t = np.arange(300) * 0.7
    x0 = np.array([{"K": 0.07}.get(s, 0.0) for s in hand.states])
    record, truth = hand.sail(t, {"delta": swing(t)}, x0, np.array([0.01, 5e-4]), np.random.default_rng(1))
    run = hand.kalman.filter(record, adapt=False)
    off = (run.x - truth) / run.std
    assert np.sqrt(np.mean(off**2)) < 1.6 and np.all(run["K"] == 0.05)
    fixed = setup("yaw", SENSORS, density={"r": 1e-5}, values={"K": 0.05}).kalman.filter(record)
    wrong = (fixed.x - truth[:, :2]) / fixed.std
    assert np.sqrt(np.mean(wrong**2)) > 3


def test_bounds_hold_an_estimate(setup: Any, swing: Any) -> None:
    """A parameter that is estimated as it is keeps within its declared bounds."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, estimated=["b"], initial={"b": "0.1 rad"})
    t = np.arange(200) * 0.7
    record = sailed(hand, t, swing, b=0.35)
    run = hand.kalman.filter(record)
    # Declared to lie below 0.2: the bound that was sailed over is where it stops.
    assert run["b"].max() == 0.2 and run["b"][-1] == 0.2


def test_single_precision(setup: Any, swing: Any) -> None:
    """Both forms in floats, beside doubles: the square root keeps the digits."""
    options: dict[str, Any] = {"density": {"r": 1e-4}, "estimated": ["K", "tau"], "gate": 5.0}
    record = sailed(setup("yaw", SENSORS, **options), np.arange(1000) * 0.7, swing)
    double = setup("yaw", SENSORS, **options).kalman.filter(record)
    kalman = setup("yaw", SENSORS, form="square-root", single=True, **options).kalman
    root = kalman.filter(record)
    assert kalman.design.loop(full=True).dtype is np.float32 and root.x.dtype == np.float64
    assert np.all(np.abs(root.x - double.x) <= 0.02 * double.std + 1e-6)
    assert root.std == pytest.approx(double.std, rel=0.01)
    plain = setup("yaw", SENSORS, single=True, **options).kalman.filter(record)
    assert np.all(np.abs(plain.x[-1] - double.x[-1]) <= 0.1 * double.std[-1])


def test_what_insists_is_followed_at_once(setup: Any, swing: Any) -> None:
    """The estimate leaps to a compass that was found right, says how unsure it is, and keeps what it knew of the ship."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, estimated=["K", "tau"], gate=5.0, patience="7 s")
    t = np.arange(300) * 0.7
    record = sailed(hand, t, swing)
    before = hand.kalman.filter(record)
    record["psi"][200:] += 0.5
    run = hand.kalman.filter(record)
    assert list(np.flatnonzero(fates(run, "psi") == REJECTED)) == list(range(200, 209))
    off = (run["psi"] - before["psi"] - 0.5)[209:]
    assert np.abs(off[0]) < 0.02 and np.all(np.abs(off) < 4 * np.hypot(run.std_of("psi"), before.std_of("psi"))[209:])
    # As sure as after one sample of a compass, and as sure of the gain as ever.
    assert run.std_of("psi")[209] == pytest.approx(0.01, rel=0.05)
    assert run.std_of("K")[209] < 1.05 * before.std_of("K")[209]
    assert abs(run["K"][-1] - before["K"][-1]) < before.std_of("K")[-1]
    # The smoother does not believe in a heading that leapt before it did.
    smoothed = smooth(run)
    assert np.all(np.abs(smoothed["psi"] - smooth(before)["psi"])[:195] < 0.02)
    assert np.all(smoothed.std <= run.std * (1 + 1e-9)) and np.all(smoothed.std[:, 0] > 0)


@pytest.mark.parametrize("form", ["covariance", "square-root"])
def test_a_leap_by_formula(setup: Any, swing: Any, form: str) -> None:
    """Standard deviation of the heading stretched until the innovation is one of its own, then the usual update."""
    options: dict[str, Any] = {"density": {"r": 1e-4}, "gate": 5.0, "patience": "7 s", "form": form}
    hand = setup("yaw", SENSORS, **options)
    record = sailed(hand, np.arange(60) * 0.7, swing)
    record["psi"][40:] += 0.5
    record["r"][49] = np.nan
    run = hand.kalman.filter(record)
    full = hand.kalman.design.layout.full
    row = run.out[49]
    ahead, packed = row[full["ahead"]], row[full["P_ahead"]]
    P = np.array([[packed[0], packed[1]], [packed[1], packed[2]]])
    e = record["psi"][49] - ahead[0]
    stretch = np.diag([np.sqrt(e**2 / (P[0, 0] + 1e-4)), 1.0])
    P = stretch @ P @ stretch
    gain = P[:, 0] / (P[0, 0] + 1e-4)
    assert run.x[49] == pytest.approx(ahead + gain * e, rel=1e-9)
    assert run.covariance[49] == pytest.approx(P - np.outer(gain, P[0]), rel=1e-6, abs=1e-12)
    assert fates(run, "psi")[49] == TAKEN and run.innovations["psi"].values[49] == pytest.approx(e)


def test_a_gate_that_rejects_the_many_opens(setup: Any, swing: Any) -> None:
    """Two samples of three are far beyond the gate, never for as long as the patience lasts: the many are right."""
    hand = setup("yaw", {"psi": 0.01}, density={"r": 1e-6}, gate=5.0, patience="7 s")
    record = sailed(hand, np.arange(400) * 0.7, swing)
    wild = np.random.default_rng(5).choice([-1.0, 1.0], 400) * 0.2
    late = np.arange(400) >= 100
    wrong = late & (np.arange(400) % 3 > 0)
    record["psi"] = record["psi"] + np.where(wrong, wild, 0.0)
    verdict = fates(hand.kalman.filter(record), "psi")
    opened = int(np.argmax((verdict == TAKEN) & wrong))
    assert 120 < opened < 180 and np.all(verdict[100:opened][wrong[100:opened]] == REJECTED)
    assert np.mean(verdict[opened:] == REJECTED) < 0.4
    # A third of the samples does not open it.
    few = late & (np.arange(400) % 3 == 0)
    record["psi"] = sailed(hand, np.arange(400) * 0.7, swing)["psi"] + np.where(few, wild, 0.0)
    assert np.array_equal(fates(hand.kalman.filter(record), "psi") == REJECTED, few)


def test_an_open_gate_does_not_open_for_a_value_that_repeats(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=5.0, patience="7 s")
    record = sailed(hand, np.arange(200) * 0.7, swing)
    record["psi"][60:160] = 3.0
    assert np.all(fates(hand.kalman.filter(record), "psi")[60:160] == REJECTED)
