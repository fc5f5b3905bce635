"""Which renderer is taken, and that a person is told."""

import json
import sys
from importlib.machinery import ModuleSpec

import pytest
from click.testing import CliRunner

from gonio.cli.render import command
from gonio.errors import MissingExtraError
from gonio.render import renderers
from gonio.render.renderers import chosen
from gonio.render.traced import Traced


@pytest.fixture
def without(monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)


def test_mitsuba_is_taken_where_it_is_installed(monkeypatch):
    monkeypatch.setattr(renderers, "find_spec", lambda name: ModuleSpec(name, None))
    assert chosen("auto").name == chosen("mitsuba").name == "mitsuba"
    assert chosen("own").name == "own"


@pytest.mark.usefixtures("without")
def test_our_own_is_taken_where_it_is_not():
    assert chosen("auto").name == chosen("own").name == "own"


@pytest.mark.usefixtures("without")
def test_what_is_not_installed_cannot_be_asked_for():
    for ask in (lambda: chosen("mitsuba"), lambda: Traced.of({})):
        with pytest.raises(MissingExtraError, match=r"needs mitsuba.*gonio\[mitsuba\]"):
            ask()


def rendered(*arguments):
    quick = ("velvet", "--size", "16", "--lights", "24", "--shape", "sphere", "--json")
    result = CliRunner().invoke(command, [*quick, *map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)["renderer"], result.stderr


@pytest.mark.usefixtures("without")
def test_the_line_says_how_to_get_mitsuba(tmp_path):
    name, said = rendered("-o", tmp_path)
    assert name == "own"
    assert "own direct light (for Mitsuba 3: pip install 'gonio[mitsuba]')" in said


def test_a_sheet_by_mitsuba(tmp_path):
    pytest.importorskip("mitsuba")
    name, said = rendered("-o", tmp_path)
    assert name == "mitsuba"
    assert "renderer: Mitsuba 3 (installed" in said
    assert (tmp_path / "velvet-sphere.exr").is_file()
