"""The material as far as it is known: a quick estimate, and what error it expects of itself."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import GonioError
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.plan import Shot
    from gonio.samples import Samples
    from gonio.session import Session

MOST_SHOTS = 128
"""How many shots an estimate is made of; of more, as many spread over the order of taking."""

_GROWTH = 1.25
_REST = 5.0
_LOOK_S = 1.0
_FLOOR = 0.01
_Z95 = 1.6448536269514722


@dataclass(frozen=True)
class Fit:
    """An estimate.

    Attributes
    ----------
    shots, of
        How many it was made of, and how many whole ones there were.
    deviation
        Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs.
    sphere
        A picture of it, as PNG.
    """

    shots: int
    of: int
    deviation: float
    sphere: bytes

    @property
    def sentence(self) -> str:
        """All of it in words."""
        some = several(self.shots, "shot") + (f" of {self.of}" if self.of > self.shots else "")
        return (
            f"From {some}; mean relative standard uncertainty over the hemisphere: "
            f"{self.deviation:.0%}, by the estimate's own posterior."
        )


class RunningFit:
    """Fits in a thread of its own, again when there is a quarter more, and rests between.

    Frames are reduced as `gonio reduce` does, in memory: nothing is written. It works at most a
    sixth of the time.

    Parameters
    ----------
    session
        What is measured.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._ready: list[Shot] = []
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="fit", daemon=True)
        self.last: Fit | None = None
        self.note = f"An estimate begins with {_least()} shots."

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End; what is being worked out is not waited for."""
        self._stop.set()

    def offer(self, shots: Sequence[Shot]) -> None:
        """Say which shots are whole."""
        self._ready = list(shots)

    def _run(self) -> None:
        tried = 0
        while not self._stop.wait(_LOOK_S):
            ready = self._ready
            if len(ready) < max(_least(), _GROWTH * tried):
                continue
            if not tried:
                self.note = f"The first estimate, of {len(ready)} shots, is being made."
            tried, began = len(ready), time.perf_counter()
            try:
                self.last, self.note = self._fit(ready), ""
            except GonioError as error:
                self.note = str(error)
            except Exception as error:  # a thread that dies says nothing
                self.note = f"the estimate failed ({type(error).__name__}: {error})"
            self._stop.wait(_REST * (time.perf_counter() - began))

    def _fit(self, ready: Sequence[Shot]) -> Fit:
        from gonio.watch.pictures import sphere_png
        from nnbrdf.posterior_model import PriorEstimator

        chosen = np.linspace(0, len(ready) - 1, min(len(ready), MOST_SHOTS)).round().astype(int)
        samples = self._reduced([ready[i] for i in chosen])
        grid = PriorEstimator().fit(samples).grid()
        floor = _FLOOR * samples.white
        spread = np.log((grid["hi"] + floor) / (grid["lo"].clip(0.0) + floor)) / (2 * _Z95)
        deviation, sphere = float(spread.mean()), sphere_png(grid["values"])
        return Fit(len(samples), len(ready), deviation, sphere)

    def _reduced(self, shots: Sequence[Shot]) -> Samples:
        from gonio.reduce.calibrate import calibrate
        from gonio.reduce.correction import correction_in
        from gonio.reduce.opening import open_frames
        from gonio.reduce.patch import PatchFinder, usual_patch_mm
        from gonio.reduce.provenance import shot_exposures
        from gonio.reduce.reduce import measure, samples_of

        opened = open_frames(self._session)
        rig, frames = opened.rig, opened.frames
        correction = correction_in(self._session.sensor_calibration)
        patches = PatchFinder(rig.camera, usual_patch_mm(rig.camera), correction.bad)
        calibration = calibrate(frames, rig, patches, shot_exposures(opened.records), correction)
        rows, left_out = measure(shots, frames, patches, rig, calibration)
        if not rows:
            raise next(iter(left_out.values()))
        return samples_of(rows, calibration)


def _least() -> int:
    from nnbrdf.usable import MIN_SAMPLES

    return MIN_SAMPLES
