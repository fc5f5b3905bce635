"""Numbers that a person gives: of the right kind and within what the command line allows."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TYPE_CHECKING, Final

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable

SIZE_PX: Final = (16, 2048)
"""Sides of a rendered picture in pixels."""

LIGHTS: Final = (16, 8192)
"""Directions that stand for a probe of light."""

STOPS: Final = (-10, 10)
"""Doublings of brightness."""


def check_whole(name: str, value: object, low: float = -math.inf, high: float = math.inf) -> None:
    """Refuse what is no whole number within bounds; None, which means not given, passes.

    Raises
    ------
    gonio.errors.BadInputError
        Saying what is allowed.
    """
    _check(name, value, "whole number", low, high, lambda it: isinstance(it, Integral))


def check_real(name: str, value: object, low: float = -math.inf, high: float = math.inf) -> None:
    """Refuse what is no finite number within bounds; None, which means not given, passes.

    Raises
    ------
    gonio.errors.BadInputError
        Saying what is allowed.
    """
    _check(
        name, value, "number", low, high, lambda it: isinstance(it, Real) and math.isfinite(it)
    )  # fmt: skip


def _check(
    name: str, value: object, kind: str, low: float, high: float, fits: Callable[[object], bool]
) -> None:
    if value is None:
        return
    # True is one to Python alone
    if isinstance(value, bool) or not fits(value) or not low <= value <= high:  # type: ignore[operator]
        above = f" from {low:g}" if math.isfinite(low) else ""
        below = f" to {high:g}" if math.isfinite(high) else ""
        raise BadInputError(f"{name} is {value!r}; give a {kind}{above}{below}")
