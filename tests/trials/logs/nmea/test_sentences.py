"""Every sentence: values computed by hand, and what its status rejects."""

import math

import numpy as np
import pytest

from shipid.trials.logs.nmea.sentences.fields import CARRIED
from shipid.trials.logs.nmea.sentences.lines import split_line
from shipid.trials.logs.reading import read_trial

KNOT = 0.5144444444444445  # m/s


def note(trial, word):
    found = [n for n in trial.source.notes if n.startswith(word) and "samples are missing" not in n]
    assert len(found) == 1, trial.source.notes
    return found[0]


@pytest.fixture
def read(log, stamped, basic, dense):
    """Read a log of the basic sentences and others, once a second or as often as they say."""

    def run(*more, instead=None, **options):
        sentences = (instead or basic) + tuple(m if isinstance(m, tuple) else (m, 1) for m in more)
        return dense(
            read_trial(log(stamped(*sentences), "trial.nmea"), format=options.pop("format", "nmea"), **options)
        )

    return run


def test_hdt_and_rsa(read):
    trial = read()
    assert list(trial.table.columns) == ["t", "psi", "delta"]
    assert trial.sampling == pytest.approx(0.2)
    np.testing.assert_allclose(np.degrees(trial["psi"]), 350 + 0.5 * trial["t"], atol=0.051)  # printed to 0.1
    assert np.degrees(trial["delta"][-1]) == pytest.approx(10)
    assert "HDT of talker HE" in note(trial, "psi") and "5 a second" in note(trial, "psi")
    assert "read as degrees" in note(trial, "delta")
    assert trial.source.format == "nmea" and trial.source.comment == "sea trial"


def test_ths_obeys_its_mode(read, basic):
    for mode, used in (("A", True), ("E", True), ("M", False), ("S", False), ("V", False)):
        trial = read((f"HETHS,42.0,{mode}", 5))
        assert ("THS" in note(trial, "psi:").partition(";")[0]) is used, mode


def test_hdg_with_deviation_and_variation(read, basic):
    trial = read(("HCHDG,100.0,1.5,W,2.5,E", 5), instead=basic[1:])
    assert np.degrees(trial["psi"][0]) == pytest.approx(100 - 1.5 + 2.5)
    assert "+2.5 deg, of HCHDG" in note(trial, "psi")


def test_hdm_without_variation_is_magnetic_and_says_so(read, basic):
    trial = read(("HCHDM,100.0,M", 5), instead=basic[1:])
    assert np.degrees(trial["psi"][0]) == pytest.approx(100)
    assert "magnetic" in note(trial, "WARNING")


def test_hdm_takes_the_variation_of_rmc(read, basic):
    rmc = "GPRMC,090000.00,A,6327.00000,N,01025.00000,E,9.0,45.0,040526,3.0,W,A"
    trial = read(("HCHDM,100.0,M", 5), rmc, instead=basic[1:])
    assert np.degrees(trial["psi"][0]) == pytest.approx(97)


def test_rot_is_degrees_a_minute(read):
    trial = read(("TIROT,30.0,A", 5))
    assert np.degrees(trial["r"][0]) == pytest.approx(0.5)  # 30 deg/min
    assert not read(("TIROT,30.0,V", 5)).has("r")
    assert not read(("TIROT,,A", 5)).has("r")


def test_ror_is_the_order(read):
    trial = read("IIROR,-12.5,A,,V,B")
    assert np.degrees(trial["delta_order"][0]) == pytest.approx(-12.5)  # to port
    assert not read("IIROR,-12.5,V,,V,B").has("delta_order")


def test_rsa_obeys_the_status_of_each_rudder(read, basic):
    trial = read(("IIRSA,5.0,V,-3.0,A", 2), instead=basic[:1])
    assert np.degrees(trial["delta"][0]) == pytest.approx(-3)
    assert "port" in note(trial, "delta")


def test_vbw_through_the_water_and_over_ground(read):
    trial = read("VDVBW,10.0,-0.5,A,11.0,0.25,A")
    assert trial["u"][0] == pytest.approx(5.144444, abs=1e-6)
    assert trial["v"][0] == pytest.approx(-0.2572222, abs=1e-6)  # to port
    assert "through the water" in note(trial, "u, v")
    ground = read("VDVBW,10.0,-0.5,V,11.0,0.25,A")
    assert not ground.has("u")
    assert ground["SOG"][0] == pytest.approx(KNOT * math.hypot(11, 0.25))
    assert np.degrees(ground["COG"][0]) == pytest.approx(350 + math.degrees(math.atan2(0.25, 11)))
    assert "over ground, knots along the ship and across" in note(ground, "SOG, COG")
    assert not read("VDVBW,10.0,-0.5,V,11.0,0.25,V").has("u")
    assert not read("VDVBW,10.0,,A,,,V").has("v")


