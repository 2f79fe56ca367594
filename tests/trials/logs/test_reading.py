import hashlib

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.writing import write_trial
from shipid.trials.trial import Trial


def test_headers_with_units_need_no_format(log, table):
    path = log("# measured by hand\n# in calm water\n" + table)
    trial = read_trial(path)
    assert list(trial.table.columns) == ["t", "psi", "r", "delta"]
    assert trial.name == "log"
    assert trial["psi"][0] == pytest.approx(np.radians(10))
    assert trial["delta"][-1] == pytest.approx(np.radians(5))
    assert all(dtype == np.float64 for dtype in trial.table.dtypes)
    assert trial.source.comment == "measured by hand\nin calm water"
    assert trial.source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert not trial.source.simulated


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "   "])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_separator_is_detected(log, table, separator, end):
    trial = read_trial(log(table.replace(",", separator).replace("\n", end)))
    assert len(trial) == 20
    assert trial["psi"][-1] == pytest.approx(np.radians(10 + 0.3 * 19))


def test_decimal_comma_is_read_where_it_cannot_be_a_separator(log, table):
    trial = read_trial(log(table.replace(",", ";").replace(".", ",")))
    assert trial["t"][1] == 0.5
    assert any("decimal comma" in note for note in trial.source.notes)


def test_separator_at_the_end_of_every_row(log, table):
    header, *rows = table.splitlines()
    trial = read_trial(log("\n".join([header, *(row + "," for row in rows)])))
    assert trial.has("t", "psi", "r", "delta")


def test_header_as_a_comment_like_numpy_savetxt(log, table):
    assert len(read_trial(log("# " + table))) == 20


def test_byte_order_mark_and_cp1252(log, table):
    assert len(read_trial(log(b"\xef\xbb\xbf" + table.encode()))) == 20
    trial = read_trial(log(table.replace("[deg]", "[°]").encode("cp1252")))
    assert trial["psi"][0] == pytest.approx(np.radians(10))
    assert any("cp1252" in note for note in trial.source.notes)


def test_comments_and_blank_lines_between_samples_are_skipped(log, table):
    lines = table.splitlines()
    text = "\n".join([*lines[:5], "# the mate sneezed", "", *lines[5:], "", ""])
    assert len(read_trial(log(text))) == 20


def test_heading_is_unwrapped(log):
    psi = np.linspace(300, 700, 50)
    rows = "".join(f"{k},{p % 360:.6f}\n" for k, p in enumerate(psi))
    trial = read_trial(log("t [s],psi [deg]\n" + rows))
    np.testing.assert_allclose(np.degrees(trial["psi"]), psi, atol=1e-5)


def test_window_by_name_of_the_file_and_by_argument(log, table):
    path = log(table)
    trial = read_trial(f"{path}@2:6")
    assert trial.name == "log@2:6"
    assert trial["t"][0] == 2 and trial["t"][-1] == 6
    pd.testing.assert_frame_equal(trial.table, read_trial(path, window=(2, 6)).table)
    pd.testing.assert_frame_equal(trial.table, read_trial(path, window="2:6").table)
    assert read_trial(f"{path}@:6")["t"][0] == 0
    assert read_trial(f"{path}@6:")["t"][-1] == 9.5


def test_file_with_an_at_in_its_name(log, table):
    path = log(table, "run@2:6")
    assert len(read_trial(path)) == 20
    assert read_trial(f"{path}@2:4").name == "run@2:4"  # a file named like a window: its window replaces the name's
    mail = log(table, "me@home.csv")
    assert read_trial(mail).name == "me@home"
    assert read_trial(f"{mail}@2:6").name == "me@home@2:6"


def test_holes_outside_the_window_do_not_matter(log, table):
    broken = table.replace("\n0.5,10.3000", "\n0.5,nan")
    path = log(broken)
    assert len(read_trial(f"{path}@2:9")) == 15
    assert np.isnan(read_trial(path)["psi"][1])


def test_rows_without_a_time_outside_the_window_do_not_matter(log, table):
    path = log(table.replace("\n0.5,", "\n,"))
    assert len(read_trial(f"{path}@2:9")) == 15
    with pytest.raises(e.NonFiniteError):
        read_trial(path)


def test_other_columns_are_allowed_with_a_unit(log, table):
    header, *rows = table.splitlines()
    text = "\n".join([header + ",fuel [kg/h]", *(row + ",36" for row in rows)])
    trial = read_trial(log(text))
    assert trial["fuel"][0] == pytest.approx(0.01)
    assert trial.unit("fuel") == "kg/s"


