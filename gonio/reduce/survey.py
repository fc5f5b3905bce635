"""Views of the holder's board among the shots of a session."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.photogrammetry.detection import LEAST_PX_PER_MODULE, find_corners, px_per_module
from gonio.reduce.frames import Frames
from gonio.reduce.opening import records_of
from gonio.reduce.picture import best_exposed, picture_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.photogrammetry.detection import BoardView
    from gonio.plan import Shot
    from gonio.protocols import Progress
    from gonio.rig import CameraSpec
    from gonio.session import Session


def survey(session: Session, progress: Progress | None = None) -> list[BoardView]:
    """Find the board in the best exposed frame of each shot.

    Shots that are too oblique for the sensor are left out.

    Parameters
    ----------
    session
        Whose sample is the board, or lies in it.
    progress
        Called with the number of shots done and of all.

    Raises
    ------
    gonio.errors.BadInputError
        When a frame is missing or damaged, or no shot shows markers large enough.
    """
    spec = session.rig().camera
    shots = _legible(session, spec)
    remedy = f"take it again with: {session.resume_command}"
    frames = Frames(session.root, spec, records_of(session), remedy)
    views = []
    for done, shot in enumerate(shots, start=1):
        best = best_exposed(frames.of_shot(shot))
        views.append(find_corners(picture_of(best.raw), best.view.theta, best.view.phi))
        if progress is not None:
            progress(done, len(shots))
    return views


def _legible(session: Session, spec: CameraSpec) -> Sequence[Shot]:
    shots = session.chain().shots
    sizes = [px_per_module(spec, np.radians(shot.view_theta_deg)) for shot in shots]
    if max(sizes) < LEAST_PX_PER_MODULE:
        raise BadInputError(
            f"{session.root}: a module of the board's markers is {max(sizes):.1f} px, and "
            f"{LEAST_PX_PER_MODULE:g} are needed; use a sensor of 2000 px or more and views up to "
            "60 deg, or leave the geometry as the rig file has it"
        )
    return [s for s, size in zip(shots, sizes, strict=True) if size >= LEAST_PX_PER_MODULE]
