"""`gonio reduce --btf`: from a session's raw frames to a picture for each pair of directions."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from gonio.cli._console import console, progress_bar
from gonio.cli._json import answer
from gonio.reduce.btf import btf_path, reduce_btf
from gonio.reduce.color import keep_color
from gonio.reduce.poses import keep_geometry
from gonio.session import Session
from gonio.words import duration

if TYPE_CHECKING:
    from pathlib import Path


def reduce_to_texels(
    root: Path,
    texels: int | None,
    scheduler: str | None,
    space: str | None,
    color_path: Path | None,
    geometry_path: Path | None,
    *,
    anew: bool,
) -> None:
    """Make the array of a session and say how large it is."""
    session = Session.open(root)
    began = time.perf_counter()
    with session.lock():
        if geometry_path is not None:
            keep_geometry(geometry_path, session)
        if color_path is not None:
            keep_color(color_path, session)
        with progress_bar("reducing to texels") as progress:
            btf = reduce_btf(
                session,
                texels=texels,
                space=space,
                scheduler=scheduler,
                anew=anew,
                progress=progress,
            )
        seconds = time.perf_counter() - began
        session.note_timing("reduce-btf", seconds)
    lights, views, side = btf.group["value"].shape[:3]
    console.print(f"{lights} lights x {views} views, {side} x {side} texels, {duration(seconds)}")
    console.print(f"texels: {btf_path(session)}")
    answer(
        {
            "folder": btf_path(session),
            "lights": lights,
            "views": views,
            "texels_along_side": side,
            "took_s": seconds,
        }
    )
