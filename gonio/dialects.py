"""Command sets of lamp heads, as data: what is sent for what, and what error codes mean."""

from __future__ import annotations

import string
from typing import Annotated, Literal

from pydantic import AfterValidator

from gonio.validation import Document, load_named

BUILT_IN = ("lamps-1",)

_REMEDY = "compare it with docs/topics/drivers.md"


def _of(*names: str) -> AfterValidator:
    """Make the annotation of a command in which each of these is named, and nothing else."""

    def check_names(text: str) -> str:
        if not text.isascii() or "\n" in text:
            raise ValueError("commands are one line of ASCII")
        try:
            found = {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}
        except ValueError as error:
            raise ValueError(f"{text!r}: {error}") from None
        if found != set(names):
            wanted = ", ".join(f"{{{name}}}" for name in names) or "nothing in braces"
            raise ValueError(f"{text!r} must name {wanted}, no more and no less")
        return text

    return AfterValidator(check_names)


Plain = Annotated[str, _of()]
OfLamp = Annotated[str, _of("n")]


class HeadError(Document):
    """What an error code means, and what a person can do about it."""

    words: str
    remedy: str


class Dialect(Document):
    """What a lamp head understands.

    Attributes
    ----------
    framing
        `numbered-xor`: requests carry a number and a checksum, and answers repeat them, as
        lamps-1 does; `plain`: neither, so that a late answer cannot be told from the next one.
    identify, ..., next_error
        Commands. Those that set something are answered with OK; `exposure` with OPEN, DONE or IDLE,
        the frame's number and the mean fluxes; `next_error` with a code and a text; the others
        with a number.
    busy, garbled
        Codes that say: ask again.
    errors
        What other codes mean.
    """

    framing: Literal["numbered-xor", "plain"]
    identify: Plain
    set_current: Annotated[str, _of("n", "mA")]
    current: OfLamp
    switch_on: OfLamp
    switch_off: OfLamp
    is_on: OfLamp
    temperature: OfLamp
    flux: OfLamp
    all_off: Plain
    expose: Annotated[str, _of("us")]
    exposure: Plain
    abort: Plain
    watchdog: Annotated[str, _of("ms")]
    next_error: Plain
    busy: int
    garbled: tuple[int, ...]
    errors: dict[int, HeadError]


def load_dialect(name: str) -> Dialect:
    """Return a built-in command set, or one of a file that ends in .toml.

    Errors as for `gonio.validation.load_named`.
    """
    return load_named(Dialect, name, BUILT_IN, "lamp dialect", _REMEDY)
