"""Quantities as a person says them."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def duration(seconds: float) -> str:
    """Say a time as a person would: 42 s, 12 min, 6 h 05 min."""
    if seconds < 100:
        return f"{seconds:.3g} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def size(count: float) -> str:
    """Say a number of bytes as a person would: 30.1 MB."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} TB"


def several(count: int, noun: str) -> str:
    """Say how many there are of something: 1 light, 14 lights."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def told_apart(names: Sequence[str], pattern: str = "{} ({})") -> list[str]:
    """Number those names that are there twice, by their place or the next number that is free."""
    told: list[str] = []
    for place, name in enumerate(names, start=1):
        numbered = (pattern.format(name, number) for number in itertools.count(place))
        free = (each for each in numbered if each not in names and each not in told)
        told.append(next(free) if names.count(name) > 1 else name)
    return told


def utf8(name: str) -> bytes:
    """Encode the name of a file, which need not be text."""
    return name.encode("utf-8", "backslashreplace")
