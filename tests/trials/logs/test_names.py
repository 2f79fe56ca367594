"""What loggers call a column, and which unit its name says."""

from __future__ import annotations

import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.logs.drafting.draft import draft_format
from shipid.trials.logs.drafting.names import meaning_of


@pytest.mark.parametrize(
    ("header", "field", "unit"),
    [
        ("Drehrate °/min", "r", "°/min"),
        ("Rate of turn deg/s", "r", "deg/s"),
        ("Ruderlage °", "delta", "°"),
        ("FdW kn", "u", "kn"),
    ],
)
def test_a_unit_stands_behind_a_name_without_brackets(header, field, unit):
    meaning = meaning_of(header)
    assert meaning.fields[0] == field and meaning.unit == unit


def test_check_and_draft_read_one_unit_out_of_a_name(tmp_path):
    """And what no unit is, as in Kurs (Kreisel), is not proposed as one."""
    log = tmp_path / "log.csv"
    rows = "".join(f"{k};{k / 10};{k / 7};{k % 3};15.0\n" for k in range(60))
    log.write_text("t [s];Kurs (Kreisel);Drehrate °/min;Ruderlage;FdW kn\n" + rows, encoding="utf-8")
    told = [f for f in check_trial(log).findings if f.kind == "unit"]
    assert [f.channels for f in told] == [("Kurs",), ("delta",)] and told[0].fix is None
    draft = draft_format(log)
    assert 'unit = "°/min"' in draft.text and 'unit = "kn"' in draft.text and 'Kreisel"' not in draft.text
