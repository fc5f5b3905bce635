from dataclasses import replace

import numpy as np
import pytest

from gonio.errors import BadFileError, StorageError
from gonio.materials import MeasuredTable
from gonio.report import write_report
from gonio.report.summary import NOT_KNOWN
from gonio.samples import Samples
from tests.gonio.report.conftest import REPORT_SCRIPTS

HOSTILE = '<script>alert("1")</script> & <img src=http://evil.test/x.png> {{ 7 * 7 }} $\\foo'
MOST_BYTES = 3_000_000


pytestmark = pytest.mark.usefixtures("small_pictures")


@pytest.fixture
def report(standalone):
    """Write the report of what was measured and return its page, checked, and its summary."""

    def write(measured, **changes):
        session, samples = measured
        arguments = {"model": session.model, "samples": samples, "session": session} | changes
        summary = write_report(session.report_path, **arguments)
        text = session.report_path.read_text()
        assert len(text) < MOST_BYTES
        return standalone(text, REPORT_SCRIPTS), summary

    return write


KINDS = {
    "with truth": {},
    "without truth": {"truth": False},
    "one channel": {"channels": ("y",)},
    "one channel, without truth": {"channels": ("y",), "truth": False},
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_stands_alone(report, measure, kind):
    page, summary = report(measure(**KINDS[kind]))
    assert page.tags[0][0] == "html"
    for name, eps8, male in summary.rows():
        assert {name.strip(), eps8, male} <= {*page.lines, ""}
    titles = [line for line in page.lines if line in ("Truth", "Reconstruction")]
    assert titles == (["Reconstruction"] if "without" in kind else ["Reconstruction", "Truth"])
    assert (NOT_KNOWN in page.text) == ("without" in kind)


def test_the_truth_is_read_once(report, measure, monkeypatch):
    measured, read = measure(), []
    load = MeasuredTable.load
    monkeypatch.setattr(MeasuredTable, "load", lambda path: read.append(path) or load(path))
    report(measured)
    assert read == [measured.session.truth_path]


def test_a_truth_that_cannot_be_read_costs_no_report(report, measure, caplog):
    measured = measure()
    measured.session.truth_path.write_bytes(b"no archive")
    page, summary = report(measured)
    assert (summary.error, "Truth" in page.lines) == (None, False)
    (warning,) = caplog.messages
    assert "truth.npz: is not a table" in warning


def test_it_names_what_it_was_made_from(report, measure):
    measured = measure()
    page, _ = report(measured)
    session = measured.session
    for digest in (session.chain().last.sha256, session.rig().sha256):
        assert digest in page.text
    for name in ("samples.nc", "model.json", "weights.safetensors", "grid.npz"):
        assert name in page.lines
    assert "oak, unvarnished" in page.text
    assert page.lines[page.lines.index("rig time") + 1] == "62 min"
    assert "4 chosen of 81" in page.text


def test_a_hostile_name_is_only_a_name(report, measure):
    measured = measure(name=HOSTILE, channels=("<i>", "$\\bar{", "http://evil.test"))
    page, _ = report(measured)
    assert page.text.count(HOSTILE) == 3  # title, heading, operator
    assert ("i", {}) not in page.tags
    assert "<i>, $\\bar{, http://evil.test" in page.text


def test_a_name_that_is_no_text_is_written_all_the_same(report, measure):
    page, _ = report(measure(name="oak \udcff"))
    assert "oak \\udcff" in page.text


def test_without_history_there_is_no_curve(report, measure):
    measured = measure(truth=False)
    with_curve, _ = report(measured)
    (measured.session.model / "history.npz").unlink()
    without, _ = report(measured)
    assert "Loss against training time" in with_curve.lines
    assert "Loss against training time" not in without.lines


def test_a_table_from_elsewhere_needs_no_session(report, measure):
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
def test_flags_are_counted(report, measure, case):
    bits, expected = FLAGS[case]
    measured = measure()
    measured.samples.flag[2, :2] = sum(bits)
    page, _ = report(measured)
    assert expected in page.text
    assert ("faint" in page.lines) == (2 in bits)


def test_the_full_set_stays_small(report, measure):
    measured = measure(truth=False)
    rng = np.random.default_rng(1)
    z, phi = rng.uniform(0.2, 1, (2, 6561)), rng.uniform(0, 2 * np.pi, (2, 6561))
    x, y = np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi)
    light, view = np.stack([x, y, z], axis=-1)
    many = Samples.from_values(light, view, rng.lognormal(-2, 0.4, (6561, 3)))
    _, summary = report(measured, samples=many)
    assert summary.share == 1


def test_one_report_of_one_model_is_equal_to_the_bit(report, measure):
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


def test_the_page_tells_where_sigma_comes_from(report, measure):
    measured = measure()
    sigma = measured.samples.sigma
    parts = {"photon": 0.8 * sigma, "flux": 0.0 * sigma, "reference": 0.6 * sigma}
    page, _ = report(measured, samples=replace(measured.samples, components=parts))
    lines = page.lines[page.lines.index("Where sigma comes from") :]
    shares = {name: lines[lines.index(name) + 1 :][:3:2] for name in ("photon", "reference")}
    assert shares == {"photon": ["64.0 %", "independent"], "reference": ["36.0 %", "common"]}
    assert any("None, since" in line and line.endswith(": flux.") for line in lines)


def test_samples_that_tell_no_components_have_no_such_table(report, measure):
    page, _ = report(measure())
    assert "Where sigma comes from" not in page.lines
