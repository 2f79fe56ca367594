from __future__ import annotations

import dataclasses
import html.parser
import re

import numpy as np
import pytest

import shipid
from shipid.report.figures import svg


class Page(html.parser.HTMLParser):
    """Text, tags and attributes of a page; void and foreign elements aside, every element has to be closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(n, v or "") for n, v in attrs]
        if tag not in ("meta", "br", "link"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(n, v or "") for n, v in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, self.getpos()

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)

    @property
    def ids(self) -> list[str]:
        return [v for n, v in self.attributes if n == "id"]

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


def simulate(manoeuvre: str, seed: int, name: str):
    trial = shipid.simulate(shipid.find_model("de-keizer"), "soesterberg", manoeuvre, noise="standard", seed=seed)
    return dataclasses.replace(trial, name=name)


@pytest.fixture
def undrawn():
    """Pages without their figures, most of what a page costs: for the words of a page whose figures are drawn elsewhere."""
    with svg.collected():
        yield


@pytest.fixture(scope="session")
def read_page():
    """Read the HTML of a page."""
    return Page


@pytest.fixture(scope="session")
def criteria(fit):
    """The manoeuvring criteria of the identified model, with few draws."""
    return shipid.manoeuvring_criteria(fit, draws=4)


@pytest.fixture(scope="session")
def fit():
    """A simulated ship identified from one trial, with another kept apart."""
    found = shipid.identify(
        "de-keizer",
        [simulate("zigzag:20/20", 1, "first")],
        ship="soesterberg",
        validate=[simulate("zigzag:10/10", 2, "second")],
        starts=1,
    )
    return shipid.assess(found)


@pytest.fixture(scope="session")
def diverged(fit):
    """The same, not converged, with a prediction that runs to infinity and a coefficient that does."""
    kept = fit.validation[0]
    bad = {n: p.copy() for n, p in kept.predicted.items()}
    n = len(kept.trial)
    bad["psi"][n // 2 :] *= np.exp(np.minimum(np.arange(n - n // 2), 600.0))
    bad["r"][-50:] = np.inf
    bad["u"][-50:] = np.nan
    lost = dataclasses.replace(
        kept,
        predicted=bad,
        rmse=dict.fromkeys(kept.rmse, float("inf")),
        refitted=dict.fromkeys(kept.rmse, float("nan")),
        refitted_bias=float("nan"),
        predicted_overshoots=(None, float("nan"), float("inf")),
    )
    parameters = dict(fit.parameters)
    parameters["tau"] = dataclasses.replace(
        parameters["tau"], value=None, std=None, ci95=None, standing="not determined", why="it runs away.", prime=None
    )
    return dataclasses.replace(
        fit,
        converged=False,
        message="the search gave up.",
        parameters=parameters,
        validation=(lost,),
        condition_number=None,
        chi_square=float("inf"),
        noise=dict.fromkeys(fit.noise, float("nan")),
        correlation=np.full_like(fit.correlation, np.nan),
    )
