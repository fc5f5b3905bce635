"""What an extreme case is held to."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One bound: what was measured, and what it may be at most."""

    case: str
    what: str
    measured: float
    bound: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether it was kept; what is not a number was not."""
        return self.measured <= self.bound
