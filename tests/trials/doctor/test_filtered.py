from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.doctor.examinations.steering.filtered import squares, squares_of_each


@pytest.mark.parametrize("scale", [1.0, 1e-150])
def test_many_models_at_once_leave_what_each_leaves_alone(scale):
    rng = np.random.default_rng(0)
    design = scale * rng.standard_normal((200, 3))
    columns = np.column_stack([rng.standard_normal((200, 4)), design[:, 0] * 2, np.zeros(200)])
    target = scale * (design[:, 1] / scale - 2 * columns[:, 1] + 0.1 * rng.standard_normal(200))
    alone = [squares(np.column_stack([column, design]), target) for column in columns.T]
    assert squares_of_each(columns, design, target) == pytest.approx(alone, rel=2e-2)
    assert squares_of_each(columns[:, :4], design, target) == pytest.approx(alone[:4], rel=1e-9)
