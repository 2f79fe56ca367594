"""Units in the cells: ``12.3 deg``, ``12.3°``."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.errors import TrialError
from shipid.trials.logs.tables.cell_units import unit_of_cell


def log(tmp_path, columns, separator=","):
    """A log of 40 samples: header, format of its cells, and values by column."""
    t = np.arange(40.0)
    values = {"t": t, "psi": 10 * np.sin(t / 8), "r": 1.25 * np.cos(t / 8), "delta": np.where(t % 20 < 10, 5.0, -5.0)}
    lines = [separator.join(header for header, _ in columns)]
    lines += [separator.join(cell % v[k] for (_, cell), v in zip(columns, values.values())) for k in range(40)]
    file = tmp_path / "log.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file, values


@pytest.mark.parametrize(
    ("columns", "separator"),
    [
        ((("t", "%.1f s"), ("psi", "%.3f deg"), ("r", "%.3f deg/s"), ("delta", "%.1f deg")), ","),
        ((("t", "%.1fs"), ("psi", "%.3f°"), ("r", "%.3f°/s"), ("delta", "%.1f [deg]")), "\t"),
        ((("t [s]", "%.1f"), ("psi [deg]", "%.3f°"), ("r [deg/s]", "%.3f"), ("delta [°]", "%.1f deg")), ";"),
    ],
)
def test_units_of_the_cells_are_those_of_the_column(tmp_path, columns, separator):
    file, values = log(tmp_path, columns, separator)
    trial = shipid.read_trial(file)
    for name in ("psi", "r", "delta"):
        assert np.allclose(trial[name], np.deg2rad(values[name]), atol=1e-5), name
    assert any("each cell says the unit" in str(note) for note in trial.source.notes)


def test_a_decimal_comma_beside_a_unit(tmp_path):
    file, values = log(
        tmp_path, (("t", "%.1f s"), ("psi", "%.3f deg"), ("r", "%.3f deg/s"), ("delta", "%.1f deg")), ";"
    )
    file.write_text(file.read_text().replace(".", ","))
    assert np.allclose(shipid.read_trial(file)["psi"], np.deg2rad(values["psi"]), atol=1e-5)


def test_units_that_do_not_agree_are_named(tmp_path):
    file, _ = log(
        tmp_path, (("t [s]", "%.1f"), ("psi [rad]", "%.3f deg"), ("r [deg/s]", "%.3f"), ("delta [deg]", "%.1f"))
    )
    with pytest.raises(
        TrialError, match=r"line 2, column 'psi \[rad\]': the cell says the unit deg, and the column rad"
    ):
        shipid.read_trial(file)
    file, _ = log(tmp_path, (("t [s]", "%.1f"), ("psi", "%.3f deg"), ("r [deg/s]", "%.3f"), ("delta [deg]", "%.1f")))
    lines = file.read_text().splitlines()
    lines[20] = lines[20].replace(" deg", " rad")
    file.write_text("\n".join(lines))
    with pytest.raises(TrialError, match="line 21, column 'psi': the cell says the unit rad, and cells above it deg"):
        shipid.read_trial(file)


@pytest.mark.parametrize(
    "cell", ["12 P", "5 S", "52.0°N", "45° N", "10 PM", "10:30 AM", "5 foo", "Ship 5 m", "12 T", "90 M", "30.5'N", "12"]
)
def test_what_is_no_unit(cell):
    assert unit_of_cell(cell) is None


def test_units_behind_numbers_between_blanks_are_refused_with_what_to_do(tmp_path):
    file, _ = log(tmp_path, (("t", "%.1f"), ("psi", "%.3f deg"), ("r", "%.3f deg/s"), ("delta", "%.1f deg")), " ")
    words = r"names 4 columns .* \(line 2\) has 7. Units stand behind the numbers, as in '.* deg', .* write the units in the header"
    with pytest.raises(TrialError, match=words):
        shipid.read_trial(file)
