"""`gonio plan --continue`: what it is not asked with, and what it says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.plan import Plan

_OF_USE = frozenset(
    {"continued", "shots", "criterion", "weight", "candidates", "view_candidates", "as_json",
     "light_candidates", "prior_path", "timing_path", "bracket", "max_theta_deg"}
)  # fmt: skip


def refuse_others() -> None:
    """Refuse options that a session has settled, or that mean nothing where it goes on.

    Raises
    ------
    gonio.errors.BadInputError
        Naming the first.
    """
    from gonio.errors import BadInputError

    context = click.get_current_context()
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
        if given and parameter.name not in _OF_USE:
            raise BadInputError(
                f"{parameter.opts[-1]} does not go with --continue, which chooses pairs for the "
                "rig and the folder of the session; leave it out"
            )


def tell(plan: Plan, path: Path) -> None:
    """Say what a plan that was added, as the file `path`, is expected to bring."""
    from gonio.session import Session
    from gonio.words import duration

    resume = Session(path.parents[1]).resume_command
    selection = plan.selection
    click.echo(
        f"mean posterior sd of ln(f + 0.01 white): {selection.deviation_before:.3f} now, "
        f"{selection.deviation_after:.3f} expected after {len(plan.shots)} more shots, "
        f"which take {duration(plan.estimates.total_s)}"
    )
    click.echo(f"added {path}, sha256 {plan.sha256}")
    click.echo(f"go on with: {resume}")
