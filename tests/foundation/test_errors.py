"""What a message offers for a name that is not known."""

from shipid.foundation.errors import nearest


def test_a_name_that_several_models_have_is_offered_once():
    assert nearest("zzz", ["L", "K", "L", "L"]) == "Known: K, L. "
    assert nearest("tua", ["tau", "tau"]) == "Did you mean tau? "
