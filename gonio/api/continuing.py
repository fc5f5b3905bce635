"""The next shots of a session, chosen by what was measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.api.following import Bars
    from gonio.api.planning import PlanRequest
    from gonio.plan import Plan
    from gonio.session import Session

SHOTS = 16
"""How many shots are added unless told otherwise."""


def check_knowing(criterion: str) -> None:
    """Refuse a criterion that does not ask what is known.

    Raises
    ------
    gonio.errors.BadInputError
        Naming those that do.
    """
    from gonio.errors import BadInputError
    from planner.criteria import PRIOR_CRITERIA

    if criterion not in PRIOR_CRITERIA:
        raise BadInputError(
            f"--continue chooses by what is known, and criterion {criterion} knows nothing; use "
            f"{' or '.join(PRIOR_CRITERIA)}"
        )


def go_on(session: Session, request: PlanRequest, bars: Bars) -> tuple[Path, Plan]:
    """Add a plan to a session's chain, and return its file and itself.

    Parameters
    ----------
    session
        What goes on.
    request
        From what to choose, by what, and how many shots; its rig is the session's.
    bars
        How it is followed.

    Raises
    ------
    gonio.errors.BadInputError
        When there is too little to go on from, or nothing left to measure.
    gonio.errors.ResumeRefusedError
        When the chain does not hold.
    """
    from gonio.adaptive import Watch
    from gonio.api.reduction import reduced
    from gonio.api.timing import timing_for

    check_knowing(request.criterion)
    request.refuse_idle(request.weight, request.prior_path)
    session.check_writable("copy it to a folder that can be written, and go on there")
    timing = timing_for(session.rig(), session.rig_path, request.timing_path, request.tell)
    bracket = request.bracket or ("predicted" if timing else "all")
    with session.lock():
        session.chain()  # one that does not hold is told before the work
        standing = Watch(session, request.believed()).take_stock(reduced(session, bars))
        with bars("choosing") as progress:
            plan = standing.next_plan(
                SHOTS if request.shots is None else request.shots,
                exactly=request.shots is not None,
                criterion=request.criterion,
                progress=progress,
                timing=timing,
                bracket=bracket,
                **request.choice,
            )
        return session.add_plan(plan), plan
