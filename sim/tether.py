"""The camera on its cable: some time after the shutter closed, a file appears in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal, Protocol

from gonio.errors import StorageError
from sim.warmth import COOL, SensorHeat, Warmth

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from gonio.clock import VirtualClock
    from gonio.geometry import ArmPose

Holder = Literal["sample", "reference"]

_QUICKEST_S, _SLOWEST_S = 0.05, 0.1


class Camera(Protocol):
    """Whatever turns a scene into a file, such as `sim.camera.SimCamera`."""

    def frame(
        self,
        *,
        holder: Holder,
        view: ArmPose,
        light: ArmPose,
        flux: NDArray[np.float64],
        exposure_s: float,
        key: str,
        shake_rad: NDArray[np.float64] | None = None,
        warmth: Warmth,
    ) -> bytes:
        """Return a whole DNG; `key` names the exposure, for its noise."""


@dataclass(frozen=True)
class Scene:
    """What the camera had before it when the shutter opened."""

    holder: Holder
    view: ArmPose
    light: ArmPose
    key: str
    shake_rad: NDArray[np.float64] | None = None


@dataclass
class _Pending:
    frame: int
    exposure_s: float
    scene: Scene
    opened_warmth: float
    closed_s: float | None = None
    flux: NDArray[np.float64] | None = None
    warmth: Warmth = COOL


class Tether:
    """Takes exposures and leaves `frame_<k>.dng`, one at a time.

    Parameters
    ----------
    camera
        Makes the files.
    folder
        Where they go.
    clock
        On which they take their time.
    random
        For how long they take.
    file_timeout_s
        After which a file that did not come keeps the camera busy no longer.

    Attributes
    ----------
    loses_files
        Set True to let files never come.
    develop
        Is given what renders a file and what then takes it; set it to have that done elsewhere.
    write
        Is given folder, frame and content of each file; set it to have something else done.
    """

    def __init__(
        self,
        camera: Camera,
        folder: Path,
        clock: VirtualClock,
        random: np.random.Generator,
        file_timeout_s: float,
    ) -> None:
        self.loses_files = False
        self.develop: Callable[[Callable[[], bytes], Callable[[bytes], None]], None] = _at_once
        self.write: Callable[[Path, int, bytes], None] = write_frame
        self._camera = camera
        self._folder = folder
        self._clock = clock
        self._random = random
        self._file_timeout_s = file_timeout_s
        self._pending: _Pending | None = None
        self._heat = SensorHeat(clock.now())

    def busy(self) -> bool:
        """Return whether the shutter is open or its file not yet written."""
        if self._pending is None:
            return False
        closed_s = self._pending.closed_s
        return closed_s is None or self._clock.now() < closed_s + self._file_timeout_s

    def opened(self, frame: int, exposure_s: float, scene: Scene) -> None:
        """Note that the shutter opened."""
        now = self._clock.now()
        self._heat.use(now, in_use=True)
        self._pending = _Pending(frame, exposure_s, scene, self._heat.warmth(now))

    def closed(self, flux: NDArray[np.float64], junctions_c: NDArray[np.float64]) -> None:
        """Note that the shutter closed; flux and temperature are each lamp's mean, shape (11,)."""
        pending, now = self._pending, self._clock.now()
        self._heat.use(now, in_use=False)
        if pending is not None:
            pending.closed_s, pending.flux = now, flux
            sensor = (pending.opened_warmth + self._heat.warmth(now)) / 2.0
            pending.warmth = Warmth(junctions_c, sensor)
            delay_s = self._random.uniform(_QUICKEST_S, _SLOWEST_S)
            self._clock.call_at(now + delay_s, lambda: self._deliver(pending))

    def aborted(self) -> None:
        """Note that the shutter was closed for no frame."""
        self._heat.use(self._clock.now(), in_use=False)
        self._pending = None

    def _deliver(self, pending: _Pending) -> None:
        if self.loses_files or pending.flux is None:
            return
        scene = pending.scene
        shaken = {} if scene.shake_rad is None else {"shake_rad": scene.shake_rad}
        render = partial(
            self._camera.frame,
            holder=scene.holder,
            view=scene.view,
            light=scene.light,
            flux=pending.flux,
            exposure_s=pending.exposure_s,
            key=scene.key,
            **shaken,
            warmth=pending.warmth,
        )
        self.develop(render, partial(self._write, pending))

    def _write(self, pending: _Pending, data: bytes) -> None:
        self.write(self._folder, pending.frame, data)
        if self._pending is pending:
            self._pending = None


def _at_once(render: Callable[[], bytes], take: Callable[[bytes], None]) -> None:
    take(render())


def write_frame(folder: Path, frame: int, data: bytes) -> None:
    """Write a frame under another name and rename it, as tethered cameras do.

    Raises
    ------
    gonio.errors.StorageError
        When the disk is full or the folder gone.
    """
    target = folder / f"frame_{frame:06d}.dng"
    aside = folder / f".frame_{frame:06d}.part"
    try:
        aside.write_bytes(data)
        aside.replace(target)
    except OSError as error:
        raise StorageError.from_os(target, error) from error
