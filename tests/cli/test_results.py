"""The result: its shape, its keys, what a failed search still writes, and the whole way for every model."""

import json
from numbers import Real

import numpy as np
import pytest

import shipid

TOP = {
    "model", "ship", "method", "converged", "parameters", "fit", "validation", "manoeuvre", "diagnostics", "provenance",
}  # fmt: skip


def parse(text: str):
    """Read JSON that may not hold NaN or infinity."""

    def refuse(name: str):
        raise AssertionError(f"JSON holds {name}")

    return json.loads(text, parse_constant=refuse)


def number(value) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and bool(np.isfinite(value))


def check_shape(result) -> None:
    """The documented shape; entries beyond it may be there."""
    assert set(result) >= TOP
    assert isinstance(result["converged"], bool)
    assert all(isinstance(result[key], str) and result[key] for key in ("model", "ship", "method"))
    for name, one in result["parameters"].items():
        assert set(one) >= {"value", "unit", "std", "interval_95", "identifiable"}, name
        assert one["value"] is None or number(one["value"])
        assert isinstance(one["unit"], str) and isinstance(one["identifiable"], bool)
        assert (one["std"] is None) == (one["interval_95"] is None)
        if one["interval_95"] is not None:
            low, high = one["interval_95"]
            assert low <= one["value"] <= high
            assert high - low == pytest.approx(2 * 1.96 * one["std"], rel=1e-3)
    for signals in result["fit"].values():
        assert signals
        assert all(set(s["rmse"]) == {"value", "unit"} for s in signals.values())
    for signals in result["validation"].values():
        assert signals
        assert all(set(s) >= {"rmse", "rmse_refitted_bias", "fit_percent"} for s in signals.values())
    assert list(result["manoeuvre"]) == [*result["fit"], *result["validation"]]
    for one in result["manoeuvre"].values():
        assert set(one) >= {"overshoots", "predicted_overshoots"}
        assert len(one["overshoots"]["value"]) == len(one["predicted_overshoots"]["value"])
    assert set(result["diagnostics"]) >= {"condition_number", "unidentifiable"}
    fitted = {n for n, e in result["parameters"].items() if not e.get("follows")}
    unsure = {n for n in fitted if not result["parameters"][n]["identifiable"]}
    assert set(result["diagnostics"]["unidentifiable"]) == unsure
    assert set(result["provenance"]) >= {"versions", "model_sha256", "trials"}
    assert list(result["provenance"]["trials"]) == list(result["manoeuvre"])
    assert all(len(t["sha256"]) == 64 for t in result["provenance"]["trials"].values())


@pytest.fixture(scope="session")
def second(tmp_path_factory):
    """Another zig-zag, of the same stem in another folder."""
    from shipid.cli import run

    path = tmp_path_factory.mktemp("others") / "zigzag.csv"
    arguments = ["--manoeuvre", "zigzag:10/10", "--noise", "standard", "--seed", "7", "-o", str(path)]
    assert run(["simulate", "nomoto", "--ship", "zeefakkel", *arguments]) == 0
    return path


