"""The prior that a command works with."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from nnbrdf.prior import MaterialPrior


def material_prior(path: Path | None) -> MaterialPrior:
    """Read a prior, or generate the default one."""
    from nnbrdf.prior import MaterialPrior

    return MaterialPrior.load(path) if path else MaterialPrior.generate()
