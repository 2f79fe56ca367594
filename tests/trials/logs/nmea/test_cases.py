"""One zig-zag as loggers keep it, and what goes wrong with such logs: what is read is the log that was sound."""

import numpy as np
import pytest

import shipid
from shipid.cli import run
from shipid.trials.logs.reading import read_trial


@pytest.fixture(scope="module")
def sailed():
    """A 20/20 zig-zag of a first-order Nomoto ship: K 0.08 1/s, T 12 s, 8 m/s, 3 deg/s of rudder; once a second."""
    dt, psi, r, delta, x, y, order, side = 0.01, 350.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1
    rows = []
    for k in range(24001):
        t = k * dt
        if k % 100 == 0:
            rows.append((t, psi, delta, x, y))
        if t >= 10 and (order == 0 or side * (psi - 350) >= 20):
            side = side if order == 0 else -side
            order = 20.0 * side
        delta += np.clip(order - delta, -3 * dt, 3 * dt)
        r += dt * (0.08 * delta - r) / 12
        psi += dt * r
        x += dt * 8 * np.cos(np.radians(psi))
        y += dt * 8 * np.sin(np.radians(psi))
    return np.array(rows).T


def minutes(x, y):
    """Latitude and longitude around 59.5 N 10.5 E, to a centimetre; enough of the ellipsoid for a few kilometres."""
    lat = 30 + x / 1856.85
    lon = 30 + y / (1856.85 * np.cos(np.radians(59.5)) * 1.00169)
    return f"59{lat:08.5f},N,010{lon:08.5f},E"


@pytest.fixture
def made(sailed, sentence, log):
    """Write the zig-zag as a log; `more` gives further sentences of a time, `kinds` those that are wanted."""

    def write(kinds=("HDT", "RSA", "GGA", "VHW"), more=None, talkers=("HE", "II", "GP", "VD"), rudder="{:.1f},A,,V"):
        lines = []
        for t, psi, delta, x, y in sailed.T:
            front = f"2026-05-04T09:{int(t) // 60:02d}:{int(t) % 60:02d}.000Z "
            utc = f"09{int(t) // 60:02d}{int(t) % 60:02d}.00"
            body = {
                "HDT": f"{talkers[0]}HDT,{psi % 360:.1f},T",
                "RSA": f"{talkers[1]}RSA," + rudder.format(delta),
                "GGA": f"{talkers[2]}GGA,{utc},{minutes(x, y)},1,10,0.9,5.0,M,40.0,M,,",
                "VHW": f"{talkers[3]}VHW,,T,,M,15.55,N,28.80,K",
            }
            lines += [front + sentence(body[kind]) for kind in kinds]
            lines += [front + sentence(text) for text in (more(t, psi, x, y, utc) if more else ())]
        return lines

    def save(lines, name="log.nmea"):
        return log("\r\n".join(lines) + "\r\n", name)

    return write, save


def close(found, sailed):
    """What is there is as it was sailed, and at most one sample of the heading is missing."""
    t, psi, delta, x, y = sailed
    np.testing.assert_allclose(found["t"], t, atol=1e-6)
    there = np.isfinite(found["psi"])
    assert there.sum() >= len(t) - 1
    np.testing.assert_allclose(np.degrees(found["psi"])[there], psi[there], atol=0.051)
    np.testing.assert_allclose(np.degrees(found["delta"]), delta, atol=0.051)
    if found.has("x"):
        np.testing.assert_allclose(np.hypot(found["x"] - x, found["y"] - y), 0, atol=0.6)  # the plane of `minutes`


def test_check_reads_what_measure_reads(made, toml, capsys):
    write, save = made
    path = str(save(write()))
    for options in ([], ["--format", "nmea"], ["--format", str(toml('[nmea]\ninterval = "1 s"\n'))]):
        assert run(["check", path, *options]) == 0
        said = " ".join(capsys.readouterr().out.split())
        assert "zigzag 20/20, first to starboard" in said
        assert "note: psi: HDT of talker HE, 241 values" in said  # what the reader says is part of it
        assert run(["measure", path, *options]) == 0
        assert "zig-zag 20/20" in capsys.readouterr().out


def test_talkers_of_digits(made, sailed):
    write, save = made
    trial = read_trial(save(write(("HDT", "RSA"), talkers=("24", "05", "GP", "VD"))))
    close(trial, sailed)
    assert any("HDT of talker 24" in note for note in trial.source.notes)


def test_talkers_of_three_letters_and_of_none(made, sailed):
    write, save = made
    trial = read_trial(save(write(("HDT", "RSA"), talkers=("HE1", "", "GP", "VD"))))
    close(trial, sailed)
    assert any("HDT of talker HE1" in note for note in trial.source.notes)
    assert any("RSA without a talker" in note for note in trial.source.notes)


@pytest.mark.parametrize("line", [0, 20, 700])
def test_a_byte_of_zero_garbles_one_line(made, log, sailed, line):
    write, _save = made
    lines = write()
    text = ("\r\n".join(lines) + "\r\n").encode()
    at = text.index(lines[line].encode()) + 28
    trial = read_trial(log(text[:at] + b"\x00" + text[at + 1 :], "log.nmea"))
    assert f"1 line was left out as broken (not a whole sentence, or fields that are not numbers): {line + 1}." in (
        trial.source.notes
    )
    close(trial, sailed)
    assert np.isnan(trial["psi"][line // 4]) == (line % 4 == 0)


def test_a_file_that_was_allotted_in_advance_ends_in_zeros(made, log, sailed):
    write, _ = made
    trial = read_trial(log(("\n".join(write()) + "\n").encode() + bytes(100_000), "log.nmea"))
    close(trial, sailed)
    assert not any("broken" in note or "cut" in note for note in trial.source.notes)


def test_sentences_that_end_in_a_bare_star(made, sailed):
    write, save = made
    trial = read_trial(save([line[:-2] for line in write()]))
    close(trial, sailed)
    assert any(
        note.startswith("WARNING: no sentence has a checksum (964 end in a star without one)")
        for note in trial.source.notes
    )


def test_a_bare_star_among_checksums_is_a_line_that_was_cut(made):
    write, save = made
    lines = write()
    lines[40] = lines[40][:-2]
    assert any(note.endswith(": 41.") and "as broken" in note for note in read_trial(save(lines)).source.notes)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "", " "])
