"""The chain of a session's plans: each names the one before it, and all count shots on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from gonio.errors import BadFileError, BadInputError, ResumeRefusedError
from gonio.plan import Plan
from gonio.timemodel import exposures_of

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.plan import Shot

FIRST_NAME: Final = "000.json"
"""The plan that a session is begun with; its folder holds no chain without it."""

_MOST: Final = 1000
_REMEDY = "put a copy of the file back, or measure anew into another folder"
_REFUSED = "leave it out, or start a new session with -o"


@dataclass(frozen=True)
class PlanChain:
    """All plans of a session.

    Attributes
    ----------
    plans
        At least one, oldest first.
    rig_sha256
        Of the session's rig, for which every plan after the first has to be.
    """

    plans: tuple[Plan, ...]
    rig_sha256: str

    @property
    def last(self) -> Plan:
        """The newest plan; it vouches for all before it."""
        return self.plans[-1]

    @property
    def shots(self) -> tuple[Shot, ...]:
        """The shots of all plans, in the order of taking."""
        return tuple(shot for plan in self.plans for shot in plan.shots)

    @property
    def exposures_s(self) -> tuple[float, ...]:
        """Each exposure once, in seconds: those of the first plan rising, then what others add.

        So an exposure keeps its place when a plan is added, and its calibration frames their names.
        """
        return tuple(dict.fromkeys(e for plan in self.plans for e in exposures_of(plan.shots)))

    @property
    def estimated_s(self) -> float:
        """What all plans together were estimated to take, in seconds."""
        return math.fsum(plan.estimates.total_s for plan in self.plans)

    @property
    def next_index(self) -> int:
        """Index of the first shot of a plan that goes on from here."""
        return 1 + max(shot.index for shot in self.shots)

    @property
    def next_name(self) -> str:
        """File name of a plan that goes on from here.

        Raises
        ------
        gonio.errors.BadInputError
            When there are as many plans as a session can name.
        """
        if len(self.plans) >= _MOST:
            raise BadInputError(
                f"the session holds {_MOST} plans, which is the most; start a new one with -o"
            )
        return f"{len(self.plans):03d}.json"

    def check_next(self, plan: Plan, where: Path) -> None:
        """Refuse a plan, of the file `where`, that does not go on from here.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            Saying what differs: its parent, its rig, or that it counts a shot again.
        """
        if plan.parent != self.last.sha256:
            parent = plan.parent and plan.parent[:12]
            problem = f"parent is {parent}, not the plan before it ({self.last.sha256[:12]})"
        elif plan.rig_sha256 != self.rig_sha256:
            problem = (
                f"is for rig {plan.rig_sha256[:12]}, not the session's ({self.rig_sha256[:12]})"
            )
        elif again := {shot.index for shot in self.shots} & {shot.index for shot in plan.shots}:
            problem = f"shot {min(again)} is in a plan before it, too"
        else:
            return
        raise ResumeRefusedError(f"{where}: {problem}; {_REFUSED}")


def load_chain(folder: Path, rig_sha256: str) -> PlanChain:
    """Read the plans of a folder, 000.json first, and check that each goes on from the one before.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        When a plan is damaged or missing, or does not go on from the one before it (see
        `PlanChain.check_next`).
    """
    chain: PlanChain | None = None
    for number, path in enumerate(sorted(folder.glob("[0-9][0-9][0-9].json"))):
        if path.name != f"{number:03d}.json":
            expected = folder / f"{number:03d}.json"
            raise ResumeRefusedError(
                f"{expected}: is missing, though {path.name} is there; {_REMEDY}"
            )
        plan = _load(path)
        if chain is None:
            chain = PlanChain((plan,), rig_sha256)
        else:
            chain.check_next(plan, path)
            chain = PlanChain((*chain.plans, plan), rig_sha256)
    if chain is None:
        raise ResumeRefusedError(f"{folder / FIRST_NAME}: no such file; {_REMEDY}")
    return chain


def _load(path: Path) -> Plan:
    try:
        return Plan.load(path, remedy=_REMEDY)
    except BadFileError as error:
        raise ResumeRefusedError(str(error)) from None