def test_shape_of_the_result(call, zigzag, second, fitted, tmp_path):
    arguments = ["identify", f"{zigzag}@0:200", zigzag, *fitted, "--validate", f"{second}@20:150", "--json"]
    answer = call(*arguments, "--out", tmp_path)
    assert (answer.code, answer.err) == (0, "")
    result = parse(answer.out)
    check_shape(result)
    assert result == parse((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert (result["model"], result["ship"], result["converged"]) == ("nomoto", "zeefakkel", True)
    assert list(result["parameters"]) == ["K", "tau"]
    assert list(result["fit"]) == ["zigzag@0:200", "zigzag"]
    assert list(result["validation"]) == ["zigzag@20:150"]
    assert result["fit"]["zigzag"]["psi"]["rmse"]["unit"] == "rad"
    assert result["fit"]["zigzag"]["r"]["rmse"]["unit"] == "rad/s"
    # 0.2 deg on the compass, within three standard errors of a standard deviation over 1396 samples
    assert result["fit"]["zigzag"]["psi"]["rmse"]["value"] == pytest.approx(np.radians(0.2), rel=3 / np.sqrt(2 * 1396))
    assert len(result["manoeuvre"]["zigzag"]["overshoots"]["value"]) >= 4


def test_trials_of_the_same_name_stand_apart(call, short, second, fitted):
    result = parse(call("identify", short, second, *fitted, "--json").out)
    check_shape(result)
    assert list(result["fit"]) == ["zigzag", "zigzag-2"]
    result = parse(call("identify", short, *fitted, "--validate", second, "--json").out)
    check_shape(result)
    assert [*result["fit"], *result["validation"]] == ["zigzag", "zigzag-2"]


def test_options_of_identify(call, short, fitted):
    def result_of(*options):
        answer = call("identify", short, *fitted, *options, "--json")
        assert answer.code == 0
        return parse(answer.out)

    assert result_of("--fix", "K=0.5 1/s")["fixed"]["K"] == {"value": 0.5, "unit": "1/s"}
    assert list(result_of("--estimate", "tau")["parameters"]) == ["tau"]
    assert list(result_of("--signals", "psi")["fit"]["zigzag"]) == ["psi"]
    once, twice = result_of("--signals", "psi"), result_of("--signals", "psi,psi")
    assert once["parameters"] == twice["parameters"]
    assert list(result_of("--window", ":80")["fit"]) == ["zigzag@0:80"]
    given = result_of("--noise", "psi=0.2 deg,r=0.02 deg/s")
    assert given["noise"]["psi"]["value"] == pytest.approx(np.radians(0.2))
    assert all(b["value"] == 0 for b in result_of("--no-rudder-bias")["rudder_bias"].values())


def test_search_that_fails_says_so_and_writes_what_it_knows(call, short, fitted, tmp_path):
    """A time constant of zero: the model runs away whatever its gain."""
    arguments = ["identify", short, *fitted, "--fix", "tau=0 s", "--out", tmp_path]
    answer = call(*arguments, "--json")
    assert answer.code == 4
    assert answer.err.startswith("shipid: ")
    assert "did not converge" in answer.said and "Traceback" not in answer.err
    result = parse(answer.out)
    check_shape(result)
    assert result["converged"] is False
    assert result["fit"]["zigzag"]["psi"]["rmse"]["value"] is None
    assert result == parse((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert {p.name for p in tmp_path.iterdir()} == {"result.json", "ship.toml", "report.html"}
    assert "NOT CONVERGED" in call(*arguments, "--overwrite").out


@pytest.mark.parametrize(
    ("model", "ship"), [("nomoto", "zeefakkel"), ("norrbin", "zeefakkel"), ("pershitz", "semerdjiev")]
)
def test_record_that_is_all_noise(call, changed, column, model, ship):
    """No silent bad fit: it did not converge, or something is not determined."""
    rng = np.random.default_rng(3)
    heading = column("psi", lambda *_: f"{rng.normal(0, 100):.6g}")
    rate = column("r", lambda *_: f"{rng.normal(0, 5):.6g}")
    log = changed(lambda rows: rate(heading(rows[:400])))
    answer = call("identify", log, "--model", model, "--ship", ship, "--starts", "1", "--json")
    assert answer.code in (0, 4, 5)
    result = parse(answer.out)
    check_shape(result)
    assert result["converged"] is (answer.code != 4)
    assert answer.code == 4 or result["diagnostics"]["unidentifiable"]
    assert "Warning" not in answer.err


@pytest.mark.usefixtures("undrawn")
def test_the_identified_ship_is_a_ship(call, zigzag, fitted, tmp_path):
    """ship.toml holds the numbers of result.json, and whoever takes it gets them again."""
    answer = call("identify", zigzag, *fitted, "--json", "--out", tmp_path / "first")
    result = parse(answer.out)
    toml = tmp_path / "first" / "ship.toml"
    ship = shipid.find_ship(toml)
    for name, one in result["parameters"].items():
        value = ship.find(shipid.find_model("nomoto"), name)
        # JSON holds twelve digits.
        assert (value.value, value.std) == pytest.approx((one["value"], one["std"]), rel=1e-11)
        assert value.unit == one["unit"]
        assert "identified" in value.source and "zigzag" in value.source
    again = parse(call("identify", zigzag, "--model", "nomoto", "--ship", toml, "--starts", "1", "--json").out)
    for name, one in result["parameters"].items():
        assert again["parameters"][name]["value"] == pytest.approx(one["value"], abs=0.01 * one["std"])
    held = [f"--fix={name}={one['value']!r} {one['unit']}" for name, one in result["parameters"].items()]
    arguments = ["simulate", "nomoto", "--manoeuvre", "zigzag:20/20"]
    by_file = call(*arguments, "--ship", toml)
    by_hand = call(*arguments, "--ship", "zeefakkel", *held)
    assert by_file.code == by_hand.code == 0
    tables = [np.loadtxt(a.out.splitlines()[2:], delimiter=",") for a in (by_file, by_hand)]
    np.testing.assert_allclose(tables[0], tables[1], rtol=1e-8, atol=1e-8)


#: Ship, and by how many degrees the heading may be off in the manoeuvre simulated again: the sensors' noise moves the
#: executes a little; of the coefficients of Davidson and Schiff a single zig-zag leaves most open.
WAYS = {
    "nomoto": ("zeefakkel", 0.5),
    "nomoto-second-order": ("mariner", 0.5),
    "norrbin": ("zeefakkel", 0.5),
    "bech": ("kvlcc2", 0.5),
    "de-keizer": ("soesterberg", 0.5),
    "van-leeuwen": ("soesterberg", 0.5),
    "davidson-schiff": ("mariner", 5.0),
    "pershitz": ("semerdjiev", 0.5),
}


def whole_way(call, folder, model, ship, tolerance):
    """Simulate, measure, identify, simulate what was identified; returns the result."""
    sail = ["simulate", model, "--manoeuvre", "zigzag:20/20"]
    noise = "psi=0.2 deg,r=0.02 deg/s,u=0.1 m/s"
    assert call(*sail, "--ship", ship, "--noise", noise, "-o", folder / "trial.csv").code == 0
    assert call(*sail, "--ship", ship, "-o", folder / "clean.csv").code == 0
    measured = parse(call("measure", folder / "trial.csv", "--json").out)
    assert measured["nominal"] == "20/20"
    arguments = [folder / "trial.csv", "--model", model, "--ship", ship, "--starts", "1"]
    answer = call("identify", *arguments, "--json", "--out", folder / "result")
    assert answer.code != 4, answer.err
    result = parse(answer.out)
    check_shape(result)
    assert call(*sail, "--ship", folder / "result" / "ship.toml", "-o", folder / "again.csv").code == 0
    clean, again = shipid.read_trial(folder / "clean.csv"), shipid.read_trial(folder / "again.csv")
    shared = min(len(clean), len(again))
    off = np.degrees(clean["psi"][:shared] - again["psi"][:shared])
    assert np.sqrt(np.mean(off**2)) < tolerance
    # The overshoots of the simulated record are those that identify compares with.
    found = [o for o in measured["overshoots"]["value"] if o is not None]
    assert result["manoeuvre"]["trial"]["overshoots"]["value"] == pytest.approx(found, abs=1e-3)
    return result


@pytest.mark.parametrize("model", WAYS)
def test_whole_way(call, tmp_path, model):
    ship, tolerance = WAYS[model]
    result = whole_way(call, tmp_path, model, ship, tolerance)
    assert (result["model"], result["ship"]) == (model, ship)


def test_model_of_the_users_own(call, own_model, own_ship, tmp_path):
    """One file of the user's own, and nothing else touched."""
    name, ship = f"{own_model()}:Yaw", own_ship()
    shown = parse(call("show", name, "--json").out)
    assert {"psi", "x", "y", "r"} <= set(shown["quantities"])
    assert "Own notes, page 1." in [e["source"] for e in shown["equations"]]
    result = whole_way(call, tmp_path, name, ship, 0.5)
    assert (result["model"], result["ship"]) == ("yaw", "own-ship")
    for parameter, truth in (("K", 0.3), ("tau", 20.0)):
        one = result["parameters"][parameter]
        assert one["identifiable"]
        assert abs(one["value"] - truth) < 4 * one["std"]


def test_method_loss_check_and_posterior(call, short, fitted):
    pytest.importorskip("emcee")

    def result_of(*options):
        answer = call("identify", short, *fitted, *options, "--json")
        assert answer.code == 0, answer.err
        return parse(answer.out)

    plain = result_of()
    assert plain["loss"] == "linear" and plain["warnings"] == [] and plain["checked"] and "posterior" not in plain
    assert [r["method"] for r in plain["ladder"] if r["used"]] == ["output-error"]
    assert not result_of("--no-check")["checked"]
    regressed = result_of("--method", "equation-error")
    assert [r["method"] for r in regressed["ladder"]] == ["equation-error"]
    assert regressed["method"].startswith("equation error by least squares")
    other = result_of("--loss", "huber", "--posterior", "400")
    assert other["loss"] == "huber" and other["posterior"]["draws"] >= 400
    assert set(other["posterior"]["parameters"]) == {"K", "tau"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--method", "magic"], "'magic' is not one of"),
        (["--loss", "cubic"], "'cubic' is not one of"),
        (["--posterior", "0"], "0 is not in the range"),
        (["--posterior", "20"], "ask for 1600"),
        (["--method", "equation-error", "--loss", "huber"], "uses squares only"),
        (["--method", "equation-error", "--posterior", "4000"], "needs the likelihood of output error"),
    ],
)
def test_what_method_loss_and_posterior_refuse(call, short, fitted, options, said):
    pytest.importorskip("emcee")
    answer = call("identify", short, *fitted, *options)
    assert answer.code in (2, 3)
    assert said in answer.said and "Traceback" not in answer.err
