"""`gonio plan --continue`: the next shots of a session, chosen by what was measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.plan import Plan

SHOTS = 16
"""How many shots are added unless told otherwise."""

_OF_USE = frozenset(
    {"continued", "shots", "criterion", "weight", "candidates", "view_candidates",
     "light_candidates", "prior_path", "timing_path", "bracket", "max_theta_deg"}
)  # fmt: skip


def refuse_others(criterion: str) -> None:
    """Refuse options that a session has settled, or that mean nothing where it goes on.

    Raises
    ------
    gonio.errors.BadInputError
        Naming the first.
    """
    from gonio.errors import BadInputError
    from planner.criteria import PRIOR_CRITERIA

    context = click.get_current_context()
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
        if given and parameter.name not in _OF_USE:
            raise BadInputError(
                f"{parameter.opts[-1]} does not go with --continue, which chooses pairs for the "
                "rig and the folder of the session; leave it out"
            )
    if criterion not in PRIOR_CRITERIA:
        raise BadInputError(
            f"--continue chooses by what is known, and criterion {criterion} knows nothing; use "
            f"{' or '.join(PRIOR_CRITERIA)}"
        )


def go_on(
    root: Path,
    shots: int | None,
    prior_path: Path | None,
    timing_path: Path | None,
    bracket: str | None,
    **choice: Any,
) -> tuple[Path, Plan]:
    """Add a plan to a session's chain, and return its file and itself.

    Parameters
    ----------
    root
        The session's folder.
    shots, prior_path, timing_path, bracket
        As the options say.
    choice
        More of `planner.make.make_plan`.

    Raises
    ------
    gonio.errors.BadInputError
        When there is too little to go on from, or nothing left to measure.
    gonio.errors.ResumeRefusedError
        When the chain does not hold.
    """
    from gonio.adaptive import Watch
    from gonio.cli._prior import material_prior
    from gonio.cli._samples import reduced
    from gonio.cli._timing import timing_for
    from gonio.session import Session

    session = Session.open(root)
    session.check_writable("copy it to a folder that can be written, and go on there")
    timing = timing_for(session.rig(), session.rig_path, timing_path)
    choice |= {"timing": timing, "bracket": bracket or ("predicted" if timing else "all")}
    prior = material_prior(prior_path)
    with session.lock():
        session.chain()  # one that does not hold is told before the work
        standing = Watch(session, prior).take_stock(reduced(session))
        wanted = SHOTS if shots is None else shots
        plan = standing.next_plan(wanted, exactly=shots is not None, **choice)
        return session.add_plan(plan), plan


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
