"""Logs in which rows stand twice, or in which the clock starts again: never a clock that was rebuilt across them."""

from __future__ import annotations

import pytest

import shipid
from shipid.trials.doctor.repair import fix_trial

HEAD = "t [s],psi [deg],r [deg/s],delta [deg]"


@pytest.fixture(scope="module")
def rows():
    def sail(manoeuvre: str) -> list[str]:
        trial = shipid.simulate("nomoto", "soesterberg", manoeuvre, noise={"psi": "0.1 deg", "r": "0.02 deg/s"})
        table = trial.to_frame()[["t [s]", "psi [deg]", "r [deg/s]", "delta [deg]"]]
        return table.to_csv(index=False, header=False, lineterminator="\n").splitlines()

    return sail("zigzag:20/20"), sail("zigzag:10/10")


def found_in(tmp_path, lines):
    path = tmp_path / "log.csv"
    path.write_text("\n".join([HEAD, *lines]) + "\n")
    return path, shipid.check_trial(path)


@pytest.mark.parametrize("order", ["twice in a row", "three times in a row", "the file twice"])
def test_rows_that_stand_several_times_are_dropped(rows, tmp_path, order):
    first = rows[0]
    repeated = {"twice in a row": 2, "three times in a row": 3}.get(order)
    lines = [row for row in first for _ in range(repeated)] if repeated else first + first
    path, found = found_in(tmp_path, lines)
    kinds = {f.kind for f in found.findings}
    assert "clock-repeats" in kinds and "clock-quantised" not in kinds
    fixed = shipid.read_trial(fix_trial(path, tmp_path / "fixed.csv")[0])
    assert len(fixed) == len(first) and fixed["t"][-1] == float(first[-1].split(",")[0])


def test_two_runs_in_one_log_are_not_mixed(rows, tmp_path):
    """The longest run is examined, and the others are accounted for; nothing is sorted."""
    first, second = rows
    _, found = found_in(tmp_path, first + second[:400])
    unsorted = next(f for f in found.findings if f.kind == "clock-unsorted")
    assert unsorted.fix is None and "starts again" in unsorted.repair
    assert {f.kind for f in found.findings} <= {"clock-unsorted", "heading-wrap"}
    assert "400 left out: rows of other runs" in found.text()
    (zigzag,) = [m for m in found.manoeuvres if m.kind == "zigzag"]
    assert (zigzag.rudder_deg, zigzag.heading_deg) == (20, 20)
