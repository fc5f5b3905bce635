"""Which prior a model was made with, as its card records it."""

from __future__ import annotations

from pydantic import Field

from gonio.validation import Document


class PriorUsed(Document):
    """A prior by its hash, and how many materials it holds.

    Attributes
    ----------
    sha256
        Of its examples' parameters and weights (see `MaterialPrior.sha256`).
    generated, measured
        How many materials of either origin there are in it.
    """

    sha256: str
    generated: int = Field(ge=0)
    measured: int = Field(ge=0)

    def __str__(self) -> str:
        measured = f" and {self.measured} measured" if self.measured else ""
        return f"{self.generated} generated{measured} materials"