def test_vhw_in_knots_or_kilometres(read):
    assert read("VWVHW,,T,,M,9.0,N,16.7,K")["u"][0] == pytest.approx(4.63)
    assert read("VWVHW,,T,,M,,N,18.0,K")["u"][0] == pytest.approx(5.0)  # 18 km/h


def test_vhw_is_the_last_resort_for_a_heading(read, basic):
    trial = read(("VWVHW,123.0,T,121.0,M,9.0,N,,K", 5), instead=basic[1:])
    assert np.degrees(trial["psi"][0]) == pytest.approx(123)


def test_vtg_is_speed_and_course_over_ground(read):
    trial = read("GPVTG,60.0,T,,M,10.0,N,,K,A")
    assert trial["SOG"][0] == pytest.approx(10 * KNOT)
    assert np.degrees(trial["COG"][0]) == pytest.approx(60)
    assert not trial.has("u") and not trial.has("U")
    assert "over ground" in note(trial, "SOG, COG")
    assert not read("GPVTG,60.0,T,,M,10.0,N,,K,N").has("SOG")
    assert read("GPVTG,60.0,T,,M,10.0,N,,K,A", "VWVHW,,T,,M,9.0,N,,K")["u"][0] == pytest.approx(9 * KNOT)


def test_courses_on_one_clock_go_the_short_way_round(log, stamped, basic, toml):
    """A course is between two samples on the short way round: 350 and 10 deg give 0, not 180."""
    course = (lambda t: f"GPVTG,{(355 + 10 * t) % 360:.1f},T,,M,10.0,N,,K,A", 1)
    trial = read_trial(log(stamped(*basic, course)), format=toml('[nmea]\ninterval = "0.2 s"\n'))
    np.testing.assert_allclose(np.degrees(np.unwrap(trial["COG"])), 355 + 10 * trial["t"], atol=0.01)


def test_rmc_obeys_status_and_mode(read):
    rmc = "GPRMC,090000.00,{},6327.00000,N,01025.00000,E,10.0,45.0,040526,,,{}"
    assert read(rmc.format("A", "D"))["SOG"][0] == pytest.approx(10 * KNOT)
    assert not read(rmc.format("V", "A")).has("SOG")
    assert not read(rmc.format("A", "E")).has("x")
    assert read("GPRMC,090000.00,A,6327.00000,N,01025.00000,E,10.0,45.0,040526,,").has("x", "SOG")  # no mode before 2.3


@pytest.mark.parametrize(
    "text",
    [
        "GPGGA,090000.00,{},N,01025.00000,E,4,9,1.0,5.0,M,40.0,M,,",
        "GPGLL,{},N,01025.00000,E,090000.00,A,A",
        "GPRMC,090000.00,A,{},N,01025.00000,E,10.0,45.0,040526,,,A",
    ],
)
def test_positions_in_local_metres(read, text):
    trial = read((lambda t: text.format(f"63{27 + t / 1000:08.5f}"), 1))
    # A minute of latitude at 63.45 deg: meridian radius 6386678.7 m times pi/10800.
    radius = 6378137 * (1 - 0.00669437999014) / (1 - 0.00669437999014 * math.sin(math.radians(63.45)) ** 2) ** 1.5
    assert trial["x"][-1] == pytest.approx(20e-3 * radius * math.pi / 10800, abs=1e-3)
    assert np.abs(trial["y"]).max() < 1e-6


def test_west_and_south_are_negative(read):
    def east(t):
        return f"GPGGA,090000.00,3354.00000,S,07000.{1000 - int(t):05d},W,1,9,1.0,5.0,M,40.0,M,,"

    assert read((east, 1))["y"][-1] > 0.1  # a smaller west longitude lies further east


@pytest.mark.parametrize("quality", [0, 6, 7, 8])
def test_gga_that_is_no_fix(read, quality):
    assert not read(f"GPGGA,090000.00,6327.00000,N,01025.00000,E,{quality},9,1.0,5.0,M,40.0,M,,").has("x")


def test_position_without_a_hemisphere_is_rejected(read):
    assert not read("GPGGA,090000.00,6327.00000,,01025.00000,E,1,9,1.0,5.0,M,40.0,M,,").has("x")


