from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from html import unescape
from pathlib import Path

import pytest

from shipid.cli import run
from shipid.report.figures import svg

OWN_MODEL = '''
from shipid import Component, given, parameter, state


class Yaw(Component):
    """A yaw model of the user's own."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    K = parameter("1/s", "gain", start=0.2, low=0.01, high=5.0)
    tau = parameter("s", "time constant", start=15.0, low=0.5, high=500.0)

    @r.rate
    def yaw(self):
        """Own notes, page 1."""
        return (self.K * self.delta - self.r) / self.tau
'''
OWN_SHIP = """
name = "own-ship"
title = "A ship of the user's own"

[particulars]
L = { value = 45.0, unit = "m", source = "assumed" }
speed = { value = 10.0, unit = "kn", source = "assumed" }
delta_max = { value = 30.0, unit = "deg", source = "assumed" }
delta_rate = { value = 10.0, unit = "deg/s", source = "assumed" }

[yaw]
K = { value = 0.3, unit = "1/s", source = "assumed" }
tau = { value = 20.0, unit = "s", source = "assumed" }

[nomoto]
K = { value = 0.3, unit = "1/s", source = "assumed" }
tau = { value = 20.0, unit = "s", source = "assumed" }

[de-keizer]
K = { value = 1.2, unit = "1", source = "assumed" }
tau = { value = 0.9, unit = "1", source = "assumed" }
alpha1 = { value = 1.0, unit = "1", source = "assumed" }
alpha3 = { value = 0.0, unit = "1", source = "assumed" }
gamma = { value = 0.4, unit = "1", source = "assumed" }
K_u = { value = 0.8, unit = "1", source = "assumed" }
tau_u = { value = 2.0, unit = "1", source = "assumed" }
"""


@dataclass(frozen=True)
class Answer:
    """What a command answered."""

    code: int
    out: str
    err: str

    @property
    def said_out(self) -> str:
        """stdout as one line."""
        return " ".join(self.out.split())

    @property
    def said(self) -> str:
        """stderr as one line."""
        return " ".join(self.err.split())


@pytest.fixture
def call(capsys) -> Callable[..., Answer]:
    """Run the command line in this process."""

    def command(*arguments: object) -> Answer:
        capsys.readouterr()
        code = run([str(a) for a in arguments])
        return Answer(code, *capsys.readouterr())

    return command


@pytest.fixture
def refused(call) -> Callable[..., str]:
    """Run a command that has to fail: one paragraph on stderr with these words, nothing on stdout."""

    def command(code: int, arguments: list[object], *words: str) -> str:
        answer = call(*arguments)
        assert answer.code == code, answer
        assert answer.out == ""
        assert answer.err.startswith("shipid: ")
        assert "\n\n" not in answer.err.strip()
        assert answer.err.count("shipid: ") == 1
        assert answer.said.endswith((".", "?"))
        for foul in ("Traceback", "a fault in shipid", "Warning:"):
            assert foul not in answer.err
        for word in words:
            assert word in answer.said, answer.said
        return answer.said

    return command


@pytest.fixture(scope="session")
def zigzag(tmp_path_factory) -> Path:
    """A simulated zig-zag of the Zeefakkel with sensor noise."""
    path = tmp_path_factory.mktemp("trials") / "zigzag.csv"
    arguments = ["--manoeuvre", "zigzag:20/20", "--noise", "standard", "-o", str(path)]
    assert run(["simulate", "nomoto", "--ship", "zeefakkel", *arguments]) == 0
    return path


@pytest.fixture(scope="session")
def short(zigzag, tmp_path_factory) -> Path:
    """Its first 100 s, for what does not depend on how well a coefficient is determined; the fit takes half of the time."""
    path = tmp_path_factory.mktemp("short") / zigzag.name
    path.write_text("\n".join(zigzag.read_text().splitlines()[:502]) + "\n")
    return path


