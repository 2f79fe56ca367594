from __future__ import annotations

import numpy as np
import pandas as pd
import pytest


@pytest.fixture
def sample() -> pd.DataFrame:
    """Forty samples, in the units of `UNITS`."""
    t = np.arange(40) * 0.5
    return pd.DataFrame({"t": t, "psi": 10 + 0.3 * t, "r": 0.3 + 0.001 * t, "delta": np.where(t > 3, 5.5, 0.0)})


@pytest.fixture
def units() -> dict[str, str]:
    return {"t": "s", "psi": "deg", "r": "deg/s", "delta": "deg"}


@pytest.fixture
def same(sample):
    """Whether a trial is the record."""

    def check(trial):
        for name, factor in (("t", 1), ("psi", np.pi / 180), ("r", np.pi / 180), ("delta", np.pi / 180)):
            np.testing.assert_allclose(trial[name], sample[name] * factor, rtol=1e-6, atol=1e-12, err_msg=name)
        return True

    return check


@pytest.fixture
def bare(tmp_path):
    """A format file that states units by name, and whatever else."""

    def write(more: str = "", names=("t", "psi", "r", "delta")):
        units = {"t": "s", "psi": "deg", "r": "deg/s", "delta": "deg"}
        columns = "".join(f'[columns.{n}]\ncolumn = "{n}"\nunit = "{units[n]}"\n' for n in names)
        path = tmp_path / "format.toml"
        path.write_text(columns + more)
        return path

    return write
