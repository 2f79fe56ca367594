"""One trial in every kind of file measures the same."""

import gzip
import io

import numpy as np
import pandas as pd
import pytest

from shipid.cli import run
from shipid.trials.logs.reading import read_trial
from shipid.trials.measuring.measure import measure


def zigzag() -> pd.DataFrame:
    """A 20/20 zig-zag of a first-order ship (K 0.08 1/s, T 12 s, 3 deg/s of rudder), twice a second."""
    step, r, psi, delta, order = 0.05, 0.0, 0.0, 0.0, 0.0
    rows = []
    for k in range(4000):
        t = k * step
        if t >= 10 and order == 0:
            order = 20.0
        elif order and psi * order > 0 and abs(psi) >= 20 and (psi - 20 * np.sign(order)) * order >= 0:
            order = -order
        if k % 10 == 0:
            rows.append((t, 1000.5 + 8 * t, psi, r, order, delta))
        delta += float(np.clip(order - delta, -3 * step, 3 * step))
        psi, r = psi + r * step, r + (0.08 * delta - r) / 12 * step
    return pd.DataFrame(rows, columns=["t [s]", "x [m]", "psi [deg]", "r [deg/s]", "delta_order [deg]", "delta [deg]"])


@pytest.fixture(scope="module")
def frame():
    return zigzag()


def text(frame, **options) -> bytes:
    return frame.to_csv(index=False, float_format="%.6f", **options).encode()


def local(frame) -> bytes:
    """Semicolons, decimal comma, points between thousands."""
    written = frame.map(lambda value: f"{value:,.4f}".translate(str.maketrans(",.", ".,")))
    return written.to_csv(index=False, sep=";").encode()


def excel(frame) -> bytes:
    pytest.importorskip("openpyxl")
    made = io.BytesIO()
    with pd.ExcelWriter(made) as book:
        pd.DataFrame({"Sea trial": ["ship", "date"], "value": ["A", "2026-05-01"]}).to_excel(
            book, sheet_name="Info", index=False
        )
        frame.to_excel(book, sheet_name="ZZ 20-20", startrow=2, index=False)
    return made.getvalue()


def parquet(frame) -> bytes:
    pytest.importorskip("pyarrow")
    made = io.BytesIO()
    frame.to_parquet(made)
    return made.getvalue()


FILES = {
    "log.csv": text,
    "semicolon.csv": local,
    "quoted.csv": lambda frame: frame.map("{:,.4f}".format).to_csv(index=False, quoting=1).encode(),
    "utf16.csv": lambda frame: text(frame).decode().encode("utf-16"),
    "log.csv.gz": lambda frame: gzip.compress(text(frame)),
    "fortran.dat": lambda frame: text(frame.rename(columns=lambda name: name.replace(" ", "")), sep=" ")
    .replace(b".000000", b".000000D+00"),
    "log.xlsx": excel,
    "log.parquet": parquet,
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_it_measures_the_same(log, frame, name):
    found = measure(read_trial(log(FILES[name](frame), name)))
    expected = measure(read_trial(log(text(frame), "plain.csv")))
    assert len(found.overshoots) == len(expected.overshoots) >= 2
    for one, other in zip(found.overshoots, expected.overshoots):
        assert abs(float(getattr(one, "value", one)) - float(getattr(other, "value", other))) < 1e-4


def test_no_row_of_a_log_with_thousands_is_dropped_by_a_repair(log, frame, tmp_path):
    fixed = tmp_path / "fixed.csv"
    assert run(["check", str(log(local(frame))), "--fix", "-o", str(fixed)]) == 0
    trial = read_trial(fixed)
    assert len(trial) == len(frame)
    np.testing.assert_allclose(trial["x"], frame["x [m]"], atol=1e-3)