def test_line_ends_of_every_kind_and_none(made, log, sailed, end):
    write, _ = made
    lines = write()
    text = "".join(line + (end if k % 3 else "\r\n") for k, line in enumerate(lines))
    close(read_trial(log(text, "log.nmea")), sailed)


def test_what_is_not_read_is_counted(made, sailed, sentence):
    write, save = made
    lines = write(("HDT", "RSA"), more=lambda t, *_: ["GPGSV,1,1,00", "PGRMC,A,0"] if int(t) % 10 == 0 else [])
    lines[5:5] = ["2026-05-04T09:00:01.000Z !" + sentence("AIVDM,1,1,,A,13u?etPv2;0n:dDPwUM1U1Cb069D,0")[1:]] * 3
    trial = read_trial(save(lines))
    close(trial, sailed)
    assert "Sentences that are not read: GPGSV (25), PGRMC (25), AIVDM (3)." in trial.source.notes


@pytest.mark.parametrize("dead", ["starboard", "port"])
def test_one_of_two_rudder_sensors_is_stuck(made, sailed, dead, toml, capsys):
    write, save = made
    path = save(write(rudder="0.0,A,{:.1f},A" if dead == "starboard" else "{:.1f},A,0.0,A"))
    trial = read_trial(path)
    close(trial, sailed)
    alive = "port" if dead == "starboard" else "starboard"
    warned = [note for note in trial.source.notes if note.startswith("WARNING")]
    assert len(warned) == 1
    assert f"the {dead} rudder of RSA stands still at 0 deg while the {alive} one moves over 40 deg" in warned[0]
    assert f"use = '{alive}' in [nmea.rudder]" in warned[0]
    stuck = read_trial(path, format=toml(f'[nmea.rudder]\nuse = "{dead}"\n'))
    assert np.ptp(stuck["delta"]) == 0
    assert run(["measure", str(path)]) == 0
    said = capsys.readouterr()
    assert "zig-zag 20/20" in said.out and "stands still" in " ".join((said.out + said.err).split())


def test_one_of_two_rudder_sensors_falls_silent(made, sailed):
    """Its status turns to V: the other one is taken, and the log says so."""
    write, save = made
    lines = write(rudder="{0:.1f},A,{0:.1f},A")
    for k, line in enumerate(lines):
        if "RSA" in line and k > 400:
            front, _, tail = line.partition("$")
            address, _, _, port, _ = tail.partition("*")[0].split(",")
            lines[k] = front + "$" + f"{address},0.0,V,{port},A"
            lines[k] += f"*{_xor(lines[k].partition('$')[2]):02X}"
    trial = read_trial(save(lines))
    close(trial, sailed)
    (warned,) = [note for note in trial.source.notes if note.startswith("WARNING")]
    assert "the starboard rudder of RSA is valid 100 times and the port one 241 times" in warned
    assert "use = 'port' in [nmea.rudder]" in warned


def _xor(text):
    total = 0
    for character in text:
        total ^= ord(character)
    return total


def test_a_rudder_that_is_never_valid_is_named(made):
    write, save = made
    trial = read_trial(save(write(rudder="{:.1f},V,,V")))
    assert not trial.has("delta")
    assert (
        "WARNING: delta is missing: 241 sentences IIRSA are there, all of them empty or marked as not valid (status V)."
        in trial.source.notes
    )


def test_twin_rudders_that_both_work(made, sailed):
    write, save = made
    trial = read_trial(save(write(rudder="{0:.1f},A,{0:.1f},A")))
    close(trial, sailed)
    assert any("the port rudder is logged too, and differs by 0 deg on average" in n for n in trial.source.notes)
    assert not any(n.startswith("WARNING") for n in trial.source.notes)
    apart = read_trial(save(write(rudder="{0:.1f},A,7.0,A"), "apart.nmea"))
    assert any("stands still" in n for n in apart.source.notes)


def test_without_a_rudder_it_is_a_trial(made, sailed):
    write, save = made
    trial = read_trial(save(write(("HDT", "GGA", "VHW"))))
    assert list(trial.table.columns) == ["t", "x", "y", "psi", "u"]
    np.testing.assert_allclose(np.degrees(trial["psi"]), sailed[1], atol=0.051)


def test_without_a_heading_it_is_a_trial(made, sailed):
    write, save = made
    trial = read_trial(save(write(("GGA",), more=lambda t, psi, *_: [f"GPVTG,{psi % 360:.1f},T,,M,15.55,N,28.80,K,A"])))
    assert list(trial.table.columns) == ["t", "x", "y", "SOG", "COG"]
    np.testing.assert_allclose(np.degrees(np.unwrap(trial["COG"])), sailed[1], atol=0.051)
    assert shipid.check_trial(trial) is not None


def test_the_antenna_cannot_be_left_without_a_heading(made, toml):
    write, save = made
    trial = read_trial(save(write(("GGA",))), format=toml('[nmea.antenna]\nx = "30 m"\n'))
    assert any(note.startswith("WARNING: x, y, SOG, COG are of the antenna") for note in trial.source.notes)