@pytest.fixture
def changed(zigzag, tmp_path):
    """Write the zig-zag with its header and rows changed."""

    def write(rows=lambda rows: rows, header=lambda header: header, name: str = "log.csv") -> Path:
        lines = zigzag.read_text().splitlines()
        path = tmp_path / name
        path.write_text("\n".join([header(lines[1]), *rows(lines[2:])]) + "\n")
        return path

    return write


@pytest.fixture
def column():
    """Change one column of rows of text: ``column("psi", lambda value, row: ...)``."""
    at = {name: i for i, name in enumerate(("t", "x", "y", "psi", "u", "r", "delta", "delta_order"))}

    def change(name: str, new: Callable[[str, int], str]) -> Callable[[list[str]], list[str]]:
        def rows(lines: list[str]) -> list[str]:
            cells = [line.split(",") for line in lines]
            for k, row in enumerate(cells):
                row[at[name]] = new(row[at[name]], k)
            return [",".join(row) for row in cells]

        return rows

    return change


@pytest.fixture
def own(tmp_path) -> Callable[..., Path]:
    """Write a file of the user's own, a model or a parameter set, with pieces of its text replaced."""

    def write(text: str, name: str, replacements: tuple[tuple[str, str], ...]) -> Path:
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.fixture
def own_model(own) -> Callable[..., Path]:
    """Write the model file; its text may be replaced as a whole."""
    return lambda *replacements, text=OWN_MODEL: own(text, "own_model.py", replacements)


@pytest.fixture
def own_ship(own) -> Callable[..., Path]:
    """Write the parameter set."""
    return lambda *replacements: own(OWN_SHIP, "own_ship.toml", replacements)


@pytest.fixture
def undrawn() -> Iterator[None]:
    """Pages without their figures, most of what a page costs: for what is written where and when, not for what a page shows."""
    with svg.collected():
        yield


@pytest.fixture
def fitted() -> tuple[str, ...]:
    """The quickest good options of ``identify`` for the zig-zag."""
    return ("--model", "nomoto", "--ship", "zeefakkel", "--starts", "1")


#: What a float looks like that nobody rounded, and words of libraries.
_RAW = {
    "not a number": re.compile(r"(?<![\w-])(?:nan|NaN|[-−]?inf)(?![\w-])"),
    "a signed zero": re.compile(r"(?<![\w.,)\]])[-−]0(?:\.0+)?(?![\w.])"),
    "a zero by rounding": re.compile(r"\d[eE]-(?:1[3-9]|[2-9]\d)(?!\d)"),
    "a word of a library": re.compile(r"\b(?:[fgx]tol|float64|np\.\w+|array\(|dtype|Traceback|<class|lambda)"),
}  # fmt: skip
_DECIMAL = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.]*\d)")
_DRAWN = re.compile(r"<(svg|style|script|math)\b.*?</\1>", re.DOTALL)
#: Most significant digits: a value is printed to the second digit of its standard deviation, and that is seven at most.
_MOST_DIGITS = 7


def _visible(page: str) -> str:
    """The words of a page, without its drawings and equations."""
    return unescape(re.sub(r"<[^>]*>", " ", _DRAWN.sub(" ", page)))


def _raw_numbers(text: str) -> Iterator[str]:
    """What in a text is no number for a reader, each with some of what stands around it."""
    for what, pattern in _RAW.items():
        for hit in pattern.finditer(text):
            yield f"{what}: {text[max(0, hit.start() - 40) : hit.end() + 20]!r}"
    for hit in _DECIMAL.finditer(text):
        if len(hit.group().replace(".", "").lstrip("0")) > _MOST_DIGITS:
            yield f"too many digits: {text[max(0, hit.start() - 40) : hit.end() + 20]!r}"


@pytest.fixture(scope="session")
def raw_numbers() -> Callable[[str], list[str]]:
    """Find what in a text, or in the words of a page, is no number for a reader."""
    return lambda text: list(_raw_numbers(_visible(text) if text.startswith("<!") else text))