def test_simulated_record_says_so(log, table):
    assert read_trial(log("# Simulated with Nomoto\n" + table)).source.simulated


class TestParquet:
    def frame(self):
        t = np.arange(30) * 0.5
        return pd.DataFrame({"t": t, "psi": 10 + 0.6 * t, "delta": np.where(t > 3, 5.0, 0.0)})

    def test_units_in_the_headers(self, tmp_path):
        pytest.importorskip("pyarrow")
        frame = self.frame().set_axis(["t [s]", "psi [deg]", "delta [deg]"], axis=1)
        frame.to_parquet(tmp_path / "log.parquet")
        assert read_trial(tmp_path / "log.parquet")["psi"][0] == pytest.approx(np.radians(10))

    def test_units_in_the_attributes(self, tmp_path):
        pytest.importorskip("pyarrow")
        frame = self.frame()
        frame.attrs["units"] = {"t": "s", "psi": "deg", "delta": "deg"}
        frame.to_parquet(tmp_path / "log.parquet")
        assert read_trial(tmp_path / "log.parquet")["delta"][-1] == pytest.approx(np.radians(5))

    def test_units_in_the_arrow_fields(self, tmp_path):
        pa = pytest.importorskip("pyarrow")
        import pyarrow.parquet as pq

        frame = self.frame()
        units = {"t": "s", "psi": "deg", "delta": "deg"}
        schema = pa.schema([pa.field(n, pa.float64(), metadata={"unit": u}) for n, u in units.items()])
        pq.write_table(pa.Table.from_pandas(frame, schema=schema, preserve_index=False), tmp_path / "log.parquet")
        assert read_trial(tmp_path / "log.parquet@2:8")["psi"][0] == pytest.approx(np.radians(11.2))

    def test_without_units_it_is_refused(self, tmp_path):
        pytest.importorskip("pyarrow")
        self.frame().to_parquet(tmp_path / "log.parquet")
        with pytest.raises(e.NoUnitError, match="'t'"):
            read_trial(tmp_path / "log.parquet")

    def test_text_and_rubbish_are_refused(self, tmp_path):
        pytest.importorskip("pyarrow")
        frame = self.frame().set_axis(["t [s]", "psi [deg]", "delta [deg]"], axis=1).astype({"psi [deg]": str})
        frame.to_parquet(tmp_path / "log.parquet")
        assert read_trial(tmp_path / "log.parquet").has("psi")  # numbers as text are numbers
        frame.loc[5, "psi [deg]"] = "north"
        frame.to_parquet(tmp_path / "log.parquet")
        with pytest.raises(e.TextInColumnError, match=r"row 5, column 'psi .deg.': 'north'"):
            read_trial(tmp_path / "log.parquet")
        (tmp_path / "bad.parquet").write_bytes(b"PAR1 not really")
        with pytest.raises(e.TrialError, match="not a readable Parquet"):
            read_trial(tmp_path / "bad.parquet")

    def test_round_trip(self, tmp_path, log, table):
        pytest.importorskip("pyarrow")
        trial = read_trial(log("# calm water\n" + table))
        back = read_trial(write_trial(trial, tmp_path / "out.parquet"))
        pd.testing.assert_frame_equal(back.table, trial.table)
        assert back.source.comment == "calm water"


def test_from_frame_takes_units_beside_the_headers():
    frame = TestParquet().frame()
    trial = Trial.from_frame(frame, name="made", units={"t": "s", "psi": "deg", "delta": "deg"}, ship="nobody")
    assert trial.ship == "nobody" and trial.name == "made"
    assert trial["psi"][0] == pytest.approx(np.radians(10))
    with pytest.raises(e.NoUnitError, match="'delta'"):
        Trial.from_frame(frame, units={"t": "s", "psi": "deg"})


def test_columns_that_are_named_otherwise_are_told(tmp_path):
    """A log of headers such as Heading is read, and its reader learns why no command finds a heading in it."""
    path = tmp_path / "log.csv"
    rows = "\n".join(f"{k},{k % 7},0.1,{k % 5},8" for k in range(30))
    path.write_text(f"t [s],Heading [deg],ROT [deg/min],Rudder [deg],Speed [kn]\n{rows}\n")
    (note,) = [n for n in read_trial(path).source.notes if n.startswith("WARNING")]
    assert "Heading and ROT and Rudder look like psi and r and delta" in note and "shipid format" in note
    path.write_text(f"t [s],Heading [deg],r [deg/min],delta [deg],psi [deg]\n{rows}\n")
    assert not any("look" in n for n in read_trial(path).source.notes)
