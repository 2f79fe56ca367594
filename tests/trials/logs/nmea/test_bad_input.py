"""Every message once: the class, and that its one paragraph says where and what to do."""

import numpy as np
import pytest

from shipid.cli import run
from shipid.foundation.errors import MissingFileError
from shipid.trials import errors as e
from shipid.trials.logs.nmea import errors as n
from shipid.trials.logs.reading import read_trial


def refused(error, path, *words, fmt="nmea"):
    with pytest.raises(error) as caught:
        read_trial(path, format=fmt)
    message = str(caught.value)
    assert "\n" not in message and message.endswith((".", "?")), message
    for word in words:
        assert word in message, message
    assert caught.value.exit_code == 3


def test_empty_files(log):
    refused(e.EmptyFileError, log(b""), "0 bytes")
    refused(e.EmptyFileError, log("# only\n\n# comments\n"), "no sentences", "3 empty or comment lines")


def test_not_nmea(log, table):
    refused(n.NotNmeaError, log(table), "not an NMEA log", "21 lines", "--format nmea")


def test_binary(log):
    refused(n.NotNmeaError, log(bytes(range(256)) * 20), "not an NMEA log", "holds a sentence such as")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_utf16(log, stamped, basic, toml, encoding):
    path = log(stamped(*basic).encode(encoding))
    trial = read_trial(path, format="nmea")
    assert len(trial) > 90 and "The file is text in UTF-16, and was read as such." in trial.source.notes
    assert len(read_trial(path, format=toml(f'encoding = "{encoding}"\n[nmea]\n'))) == len(trial)


def test_wrong_encoding_stated(log, stamped, basic, toml):
    path = log(stamped(*basic))
    refused(n.NotNmeaError, path, "utf-16", "Correct the encoding", fmt=toml('encoding = "utf-16"\n[nmea]\n'))


def test_mostly_broken(log, stamped, basic):
    lines = stamped(*basic).splitlines()
    text = "\n".join(line[:-2] + "00" if k % 3 else line for k, line in enumerate(lines))
    refused(n.BrokenLogError, log(text + "\n"), "have a wrong checksum", "in lines 2, 3, 5", "baud rate")
    text = "\n".join(line[:-8] if k % 3 else line for k, line in enumerate(lines))
    refused(n.BrokenLogError, log(text + "\n"), "lines are broken")


def test_nothing_that_is_read(log, stamped):
    refused(n.NoSignalError, log(stamped(("GPGSV,1,1,00", 1))), "nothing that is read", "GPGSV (21)")
    refused(n.NoSignalError, log(stamped(("IIRSA,1.0,V,,V", 2))), "two valid values", "IIRSA (41)")


def test_rudder_that_is_not_sent(log, stamped, basic, toml):
    refused(n.NoRudderError, log(stamped(*basic)), "asks for port of RSA", fmt=toml('[nmea.rudder]\nuse = "port"\n'))


def test_rsa_that_cannot_be_degrees(log, stamped, basic, toml):
    path = log(stamped(basic[0], (lambda t: f"IIRSA,{200 if t > 9.9 else 0},A,,V", 2)))
    refused(n.CalibrationError, path, "line 73", "200", "not in degrees", "scale = '0.1 deg'")
    trial = read_trial(path, format=toml('[nmea.rudder]\nscale = "0.1 deg"\n'))
    assert np.degrees(np.nanmax(trial["delta"])) == pytest.approx(20)
    fmt = toml('[nmea.rudder]\nscale = "0.5 deg"\n')
    refused(n.CalibrationError, path, "goes to 100 deg", "Correct the scale", "200", fmt=fmt)


def test_rsa_that_is_much_for_degrees(log, stamped, basic):
    trial = read_trial(log(stamped(basic[0], (lambda t: f"IIRSA,{80 if t > 9.9 else 0},A,,V", 2))), format="nmea")
    assert any(note.startswith("WARNING: RSA goes to 80") for note in trial.source.notes)


