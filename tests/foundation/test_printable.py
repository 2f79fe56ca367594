"""What came out of a file cannot steer a terminal."""

import json

import pytest

from shipid.cli.frame import messages
from shipid.foundation.errors import ShipidError, UnknownNameError
from shipid.foundation.printable import escaped, printable

STEERING = ["\x00", "\x1b[31m", "\x07", "\x7f", "\x9b2J", "\r", "\u202e", "\u2066", "\u2028", "\ud800", "\ufeff"]


@pytest.mark.parametrize("steering", STEERING)
def test_what_steers_a_terminal_is_replaced(steering: str) -> None:
    assert printable(f"a{steering}b\tc\n") == f"a?{steering[1:]}b\tc\n"
    assert json.loads(escaped(json.dumps(f"a{steering}b", ensure_ascii=False))) == f"a{steering}b"
    assert steering[0] not in escaped(json.dumps(f"a{steering}b", ensure_ascii=False))


@pytest.mark.parametrize("text", ["psi [°]", "Δψ = −3,5 m·s⁻¹", "舵角", "naïve\tline\n"])
def test_what_is_printed_stays(text: str) -> None:
    assert printable(text) == text and escaped(text) == text


@pytest.mark.parametrize("steering", STEERING)
def test_messages_and_what_is_said_are_clean(steering: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert steering[0] not in str(ShipidError(f"column '{steering}'"))
    assert steering[0] not in str(UnknownNameError("column", steering, ["psi"]))
    messages.say(f"column '{steering}'")
    assert steering[0] not in capsys.readouterr().err
