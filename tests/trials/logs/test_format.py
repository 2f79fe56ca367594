import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import MissingFileError
from shipid.trials import errors as e
from shipid.trials.logs.conversion import mended_heading
from shipid.trials.logs.format import read_format
from shipid.trials.logs.reading import read_trial

SOUND = """
separator = "comma"
header_lines = 0
[columns.t]
index = 0
unit = "s"
[columns.psi]
index = 1
unit = "deg"
"""


@pytest.fixture
def fmt(tmp_path):
    def write(text=SOUND):
        path = tmp_path / "format.toml"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("separator = ", ("is not valid TOML",)),
        ("seperator = 'tab'" + SOUND, ("'seperator'", "Did you mean separator")),
        (SOUND + "sing = -1\n", ("[columns.psi]", "'sing'", "sign")),
        (SOUND + "sign = -2\n", ("'sign' is -2", "1 or -1")),
        (SOUND + "sign = 'minus'\n", ("has to be a whole number",)),
        (SOUND + "scale = 0\n", ("'scale' is 0",)),
        (SOUND + "scale = true\n", ("has to be a number",)),
        (SOUND + "frame = 'earth'\n", ("psi takes no frame",)),
        (SOUND + "column = 'psi'\n", ("either column",)),
        (SOUND.replace("index = 1\n", ""), ("either column",)),
        (SOUND.replace("index = 1", "index = -1"), ("counted from 0",)),
        (SOUND.replace("comma", "pipe"), ("Write one of comma, semicolon, tab, space, bar",)),
        (SOUND.replace("header_lines = 0", "header_lines = -1"), ("cannot be negative",)),
        ("encoding = 'utf-9'" + SOUND, ("utf-8, cp1252",)),
        ("comment = '//'" + SOUND, ("one character",)),
        ("title = 3" + SOUND, ("has to be text",)),
        ("clock = 3" + SOUND, ("[clock]",)),
        ("", ("names no columns",)),
        (SOUND.replace("columns.t]", "columns.x]"), ("no clock",)),
        (SOUND + "[clock]\ninterval = 0.1\n", ("no unit",)),
        (SOUND + "[clock]\ninterval = '-0.1 s'\n", ("greater than zero",)),
        (SOUND + "[windows]\nzz = [5, 2]\n", ("[windows]: 'zz'", "start before end")),
        (SOUND + "[windows.zz]\nspan = [2, 5]\nmeening = 'x'\n", ("meening", "meaning")),
        (SOUND + "[repairs]\ntrailing = 'keep'\n", ("[repairs]: 'trailing' is 'keep'", "drop")),
        (SOUND + "[repairs]\nheading_glitch = true\n", ("heading_glitches",)),
        (SOUND + "[repairs]\nheading_glitches = true\n", ("needs [columns.psi] and [columns.r]",)),
        (SOUND + "[columns.u]\nindex = 2\nunit = 'm/s'\nframe = 'earth'\n", ("both velocities",)),
        (SOUND + "[columns.wind_direction]\nindex = 2\nunit = 'deg'\nframe = 'earth'\n", ('can be "from"',)),
    ],
)
def test_what_a_format_file_cannot_mean(fmt, text, words):
    with pytest.raises(e.FormatFileError) as caught:
        read_format(fmt(text))
    assert "format.toml" in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_missing_format_file(tmp_path):
    with pytest.raises(MissingFileError, match=r"no trial format file .*none\.toml"):
        read_format(tmp_path / "none.toml")


def rows(count=20, text="{t},{psi}"):
    return "".join(text.format(t=0.5 * k, psi=10 + k) + "\n" for k in range(count))


def test_columns_by_index_without_a_header(log, fmt):
    trial = read_trial(log(rows()), fmt())
    assert trial["psi"][0] == pytest.approx(np.radians(10))
    assert trial.source.format == "format"


def test_column_that_the_file_does_not_have(log, fmt):
    with pytest.raises(e.UnknownColumnError, match=r"2 columns, counted from 0.*number 7"):
        read_trial(log(rows()), fmt(SOUND.replace("index = 1", "index = 7")))
    text = SOUND.replace("header_lines = 0", "header_lines = 1").replace("index = 1", "column = 'headin'")
    with pytest.raises(e.UnknownColumnError, match=r"'headin'.*Did you mean heading"):
        read_trial(log("time,heading\n" + rows()), fmt(text))
    with pytest.raises(e.HeaderError, match="names 3 columns and the first sample has 2"):
        read_trial(log("time,heading,more\n" + rows()), fmt(text))


def test_unit_from_the_header_where_the_format_says_none(log, fmt):
    text = SOUND.replace("header_lines = 0", "header_lines = 1").replace('\nunit = "deg"', "")
    assert read_trial(log("time,heading [deg]\n" + rows()), fmt(text))["psi"][0] == pytest.approx(np.radians(10))
    with pytest.raises(e.NoUnitError, match=r"format file 'format'.*'psi'"):
        read_trial(log("time,heading\n" + rows()), fmt(text))


def test_sign_scale_and_revolutions(log, fmt):
    text = SOUND + "sign = -1\nscale = 2\n[columns.n]\nindex = 1\nunit = '1/s'\nnote = 'port shaft'\n"
    trial = read_trial(log(rows()), fmt(text))
    assert trial["psi"][0] == pytest.approx(-np.radians(20))
    assert trial["n"][0] == pytest.approx(10)
    assert any(note.startswith("the sign of psi was changed") for note in trial.source.notes)
    assert "n: port shaft" in trial.source.notes


