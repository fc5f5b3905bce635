"""A new session: what it measures, by which plan, and what speaks against it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gonio.plan import Plan

if TYPE_CHECKING:
    from gonio.adaptive import Goal
    from gonio.api.calibration import Asked
    from gonio.api.following import Tell
    from gonio.api.twin import TwinSettings
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
        """Read what was asked for; None: the default."""
        from gonio.api.twin import TwinSettings
        from sim.materials import load_material

        name = material or _MATERIAL
        return cls(load_material(name), TwinSettings.of(name, seed or 0, imperfections))

    @property
    def described(self) -> str:
        """The sample, for the notes."""
        return f"{Path(self.settings.material).stem} (simulated)"


def begun(
    root: Path,
    chosen: Plan | Path | None,
    rig_path: Path | None,
    carried: Carried | None,
    said: dict[str, Any],
    goal: Goal | None,
    calibration: Asked | None,
    tell: Tell,
) -> Session:
    """Make the session once nothing speaks against it.

    Parameters
    ----------
    root
        Its folder.
    chosen
        The plan, or its file; None: plan.json where there is one, else a fresh one.
    rig_path
        The rig's file; None: the built-in rig.
    carried
        What the twin carries; None on a real rig.
    said
        The notes.
    goal
        Of an adaptive capture.
    calibration
        Of the camera, where one is asked for.
    tell
        Told what else was decided.

    Raises
    ------
    gonio.errors.GonioError
        For whatever cannot be measured, or cannot be stored.
    """
    from gonio.api.rounds import check_affordable, note_goal
    from gonio.api.twin import remember
    from gonio.capture import check_reach, check_space
    from gonio.clock import SystemClock, VirtualClock
    from gonio.creation import create_session
    from gonio.materials import reference_material
    from gonio.notes import Notes
    from gonio.rig import default_rig, default_rig_text, load_rig
    from gonio.validation import check

    rig = load_rig(rig_path) if rig_path else default_rig()
    rig_text = rig_path.read_text(encoding="utf-8") if rig_path else default_rig_text()
    notes = check(Notes, said, Path("notes"), "correct the option of that name")
    # what cannot be measured is refused before anything is written
    reference_material(rig)
    plan = _plan_for(chosen, rig, rig_path, goal, tell)
    _check_rig(plan, rig, chosen)
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


def _check_rig(plan: Plan, rig: Rig, chosen: Plan | Path | None) -> None:
    from gonio.errors import BadInputError

    if plan.rig_sha256 != rig.sha256:
        where = chosen if isinstance(chosen, Path) else _DEFAULT_PLAN
        named = "the plan" if isinstance(chosen, Plan) else where
        raise BadInputError(
            f"{named}: was made for another rig ({plan.rig_sha256[:12]}, not "
            f"{rig.sha256[:12]}); make it anew with gonio plan --rig, or name that rig with --rig"
        )


def _plan_for(
    chosen: Plan | Path | None, rig: Rig, rig_path: Path | None, goal: Goal | None, tell: Tell
) -> Plan:
    """Return the plan asked for, or plan.json, or a fresh one: `sixth`, or few pairs to begin."""
    if isinstance(chosen, Plan):
        return chosen
    found = chosen or (_DEFAULT_PLAN if _DEFAULT_PLAN.exists() else None)
    return Plan.load(found) if found is not None else _fresh(rig, rig_path, goal, tell)


def _fresh(rig: Rig, rig_path: Path | None, goal: Goal | None, tell: Tell) -> Plan:
    from gonio.api.prior import material_prior, with_prior
    from gonio.api.rounds import first_shots
    from gonio.api.timing import timing_for
    from planner.make import make_plan

    shots = first_shots(goal) if goal else None
    what = f"begins with {shots} pairs" if shots else "measures density sixth"
    tell(f"no plan.json here, so this {what} (see gonio plan --help)")
    timing = timing_for(rig, rig_path, None, tell)
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
