"""A shell completes commands, options, models, ships, manoeuvres and files."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from click.shell_completion import ShellComplete

from shipid.cli import main
from shipid.cli.frame import completing
from shipid.parameters.catalogue import known_models, known_ships
from shipid.trials.manoeuvres.manoeuvre import KINDS, parse_manoeuvre


def offered(*words: str) -> list[tuple[str, str]]:
    *args, incomplete = words
    found = ShellComplete(main, {}, "shipid", "_SHIPID_COMPLETE").get_completions(list(args), incomplete)
    return [(item.type, item.value) for item in found]


def test_what_is_offered():
    assert ("plain", "simulate") in offered("sim")
    assert offered("simulate", "norr") == [("plain", "norrbin")]
    assert offered("simulate", "norrbin", "--ship", "zee") == [("plain", "zeefakkel")]
    assert offered("simulate", "norrbin", "--manoeuvre", "turn") == [("plain", "turn:35")]
    assert offered("compare", "t.csv", "--models", "nomoto,norr") == [("plain", "nomoto,norrbin")]
    assert ("plain", "soesterberg") in offered("show", "soest")
    assert offered("identify", "tri") == [("file", "tri")]
    assert offered("simulate", "my/mod") == [("file", "my/mod")]
    assert ("plain", "--manoeuvre") in offered("simulate", "norrbin", "--man")


def test_names_are_those_that_there_are():
    """Read from the text of files, without importing a model."""
    assert completing.model_names() == sorted(known_models())
    assert completing.ship_names() == sorted(known_ships())
    assert {k.rstrip(":") for k in completing.MANOEUVRES} == set(KINDS)
    for examples in completing.MANOEUVRES.values():
        assert all(parse_manoeuvre(e) for e in examples)


@pytest.mark.parametrize(
    ("shell", "word"), [("bash", "complete -o"), ("zsh", "compdef"), ("fish", "complete --no-files")]
)
def test_the_script_of_each_shell(call, shell, word):
    answer = call("completion", shell)
    assert answer.code == 0 and word in answer.out and f"_SHIPID_COMPLETE={shell}_complete" in answer.out


def test_a_colon_does_not_end_a_word_in_bash(call):
    """'zigzag:2' is completed to 'zigzag:20/20'."""
    assert call("completion", "bash").out.rstrip().endswith("COMP_WORDBREAKS=${COMP_WORDBREAKS//:/}")


def test_another_shell_is_refused(refused):
    refused(2, ["completion", "tcsh"], "'tcsh' is not one of 'bash', 'zsh', 'fish'")


def test_a_shell_is_answered_without_anything_numeric():
    """As bash asks; what is imported for it is told by the interpreter."""
    asked = os.environ | {
        "_SHIPID_COMPLETE": "bash_complete",
        "COMP_WORDS": "shipid tune de-keizer --ship zee",
        "COMP_CWORD": "4",
    }
    found = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "shipid"], env=asked, capture_output=True, text=True, check=False
    )
    assert found.stdout.split() == ["plain,zeefakkel"]
    assert not {"numpy", "casadi", "pandas"} & {line.rpartition("|")[2].strip() for line in found.stderr.splitlines()}
