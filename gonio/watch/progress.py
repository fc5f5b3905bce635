"""How far a capture is along its plans: what is done, what comes next, and how long it takes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gonio.adaptive import rig_time
from gonio.report.planned import done_s
from gonio.timemodel import DARK_FRAMES, WHITE_FRAMES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.planchain import PlanChain
    from gonio.rig import Rig
    from gonio.watch.following import Told

_TELLING_SHARE = 0.02
_PACES = (0.5, 3.0)


@dataclass(frozen=True)
class Route:
    """The shots of all plans, with the seconds that each was estimated to take.

    Attributes
    ----------
    chain, rig
        The session's.
    """

    chain: PlanChain
    rig: Rig

    @cached_property
    def seconds(self) -> NDArray[np.float64]:
        """Of each shot by its plan; that of a plan's first holds homing and calibration."""
        parts = [np.diff(done_s(plan, self.rig), prepend=0.0) for plan in self.chain.plans]
        return np.concatenate(parts)

    @property
    def calibration_frames(self) -> int:
        """How many dark and white frames are wanted."""
        return len(self.chain.exposures_s) * (DARK_FRAMES + WHITE_FRAMES)

    @property
    def frames(self) -> int:
        """How many frames are wanted."""
        shots = sum(len(shot.exposures_s) for shot in self.chain.shots)
        return self.calibration_frames + shots


@dataclass(frozen=True)
class Progress:
    """Where a capture is.

    Attributes
    ----------
    marks
        A letter a shot in route order: d done, f failed or rejected (later ones are done), n next,
        w waiting.
    frames
        How many are there.
    left_s
        Seconds of the rig's time that are left, by the plans and at this capture's pace.
    pace
        How many times longer than planned it takes; 1 while too little is known.
    """

    marks: str
    frames: int
    left_s: float
    pace: float


def progress_of(route: Route, told: Told) -> Progress:
    """Return how far a capture is, by its journal."""
    have = told.frames.keys()
    done = np.array(
        [all(("shot", s.index, 0, e) in have for e in s.exposures_s) for s in route.chain.shots]
    )
    planned_s, all_s = float(route.seconds[done].sum()), float(route.seconds.sum())
    pace = 1.0
    if planned_s > _TELLING_SHARE * all_s:
        pace = float(np.clip(rig_time(told.events) / planned_s, *_PACES))
    return Progress(_marks(done), len(have), pace * (all_s - planned_s), pace)


def _marks(done: NDArray[np.bool_]) -> str:
    marks = np.where(done, "d", "w")
    if done.any():
        furthest = int(np.flatnonzero(done)[-1])
        marks[:furthest][~done[:furthest]] = "f"
    left = np.flatnonzero(~done)
    if len(left):
        waiting = np.flatnonzero(marks == "w")
        # what failed is taken again after all else
        marks[(waiting if len(waiting) else left)[0]] = "n"
    return "".join(marks)
