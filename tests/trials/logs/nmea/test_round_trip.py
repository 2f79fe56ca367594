"""A trial written as a log and read back, within the resolution of the sentences."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import shipid
from shipid.foundation.errors import MissingFileError, OverwriteError, UnknownNameError
from shipid.trials.logs.nmea.sentences.lines import checksum as shipids_checksum
from shipid.trials.logs.nmea.sentences.lines import split_line
from shipid.trials.logs.nmea.writing import RATES, STAMPS, nmea_lines, sentence, write_nmea
from shipid.trials.logs.reading import read_trial
from shipid.trials.trial import Trial

ROOT = Path(__file__).resolve().parents[4]
EXAMPLE = ROOT / "studies" / "trials" / "zigzag-20-20.nmea"
FORMAT = ROOT / "studies" / "formats" / "nmea-example.toml"
KNOT = 1852 / 3600

#: Half of the last decimal, and a millisecond of the stamp at the largest slope below.
WITHIN = {
    "psi": np.radians(0.05 + 0.02),
    "r": np.radians(0.05) / 60 + 1e-5,
    "u": 0.005 * KNOT + 1e-4,
    "v": 0.005 * KNOT + 1e-4,
    "delta": np.radians(0.05 + 0.02),
    "delta_order": np.radians(0.05 + 0.02),
    "x": 0.05,
    "y": 0.05,
    "SOG": 0.005 * KNOT + 1e-3,
    "wind_speed_relative": 0.05 * KNOT + 1e-3,
    "wind_direction_relative": np.radians(0.05 + 0.02),
}


def made(heading, turning, rudder, speed, drift) -> Trial:
    """A trial of straight lines, which sampling and interpolation leave as they are."""
    t = np.arange(0, 40.01, 0.1)
    frame = pd.DataFrame(
        {
            "t [s]": t,
            "x [m]": 3 * t,
            "y [m]": -2 * t,
            "psi [deg]": heading + turning * t,
            "u [m/s]": speed + 0.01 * t,
            "v [m/s]": drift - 0.005 * t,
            "r [deg/s]": np.full_like(t, turning),
            "delta [deg]": rudder + 0.2 * t,
            "delta_order [deg]": rudder - 0.1 * t,
            "wind_speed_relative [m/s]": np.full_like(t, 7.3),
            "wind_direction_relative [deg]": np.full_like(t, (heading * 7) % 360),
        }
    )
    return Trial.from_frame(frame, name="made")


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    heading=st.floats(0, 360),
    turning=st.floats(-4, 4),
    rudder=st.floats(-30, 25),
    speed=st.floats(1, 12),
    drift=st.floats(-1, 1),
    stamp=st.sampled_from([s for s in STAMPS if s != "none"]),
    kind=st.sampled_from(["HEHDT", "HETHS"]),
)
def test_written_and_read(tmp_path, heading, turning, rudder, speed, drift, stamp, kind):
    trial = made(heading, turning, rudder, speed, drift)
    rates = {kind: 5.0, **{k: v for k, v in RATES.items() if k != "HEHDT"}}
    path = write_nmea(trial, tmp_path / "made.nmea", rates, stamp=stamp, overwrite=True)
    back = read_trial(path, format="nmea")
    for name, within in WITHIN.items():
        there = np.isfinite(back[name])
        t, found = back["t"][there], back[name][there]
        if name == "SOG":
            expected = np.interp(t, trial["t"], np.hypot(trial["u"], trial["v"]))
        else:
            expected = np.interp(t, trial["t"], trial[name])
        error = found - expected
        if name in ("x", "y"):
            error -= np.median(error)  # the origin is the first fix
        if name in ("psi", "wind_direction_relative"):
            error = np.angle(np.exp(1j * error))
        assert np.abs(error).max() <= within, name


@given(
    st.text("ABCDEFGHIJKLMNOPQRSTUVWXYZ", min_size=5, max_size=5),
    st.lists(st.text("ABCabc0123456789.- ", max_size=8), max_size=9),
)
def test_a_sentence_is_found_again(address, fields):
    text = sentence(address, *fields)
    for front in ("", "2026-05-04T09:00:00Z ", "\\s:X*00\\", "$HEHDT,12"):
        found = split_line(front + text)
        assert found.address == address and found.front == front
        assert found.text.split(",")[1:] == fields
        assert shipids_checksum(found.text[1:]) == found.checksum


def test_a_known_checksum():
    assert (
        sentence("GPGLL", "5057.970", "N", "00146.110", "E", "142451", "A")
        == "$GPGLL,5057.970,N,00146.110,E,142451,A*27"
    )


@pytest.mark.parametrize(
    "line", ["", "HEHDT,1,T", "$", "$HEHDT,1,T*2", "$HEHDT,1,T*ZZ", "$hehdt,1,T", "$HEHDT,\x001,T*00"]
)
def test_what_is_no_sentence(line):
    assert split_line(line) is None


def test_other_sentences_of_the_writer(tmp_path):
    trial = made(30, 0, 5, 6, 0.5)
    rates = {"HETHS": 5.0, "IIRSA": 2.0, "VWVHW": 1.0, "GPRMC": 1.0, "GPGLL": 1.0}
    path = write_nmea(trial, tmp_path / "made.nmea", rates, stamp="none")
    back = read_trial(path, format="nmea")
    assert back["u"][np.isfinite(back["u"])][1] == pytest.approx(6, abs=0.03)
    assert back["SOG"][np.isfinite(back["SOG"])][1] == pytest.approx(np.hypot(6, 0.5), abs=0.03)
    assert any("UTC of GPRMC" in n for n in back.source.notes)
    with pytest.raises(UnknownNameError, match="XTE"):
        list(nmea_lines(trial, {"GPXTE": 1.0}))
    with pytest.raises(UnknownNameError, match="sundial"):
        list(nmea_lines(trial, stamp="sundial"))


def test_nothing_is_overwritten(tmp_path):
    path = write_nmea(made(0, 0, 0, 5, 0), tmp_path / "a.nmea")
    with pytest.raises(OverwriteError, match="exists already"):
        write_nmea(made(0, 0, 0, 5, 0), path)
    with pytest.raises(MissingFileError, match="there is no folder"):
        write_nmea(made(0, 0, 0, 5, 0), tmp_path / "no" / "a.nmea")
    assert [p.name for p in tmp_path.iterdir()] == ["a.nmea"]


class TestExample:
    """The log of studies/trials."""

    def test_it_says_what_it_is(self):
        assert EXAMPLE.read_text(encoding="ascii").splitlines()[0].startswith("# Simulated, not measured")
        trial = read_trial(EXAMPLE, format=FORMAT)
        assert trial.source.simulated and trial.ship == "zeefakkel"
        notes = " ".join(trial.source.notes)
        assert "1 line was left out for a wrong checksum" in notes and "1 line was left out as broken" in notes

    def test_it_is_the_trial_that_was_simulated(self):
        truth = shipid.simulate(
            shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", speed="9 kn", sampling="0.05 s"
        )
        trial = read_trial(EXAMPLE, format=FORMAT)
        t = trial["t"]
        # Resolution, and what linear interpolation over 0.2 s leaves of a rudder that runs at a few degrees a second.
        for name, within in (
            ("psi", np.radians(0.06)),
            ("r", np.radians(0.01)),
            ("delta", np.radians(0.5)),
            ("u", 0.003),
        ):
            assert np.abs(trial[name] - np.interp(t, truth["t"], truth[name])).max() < within, name

    def test_identification_recovers_the_model(self):
        fit = shipid.identify(
            shipid.find_model("norrbin"), [read_trial(EXAMPLE, format="nmea")], ship="zeefakkel", starts=1
        )
        found = fit.to_dict()["parameters"]
        # K and tau of the ship's table at 9 kn = 4.63 m/s, n3 = 0.4 s²/deg².
        truth = {"K": np.interp(4.63, [4, 5], [0.37, 0.50]), "tau": np.interp(4.63, [4, 5], [33, 31]), "n3": 1313.1}
        for name, value in truth.items():
            assert found[name]["value"] == pytest.approx(value, rel=0.01), name


def test_positions_are_written_about_the_origin_that_the_trial_states(tmp_path):
    trial, origin = made(10, 0.1, 5, 5, 0), (np.radians(53.5), np.radians(8.1))
    stated = replace(trial, source=replace(trial.source, origin=origin))
    back = read_trial(write_nmea(stated, tmp_path / "log.nmea"))
    assert back.source.origin == pytest.approx(origin, abs=1e-7)
    elsewhere = read_trial(write_nmea(stated, tmp_path / "other.nmea", origin=(0.2, 0.1)))
    assert elsewhere.source.origin == pytest.approx((0.2, 0.1), abs=1e-7)


def test_a_zero_has_no_sign():
    t = np.arange(0, 20.0, 1.0)
    frame = pd.DataFrame(
        {"t [s]": t, "psi [deg]": 10 + 0 * t, "r [deg/s]": -1e-7 + 0 * t, "delta [deg]": -0.01 + 0 * t}
    )
    lines = list(nmea_lines(Trial.from_frame(frame, name="still")))
    assert any("ROT" in line for line in lines) and not [line for line in lines if "-0.0," in line]
