"""The scene file: how a material will be used."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field, model_validator

from gonio.validation import Document, check, parse_toml, read_text
from planner.scene.lights import Light
from planner.scene.surfaces import Surface
from planner.scene.viewers import Viewer

_REMEDY = "compare it with docs/topics/scenes.md"
_MOST = 1000


class Scene(Document):
    """Surfaces, lights and viewers; see docs/topics/scenes.md for every key."""

    surface: tuple[Surface, ...] = Field(min_length=1, max_length=_MOST)
    light: tuple[Light, ...] = Field(min_length=1, max_length=_MOST)
    viewer: tuple[Viewer, ...] = Field(min_length=1, max_length=_MOST)

    @model_validator(mode="after")
    def _some_weight(self) -> Scene:
        for name in ("surface", "light", "viewer"):
            if not any(each.weight for each in getattr(self, name)):
                raise ValueError(f"every {name} has weight 0; give one of them more")
        return self


def load_scene(path: Path | str) -> Scene:
    """Read and check a scene file.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, is not TOML, or a key is missing, unknown or out of range.
    """
    path = Path(path)
    return check(Scene, parse_toml(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY)
