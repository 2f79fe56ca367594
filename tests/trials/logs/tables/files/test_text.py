"""Text tables as spreadsheets, loggers and laboratories write them."""

import numpy as np
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.reading import read_record, read_trial
from shipid.trials.logs.tables.files import text as reader

T, PSI, X = np.arange(40) * 0.5, 350.0346 + 0.1 * np.arange(40), 990.25 + 1.5 * np.arange(40)
HEADER = ("t [s]", "x [m]", "psi [deg]", "delta [deg]")


def written(row, header=HEADER, separator=","):
    """A log of 40 samples, each row formatted by a function of the sample."""
    return (
        "\n".join([separator.join(header), *(row(*sample) for sample in zip(T, X, PSI, np.where(T > 3, 5.5, 0.0)))])
        + "\n"
    )


def point(number, thousands=""):
    return f"{number:,.4f}".replace(",", thousands)


def comma(number, thousands=""):
    return f"{number:,.4f}".replace(",", "_").replace(".", ",").replace("_", thousands)


FORMS = {
    "bars": lambda: written(lambda *s: "|".join(map(point, s)), separator="|"),
    "the comment of LabVIEW": lambda: written(lambda *s: "\t".join(map(point, s)), (*HEADER, "Comment"), "\t"),
    "bars with blanks": lambda: written(lambda *s: " | ".join(map(point, s)), separator=" | "),
    "thousands point and decimal comma": lambda: written(lambda *s: ";".join(comma(n, ".") for n in s), separator=";"),
    "thousands comma in quotes": lambda: written(lambda *s: ",".join(f'"{point(n, ",")}"' for n in s)),
    "decimal comma in quotes": lambda: written(lambda *s: ",".join(f'"{comma(n)}"' for n in s)),
    "apostrophes": lambda: written(lambda *s: ",".join(point(n, "'") for n in s)),
    "narrow blanks": lambda: written(lambda *s: "\t".join(comma(n, "\u202f") for n in s), separator="\t"),
    "thousands comma between semicolons": lambda: written(lambda *s: ";".join(point(n, ",") for n in s), separator=";"),
    "decimal comma between blanks": lambda: written(
        lambda *s: " ".join(comma(n) for n in s), [h.replace(" ", "") for h in HEADER], "  "
    ),
    "exponents of Fortran": lambda: written(
        lambda *s: "".join(f"  {n:.10E}".replace("E", "D") for n in s), [h.replace(" ", "") for h in HEADER], " "
    ),
    "names of several words": lambda: written(
        lambda *s: "   ".join(point(n) for n in s), ["t [s]", "x [m]", "psi [deg]", "delta [deg]"], "   "
    ),
    "a row of units": lambda: "t,x,psi,delta\ns,m,deg,deg\n" + written(lambda *s: ",".join(map(point, s))).split("\n", 1)[1],
    "units in brackets and titles": lambda: (
        "MV Alpha;;;\nDate;2026-05-01;;\n\nClock;GNSS;Gyro;Rudder\nt;x;psi;delta\n[s];[m];[deg];[deg]\n"
        + written(lambda *s: ";".join(map(point, s))).split("\n", 1)[1]
    ),
    "a header in quotes over two lines": lambda: written(
        lambda *s: ",".join(map(point, s)), ['"t\n[s]"', '"x [m]"', '"psi\n[deg]"', "delta [deg]"]
    ),
    "a header of which every field runs over two lines": lambda: written(
        lambda *s: ",".join(map(point, s)), ['"t\n[s]"', '"x\n[m]"', '"psi\n[deg]"', '"delta\n[deg]"']
    ),
    "row names of R": lambda: (
        ",".join(f'"{h}"' for h in HEADER)
        + "\n"
        + "\n".join(f'"{k + 1}",{point(t)},{point(x)},{point(psi)},{5.5 if t > 3 else 0.0}' for k, (t, x, psi) in enumerate(zip(T, X, PSI)))
        + "\n"
    ),
    "names that end in a unit": lambda: written(
        lambda *s: ",".join(map(point, s)), ["t_s", "x_m", "psi_deg", "delta_deg"]
    ),
    "names and units in comments": lambda: (
        "# run 3\n# t x psi delta\n# s m deg deg\n" + written(lambda *s: " ".join(map(point, s))).split("\n", 1)[1]
    ),
    "comments of MATLAB": lambda: "% run 3\n% t [s], x [m], psi [deg], delta [deg]\n" + written(
        lambda *s: " ".join(map(point, s)) + ("\n% a remark" if s[0] == 3 else "")
    ).split("\n", 1)[1],
    "a header with commas over blanks": lambda: written(lambda *s: " ".join(map(point, s)), separator=", "),
    "UTF-16": lambda: written(lambda *s: ",".join(map(point, s))).encode("utf-16"),
    "UTF-16 without a mark": lambda: written(lambda *s: ",".join(map(point, s))).encode("utf-16-le"),
    "UTF-16, the other way round": lambda: written(lambda *s: ",".join(map(point, s))).encode("utf-16-be"),
    "a mark of UTF-8": lambda: b"\xef\xbb\xbf" + written(lambda *s: ",".join(map(point, s))).encode(),
    "cp1252": lambda: written(lambda *s: ",".join(map(point, s))).replace("[deg]", "[°]").encode("cp1252"),
    "ends of lines of the old Macintosh": lambda: written(lambda *s: ",".join(map(point, s))).replace("\n", "\r"),
    "zeros behind the last row": lambda: written(lambda *s: ",".join(map(point, s))).encode() + bytes(4096),
    "separators behind some rows": lambda: written(lambda *s: ",".join(map(point, s)) + (",," if s[0] == 5 else "")),
    "texts beside": lambda: written(
        lambda *s: ",".join(map(point, s)) + (',"steady, more or less"' if s[0] < 3 else ","), [*HEADER, "remark"]
    ),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_numbers(log, form):
    trial = read_trial(log(FORMS[form]()))
    assert len(trial) == 40 and not np.isnan(trial.table.to_numpy()).any()
    np.testing.assert_allclose(trial["t"], T, atol=1e-12)
    np.testing.assert_allclose(trial["x"], X, atol=1e-9)
    np.testing.assert_allclose(np.degrees(trial["psi"]), PSI, atol=1e-9)
    np.testing.assert_allclose(np.degrees(trial["delta"]), np.where(T > 3, 5.5, 0), atol=1e-12)


def test_what_was_found_out_is_noted(log):
    notes = read_trial(log(FORMS["units in brackets and titles"]())).source.notes
    assert "Lines 1, 2, 4 above the samples were not used: 'MV Alpha;;;'." in notes
    assert (
        "The numbers are written with a decimal comma."
        in read_trial(log(FORMS["decimal comma in quotes"]())).source.notes
    )
    assert "Columns of text were left out: 'remark'." in read_trial(log(FORMS["texts beside"]())).source.notes
    assert "The text is UTF-16." in read_trial(log(FORMS["UTF-16"]())).source.notes


def test_numbers_that_can_be_read_in_two_ways_are_refused_unless_the_format_file_decides(log, tmp_path):
    path = log("t [s];n [rpm]\n" + "".join(f"{k};1,{200 + k}\n" for k in range(20)))
    with pytest.raises(e.AmbiguousNumberError, match=r"'n \[rpm\]': '1,200' can be 1200 or 1.200"):
        read_trial(path)
    fmt = tmp_path / "f.toml"
    for decimal, n in (("comma", 1.2), ("point", 1200.0)):
        fmt.write_text(f"decimal = '{decimal}'\n[columns.t]\ncolumn = 't'\n[columns.n]\ncolumn = 'n'\n")
        assert read_trial(path, fmt)["n"][0] == pytest.approx(n / 60)


def test_three_decimals_are_decimals_where_something_tells(log):
    trial = read_trial(log("t [s],x [m]\n" + "".join(f"{k}.000,{998 + k}.500\n" for k in range(20))))
    assert trial["x"][2] == 1000.5
    with pytest.raises(e.AmbiguousNumberError, match=r"'1\.000' can be 1000 or 1\.000"):
        read_trial(
            log("t [s];x [m]\n" + "".join(f"{k};{990 + k if k < 10 else f'1.{k - 10:03d}'}\n" for k in range(20)))
        )


@pytest.mark.parametrize("cell", ["eleven", "0x1f", "1_000", "１２", "12:30", "1.2.3", '"1,5"', "#####", "True"])
def test_a_cell_that_is_no_number_is_told(log, table, cell):
    lines = table.splitlines()
    lines[5] = lines[5].replace(",0.6,", f",{cell},")
    lines[7] = lines[7].replace(",0.6,", ",x,")
    path = log("\n".join(lines))
    with pytest.raises(e.TextInColumnError, match=r"line 6, column 'r \[deg/s\]': .* is not a number.* 1 more cells"):
        read_trial(path)
    record = read_record(path)
    assert np.flatnonzero(np.isnan(record.values["r"])).tolist() == [4, 6] and len(record) == 20


@pytest.mark.parametrize(
    "mark", ["-", "--", "N/A", "#N/A", "null", "None", "nan", "NaN", "#DIV/0!", '""', "1e400", "-inf"]
)
def test_marks_of_a_missing_sample(log, table, mark):
    trial = read_trial(log(table.replace("2.0,11.2000,0.6,", f"2.0,11.2000,{mark},")))
    assert np.flatnonzero(np.isnan(trial["r"])).tolist() == [4]
    assert np.isfinite(trial["delta"]).all(), "what stands behind the mark is kept"
    assert "r: 1 of 20 samples are missing." in trial.source.notes


def test_garbled_lines_are_left_out_and_counted(log, table):
    trial = read_trial(log(table.replace("2.0,11.2", "2.0,1\x001.2").replace("\n6.0,", "\n6.\x1b0,")))
    assert len(trial) == 18 and 2.0 not in trial["t"] and 6.0 not in trial["t"]
    assert "2 lines hold control characters and were left out: line 6, 14." in trial.source.notes
    with pytest.raises(
        e.TrialError, match=r"is no text: 20 of 21 lines hold control characters, the first is line 2|binary file"
    ):
        read_trial(log(table.replace(",0.6,", ",0\x016,")))


def test_a_stray_quote_swallows_no_rows(log, table):
    text = table.replace("\n2.0,11.2000", '\n2.0,"11.2000').replace("\n7.0,", '\n7.0",')
    with pytest.raises(e.RaggedRowError, match="line 6: a quote is opened or closed alone"):
        read_trial(log(text))


def test_a_remark_in_quotes_over_two_lines_is_one_field(log, table):
    lines = table.rstrip("\n").split("\n")
    lines = [lines[0] + ",remark", *(f'{line},""' for line in lines[1:])]
    lines[4] = lines[4][:-1] + 'rudder ""hard""\nto starboard"'
    trial = read_trial(log("\n".join(lines) + "\n"))
    assert len(trial) == len(lines) - 1
    lines[6] += "x"  # what is no number is named by its line in the file, that of the remark counted
    bad = lines[6].split(",")
    bad[1] = "abc"
    lines[6] = ",".join(bad)
    assert any("line 8," in str(fault) for fault in read_record(log("\n".join(lines) + "\n")).faults)


def test_names_without_units_and_samples_of_nothing(log, table):
    with pytest.raises(e.NoUnitError, match="'spare'"):
        read_trial(log(table.replace("r [deg/s]", "spare")))
    text = "\n".join(line + ("," if k else ",spare") for k, line in enumerate(table.splitlines()))
    assert "Columns without a sample were left out: 'spare'." in read_trial(log(text)).source.notes


def test_lines_and_columns_are_bounded(log, monkeypatch):
    with pytest.raises(e.SeparatorError, match=r"line 2 has 1500000 characters, and at most 1000000"):
        read_trial(log("t [s],psi [deg]\n" + "1" * 1_500_000 + "\n"))
    wide = ",".join(f"c{k}" for k in range(10_001)) + "\n" + 3 * (",".join(["1"] * 10_001) + "\n")
    with pytest.raises(e.SeparatorError, match="has 10001 columns, and at most 10000 are read"):
        read_trial(log(wide))
    monkeypatch.setattr(reader, "LONGEST_LINE", 20)
    with pytest.raises(e.SeparatorError, match="line 1 has 27 characters, and at most 20"):
        read_trial(log("t [s],psi [deg],delta [deg]\n1,2,3\n"))


def test_the_header_line_that_holds_the_names_of_the_format_file(log, tmp_path):
    fmt = tmp_path / "f.toml"
    fmt.write_text(
        "header_lines = 3\n[columns.t]\ncolumn = 'Time'\nunit = 's'\n[columns.psi]\ncolumn = 'Gyro'\nunit = 'deg'\n"
    )
    text = "Run 3,,\nTime,Gyro,Ruder\ns,deg,deg\n" + "".join(f"{k},{k},5\n" for k in range(12))
    assert read_trial(log(text), fmt)["psi"][3] == pytest.approx(np.radians(3))


def test_a_hole_between_blanks_is_refused(log, table):
    """The fields behind the hole would move to the left: a rate of turn would be read as a heading."""
    text = table.replace(",", "  ").replace("t [s]", "t[s]").replace("2.0  11.2000  0.6", "2.0    0.6")
    with pytest.raises(
        e.RaggedRowError, match=r"line 6: the row has fewer fields than the 4 .* nothing tells which one is missing"
    ):
        read_trial(log(text))
    assert np.isnan(read_trial(log(table.replace(",", "  ").rstrip()[:-3]))["delta"][-1])


def test_a_line_that_is_one_field_of_a_hundred_thousand_signs_by_another_separator(tmp_path):
    """120 000 columns with commas are one field with semicolons; csv refuses that one with an error of its own."""
    path = tmp_path / "wide.csv"
    names = ",".join(["t [s]", "psi [deg]", *(f"c{k}" for k in range(120_000))])
    path.write_text(names + "\n" + "\n".join(f"{k},0" + "," * 120_000 for k in range(3)) + "\n")
    with pytest.raises(e.TrialError):
        read_trial(path)
