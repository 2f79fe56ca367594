"""Every error of a filter once, with what was wrong and what to do."""

from typing import Any

import numpy as np
import pytest

from shipid import ExtendedKalmanFilter, find_model
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError, SensorRateError
from shipid.foundation.errors import DeclarationError, ShipidError, UnitError, UnknownNameError, UsageError
from shipid.generation.simulator import UnstatedInputError

SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s"}
CASES: list[tuple[dict[str, Any], type[ShipidError], str]] = [
    ({"measured": {}}, NotMeasurableError, r"at least one measured quantity, as in measured=\{'psi': '0\.2 deg'\}"),
    ({"measured": {"heading": "1 deg"}}, NotMeasurableError, r"no quantity of model yaw to measure called 'heading'"),
    ({"measured": {"delta": "1 deg"}}, NotMeasurableError, r"to measure called 'delta'.*It is given there"),
    ({"measured": {"psi": None}}, NoiseLevelError, r"sensor of 'psi' has no noise level.*as in psi='0\.2 deg'"),
    ({"measured": {"psi": "0 deg"}}, NoiseLevelError, r"noise of the sensor of 'psi' is 0 deg; a noise level must be greater"),
    ({"measured": {"psi": "-1 deg"}}, NoiseLevelError, r"is -1 deg; a noise level must be greater than zero"),
    ({"measured": {"psi": 0.2}}, UnitError, r"bare number 0\.2.*where the unit rad is needed"),
    ({"measured": {"psi": "0.2 m"}}, UnitError, r"needs the unit rad, and m does not fit it"),
    ({"noise": {"r": "0 deg/s"}}, NoiseLevelError, r"noise of 'r' is 0 deg/s; .*leave the noise out"),
    ({"noise": {"r": "-0.1 deg/s^1.5"}}, NoiseLevelError, r"noise of 'r' is -0\.1 deg/s\^1\.5"),
    ({"noise": {"r": "0.1 m"}}, UnitError, r"in rad/s \(for one sample\) or rad/s\^1\.5 \(a density\)"),
    ({"noise": {"delta": "1 deg/s"}}, UnitError, r"in rad \(for one sample\) or rad\*s\^0\.5 \(a density\)"),
    ({"noise": {"q": "1 deg"}}, UnknownNameError, r"no state, input or estimated parameter of model yaw to put noise on"),
    ({"noise": {"K": "0.1 1/s"}}, UnknownNameError, r"to put noise on called 'K'"),
    ({"estimated": ["Kay"]}, UnknownNameError, r"no parameter in model yaw called 'Kay'"),
    ({"estimated": ["K"], "log": ["tau"]}, DeclarationError, r"'tau' is to be in log scale but is not among"),
    ({"initial": {"q": "1 deg"}}, UnknownNameError, r"no state of model yaw called 'q'"),
    ({"initial": {"psi": "0 deg"}}, NoiseLevelError, r"first standard deviation of 'psi' is 0 deg; it must be greater than zero"),
    ({"start": {"q": "1 deg"}}, UnknownNameError, r"no state of model yaw to start called 'q'"),
    ({"rates": {"delta": "1 s"}}, NotMeasurableError, r"a rate is given for 'delta', which is not measured\. Measured: psi, r"),
    ({"rates": {"psi": "0 s"}}, SensorRateError, r"'psi' is to be read every 0 s: an interval must be longer than zero"),
    ({"rates": {"psi": "-1 Hz"}}, SensorRateError, r"'psi' is to be read every -1 Hz"),
    ({"rates": {"psi": "1 m"}}, SensorRateError, r"interval of 'psi' needs the unit s, and m does not fit.*such as '0\.5 Hz'"),
    ({"ranges": {"psi": ("1 deg", "0 deg")}}, UsageError, r"range of 'psi' runs from 1 deg to 0 deg"),
    ({"ranges": {"delta": ("0 deg", "1 deg")}}, NotMeasurableError, r"a range is given for 'delta', which is not measured"),
    ({"inputs": {"rudder": "1 deg"}}, UnknownNameError, r"no input of model yaw called 'rudder'"),
    ({"lost": {"r": "1 deg/s"}}, UnknownNameError, r"no input of model yaw that can be lost called 'r'"),
    ({"lost": {"delta": "0 deg"}}, NoiseLevelError, r"uncertainty of lost 'delta' is 0 deg; it must be greater than zero"),
    ({"gate": 0.0}, UsageError, r"a gate of 0 standard deviations rejects every sample"),
    ({"gate": -1.0}, UsageError, r"a gate of -1 standard deviations"),
    ({"patience": "-1 s"}, UsageError, r"patience of -1 s"),
    ({"form": "cholesky"}, UnknownNameError, r"no form of the filter 'cholesky'|form of the filter"),
    ({"form": "square-root", "switchable": True}, UsageError, r"needs the covariance form"),
    ({"method": "rk5"}, UnknownNameError, r"integration method"),
    ({"hold": "cubic"}, UnknownNameError, r"hold"),
    ({"substeps": 0}, UsageError, r"at least one substep"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "error", "message"), CASES, ids=[str(c[0]) for c in CASES])
