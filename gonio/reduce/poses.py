"""The camera's pose of each frame: by the encoders, the rig's geometry and the board."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gonio.photogrammetry.detection import LEAST_PX_PER_MODULE, find_corners, px_per_module
from gonio.photogrammetry.geometry_file import Geometry
from gonio.photogrammetry.refinement import refined_pose
from gonio.reduce.picture import best_exposed, picture_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from gonio.reduce.frames import Frame
    from gonio.rig import CameraSpec
    from gonio.session import Session


def posed(frames: Sequence[Frame], geometry: Geometry, spec: CameraSpec) -> list[Frame]:
    """Return frames of one pose with what the board tells of it, where it is seen.

    Parameters
    ----------
    frames
        A bracket, posed by encoders and alignment; the best exposed is searched for the board.
    geometry
        Of the rig.
    spec
        The camera.
    """
    best = best_exposed(frames)
    if px_per_module(spec, best.view.theta) < LEAST_PX_PER_MODULE:
        return list(frames)
    seen = find_corners(picture_of(best.raw), best.view.theta, best.view.phi)
    pose = refined_pose(geometry, spec, seen)
    return [replace(frame, view=pose) for frame in frames]


def keep_geometry(path: Path, session: Session) -> None:
    """Give a session a geometry, by which it is reduced from then on.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken or of another rig.
    """
    Geometry.load(path, session.rig()).save(session.geometry_path)


def kept_geometry(session: Session) -> Geometry | None:
    """Return the geometry that a session was given; None where it has none.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken or of another rig.
    """
    if not session.geometry_path.is_file():
        return None
    return Geometry.load(session.geometry_path, session.rig())
