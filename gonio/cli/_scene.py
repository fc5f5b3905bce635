"""The options of `gonio plan` that say how the material will be used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Callable

_OPTIONS = (
    click.option(
        "--scene",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE",
        help="How the material will be used: a scene file (docs/topics/scenes.md), or a Mitsuba "
        "scene (.xml, with --material). Without --shots, --hours, --density and the like: as few "
        "shots as know what the scene asks for as well as the default plan would.",
    ),
    click.option("--material", metavar="NAME", help="The material's id in a Mitsuba scene."),
    click.option(
        "--isotropic",
        is_flag=True,
        help="The material has no grain: only the difference of the azimuths counts. Planned as "
        "for a scene; without one all pairs count alike.",
    ),
    click.option("--mono", is_flag=True, help="Color does not count; the plan says what it saves."),
    click.option(
        "--plot-demand",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE.png",
        help="Also draw what the scene asks for.",
    ),
)


def scene_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options of a use, as `gonio.api.scene.SceneOptions` has them."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command