def test_making_a_filter(
    models: Any, ship: Any, change: dict[str, Any], error: type[ShipidError], message: str
) -> None:
    with pytest.raises(error, match=message):
        ExtendedKalmanFilter(models["yaw"], ship, **{"measured": SENSORS} | change)


def test_a_ship_that_does_not_say_enough(models: Any) -> None:
    with pytest.raises(ShipidError, match=r"K.*tau|tau.*K"):
        ExtendedKalmanFilter(models["yaw"], measured=SENSORS)


def test_a_parameter_that_starts_at_zero_and_may_be_anything(setup: Any) -> None:
    """Of zero no share can be taken; bounds or the user say how sure it is."""
    from dataclasses import replace

    kalman = setup("yaw", {"psi": 0.01}, estimated=["b"]).kalman
    assert kalman.design.first.parameters["b"] == (0.0, pytest.approx(0.1))
    base = kalman.design.base
    entry = replace(base["b"], quantity=replace(base["b"].quantity, low=None, high=None))
    free = replace(base, entries={**base.entries, "b": entry})
    with pytest.raises(NoiseLevelError, match=r"'b' starts at zero and has no standard deviation: give initial=\{'b'"):
        ExtendedKalmanFilter(free, kalman.design.ship, measured=SENSORS, estimated=["b"])
    given = ExtendedKalmanFilter(free, kalman.design.ship, measured=SENSORS, estimated=["b"], initial={"b": "0.05 rad"})
    assert (
        given.filter({"t": np.arange(3.0), "psi": np.zeros(3), "r": np.zeros(3), "delta": np.zeros(3)}).std_of("b")[0]
        > 0
    )


def test_a_parameter_that_starts_nowhere(models: Any) -> None:
    from dataclasses import replace

    base = models["yaw"]
    entry = replace(base["b"], quantity=replace(base["b"].quantity, start=None))
    model = replace(base, entries={**base.entries, "b": entry})
    with pytest.raises(NoiseLevelError, match=r"the estimate of 'b' has no first value: give start=\{'b'"):
        ExtendedKalmanFilter(model, measured=SENSORS, estimated=["K", "tau", "b"])


def record(**columns: np.ndarray) -> dict[str, np.ndarray]:
    t = np.arange(20.0)
    return {"t": t, "psi": 0 * t, "r": 0 * t, "delta": 0 * t} | columns


def test_records(models: Any, ship: Any) -> None:
    kalman = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, rates={"psi": "0.5 s"})
    with pytest.raises(
        SensorRateError, match=r"'psi' is to be read every 0\.5 s, and trial record is sampled every 1 s"
    ):
        kalman.filter(record())
    kalman = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS)
    bare = record()
    with pytest.raises(UsageError, match=r"a record to filter needs its times 't'; it has psi, r, delta"):
        kalman.filter({n: c for n, c in bare.items() if n != "t"})
    with pytest.raises(
        NotMeasurableError, match=r"'r' is measured, and trial record has no such column\. Its columns: t, psi"
    ):
        kalman.filter({n: c for n, c in bare.items() if n != "r"})
    # A column without a number states nothing either.
    for unstated in ({n: c for n, c in bare.items() if n != "delta"}, bare | {"delta": np.full(20, np.nan)}):
        with pytest.raises(
            UnstatedInputError, match=r"model yaw reads 'delta' \(rudder angle\), that trial record does not record"
        ):
            kalman.filter(unstated)
    with pytest.raises(UsageError, match=r"column 'psi' of the record has 3 samples, and 't' has 20"):
        kalman.filter(bare | {"psi": np.zeros(3)})
    with pytest.raises(UsageError, match=r"of 0 stamps 0 can be used"):
        kalman.filter({n: c[:0] for n, c in bare.items()})
    with pytest.raises(UsageError, match=r"made without switchable=True"):
        kalman.filter(bare, adapt=False)
    with pytest.raises(UnknownNameError, match=r"no noise to scale called 'wind'"):
        kalman.filter(bare, scale={"wind": 2.0})
    with pytest.raises(UsageError, match=r"factors on the noise of 'r': 3 values, and the record has 20 samples"):
        ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, noise={"r": "0.1 deg/s"}).filter(
            bare, scale={"r": np.ones(3)}
        )