def test_rot_in_degrees_a_second(log, stamped, toml):
    def psi(t):
        return 10 * np.sin(t / 4)

    text = stamped(
        (lambda t: f"HEHDT,{psi(t) % 360:.2f},T", 5),
        (lambda t: f"HEROT,{2.5 * np.cos(t / 4):.3f},A", 5),
        (lambda t: "IIRSA,10.0,A,,V", 2),
        seconds=60,
    )
    path = log(text)
    refused(n.CalibrationError, path, "60 times as fast as r says", "unit = 'deg/s'", "[nmea.rate]")
    trial = read_trial(path, format=toml('[nmea.rate]\nunit = "deg/s"\n'))
    assert np.degrees(trial["r"][0]) == pytest.approx(2.5)


def test_heading_and_rudder_that_do_not_meet(log, stamped, basic, toml):
    text = stamped(
        (lambda t: "HEHDT,1.0,T" if t < 10 else "GPXXX,1", 5), (lambda t: "IIRSA,1.0,A,,V" if t > 12 else "GPXXX,1", 2)
    )
    trial = read_trial(log(text), format="nmea")
    assert np.nanmax(trial["t"][np.isfinite(trial["psi"])]) < np.nanmin(trial["t"][np.isfinite(trial["delta"])])
    fmt = toml('[nmea]\ninterval = "0.2 s"\n')
    refused(
        n.NoOverlapError, log(text), "psi and delta are nowhere known together", "psi from 0 to", "Leave out", fmt=fmt
    )


def test_a_source_that_is_not_there(log, stamped, basic, toml):
    refused(
        n.NoSuchSourceError,
        log(stamped(*basic)),
        "no sentence GPHDT",
        "HEHDT (101)",
        fmt=toml('[nmea.sources]\npsi = "GPHDT"\n'),
    )


def test_too_short(log, stamped, basic):
    refused(e.TooShortError, log(stamped(*basic, seconds=1)), "7 samples")


def test_the_last_line_is_cut(log, stamped, basic):
    text = stamped(*basic)
    trial = read_trial(log(text.rstrip()[:-6]), format="nmea")
    assert any(note.startswith("The last line (143) is cut off") for note in trial.source.notes)
    whole = read_trial(log(text.rstrip()), format="nmea")  # only its end is missing
    assert not any("cut off" in note for note in whole.source.notes)


def test_without_checksums(log, stamped, basic):
    text = "\n".join(line.partition("*")[0] for line in stamped(*basic).splitlines())
    trial = read_trial(log(text + "\n"), format="nmea")
    assert any(note.startswith("WARNING: no sentence has a checksum") for note in trial.source.notes)
    cut = read_trial(log(text[:-4]), format="nmea")  # nothing else tells that it was cut
    assert any("is cut off" in note for note in cut.source.notes)


def test_bad_lines_are_counted_and_named(log, stamped, basic):
    lines = stamped(*basic).splitlines()
    lines[10] = lines[10][:-2] + "00"
    lines[20] = lines[20].partition(",")[0]
    lines[30] = "the mate sneezed"
    lines[40] = lines[40][:40] + lines[41]  # a lost line end
    lines[41] = ""
    lines[50] += "  "
    trial = read_trial(log("\r\n".join(lines) + "\r\n"), format="nmea")
    notes = trial.source.notes
    assert any(note == "1 line was left out for a wrong checksum: 11." for note in notes), notes
    assert any(note.startswith("3 lines were left out as broken") and note.endswith(": 21, 31, 41.") for note in notes)


def test_fields_that_are_no_numbers(log, stamped, basic, sentence):
    text = (
        stamped(*basic)
        + "2026-05-04T09:00:21Z "
        + sentence("HEHDT,abc,T")
        + "\n2026-05-04T09:00:22Z "
        + sentence("HEHDT,nan,T")
        + "\n"
    )
    trial = read_trial(log(text), format="nmea")
    assert any("as broken" in note and note.endswith(": 144.") for note in trial.source.notes)
    assert np.isfinite(trial["psi"]).sum() == 101


def test_the_command_line_refuses_with_3(log, stamped, basic, capsys):
    assert run(["measure", str(log(stamped(("GPGSV,1,1,00", 1)), "a.nmea")), "--format", "nmea"]) == 3
    said = capsys.readouterr().err
    assert "nothing that is read" in " ".join(said.split()) and "Traceback" not in said


