import re
from html.parser import HTMLParser

import numpy as np
import pytest

from gonio.errors import BadFileError, StorageError
from gonio.materials import MeasuredTable
from gonio.report import write_report
from gonio.report.summary import NOT_KNOWN
from gonio.samples import Samples

HOSTILE = '<script>alert("1")</script> & <img src=http://evil.test/x.png> {{ 7 * 7 }} $\\foo'
MOST_BYTES = 3_000_000
VOID = {"meta", "img", "br", "link", "input"}


class Page(HTMLParser):
    """Tags with their attributes, and all text outside of style."""

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
        if "style" not in self._open and data.strip():
            self.lines.append(data.strip())

    @property
    def text(self):
        return "\n".join(self.lines)

    def values(self, *names):
        return [value for _, attrs in self.tags for name, value in attrs.items() if name in names]


@pytest.fixture(autouse=True)
def small_spheres(monkeypatch):
    monkeypatch.setattr("gonio.report.spheres._SIZE_PX", 16)


def report(measured, **changes):
    session, samples = measured
    arguments = {"model": session.model, "samples": samples, "session": session} | changes
    summary = write_report(session.report_path, **arguments)
    text = session.report_path.read_text()
    assert len(text) < MOST_BYTES
    check_alone(text)
    return Page(text), summary


def check_alone(text):
    """Nothing is fetched, nothing runs, and what refers within the page finds its place."""
    page = Page(text)
    names = {tag for tag, _ in page.tags}
    assert not names & {"script", "link", "iframe", "object", "embed", "base", "form"}
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


KINDS = {
    "with truth": {},
    "without truth": {"truth": False},
    "one channel": {"channels": ("y",)},
    "one channel, without truth": {"channels": ("y",), "truth": False},
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_stands_alone(measure, kind):
    page, summary = report(measure(**KINDS[kind]))
    assert page.tags[0][0] == "html"
    for name, eps8, male in summary.rows():
        assert {name.strip(), eps8, male} <= {*page.lines, ""}
    titles = [line for line in page.lines if line in ("Truth", "Reconstruction")]
    assert titles == (["Reconstruction"] if "without" in kind else ["Reconstruction", "Truth"])
    assert (NOT_KNOWN in page.text) == ("without" in kind)


def test_the_truth_is_read_once(measure, monkeypatch):
    measured, read = measure(), []
    load = MeasuredTable.load
    monkeypatch.setattr(MeasuredTable, "load", lambda path: read.append(path) or load(path))
    report(measured)
    assert read == [measured.session.truth_path]


def test_a_truth_that_cannot_be_read_costs_no_report(measure, caplog):
    measured = measure()
    measured.session.truth_path.write_bytes(b"no archive")
    page, summary = report(measured)
    assert (summary.error, "Truth" in page.lines) == (None, False)
    (warning,) = caplog.messages
    assert "truth.npz: is not a table" in warning


def test_it_names_what_it_was_made_from(measure):
    measured = measure()
    page, _ = report(measured)
    session = measured.session
    for digest in (session.chain()[0].sha256, session.rig().sha256):
        assert digest in page.text
    for name in ("samples.nc", "model.json", "weights.safetensors", "grid.npz"):
        assert name in page.lines
    assert "oak, unvarnished" in page.text
    assert "1:02:03" in page.text
    assert "4 chosen of 81" in page.text


def test_a_hostile_name_is_only_a_name(measure):
    measured = measure(name=HOSTILE, channels=("<i>", "$\\bar{", "http://evil.test"))
    page, _ = report(measured)
    assert page.text.count(HOSTILE) == 3  # title, heading, operator
    assert ("i", {}) not in page.tags
    assert "<i>, $\\bar{, http://evil.test" in page.text


def test_a_name_that_is_no_text_is_written_all_the_same(measure):
    page, _ = report(measure(name="oak \udcff"))
    assert "oak \\udcff" in page.text


def test_without_history_there_is_no_curve(measure):
    measured = measure(truth=False)
    with_curve, _ = report(measured)
    (measured.session.model / "history.npz").unlink()
    without, _ = report(measured)
    assert "Loss against training time" in with_curve.lines
    assert "Loss against training time" not in without.lines


def test_a_table_from_elsewhere_needs_no_session(measure):
    page, summary = report(measure(), session=None)
    assert summary.error is None
    assert "Material from a table of samples" in page.text
    assert "chosen of" not in page.text
    assert "4 directions" in page.text


FLAGS = {
    "none": ((), "No value is flagged."),
    "clipped and faint": ((1, 2), "2 of 48"),
}


@pytest.mark.parametrize("case", FLAGS)
def test_flags_are_counted(measure, case):
    bits, expected = FLAGS[case]
    measured = measure()
    measured.samples.flag[2, :2] = sum(bits)
    page, _ = report(measured)
    assert expected in page.text
    assert ("faint" in page.lines) == (2 in bits)


def test_the_full_set_stays_small(measure):
    measured = measure(truth=False)
    rng = np.random.default_rng(1)
    z, phi = rng.uniform(0.2, 1, (2, 6561)), rng.uniform(0, 2 * np.pi, (2, 6561))
    x, y = np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi)
    light, view = np.stack([x, y, z], axis=-1)
    many = Samples.from_values(light, view, rng.lognormal(-2, 0.4, (6561, 3)))
    _, summary = report(measured, samples=many)
    assert summary.share == 1


def test_one_report_of_one_model_is_equal_to_the_bit(measure):
    measured = measure()
    report(measured)
    first = measured.session.report_path.read_bytes()
    report(measured)
    assert measured.session.report_path.read_bytes() == first


def test_a_page_that_cannot_be_written_is_one_line(measure):
    session, samples = measure()
    blocked = session.root / "rig.toml" / "report.html"
    with pytest.raises(StorageError, match=r"report\.html"):
        write_report(blocked, model=session.model, samples=samples)


def test_a_folder_without_a_model_is_named(measure):
    session, samples = measure()
    with pytest.raises(BadFileError, match="is not a model"):
        write_report(session.report_path, model=session.raw, samples=samples)
    assert not session.report_path.exists()