def test_clock_is_rebuilt(log, fmt):
    trial = read_trial(log(rows(text="3.0,{psi}")), fmt(SOUND + "[clock]\ninterval = '100 ms'\n"))
    np.testing.assert_allclose(trial["t"], 0.1 * np.arange(20))
    with pytest.raises(e.ClockError):
        read_trial(log(rows(text="3.0,{psi}")), fmt())


def test_trailing_rows_are_dropped_only_if_stated(log, fmt):
    text = rows() + ",\n,\n"
    kept = read_trial(log(text), fmt())
    assert len(kept) == 20 and "2 rows without any number were left out of 22." in kept.source.notes
    interval = SOUND + "[clock]\ninterval = '1 s'\n"
    assert len(read_trial(log(text), fmt(interval))) == 22  # without a clock of its own a row is a tick
    trial = read_trial(log(text), fmt(SOUND + "[repairs]\ntrailing = 'drop'\n"))
    assert len(trial) == 20
    assert "2 empty rows at the end were dropped." in trial.source.notes
    holed = read_trial(log(text.replace("1.0,12", "1.0,")), fmt(SOUND + "[repairs]\ntrailing = 'drop'\n"))
    assert len(holed) == 20 and np.isnan(holed["psi"]).sum() == 1
    with pytest.raises(e.TooShortError, match="0 samples"):
        read_trial(log(",\n" * 30), fmt(SOUND + "[repairs]\ntrailing = 'drop'\n"))


def test_named_windows(log, fmt):
    text = SOUND + "[windows]\nzigzag = [2, 7]\n[windows.turn]\nspan = [3, 9]\nmeaning = 'to port'\n"
    path = log(rows())
    assert read_trial(path, fmt(text), window="zigzag").name == "log@2:7"
    assert read_trial(path, fmt(text), window="turn")["t"][0] == 3
    assert read_format(fmt(text)).windows["turn"].meaning == "to port"
    with pytest.raises(e.WindowError, match="Did you mean zigzag"):
        read_trial(path, fmt(text), window="zigzg")
    assert read_trial(f"{path}@zigzag", fmt(text)).name == "log@2:7"
    assert read_trial(f"{path}@4:7", fmt(text)).name == "log@4:7"


EARTH = SOUND + "".join(f"[columns.{c}]\nindex = {k}\nunit = 'm/s'\nframe = 'earth'\n" for c, k in (("u", 2), ("v", 3)))


@given(st.floats(-179, 179), st.floats(0.1, 10), st.floats(-3, 3))
@settings(max_examples=20, deadline=None)
def test_velocities_are_rotated_to_the_ship(tmp_path_factory, psi, u, v):
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    north, east = float(u * c - v * s), float(u * s + v * c)
    folder = tmp_path_factory.mktemp("earth")
    (folder / "log.csv").write_text("".join(f"{k},{psi!r},{north!r},{east!r}\n" for k in range(12)))
    (folder / "format.toml").write_text(EARTH)
    trial = read_trial(folder / "log.csv", folder / "format.toml")
    np.testing.assert_allclose(trial["u"], u, atol=1e-9)
    np.testing.assert_allclose(trial["v"], v, atol=1e-9)


def test_wind_from_becomes_wind_to(log, fmt):
    text = SOUND + "[columns.wind_direction]\nindex = 1\nunit = 'deg'\nframe = 'from'\n"
    trial = read_trial(log(rows()), fmt(text))
    assert np.degrees(trial["wind_direction"][0]) == pytest.approx(190)


class TestHeadingGlitches:
    t = np.arange(0, 200, 0.5)
    r = np.radians(3) * np.sin(t / 15)
    psi = np.concatenate(([0], np.cumsum(0.25 * (r[1:] + r[:-1])))) + 6.2

    def test_sound_heading_is_left_alone(self):
        mended, count = mended_heading(self.t, np.mod(self.psi, 2 * np.pi), self.r, np.radians(1))
        assert count == 0
        np.testing.assert_allclose(np.diff(mended), np.diff(self.psi), atol=1e-12)
        assert mended[0] == pytest.approx(np.mod(self.psi[0], 2 * np.pi))

    def test_drifting_gyro_is_followed(self):
        mended, count = mended_heading(self.t, self.psi, self.r + np.radians(0.05), np.radians(1))
        assert count == 0
        np.testing.assert_allclose(mended, self.psi, atol=1e-9)

    @settings(deadline=None)
    @given(st.lists(st.integers(3, 190), min_size=1, max_size=4, unique=True), st.floats(3, 170), st.integers(1, 5))
    def test_glitches_are_replaced(self, places, size, length):
        bad = np.zeros(len(self.t), dtype=bool)
        for place in places:
            bad[2 * place : 2 * place + length] = True
        edges = np.flatnonzero(np.diff(np.concatenate(([0], bad, [0]))))
        if np.any(edges[1::2] - edges[::2] > 5) or np.any(edges[2::2] - edges[1:-1:2] < 20):
            return  # longer than it can tell from the ship's own motion
        broken = np.where(bad, self.psi + np.radians(size), self.psi)
        mended, count = mended_heading(self.t, np.mod(broken, 2 * np.pi), self.r, np.radians(1))
        assert count == bad.sum()
        np.testing.assert_allclose(np.diff(mended), np.diff(self.psi), atol=1e-9)

    def test_heading_interpolated_across_the_wrap(self):
        wrapped = np.mod(self.psi, 2 * np.pi)
        k = int(np.flatnonzero(np.abs(np.diff(wrapped)) > 3)[0])
        wrapped[k - 1 : k + 3] = np.linspace(wrapped[k - 1], wrapped[k + 2], 4)
        mended, count = mended_heading(self.t, wrapped, self.r, np.radians(1))
        assert count == 2
        np.testing.assert_allclose(np.diff(mended), np.diff(self.psi), atol=1e-9)
