"""Finding a campaign: shipped or in a file, and what is said when there is none."""

from __future__ import annotations

import pytest

from shipid.campaign.errors import CampaignDeclarationError
from shipid.campaign.find_campaign import find_campaign, whole
from shipid.foundation.errors import UnknownNameError

FILE = """
import shipid
def throw(rng):
    return {"miss": rng.normal()}
darts = shipid.Campaign("darts", throw, {"miss": shipid.Measure("error", "m")})
"""


@pytest.fixture
def file(tmp_path):
    def write(text: str = FILE):
        path = tmp_path / "study.py"
        path.write_text(text)
        return path

    return write


def test_a_file_with_one_campaign_needs_no_name(file):
    path = file()
    assert whole(find_campaign(str(path))).name == whole(find_campaign(f"{path}:darts")).name == "darts"


def test_a_changed_file_is_another_study(file):
    one = whole(find_campaign(str(file()))).identity
    assert whole(find_campaign(str(file(FILE + "# changed\n")))).identity != one != ""


def test_the_file_may_import_what_lies_beside_it(file, tmp_path):
    (tmp_path / "beside_the_study.py").write_text("HALF = 0.5\n")
    path = file("from beside_the_study import HALF\n" + FILE)
    assert whole(find_campaign(str(path))).name == "darts"


@pytest.mark.parametrize(
    ("text", "name", "error", "words"),
    [
        (FILE, ":arrows", UnknownNameError, "no campaign in .* called 'arrows'"),
        (FILE + "more = darts\n", "", CampaignDeclarationError, "say which campaign"),
        ("x = 1\n", "", CampaignDeclarationError, "declares no campaign"),
        ("x = 1 / 0\n", "", CampaignDeclarationError, "fails in line 1: ZeroDivisionError"),
        ("x = (\n", "", CampaignDeclarationError, "SyntaxError"),
        (
            'import shipid\nshipid.Campaign("a", None, {})\n',
            "",
            CampaignDeclarationError,
            "study.py: campaign a needs run",
        ),
    ],
)
def test_what_is_no_campaign_is_told(file, text, name, error, words):
    with pytest.raises(error, match=words):
        find_campaign(f"{file(text)}{name}")


def test_what_is_not_there_is_told(tmp_path):
    with pytest.raises(UnknownNameError, match=r"path/to/file.py:name"):
        find_campaign("no-such-campaign")
    with pytest.raises(CampaignDeclarationError, match="cannot be read: No such file"):
        find_campaign(str(tmp_path / "none.py"))
