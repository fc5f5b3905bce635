"""A new session: what it measures, by which plan, and what speaks against it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from gonio.adaptive import Goal
    from gonio.cli._calibration import Asked
    from gonio.cli._twin import TwinSettings
    from gonio.plan import Plan
    from gonio.protocols import Material
    from gonio.rig import Rig
    from gonio.session import Session

_DEFAULT_PLAN = Path("plan.json")
_MATERIAL = "wood-veneer"


@dataclass(frozen=True)
class Carried:
    """What the twin of a new session carries."""

    material: Material
    settings: TwinSettings

    @classmethod
    def of(cls, material: str | None, seed: int | None, imperfections: str | None) -> Carried:
        from gonio.cli._twin import TwinSettings
        from sim.materials import load_material

        name = material or _MATERIAL
        return cls(load_material(name), TwinSettings.of(name, seed or 0, imperfections))

    @property
    def described(self) -> str:
        """The sample, for the notes."""
        return f"{Path(self.settings.material).stem} (simulated)"


def begun(
    root: Path,
    plan_path: Path | None,
    rig_path: Path | None,
    carried: Carried | None,
    said: dict[str, Any],
    goal: Goal | None,
    calibration: Asked | None = None,
) -> Session:
    """Make the session once nothing speaks against it.

    Parameters
    ----------
    root
        Its folder.
    plan_path, rig_path
        As typed; None: what there is.
    carried
        What the twin carries; None on a real rig.
    said
        The notes.
    goal
        Of an adaptive capture.
    calibration
        Of the camera, where one is asked for.

    Raises
    ------
    gonio.errors.GonioError
        For whatever cannot be measured, or cannot be stored.
    """
    from gonio.capture import check_reach, check_space
    from gonio.cli._adaptive import check_affordable, note_goal
    from gonio.cli._twin import remember
    from gonio.clock import SystemClock, VirtualClock
    from gonio.creation import create_session
    from gonio.errors import BadInputError
    from gonio.materials import reference_material
    from gonio.notes import Notes
    from gonio.rig import default_rig, default_rig_text, load_rig
    from gonio.validation import check

    rig = load_rig(rig_path) if rig_path else default_rig()
    rig_text = rig_path.read_text(encoding="utf-8") if rig_path else default_rig_text()
    notes = check(Notes, said, Path("notes"), "correct the option of that name")
    # what cannot be measured is refused before anything is written
    reference_material(rig)
    plan = _plan_for(plan_path, rig, rig_path, goal)
    if plan.rig_sha256 != rig.sha256:
        raise BadInputError(
            f"{plan_path or _DEFAULT_PLAN}: was made for another rig ({plan.rig_sha256[:12]}, not "
            f"{rig.sha256[:12]}); make it anew with gonio plan --rig, or name that rig with --rig"
        )
    if calibration:
        calibration.check(rig, carried.settings if carried else None)
    check_reach(plan.shots, rig)
    remedy = "free some space or choose another folder with -o"
    check_space(root, plan.estimates.frames, rig, remedy)
    if goal:
        check_affordable(plan, goal)
    if carried is None:
        from gonio.capture.hardware import operator_of

        operator_of(rig)

    def furnish(session: Session) -> None:
        if carried:
            remember(session, carried.settings, carried.material)
        if calibration:
            calibration.keep(session)
        if goal:
            note_goal(session, goal, VirtualClock() if carried else SystemClock())

    return create_session(root, plan, rig_text, notes, furnish)


def _plan_for(path: Path | None, rig: Rig, rig_path: Path | None, goal: Goal | None) -> Plan:
    """Return the plan asked for, or plan.json, or a fresh one: `sixth`, or few pairs to begin."""
    from gonio.cli._adaptive import first_shots
    from gonio.cli._prior import material_prior, with_prior
    from gonio.cli._timing import timing_for
    from gonio.plan import Plan
    from planner.make import make_plan

    found = path or (_DEFAULT_PLAN if _DEFAULT_PLAN.exists() else None)
    if found is not None:
        return Plan.load(found)
    shots = first_shots(goal) if goal else None
    what = f"begins with {shots} pairs" if shots else "measures density sixth"
    click.echo(f"no plan.json here, so this {what} (see gonio plan --help)")
    timing = timing_for(rig, rig_path, None)
    prior = material_prior(goal.prior_path if goal else None)
    plan = make_plan(
        rig,
        criterion="i-optimal",
        shots=shots,
        prior=lambda: prior,
        timing=timing,
        bracket="predicted" if timing else "all",
    )
    return with_prior(plan, prior)
