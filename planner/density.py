"""How many directions a plan takes: all, sixth, a number, or the paper's names for both arms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Mapping

Arm = Literal["view", "light"]
Density = str | int
"""`all`, `sixth`, or a number of directions (as a number or in digits)."""

PAPER_SUBSETS: Mapping[str, tuple[str, str]] = {
    "va-ia": ("all", "all"),
    "vs-ia": ("sixth", "all"),
    "va-is": ("all", "sixth"),
    "vs-is": ("sixth", "sixth"),
}
"""Densities of views and lights by the paper's names: v views, i illumination, a all, s sixth."""


def split_density(density: Density) -> tuple[Density, Density]:
    """Return the densities of views and of lights: a paper's name's own, else twice the same."""
    if isinstance(density, str) and density in PAPER_SUBSETS:
        return PAPER_SUBSETS[density]
    return density, density


def count_of(density: Density, candidates: int, reachable: int, arm: Arm, option: str) -> int:
    """Return how many directions a density means.

    Parameters
    ----------
    density
        `all` means all that can be reached, `sixth` a sixth of the candidates.
    candidates, reachable
        How many directions there are, and how many of them the rig can take.
    arm
        Which arm they are for, for the message.
    option
        What said so, for the message: density, lights or views.

    Raises
    ------
    BadInputError
        When it is none of the known words, or a number beyond the set or the rig's reach.
    """
    if density == "all":
        return reachable
    try:
        count = max(1, round(candidates / 6)) if density == "sixth" else int(density)
    except ValueError:
        count = 0
    if not 1 <= count <= candidates:
        raise BadInputError(
            f"--{option} {density!r} is no density; use all, sixth, a number from 1 to "
            f"{candidates}, or for views and lights together {', '.join(PAPER_SUBSETS)}"
        )
    if count > reachable:
        raise BadInputError(
            f"{arm}s: {count} directions are asked for, but within the travel of {arm}_theta and "
            f"{arm}_phi, the limits of the plan and clear of everything are {reachable} of "
            f"{candidates}; ask for fewer or all, widen the limits, or correct the rig file"
        )
    return count
