"""Whether what fails is a matter of single shots, which a retake may mend, or of all."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sized

_MOST = 0.1


def is_chance(failing: Sized, all_of_them: Sized) -> bool:
    """Tell whether few enough fail that taking them again may help."""
    return 0 < len(failing) <= max(1.0, _MOST * len(all_of_them))


def remedy_for(failing: Sized, all_of_them: Sized, systematic: str) -> str:
    """Return what to do: nothing, a retake, or what mends the rig where most fail."""
    if not len(failing):
        return ""
    return "take them again" if is_chance(failing, all_of_them) else systematic
