"""Sentences about a result, with their kind."""

import copy
import json
import pickle

from shipid.foundation.notices import NOTE, Notice, notice_of, plain_notices

NOTICE = Notice("The noise of psi does not fit.", "noise-does-not-fit", serious=True, signal="psi", rejected=0.6)


def test_a_notice_is_its_sentence():
    assert NOTICE == "The noise of psi does not fit."
    assert f"  {NOTICE}" == "  The noise of psi does not fit."


def test_its_plain_form():
    assert list(NOTICE.to_dict().items()) == [
        ("kind", "noise-does-not-fit"),
        ("serious", True),
        ("message", "The noise of psi does not fit."),
        ("signal", "psi"),
        ("rejected", 0.6),
    ]
    plain = plain_notices(["A sentence.", NOTICE])
    assert plain[0] == {"kind": NOTE, "serious": False, "message": "A sentence."}
    assert json.loads(json.dumps(plain)) == plain


def test_a_notice_about_something_keeps_its_kind():
    told = NOTICE.about("a.toml")
    assert told == "a.toml: The noise of psi does not fit."
    assert (told.kind, told.serious, told.known["subject"]) == ("noise-does-not-fit", True, "a.toml")
    assert notice_of("plain").about("b").kind == NOTE


def test_it_can_be_copied_and_sent_to_another_process():
    for one in (copy.deepcopy(NOTICE), pickle.loads(pickle.dumps(NOTICE))):
        assert one.to_dict() == NOTICE.to_dict()
