"""Which renderer makes the pictures, and why."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Final, NamedTuple

from gonio.errors import MissingExtraError

RENDERERS: Final = ("auto", "own", "mitsuba")
"""What a person may ask for."""
_TITLES: Final = {"own": "own direct light", "mitsuba": "Mitsuba 3"}


class Renderer(NamedTuple):
    """A renderer.

    Attributes
    ----------
    name
        `own` or `mitsuba`.
    why
        It and no other, in a few words.
    """

    name: str
    why: str

    def __str__(self) -> str:
        return f"renderer: {_TITLES[self.name]} ({self.why})"


def chosen(asked: str) -> Renderer:
    """Return the renderer that was asked for; `auto` takes Mitsuba where it is installed.

    Raises
    ------
    gonio.errors.MissingExtraError
        When Mitsuba was asked for and is not installed.
    """
    # only looked for: to load it takes longer than a small picture
    installed = find_spec("mitsuba") is not None
    if asked == "mitsuba" and not installed:
        raise MissingExtraError("mitsuba", "mitsuba")
    if asked != "auto":
        return Renderer(asked, "as asked")
    if installed:
        return Renderer("mitsuba", "installed; --renderer own is direct light")
    return Renderer("own", "for Mitsuba 3: pip install 'gonio[mitsuba]'")
