"""``shipid measure``: a table, JSON with reasons, a list of manoeuvres."""

import json

import numpy as np
import pandas as pd
import pytest

import shipid


@pytest.fixture(scope="module")
def sailed():
    return shipid.simulate("nomoto", "soesterberg", "zigzag:20/20")


@pytest.fixture
def log(tmp_path, sailed):
    """Write the zig-zag, as one or several in a row, with columns left out and samples missing."""

    def write(repeat=1, drop=(), missing=None):
        frame = sailed.to_frame().drop(columns=list(drop))
        if missing is not None:
            column, start, end = missing
            frame.loc[(sailed["t"] > start) & (sailed["t"] < end), column] = np.nan
        parts = []
        for k in range(repeat):
            part = frame.copy()
            part["t [s]"] += k * (sailed.duration + 1.0)
            parts.append(part)
        path = tmp_path / "log.csv"
        type(frame)(np.concatenate([p.to_numpy() for p in parts]), columns=frame.columns).to_csv(path, index=False)
        return path

    return write


def test_table_says_which_execute_was_taken(call, log):
    answer = call("measure", log(drop=["delta_order [deg]"]))
    assert answer.code == 0
    assert (
        "executes read from the ramp of the rudder (2.5 deg/s)" in answer.out
        and "the order is not logged" in answer.out
    )
    assert "reversal" in answer.out and "overshoot [deg]" in answer.out
    moved = call("measure", log(drop=["delta_order [deg]"]), "--execute", "moved", "--json")
    ordered = json.loads(call("measure", log(drop=["delta_order [deg]"]), "--json").out)
    assert ordered["overshoots_moved"]["value"][0] == pytest.approx(
        json.loads(moved.out)["overshoots"]["value"][0], abs=1e-3
    )
    assert ordered["overshoots"]["value"][0] > json.loads(moved.out)["overshoots"]["value"][0] + 0.3


def test_null_in_json_has_a_reason_beside_it(call, log):
    answer = call("measure", log(missing=("psi [deg]", 80, 130)), "--json")
    result = json.loads(answer.out)
    assert answer.code == 0
    overshoots = result["overshoots"]
    assert overshoots["value"][0] is None and overshoots["value"][1] is not None and overshoots["unit"] == "deg"
    assert overshoots["reason"] == "gap 80 to 130 s in the heading"
    assert result["reasons"]["overshoots[1]"] == "gap 80 to 130 s in the heading"
    assert "not known: gap 80 to 130 s in the heading" in call("measure", log(missing=("psi [deg]", 80, 130))).out


def test_several_manoeuvres_are_listed_and_one_is_measured(call, log):
    path = log(repeat=2)
    answer = call("measure", path)
    assert answer.code == 2 and answer.out == ""
    assert "holds several manoeuvres" in answer.err and "--manoeuvre 1" in answer.err
    lines = [line for line in answer.err.splitlines() if "zig-zag" in line]
    assert len(lines) == 2 and lines[0].strip().startswith("1: zig-zag 20/20")
    second = json.loads(call("measure", path, "--manoeuvre", "2", "--json").out)
    alone = json.loads(call("measure", log(), "--json").out)
    np.testing.assert_allclose(second["overshoots"]["value"][:3], alone["overshoots"]["value"][:3], atol=0.1)
    assert call("measure", log(repeat=2), "--manoeuvre", "3").code == 2


def test_a_serious_finding_is_an_exit_code(call, log):
    """The order is stamped 8 s early: overshoots from it are too large. A finding elsewhere is said, and misleads no overshoot."""
    path = log()
    frame = pd.read_csv(path)
    order = np.interp(frame["t [s]"] + 8, frame["t [s]"], frame["delta_order [deg]"])
    early = frame.assign(**{"delta_order [deg]": order})
    early.to_csv(path, index=False)
    answer = call("measure", path, "--json")
    [told] = [w for w in json.loads(answer.out)["warnings"] if w["serious"]]
    assert answer.code == 5 and told["kind"] == "order-early"
    assert "WARNING: order-early" in call("measure", path).out
    assert call("check", path).code == 3
    frame.assign(**{"y [m]": -frame["y [m]"]}).to_csv(path, index=False)
    answer = call("measure", path)
    assert (
        answer.code == 0
        and "note: in columns that are not measured here the doctor finds: track-direction (x,y)" in answer.out
    )
    assert call("check", path).code == 3
