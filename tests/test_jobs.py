"""The jobs of users, from their files to their answers: each script of ``studies/`` ends with every row held.

The two that take longest, `job_own_model.py` and `job_live_nmea.py`, are run beside the tests, by ``.ci/run``.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).resolve().parents[1] / "studies"


@pytest.mark.parametrize(
    ("script", "options", "rows"), [("job_odd_log.py", ["--short"], 10), ("job_notebook.py", [], 15)]
)
def test_a_job_is_done(script, options, rows, tmp_path):
    done = subprocess.run(
        [sys.executable, STUDIES / script, "--json", *options], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout)
    assert len(found) == rows and all(row["holds"] for row in found)
    assert list(tmp_path.iterdir()) == []
