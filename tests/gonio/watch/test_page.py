"""The page in a real browser: its pictures, its buttons, and that nothing is complained of."""

import contextlib
import shutil

import pytest

from tests.gonio.watch.browser import Page

pytestmark = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")

CLICK = "(b => b && !b.disabled && (b.click(), true))(document.getElementById('{}'))"
PHASE = "document.getElementById('phase')?.textContent === '{}'"
WIDTH = "document.getElementById('{}').naturalWidth"
OVERFLOW = "document.documentElement.scrollWidth - innerWidth"


def test_the_page_pauses_goes_on_and_shows_frame_and_estimate(begin, tmp_path):
    with contextlib.closing(Page(tmp_path)) as page, begin("seen") as (capture, watcher):
        page.ask("Page.navigate", url=watcher.server.access.url)
        page.until(CLICK.format("pause"))
        page.until(PHASE.format("paused"))
        assert page.value("document.querySelectorAll('#view circle.n').length") == 1
        page.until(CLICK.format("resume"))
        assert page.until(WIDTH.format("frame")) == 80
        page.until(PHASE.format("finished"))
        assert page.until(WIDTH.format("fit")) == 72
        assert "uncertainty" in page.value("document.getElementById('fit-note').textContent")
        assert capture.wait(60) == 0
        for width in (400, 1200):
            assert page.look(width, "dark").startswith(b"\x89PNG")
            assert page.value(OVERFLOW) <= 0
        assert page.complaints == []
