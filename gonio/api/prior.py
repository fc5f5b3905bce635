"""The prior that a command works with."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.plan import Plan
    from nnbrdf.prior import MaterialPrior


def material_prior(path: Path | None) -> MaterialPrior:
    """Read a prior, or generate the default one."""
    from nnbrdf.prior import MaterialPrior

    return MaterialPrior.load(path) if path else MaterialPrior.generate()


def with_prior(plan: Plan, prior: MaterialPrior) -> Plan:
    """Return the plan with the hash of the prior that it was made with."""
    told = plan.selection.model_copy(update={"prior_sha256": prior.sha256})
    return plan.model_copy(update={"selection": told})
