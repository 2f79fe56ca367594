"""The page of a campaign: measures that differ in one word stand beside each other in a figure, counts have no decimals."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from shipid.campaign.campaign import Measure
from shipid.campaign.moments import Statistic
from shipid.campaign.result import CampaignResult, summary
from shipid.foundation.notices import Notice
from shipid.report.write_report import render


def _count(name: str, meaning: str, mean: float) -> Statistic:
    return Statistic(
        name, Measure("count", "1", meaning), 40, 0, mean=mean, std=1.493, low=0.0, high=7.0, mean_interval=(1.02, 1.98)
    )


@pytest.fixture
def found():
    entered = Statistic(
        "entered", Measure("event", "1", "whether it was entered"), 40, 0, mean=0.625, std=0.49, low=0.0, high=1.0,
        mean_interval=(0.47, 0.758),
    )  # fmt: skip
    statistics = {
        s.name: s for s in (_count("one", "entries: raw", 1.5), _count("two", "entries: smooth", 0.8), entered)
    }
    return CampaignResult("darts", 40, 0, 20, statistics, None, {"versions": {"shipid": "1"}})


def test_a_whole_number_has_no_decimals_on_page_and_terminal(found):
    page = render(found)
    row = re.search(r"<tr><th[^>]*>Entries: raw.*?</tr>", page, re.DOTALL).group()
    cells = dict(re.findall(r'data-label="([^"]*)">([^<]*)<', row))
    assert (cells["Standard deviation"], cells["Smallest"], cells["Largest"]) == ("1.5", "0", "7")
    assert "those of counts Garwood's" in page
    assert "standard deviation 1.5, from 0 to 7" in summary(found.statistics["one"])


def test_of_an_event_the_share_says_it_all(found):
    row = re.search(r"<tr><th[^>]*>Whether it was entered.*?</tr>", render(found), re.DOTALL).group()
    assert 'data-label="Largest">–<' in row and "0.470 to 0.758" in row


def test_measures_that_differ_in_one_word_are_drawn_beside_each_other(found):
    page = render(found)
    assert page.count("means with their 95 % intervals") == 2, "a title and a label of one figure"
    words = re.findall(r"<text[^>]*>([^<]*)</text>", page)
    assert {"raw", "smooth", "Entries"} <= set(words)


def test_what_a_page_warns_of_ends_with_a_full_stop(found):
    """Words of the terminal stood in a box of the page without one."""
    warnings = (Notice("the propeller is stopped: no zig-zag does that", "a", serious=True), Notice("It is so.", "b"))
    page = render(replace(found, warnings=warnings))
    assert "no zig-zag does that.</p>" in page and "It is so.</p>" in page
