"""A camera by libgphoto2, through the package gphoto2."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING, Any, TypeVar

from gonio.errors import (
    BadInputError,
    DeviceFaultError,
    MissingExtraError,
    TransportLostError,
    TransportTimeoutError,
)
from gonio.files import write_bytes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

T = TypeVar("T")

# of gphoto2/gphoto2-port-result.h and gphoto2/gphoto2-result.h
_TIMEOUT, _HELD, _NO_SETTING, _NO_CAMERA = -10, -53, -2, -105
_PORT = range(-60, -6)


class GPhotoPort:
    """A `gonio.transports.CameraPort` at USB: the one camera that libgphoto2 finds there.

    It connects when it is first asked; a connection that broke is made anew at the next request.
    """

    def __init__(self) -> None:
        self._camera: Any = None

    def connect(self) -> None:
        """Connect (see `gonio.transports.CameraPort`).

        Raises
        ------
        gonio.errors.BadInputError
            When there are several cameras.
        gonio.errors.MissingExtraError
            When the package gphoto2 is not installed.
        """
        self.close()
        self._opened()

    def read(self, name: str) -> str:
        """Return a setting (see `gonio.transports.CameraPort`)."""
        return str(self._ask(name, lambda camera: camera.get_single_config(name).get_value()))

    def write(self, name: str, value: str) -> None:
        """Change a setting (see `gonio.transports.CameraPort`)."""

        def change(camera: Any) -> None:
            widget = camera.get_single_config(name)
            widget.set_value(value)
            camera.set_single_config(name, widget)

        self._ask(f"{name} {value}", change)

    def choices(self, name: str) -> list[str]:
        """Return what a setting may be (see `gonio.transports.CameraPort`)."""
        gphoto2 = _library()

        def of(camera: Any) -> list[str]:
            widget = camera.get_single_config(name)
            is_choice = widget.get_type() in (gphoto2.GP_WIDGET_RADIO, gphoto2.GP_WIDGET_MENU)
            return [*widget.get_choices()] if is_choice else []

        return self._ask(name, of)

    def files(self) -> set[str]:
        """Return all paths (see `gonio.transports.CameraPort`)."""
        return self._ask("its files", lambda camera: {*_below(camera, "/")})

    def trigger(self) -> None:
        """Take a picture (see `gonio.transports.CameraPort`)."""
        self._ask("the trigger", lambda camera: camera.trigger_capture())

    def new_file(self, timeout_s: float) -> str | None:
        """Return what came (see `gonio.transports.CameraPort`)."""
        gphoto2 = _library()
        until_s = time.monotonic() + timeout_s
        while (left_s := until_s - time.monotonic()) > 0:
            kind, data = self._next_event(max(round(1000 * left_s), 1))
            if kind == gphoto2.GP_EVENT_FILE_ADDED:
                return f"{data.folder.rstrip('/')}/{data.name}"
            if kind == gphoto2.GP_EVENT_TIMEOUT:
                break
        return None

    def download(self, path: str, target: Path) -> int:
        """Fetch a file (see `gonio.transports.CameraPort`)."""
        gphoto2 = _library()
        folder, _, name = path.rpartition("/")

        def fetch(camera: Any) -> tuple[int, bytes]:
            size = int(camera.file_get_info(folder, name).file.size)
            file = camera.file_get(folder, name, gphoto2.GP_FILE_TYPE_NORMAL)
            return size, bytes(file.get_data_and_size())

        size, data = self._ask(path, fetch)
        write_bytes(target, data)
        return size

    def delete(self, path: str) -> None:
        """Delete a file (see `gonio.transports.CameraPort`)."""
        folder, _, name = path.rpartition("/")
        self._ask(f"deleting {path}", lambda camera: camera.file_delete(folder, name))

    def close(self) -> None:
        """Let go of the camera."""
        camera, self._camera = self._camera, None
        if camera is not None:
            # one that is gone already cannot be told
            with contextlib.suppress(_library().GPhoto2Error):
                camera.exit()

    def _next_event(self, timeout_ms: int) -> tuple[int, Any]:
        kind, data = self._ask("its events", lambda camera: camera.wait_for_event(timeout_ms))
        return kind, data

    def _opened(self) -> Any:
        if self._camera is None:
            gphoto2 = _library()
            _check_one(gphoto2.Camera.autodetect())
            camera = gphoto2.Camera()
            try:
                camera.init()
            except gphoto2.GPhoto2Error as error:
                raise _told("connecting", error) from None
            self._camera = camera
        return self._camera

    def _ask(self, what: str, request: Callable[[Any], T]) -> T:
        camera = self._opened()
        try:
            return request(camera)
        except _library().GPhoto2Error as error:
            fault = _told(what, error)
            if isinstance(fault, TransportLostError):
                self.close()
            raise fault from None


def _library() -> Any:
    try:
        import gphoto2
    except ImportError:
        raise MissingExtraError("gphoto2", "gphoto2") from None
    return gphoto2


def _check_one(found: Any) -> None:
    names = [f"{name} at {found.get_value(i)}" for i, name in enumerate(_names(found))]
    if not names:
        raise TransportLostError(
            "camera: none is found at USB; switch it on, and check its cable, its USB mode (PTP) "
            "and who may use the device"
        )
    if len(names) > 1:
        raise BadInputError(
            f"camera: there are several, {', '.join(names)}; leave the rig's own connected"
        )


def _names(found: Any) -> list[str]:
    return [found.get_name(number) for number in range(found.count())]


def _below(camera: Any, folder: str) -> Iterator[str]:
    root = folder.rstrip("/")
    yield from (f"{root}/{name}" for name in _names(camera.folder_list_files(folder)))
    for name in _names(camera.folder_list_folders(folder)):
        yield from _below(camera, f"{root}/{name}")


def _told(what: str, error: Any) -> DeviceFaultError:
    """Return what libgphoto2 says as one of ours."""
    said = f"camera: {what}: {error.string}"
    if error.code == _TIMEOUT:
        return TransportTimeoutError(f"{said}; check that it is awake, and its cable")
    if error.code == _HELD:
        return TransportLostError(
            f"{said}; another program holds it: close it, or unmount the camera there"
        )
    if error.code in _PORT or error.code == _NO_CAMERA:
        return TransportLostError(f"{said}; switch it on, and check its cable")
    if error.code == _NO_SETTING:
        return DeviceFaultError(f"{said}; it has no such setting: see gphoto2 --list-config")
    return DeviceFaultError(f"{said}; check its card, mode and focus")
