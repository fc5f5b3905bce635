"""`gonio geometry`: camera and view arm, calibrated by views of the holder's board."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from rich.table import Table

    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.session import Session


@click.command(name="geometry")
@click.argument("root", metavar="[SESSION]", type=click.Path(path_type=Path), default="session")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("geometry.json"),
    show_default=True,
    help="The file of what was found; one that is there is replaced.",
)
@answers
def command(*, root: Path, output: Path) -> None:
    """Find the camera's intrinsics and the view arm's axes from the board in SESSION's shots.

    Offsets and tilts of the axes, the camera's distance and where the axes meet come with their
    uncertainties; those beyond 0.03 deg or 0.05 mm are marked. It takes a sensor of 2000 px or more
    and some twenty views of theta up to 60 deg, at azimuths all round. Of a twin the true values
    stand beside those found.

    \b
    Examples:
        gonio plan --view-candidates rings:0x1,30x6,60x6 --views all --lights 1 -o views.json
        gonio capture --sim --rig fine.toml --material charuco --plan views.json -o board/
        gonio geometry board/
        gonio reduce session/ --geometry geometry.json
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._console import console, note, progress_bar
    from gonio.photogrammetry.adjustment import adjust
    from gonio.photogrammetry.detection import LEAST_PX_PER_MODULE
    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.reduce.survey import survey
    from gonio.session import Session
    from gonio.words import several

    session = Session.open(root)
    rig = session.rig()
    with progress_bar("finding the board") as progress:
        views = survey(session, progress)
    geometry = Geometry.of(rig, adjust(rig.camera, views))
    geometry.save(output)
    true = _true(session)
    console.print(_table(geometry, true))
    console.print(_residuals(geometry, len(views)))
    if small := len(session.chain().shots) - len(views):
        note(
            f"{several(small, 'view')} left out: a module of the board's markers is below "
            f"{LEAST_PX_PER_MODULE:g} px there"
        )
    console.print(f"geometry: {output}")
    answer(
        {
            "file": output,
            "found": geometry.values,
            "sigma": geometry.sigmas,
            "injected": true,
            "views_shown": len(views),
            "residuals": geometry.residuals.model_dump(),
            "within_limits": _within_limits(geometry),
        }
    )


def _true(session: Session) -> dict[str, float] | None:
    """Return what the session's twin was made with; None of a real rig."""
    if not session.sim.is_dir():
        return None
    from gonio.api.twin import recall
    from gonio.photogrammetry.model import DISTORTION, INTRINSICS

    camera = session.rig().camera
    values = (camera.focal_px, *camera.centre_px, *camera.distortion)
    alignment = recall(session, None, None, None).imperfections.alignment("view")
    intrinsics = zip((*INTRINSICS, *DISTORTION), values, strict=False)
    return dict(intrinsics) | alignment.model_dump()


def _table(geometry: Geometry, true: dict[str, float] | None) -> Table:
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("", "found", "sigma", *(("injected", "off") if true else ())):
        table.add_column(title, justify="right" if title else "left")
    for name, value in geometry.values.items():
        sigma = geometry.sigmas[name]
        beyond = sigma > _limit(name)
        known = (f"{true[name]:.5g}", f"{value - true[name]:+.2g}") if true else ()
        mark = " (!)" if beyond else ""
        table.add_row(name, f"{value:.6g}", f"{sigma:.2g}{mark}", *known)
    return table


def _limit(name: str) -> float:
    from gonio.photogrammetry.geometry_file import LIMIT_DEG, LIMIT_MM

    limits = {"deg": LIMIT_DEG, "mm": LIMIT_MM}
    return limits.get(name.rpartition("_")[2], float("inf"))


def _residuals(geometry: Geometry, shown: int) -> str:
    left = geometry.residuals
    verdict = "within limits" if _within_limits(geometry) else "BEYOND LIMITS"
    return (
        f"{left.corners} corners in {left.views} of {shown} views: {left.corner_px:.3f} px or "
        f"{left.corner_mm:.4f} mm (limit {_limit('_mm'):g}), angles {left.angle_deg:.4f} deg "
        f"(limit {_limit('_deg'):g}): {verdict}"
    )


def _within_limits(geometry: Geometry) -> bool:
    left = geometry.residuals
    return left.corner_mm <= _limit("_mm") and left.angle_deg <= _limit("_deg")
