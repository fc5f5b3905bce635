"""A session that goes on: is it as it was, and is what is asked for now what it was begun with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.api.twin import TwinSettings
    from gonio.plan import Plan
    from gonio.session import Session


def resumed(
    session: Session,
    chosen: Plan | Path | None,
    rig_path: Path | None,
    asked: tuple[str | None, int | None, str | None],
    *,
    sim: bool,
) -> TwinSettings | None:
    """Check a session to go on with, and return what its twin carries, if it has one.

    Parameters
    ----------
    session
        Opened to be measured.
    chosen, rig_path
        As asked for; a plan that goes on from the session's last one is added.
    asked
        Material, seed and imperfections as asked for.
    sim
        Whether the twin is asked for.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        Naming what differs.
    """
    from gonio.api.twin import recall
    from gonio.errors import ResumeRefusedError
    from gonio.plan import Plan
    from gonio.rig import load_rig

    if session.sim.is_dir() and not sim:
        raise ResumeRefusedError(
            f"{session.root}: was begun on the simulated rig; go on with: {session.resume_command}"
        )
    # a plan is added only once nothing else speaks against going on
    session.check_same(None, load_rig(rig_path) if rig_path else None)
    settings = recall(session, *asked) if sim else None
    if chosen:
        path = chosen if isinstance(chosen, Path) else None
        _bring_along(session, Plan.load(chosen) if isinstance(chosen, Path) else chosen, path)
    return settings


def _bring_along(session: Session, plan: Plan, path: Path | None) -> None:
    """Add a plan that goes on from the session's last one; refuse one that is no part of it."""
    from gonio.capture import check_reach

    if plan.parent is not None and _is_new(plan, session):
        check_reach(plan.shots, session.rig())
        with session.lock():
            session.add_plan(plan, path)
    session.check_same(plan, None)


def _is_new(plan: Plan, session: Session) -> bool:
    return plan.sha256 not in {each.sha256 for each in session.chain().plans}
