"""Symmetric matrices and their packed triangles."""

from __future__ import annotations

import numpy as np

from shipid.estimation.records.triangles import deviations_of, packed_of, unpacked


def test_columns_of_the_upper_triangle_stand_one_after_the_other() -> None:
    full = np.array([[1.0, 2.0, 4.0], [2.0, 9.0, 5.0], [4.0, 5.0, 16.0]])
    assert packed_of(full).tolist() == [1.0, 2.0, 9.0, 4.0, 5.0, 16.0]
    assert unpacked(packed_of(full[None]), 3).tolist() == [full.tolist()]
    assert deviations_of(packed_of(full), 3).tolist() == [1.0, 3.0, 4.0]
