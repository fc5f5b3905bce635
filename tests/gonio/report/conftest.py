import re
from functools import partial
from html.parser import HTMLParser
from typing import NamedTuple

import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.directions import from_degrees
from gonio.materials import MeasuredTable
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text
from gonio.samples import Samples
from gonio.session import Session
from nnbrdf.paper import PaperEstimator
from nnbrdf.prior import MaterialPrior
from planner.make import make_plan


class Measured(NamedTuple):
    session: Session
    samples: Samples


VOID = {"meta", "img", "br", "link", "input"}


class Page(HTMLParser):
    """Tags with their attributes, and all text outside of style and scripts."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.lines, self._open = [], [], []
        self.feed(text)
        assert not self._open

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        if not {"style", "script"} & set(self._open) and data.strip():
            self.lines.append(data.strip())

    @property
    def text(self):
        return "\n".join(self.lines)

    def values(self, *names):
        return [value for _, attrs in self.tags for name, value in attrs.items() if name in names]


@pytest.fixture
def standalone():
    """Parse a page of which nothing is fetched, and what refers finds its place."""
    return check_alone


def check_alone(text, scripts=()):
    """Nothing is fetched, nothing runs but what is told, and what refers finds its place."""
    page = Page(text)
    names = {tag for tag, _ in page.tags}
    assert not names & {"link", "iframe", "object", "embed", "base", "form"}
    assert [attrs for tag, attrs in page.tags if tag == "script"] == list(scripts)
    assert not [name for _, attrs in page.tags for name in attrs if name.startswith("on")]
    assert all(value.startswith("data:image/png;base64,") for value in page.values("src"))
    links = page.values("href", "xlink:href")
    inside = [link for link in links if not link.startswith("data:image/png;base64,")]
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    within = re.findall(r"url\(([^)]*)\)", text)
    assert {link.removeprefix("#") for link in [*inside, *within]} <= set(ids)
    assert "@import" not in text
    assert not re.search(r"<[^>]*https?://", text)
    return page


REPORT_SCRIPTS = ({"type": "application/json", "id": "data"}, {})


@pytest.fixture
def small_pictures(monkeypatch):
    """Do what `make_small` does."""
    make_small(monkeypatch)


def make_small(monkeypatch):
    """Make the pictures of reports small, and what fewer shots are judged by quick."""
    few = MaterialPrior.generate(examples=10)
    monkeypatch.setattr("gonio.report.content._generated", lambda: few)
    monkeypatch.setattr("gonio.report.renders._SIZE_PX", 16)
    monkeypatch.setattr("gonio.report.renders._LIGHTS", 4)
    monkeypatch.setattr("gonio.report.renders._SHAPES", ("sphere",))


def a_truth(rng):
    return MeasuredTable.of(rng.lognormal(-2.0, 0.5, (81, 81, 3)))


def samples_of(plan, truth, channels):
    light, view = (
        from_degrees(
            [shot.axis_deg(f"{side}_theta") for shot in plan.shots],
            [shot.axis_deg(f"{side}_phi") for shot in plan.shots],
        )
        for side in ("light", "view")
    )
    value = truth.evaluate(light, view)[:, : len(channels)]
    value[0] = -1e-4  # noise about zero
    return Samples.from_values(light, view, value, 0.01 * abs(value), channels)


def make_measured(
    folder, *, channels=("r", "g", "b"), truth=True, name="oak, unvarnished", density=4
):
    """Make a session with samples, a quickly trained model and, unless told, its truth."""
    plan = make_plan(default_rig(), views=density, lights=density)
    notes = Notes(sample=name, orientation="grain", mounting="flat", operator=name)
    session = create_session(folder, plan, default_rig_text(), notes)
    material = a_truth(np.random.default_rng(0))
    if truth:
        material.save(session.truth_path)
    samples = samples_of(plan, material, channels)
    samples.save(session.samples_path)
    PaperEstimator(hidden=(4,), epochs=3).fit(samples).save(session.model)
    session.note_timing("reconstruct", 1.5)
    clock = VirtualClock()
    with session.journal(writing=True) as journal:
        journal.append(clock, "begun")
        clock.sleep(3723)
        journal.append(clock, "finished")
    return Measured(session, samples)


@pytest.fixture
def measure(tmp_path):
    """Make what `make_measured` does."""
    return partial(make_measured, tmp_path / "session")