@pytest.mark.parametrize(("unit", "speed"), [("N", 10 * KNOT), ("K", 10 / 3.6), ("M", 10.0)])
def test_mwv_relative(read, unit, speed):
    trial = read(f"WIMWV,30.0,R,10.0,{unit},A")
    assert trial["wind_speed_relative"][0] == pytest.approx(speed)
    assert np.degrees(trial["wind_direction_relative"][0]) == pytest.approx(210)  # from 30 is to 210
    assert not read(f"WIMWV,30.0,R,10.0,{unit},V").has("wind_speed_relative")


def test_mwv_true_counts_from_the_bow(read, basic):
    trial = read("WIMWV,90.0,T,10.0,M,A", instead=((lambda t: "HEHDT,300.0,T", 5), basic[1]))
    assert np.degrees(trial["wind_direction"][0]) == pytest.approx(210)  # from 300 + 90 = 30, to 210
    assert trial["wind_speed"][0] == pytest.approx(10)


def test_dpt(read):
    trial = read("SDDPT,12.5,0.8,100")
    assert trial["depth"][0] == pytest.approx(12.5) and trial.unit("depth") == "m"


def test_other_sentences_are_counted(read):
    trial = read("GPGSA,A,3,01,02,,,,,,,,,,,2,1,2", "PXYZ,1,2", "!AIVDM,1,1,,A,13u?etPv2;0n:dDPwUM1U1Cb069D,0*24")
    text = note(trial, "Sentences that are not read")
    assert "GPGSA (21)" in text and "PXYZ (21)" in text and "AIVDM (21)" in text


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("HEHDT,123.4,T", {"heading": "headingT"}),
        ("HETHS,123.4,A", {"heading": "headt"}),
        ("HCHDM,123.4,M", {"heading": "headingM"}),
        ("HEROT,-12.3,A", {"rate": "rot"}),
        ("IIRSA,5.5,A,-3.5,A", {"starboard": "stbdangle", "port": "portangle"}),
        ("IIROR,5.5,A,-3.5,A,B", {"starboard": "stbdrudderorder", "port": "portrudderorder"}),
        ("VDVBW,10.1,-0.5,A,11.2,0.3,A", {"u": "longwaterspd", "v": "transwaterspd", "u_ground": "longgroundspd"}),
        ("VWVHW,123.0,T,121.0,M,9.1,N,16.9,K", {"heading": "hdgT", "u": "spdN"}),
        ("GPVTG,60.1,T,,M,10.2,N,18.9,K,A", {"sog": "sogn", "cog": "cogt"}),
        (
            "GPRMC,091530.25,A,6327.12345,S,01025.54321,W,9.5,45.5,040526,,,A",
            {"lat": "lat", "lon": "lon", "sog": "spd", "cog": "cog"},
        ),
        (
            "GNGGA,091530.25,6327.12345,N,01025.54321,E,4,9,1.0,5.0,M,40.0,M,,",
            {"lat": "lat", "lon": "lon", "quality": "quality"},
        ),
        ("GPGLL,6327.12345,N,01025.54321,E,091530.25,A,A", {"lat": "lat", "lon": "lon"}),
        ("WIMWV,33.5,R,12.5,N,A", {"angle": "angle", "speed": "speed"}),
        ("SDDPT,12.5,0.0", {"depth": "depth"}),
    ],
)
def test_fields_are_those_of_another_parser(sentence, text, fields):
    """pynmeagps, which we did not write, finds the same numbers."""
    pynmeagps = pytest.importorskip("pynmeagps")
    names, read_fields = CARRIED[text[2:5]]
    found = dict(zip(names, read_fields(text.split(","))))
    other = pynmeagps.NMEAReader.parse(sentence(text))
    for ours, theirs in fields.items():
        assert found[ours] == pytest.approx(float(getattr(other, theirs)), abs=1e-8), ours
    if "utc" in names:
        assert found["utc"] == 9 * 3600 + 15 * 60 + 30.25
        assert other.time.isoformat() == "09:15:30.250000"


@pytest.mark.parametrize(
    "text", ["HEHDT,1_0,T", "HEHDT,abc,T", "GPGGA,0915xx,6327.1,N,01025.5,E,1", "GPGLL,63x7.1,N,01025.5,E,091530,A"]
)
def test_text_where_a_number_has_to_stand(text):
    with pytest.raises(ValueError, match=r"."):
        CARRIED[text[2:5]][1](text.split(","))


def test_spaces_before_a_star_without_a_checksum_are_no_field():
    """The heading of a log was left out without a word: its last field was 'T ', which is no true heading."""
    assert split_line("$HEHDT,350.0,T *").text == "$HEHDT,350.0,T"