def test_a_log_without_a_rudder_is_refused_by_what_needs_one(log, stamped, basic, capsys):
    assert run(["measure", str(log(stamped(basic[0]), "a.nmea")), "--format", "nmea"]) == 3
    assert "has no rudder angle" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("nmea = 3", "'nmea' is 3"),
        ("[nmea]\nspede = 1", "no entry 'spede'"),
        ("separator = 'tab'\n[nmea]", "no entry 'separator'"),
        ("[nmea]\nstamp = 'noon'", "no directive for the hour"),
        ("[nmea]\nstamp = '%H:%q'", "directive %q"),
        ("[nmea]\ndate = '2026-05-04'", "without quotes"),
        ("[nmea]\ninterval = 0.2", "bare number"),
        ("[nmea]\ngap = '-3 s'", "greater than zero"),
        ("[nmea]\nspeed = 'air'", "water, ground"),
        ("[nmea]\nleave_out = 'r'", "has to be a list"),
        ("[nmea]\nleave_out = [1]", "list of names"),
        ("[nmea]\nleave_out = ['q']", "'leave_out' names 'q'"),
        ("[nmea]\nrudder = 1", "table [nmea.rudder]"),
        ("[nmea.rudder]\nuse = 'left'", "starboard, port, mean"),
        ("[nmea.rudder]\nscale = 0.5", "bare number"),
        ("[nmea.rudder]\noffset = true", "Write '1.0 rad'"),
        ("[nmea.rudder]\nsign = 2", "1 or -1"),
        ("[nmea.heading]\nvariation = '2 m'", "rad"),
        ("[nmea.heading]\nreference = 'grid'", "true, magnetic"),
        ("[nmea.rate]\nunit = 'kn'", "[nmea.rate]: 'unit'"),
        ("[nmea.antenna]\nz = '2 m'", "no entry 'z'"),
        ("[nmea.sources]\npsi = 'GPGGA'", "THS, HDT, HDG, HDM, VHW"),
        ("[nmea.sources]\npsi = 3", "has to be text"),
    ],
)
def test_format_files(toml, log, stamped, basic, text, words):
    refused(e.FormatFileError, log(stamped(*basic)), words, fmt=toml(text + "\n"))


def test_a_format_that_is_not_there(log, stamped, basic, tmp_path):
    refused(MissingFileError, log(stamped(*basic)), "no trial format file", fmt=tmp_path / "no.toml")


@pytest.mark.parametrize("upper_checksum", [False, True])
def test_sentences_in_small_letters_are_read(log, upper_checksum, sentence, stamped, basic):
    text = stamped(*basic)
    small = []
    for line in text.splitlines(keepends=True):
        front, dollar, rest = line.partition("$")
        body, star, summed = rest.partition("*")
        if not upper_checksum and star:
            summed = sentence(body.lower()).partition("*")[2] + "\n"
        small.append(front + dollar + body.lower() + star + summed)
    read, wanted = read_trial(log("".join(small), "small.nmea")), read_trial(log(text, "capitals.nmea"))
    assert read.table.equals(wanted.table)


def test_small_letters_with_a_wrong_checksum_are_left_out_and_told(log, stamped, basic):
    trial = read_trial(log(stamped(*basic) + "$hehdt,123.4,t*00\n", "t.nmea"))
    assert any("wrong checksum" in note for note in trial.source.notes)
    assert np.nanmin(np.degrees(trial["psi"])) > 300


@pytest.mark.parametrize("text", ["99.99", "-99.99", "999.9", "99.9"])
def test_a_speed_of_nines_is_missing(log, stamped, basic, text):
    def vbw(t):
        return f"VDVBW,{text if round(t) % 2 else 8.0},0.1,A,7.5,{text},A"

    trial = read_trial(log(stamped(*basic, (vbw, 1)), "trial.nmea"))
    assert np.nanmax(trial["u"]) == np.nanmin(trial["u"]) == pytest.approx(8 * 1852 / 3600)
    assert not any("devices" in note for note in trial.source.notes)
