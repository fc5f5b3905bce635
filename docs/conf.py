"""Sphinx configuration: Markdown pages, and the reference from the program and its docstrings."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import generated

from gonio import __version__

project = "gonio"
author = "the gonio authors"
copyright = "the gonio authors"  # noqa: A001
release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
# attributes of named tuples are members as well; named once
napoleon_use_ivar = True
# single backticks in docstrings are names and values
default_role = "literal"
html_theme = "furo"
html_title = "gonio"
exclude_patterns = ["_build"]
autodoc_typehints = "none"
autodoc_member_order = "bysource"
myst_heading_anchors = 3

generated.write(Path(__file__).parent / "reference")
