"""A capture as it is asked for: begun or gone on with, and taken to its end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gonio.api.measuring import NOT_NOTED
from gonio.api.wish import Wish
from gonio.session import DEFAULT_ROOT

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from gonio.adaptive import Goal, Round
    from gonio.api.beginning import Carried
    from gonio.api.following import Following, Tell
    from gonio.api.measuring import Measured
    from gonio.api.twin import TwinSettings
    from gonio.plan import Plan
    from gonio.session import Session
    from sim.faults import Fault

_OF_THE_TWIN = {
    "material": "--material",
    "seed": "--seed",
    "faults_path": "--faults",
    "imperfections": "--imperfections",
    "rehearse": "--rehearse",
}


@dataclass(frozen=True)
class Ready:
    """A session that is ready to be measured: on which twin, with which faults, until when."""

    session: Session
    twin: TwinSettings | None
    faults: Sequence[Fault]
    goal: Goal | None

    def capture(self, following: Following, *, retake: bool = False) -> Measured | Round:
        """Take what the session lacks, by its plans or in rounds; return what that came to.

        With `retake`, flagged shots are taken again.
        """
        from gonio.api.measuring import driven, measure
        from gonio.api.retaking import without_suspects
        from gonio.api.rounds import measure_adaptively

        rig = driven(self.session, self.twin, self.faults)
        if retake:
            rig = without_suspects(self.session, rig, following.given_up)
        if self.goal is None:
            return measure(self.session, rig, following)
        return measure_adaptively(self.session, rig, self.goal, following)


@dataclass(frozen=True, kw_only=True)
class CaptureRequest:
    """What is to be measured, and how; `gonio capture --help` says more of each.

    Attributes
    ----------
    plan
        The plan, or its file; None: plan.json where there is one, else a fresh one.
    rig_path
        The rig's file; None: the built-in rig.
    output
        The session's folder.
    sim, material, seed, imperfections, faults_path, rehearse
        The simulated twin, what it carries, and what goes wrong with it.
    adaptive, until, batch, max_shots, hours, prior_path
        Rounds of measuring and choosing, and when they end.
    calibration_path, max_age_days
        The camera's calibration, and how old it may be.
    sample, orientation, mounting, operator, temperature_c
        Notes.
    """

    plan: Plan | Path | None = None
    rig_path: Path | None = None
    output: Path = DEFAULT_ROOT
    sim: bool = False
    material: str | None = None
    seed: int | None = None
    imperfections: str | None = None
    faults_path: Path | None = None
    rehearse: bool | None = None
    adaptive: bool = False
    until: float | None = None
    batch: int | None = None
    max_shots: int | None = None
    hours: float | None = None
    prior_path: Path | None = None
    calibration_path: Path | None = None
    max_age_days: float | None = None
    sample: str | None = None
    orientation: str = "marked edge along +x"
    mounting: str = "flat in the holder"
    operator: str = NOT_NOTED
    temperature_c: float | None = None

    def begin(self, tell: Tell) -> Ready:
        """Make the session, once nothing speaks against it.

        Raises
        ------
        gonio.errors.GonioError
            For whatever cannot be measured, or cannot be stored.
        """
        from gonio.api.beginning import Carried, begun
        from gonio.api.calibration import asked_for
        from gonio.api.twin import unstated

        wish = self._checked(resume=False)
        faults = self._faults()
        calibration = asked_for(self.calibration_path, self.max_age_days, resume=False)
        asked = (self.material, self.seed, self.imperfections)
        carried = Carried.of(*asked) if self.sim else None
        goal = wish.goal()
        session = begun(
            self.output, self.plan, self.rig_path, carried, self._notes(carried), goal,
            calibration, tell,
        )  # fmt: skip
        if carried and (said := unstated(carried.settings.imperfections, session.rig())):
            tell(said)
        return Ready(session, carried.settings if carried else None, faults, goal)

    def resume(self, *, retake: bool = False) -> Ready:
        """Open the session, once it is found as it was; with `retake`, only if it has checks.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            Naming what differs.
        """
        from gonio.api.calibration import asked_for
        from gonio.api.rehearsal import check_begun_so
        from gonio.api.resuming import resumed
        from gonio.capture.retake import flagged
        from gonio.errors import BadInputError
        from gonio.session import Session

        if retake and self.adaptive:
            raise BadInputError(
                "--retake takes flagged shots again and chooses no others; leave out --adaptive"
            )
        wish = self._checked(resume=True)
        faults = self._faults()
        asked_for(self.calibration_path, self.max_age_days, resume=True)
        asked = (self.material, self.seed, self.imperfections)
        session = Session.open(self.output, measuring=True)
        twin = resumed(session, self.plan, self.rig_path, asked, sim=self.sim)
        if self.rehearse:
            check_begun_so(session)
        goal = wish.going_on(session)
        if retake:
            flagged(session)  # one without checks is refused before anything moves
        return Ready(session, twin, faults, goal)

    def _checked(self, *, resume: bool) -> Wish:
        """Refuse what does not go together; return what is asked of an adaptive capture."""
        from gonio.api.rehearsal import check_shown_nothing
        from gonio.errors import BadInputError

        names = ("until", "batch", "max_shots", "hours")
        said = {name: getattr(self, name) for name in names}
        wish = Wish.of(said, self.prior_path, adaptive=self.adaptive)
        for name, option in _OF_THE_TWIN.items():
            if not self.sim and getattr(self, name) is not None:
                raise BadInputError(f"{option} is an option of --sim; add that, or leave it out")
        if not (self.sim or resume or self.rig_path):
            raise BadInputError(
                "which rig? give its file with --rig, or add --sim to measure on the simulated one"
            )
        if self.rehearse:
            check_shown_nothing(self.material, adaptive=self.adaptive)
        return wish

    def _faults(self) -> tuple[Fault, ...]:
        from sim.faults import load_faults

        return () if self.faults_path is None else load_faults(self.faults_path)

    def _notes(self, carried: Carried | None) -> dict[str, Any]:
        return {
            "sample": self.sample or (carried.described if carried else NOT_NOTED),
            "orientation": self.orientation,
            "mounting": self.mounting,
            "operator": self.operator,
            "temperature_c": self.temperature_c,
            "rehearsal": bool(self.rehearse),
        }
