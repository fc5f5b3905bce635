"""The whole measurement of what a rig takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.bench.frames import FrameBench, FrameResult, steps_of
from gonio.bench.moves import STEPS, AxisBench, AxisResult
from gonio.errors import BadInputError
from gonio.rig import AXES
from gonio.steps import Steps
from gonio.timemodel import WHITE_POSE_DEG
from gonio.timing import AxesTiming, Timing

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.capture import Instrument, Operator
    from gonio.protocols import Progress
    from gonio.rig import Rig


@dataclass(frozen=True)
class Bench:
    """What was measured, and the timing made of it.

    Attributes
    ----------
    axes
        By name.
    frames
        Start, lamps, frames and white.
    timing
        For the time model.
    """

    axes: dict[str, AxisResult]
    frames: FrameResult
    timing: Timing


def bench_rig(
    instrument: Instrument,
    operator: Operator,
    rig: Rig,
    scratch: Path,
    progress: Progress | None = None,
) -> Bench:
    """Measure what a rig takes, through the drivers that a capture uses.

    Parameters
    ----------
    instrument, operator
        What to drive, and who lays the white reference under the camera.
    rig
        What it is said to be.
    scratch
        An empty folder on the disk of the camera's folder.
    progress
        Called with the number of steps done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When the rig cannot be measured: boxes that sweeps may enter, 0:45 out of reach, no exposure
        that shows the white reference.
    gonio.errors.DeviceFaultError
        When a device fails, or times fit no model.
    """
    _check(rig)
    step = Steps(STEPS + steps_of(rig), progress)
    with instrument.ready():
        instrument.place(operator, "reference")
        bench = AxisBench(instrument, rig, step)
        axes = {name: bench.measure(name) for name in AXES}
        frames = FrameBench(instrument, rig, scratch, step).measure()
    ring_down_s = [axis.ring_down_s for axis in axes.values() if axis.ring_down_s]
    timing = Timing(
        rig_sha256=rig.sha256,
        measured=True,
        axis=AxesTiming(**{name: axis.timing for name, axis in axes.items()}),
        ring_down_s=float(np.median(ring_down_s)) if ring_down_s else 0.0,
        **frames._asdict(),
    )
    return Bench(axes, frames, timing)


def _check(rig: Rig) -> None:
    if rig.arm.keep_out:
        raise BadInputError(
            "arm.keep_out: axes are measured over all of their travel, and that may enter a box; "
            "measure with the boxes' contents out of the way and keep_out empty, or plan without "
            "--timing"
        )
    for name, angle in WHITE_POSE_DEG.items():
        rig.check_reach(name, angle)
