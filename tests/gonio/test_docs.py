"""The documentation: pages that are made of the program, and that no page is lost."""

import importlib.util
import re
from pathlib import Path

import pytest

from gonio import errors
from gonio.cli._main import COMMANDS

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def generated():
    spec = importlib.util.spec_from_file_location("generated", DOCS / "generated.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_catalogue_has_every_error_with_advice_of_its_own(generated):
    told = generated.catalogue()
    kinds = [each for each in vars(errors).values() if isinstance(each, type)]
    for error in kinds:
        assert f"## {error.__name__}\n" in told
        assert "advice" in vars(error), error
        assert error.advice in told
        assert f"Exit code {error.exit_code}" in told
    assert len({error.advice for error in kinds}) == len(kinds) > 10


def test_the_reference_has_every_command(generated):
    told = generated.commands()
    for name in COMMANDS:
        assert f"\n## gonio {name}\n" in told
    assert "\n### gonio study shots\n" in told
    assert "--rehearse" in told


def test_every_page_has_its_place():
    pages = {str(path.relative_to(DOCS))[:-3] for path in DOCS.rglob("*.md")}
    pages |= {"reference/commands", "reference/errors"}  # made with the site
    placed = {"index"} | {page for page in pages if page.startswith("decisions/")}
    for listing in ("index.md", "reference/files.md"):
        for line in re.findall(r"^[./\w-]+$", (DOCS / listing).read_text(), re.MULTILINE):
            placed.add(line.removeprefix("../"))
    assert pages <= placed
