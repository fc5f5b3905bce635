"""A session that goes on: is it as it was, and is what is asked for now what it was begun with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.cli._twin import TwinSettings
    from gonio.plan import Plan
    from gonio.session import Session

_NOTES = {
    "sample": "--sample",
    "orientation": "--orientation",
    "mounting": "--mounting",
    "operator": "--operator",
    "temperature_c": "--temperature",
}


def refuse_notes() -> None:
    """Refuse notes on a resume, which keeps those that the session was begun with."""
    from gonio.errors import ResumeRefusedError

    context = click.get_current_context()
    for name, option in _NOTES.items():
        if context.get_parameter_source(name) == ParameterSource.COMMANDLINE:
            raise ResumeRefusedError(
                f"{option}: the notes are those that the session was begun with; leave it out"
            )


def resumed(
    root: Path,
    plan_path: Path | None,
    rig_path: Path | None,
    asked: tuple[str | None, int | None, str | None],
    *,
    sim: bool,
) -> tuple[Session, TwinSettings | None]:
    """Open a session to go on with, and return what its twin carries, if it has one.

    Parameters
    ----------
    root
        Its folder.
    plan_path, rig_path
        As typed; a plan that goes on from the session's last one is added.
    asked
        Material, seed and imperfections as typed.
    sim
        Whether the twin is asked for.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        Naming what differs.
    """
    from gonio.cli._twin import recall
    from gonio.errors import ResumeRefusedError
    from gonio.plan import Plan
    from gonio.rig import load_rig
    from gonio.session import Session

    session = Session.open(root, measuring=True)
    if session.sim.is_dir() and not sim:
        raise ResumeRefusedError(
            f"{root}: was begun on the simulated rig; go on with: {session.resume_command}"
        )
    # a plan is added only once nothing else speaks against going on
    session.check_same(None, load_rig(rig_path) if rig_path else None)
    settings = recall(session, *asked) if sim else None
    if plan_path:
        _bring_along(session, Plan.load(plan_path), plan_path)
    return session, settings


def _bring_along(session: Session, plan: Plan, path: Path) -> None:
    """Add a plan that goes on from the session's last one; refuse one that is no part of it."""
    from gonio.capture import check_reach

    if plan.parent is not None and plan not in session.chain().plans:
        check_reach(plan.shots, session.rig())
        with session.lock():
            session.add_plan(plan, path)
    session.check_same(plan, None)