def test_adapt_has_one_entry_a_sample(models: Any, ship: Any) -> None:
    kalman = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["K"], switchable=True)
    with pytest.raises(UsageError, match=r"'adapt': 3 values, and the record has 20 samples"):
        kalman.filter(record(), adapt=np.ones(3, dtype=bool))


def test_an_output_is_found_by_what_it_measures(models: Any, ship: Any) -> None:
    """A record that has the heading serves a filter with a compass; one that has neither is told of both."""
    kalman = ExtendedKalmanFilter(models["waved"], ship, measured={"compass": None})
    rows = record()
    assert kalman.filter(rows).t.size == 20
    del rows["psi"]
    with pytest.raises(
        NotMeasurableError, match=r"'compass', which measures 'psi', is measured, and trial record has no"
    ):
        kalman.filter(rows)


def test_names_of_results(models: Any, ship: Any) -> None:
    kalman = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["K"])
    run = kalman.filter(record())
    for ask in (run.__getitem__, run.std_of, kalman.smooth(run).__getitem__):
        with pytest.raises(UnknownNameError, match=r"no state or estimated parameter of model yaw called 'q'"):
            ask("q")
    # Along a run any quantity of the model can be asked for; smoothed are the states alone.
    assert (run.std_of("delta") == 0).all()
    with pytest.raises(UnknownNameError, match=r"no state or estimated parameter of model yaw called 'delta'"):
        kalman.smooth(run)["delta"]


def test_a_run_belongs_to_its_filter(models: Any, ship: Any) -> None:
    run = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["K"]).filter(record())
    same = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["K"])
    assert same.smooth(run).x.shape == run.x.shape
    other = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["tau"])
    for ask in (other.smooth, other.observability):
        with pytest.raises(UsageError, match="the run of record record is of another filter"):
            ask(run)


def test_a_model_is_found_by_name() -> None:
    named = ExtendedKalmanFilter("nomoto", "soesterberg", measured={"r": "0.1 deg/s"})
    assert named.model == ExtendedKalmanFilter(find_model("nomoto"), "soesterberg", measured={"r": "0.1 deg/s"}).model
    with pytest.raises(UnknownNameError, match="no model 'nomotto'"):
        ExtendedKalmanFilter("nomotto", "soesterberg")
    for wrong in (3.0, dict):
        with pytest.raises(
            UsageError, match=r"a model is a name such as 'norrbin', a component class or what shipid\.join"
        ):
            ExtendedKalmanFilter(wrong, "soesterberg")


def test_one_sample_is_a_record(models: Any, ship: Any) -> None:
    kalman = ExtendedKalmanFilter(models["yaw"], ship, measured=SENSORS, estimated=["K"], rates={"psi": "2 s"})
    run = kalman.filter({n: c[:1] for n, c in record(psi=np.full(20, 0.3)).items()})
    assert run["psi"] == pytest.approx([0.3]) and kalman.smooth(run).x.shape == (1, 3)
    assert kalman.observability(run).states == ("psi", "r", "log_K")


def test_a_trial_serves(models: Any) -> None:
    """A trial of the toolbox's own, and a filter without more than a model, a ship and sensors."""
    from shipid import simulate

    trial = simulate(
        find_model("de-keizer"), "soesterberg", "zigzag:10/10", noise={"psi": "0.2 deg", "r": "0.02 deg/s"}
    )
    kalman = ExtendedKalmanFilter(find_model("de-keizer"), "soesterberg", measured=SENSORS, estimated=["K", "tau"])
    run = kalman.filter(trial)
    assert run.record == trial.name and run.t.size == len(trial)
    assert run.parameters["K"].ci95[0] < 1.6 < run.parameters["K"].ci95[1]
    assert {s.name for s in kalman.design.sources if s.assumed} == {"r", "u"}
