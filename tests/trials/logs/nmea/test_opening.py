"""What a file is, by its lines: an NMEA log needs no option, and a table is none."""

import bz2
import gzip
import io
import zipfile

import numpy as np
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.nmea.errors import NotNmeaError
from shipid.trials.logs.nmea.opening import is_nmea
from shipid.trials.logs.reading import read_trial


def test_a_log_of_sentences_needs_no_option(log, stamped, basic):
    path = log(stamped(*basic), "log.txt")
    trial = read_trial(path)
    assert trial.source.format == "nmea" and np.isfinite(trial["psi"]).sum() == 101
    assert np.isfinite(read_trial(f"{path}@5:10")["psi"]).sum() == 26


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le"])
def test_in_other_encodings(log, stamped, basic, encoding):
    assert is_nmea(log(stamped(*basic).encode(encoding)))


def test_behind_a_head_and_among_garbage(log, stamped, basic):
    lines = stamped(*basic, comment="").splitlines()
    mixed = [text for line in lines for text in (line, "\x00\x01 garbage")][:-10]
    assert is_nmea(log("Logger 3.1\nport COM1\n" + "\n".join(lines[:40])))
    assert is_nmea(log("\n".join(mixed + lines)))
    assert not is_nmea(log("\n".join(mixed) + "\ngarbage" * 20))


@pytest.mark.parametrize(
    "text",
    [
        "t [s],psi [deg],price\n0,1,$100\n1,2,$200\n2,3,$300\n3,4,$HDTV\n",
        "time;cost\n0;$HEHDT\n1;$IIRSA\n2;$GPGGA\n3;!AIVDM\n",
        "$HEHDT,1.0,T*00\n" * 20,  # no checksum is right
        "# $HEHDT,123.4,T\n" * 20,
        "",
    ],
)
def test_what_is_none(log, text):
    assert not is_nmea(log(text))


def test_a_table_stays_a_table(log, table):
    path = log(table)
    assert not is_nmea(path) and read_trial(path).source.format is None


def test_a_file_of_zeros_and_one_long_line(log):
    assert not is_nmea(log(bytes(100_000)))
    assert not is_nmea(log("$HEHDT," * 100_000))
    with pytest.raises(e.TrialError):
        read_trial(log("$HEHDT," * 100_000), format="nmea")


def zipped(data):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("log.nmea", data)
    return buffer.getvalue()


@pytest.mark.parametrize("compress", [gzip.compress, bz2.compress, zipped])
def test_compressed(log, stamped, basic, compress):
    text = stamped(*basic).encode()
    trial = read_trial(log(compress(text), "log.nmea.gz"))
    assert np.isfinite(trial["psi"]).sum() == 101
    with pytest.raises(e.ForeignFileError, match=r"damaged|cannot be opened"):
        read_trial(log(compress(text)[:-30], "cut.nmea.gz"))


def test_a_log_that_lost_all_its_line_ends(log, sentence):
    """It is longer than a piece in which lines are read, and no sentence is lost where pieces meet."""
    text = "".join(
        f"2026-05-04T09:{k // 60:02d}:{k % 60:02d}.000Z " + sentence(f"HEHDT,{k % 360:.1f},T") for k in range(3000)
    )
    trial = read_trial(log(text, "log.nmea"))
    assert len(trial) == 3000
    assert not any("broken" in note for note in trial.source.notes)


@pytest.mark.parametrize(
    ("spoilt", "fault"),
    [
        (lambda s: s[:-2] + "00", "their checksums are wrong or cut short"),
        (lambda s: s[:-1], "their checksums are wrong or cut short"),
        (lambda s: s[1:], "no line has the sign $ in front of it"),
    ],
)
def test_what_looks_like_sentences_and_is_none_is_named(log, sentence, spoilt, fault):
    text = "".join(spoilt(sentence(f"HEHDT,{100.5 + k},T")) + "\r\n" for k in range(50))
    with pytest.raises(NotNmeaError) as found:
        read_trial(log(text, "log.txt"))
    assert "look like NMEA 0183 sentences ('" in str(found.value) and fault in str(found.value)
