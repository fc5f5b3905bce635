"""The report in a real browser: what it tells when asked, on every screen, and on paper."""

import base64
import contextlib
import re
import shutil

import numpy as np
import pytest

from gonio.directions import paper_angles_deg
from gonio.materials import MeasuredTable
from gonio.report import write_report
from tests.gonio.report.conftest import make_measured, make_small
from tests.gonio.watch.browser import Page

pytestmark = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")

BY_ID = "document.getElementById('{}')"
MAP = BY_ID.format("map")
AT = f"""(() => {{{{ const map = {MAP}; map.scrollIntoView();
  const at = new DOMPoint({{1}} + .5, {{0}} + .5).matrixTransform(map.getScreenCTM());
  return [at.x, at.y]; }}}})()"""
TEXT = BY_ID + ".textContent"
ROWS = """Array.from(document.querySelectorAll("#values tr"),
  row => Array.from(row.cells, cell => cell.textContent))"""
PRESS = BY_ID + ".dispatchEvent(new KeyboardEvent('keydown', {{ key: '{}' }}))"
LAYERS = """Array.from(document.querySelectorAll('input[name="layer"]'), input => {
  input.click();
  const [picture, caption, unsure] = ["map-picture", "map-caption", "unsure"].map(id =>
    document.getElementById(id));
  return [picture.getAttribute("href"), caption.textContent, unsure.hidden]; })"""
SHAPE = "document.querySelector('{}').getAttribute('{}')"
OVERFLOW = "document.documentElement.scrollWidth - innerWidth"
PAIRS = {"filled in": (40, 17), "at the rim": (80, 80), "at the pole": (0, 0)}


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    session, samples = make_measured(tmp_path_factory.mktemp("browser") / "session")
    with pytest.MonkeyPatch.context() as patched:
        make_small(patched)
        write_report(session.report_path, model=session.model, samples=samples, session=session)
    return session, samples


@pytest.fixture(scope="module")
def page(measured, tmp_path_factory):
    with contextlib.closing(Page(tmp_path_factory.mktemp("profile"))) as page:
        page.look(1200, "light")
        page.ask("Page.navigate", url=measured[0].report_path.as_uri())
        page.until("document.querySelectorAll('#values tr').length === 3")
        yield page
        assert page.complaints == []


def point_at(page, light, view, *, press=False):
    x, y = page.value(AT.format(light, view))
    page.ask("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    for kind in ("mousePressed", "mouseReleased") if press else ():
        page.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)


def spoken(index):
    theta, phi = (angles[index] for angles in paper_angles_deg())
    return f"θ {theta:g}°" + (f", φ {phi:g}°" if theta else "")


def with_sigma(value, sigma):
    digits = max(1 - int(np.floor(np.log10(sigma))), 0)
    return f"{value:.{digits}f} ±\N{NO-BREAK SPACE}{sigma:.{digits}f}"


@pytest.mark.parametrize("case", PAIRS)
def test_pointing_tells_the_pair_and_its_value(page, measured, case):
    light, view = PAIRS[case]
    point_at(page, light, view)
    assert page.value(TEXT.format("pair")) == f"Light {spoken(light)}; view {spoken(view)}"
    assert page.value(TEXT.format("pair-kind")) == "filled in"
    rows = page.value(ROWS)
    with np.load(measured[0].model / "grid.npz") as grid:
        told = grid["values"][light, view].astype(float), grid["sigma"][light, view].astype(float)
        low = grid["lo"][light, view].astype(float)
    truth = MeasuredTable.load(measured[0].truth_path).values[light, view]
    for row, name, value, sigma, least, true in zip(rows, "rgb", *told, low, truth, strict=True):
        assert row[:2] == [name, with_sigma(value, sigma)]
        digits = len(row[1].partition(" ")[0].partition(".")[2])
        assert row[2].startswith(f"{least:.{digits}f} to\N{NO-BREAK SPACE}")
        assert float(row[3]) == pytest.approx(true, abs=0.51 * 10.0**-digits)


def test_a_measured_pair_says_what_was_measured(page, measured):
    _, samples = measured
    data = page.value("JSON.parse(document.getElementById('data').textContent).samples.pair")
    pairs = np.frombuffer(base64.b64decode(data), "<u2")
    light, view = divmod(int(pairs[3]), 81)
    point_at(page, light, view)
    assert page.value(TEXT.format("pair-kind")) == "measured"
    value, sigma = samples.value[3], samples.sigma[3]
    expected = [with_sigma(*each) for each in zip(value, sigma, strict=True)]
    assert [row[3] for row in page.value(ROWS)] == expected


def test_a_click_and_keys_choose_a_light_and_its_lobe_is_shown(page):
    drawings = []
    for choose in (
        lambda: point_at(page, 30, 40, press=True),
        lambda: page.value(PRESS.format("map", "ArrowDown")),
        lambda: page.value(PRESS.format("lights", "ArrowRight")),
    ):
        choose()
        place = int(page.value(SHAPE.format("#map-row", "y")))
        told = page.value(TEXT.format("slice-told"))
        assert told.startswith(f"Light {spoken(place)}.")
        drawings.append((place, page.value(SHAPE.format("#slice .mean", "d"))))
    assert [place for place, _ in drawings] == [30, 31, 32]
    assert len({drawing for _, drawing in drawings}) == 3


def test_the_lobe_turns_and_the_scale_is_chosen(page):
    def seen():
        return page.value(SHAPE.format("#lobe polygon", "points"))

    shapes = [seen()]
    for act in (
        PRESS.format("lobe", "ArrowLeft"),
        "document.querySelector('input[name=\"scale\"]:not(:checked)').click()",
    ):
        page.value(act)
        shapes.append(seen())
    assert len(set(shapes)) == 3
    assert "NaN" not in "".join(shapes)


def test_each_layer_of_the_map_is_shown_when_chosen(page):
    pictures, captions, hidden = zip(*page.value(LAYERS), strict=True)
    assert len(set(pictures)) == 5
    assert len(set(captions)) == 4  # that of the truth is that of the reconstruction
    assert hidden == (True, False, True, True, True)


@pytest.mark.parametrize(("width", "scheme"), [(400, "light"), (1200, "dark")])
def test_nothing_is_wider_than_the_screen(page, width, scheme):
    assert page.look(width, scheme).startswith(b"\x89PNG")
    assert page.value(OVERFLOW) <= 0


def test_it_prints(page):
    printed = base64.b64decode(page.ask("Page.printToPDF", preferCSSPageSize=True)["data"])
    assert printed.startswith(b"%PDF")
    assert 3 <= len(re.findall(rb"/Type\s*/Page\b", printed)) <= 8
