"""How far the twin is from ideal, chosen by name or by a file of sizes."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from gonio.errors import BadInputError
from gonio.validation import check, parse_toml, read_text
from sim import arm_imperfections, camera_imperfections
from sim.arm_imperfections import ArmImperfections
from sim.camera_imperfections import CameraImperfections

_REMEDY = "compare it with docs/topics/imperfections.md"


class Imperfections(ArmImperfections, CameraImperfections):
    """Sizes of everything that is not ideal; as it is made without arguments, nothing is."""

    @property
    def of_camera(self) -> CameraImperfections:
        """Those of camera and lamps alone."""
        fields = CameraImperfections.model_fields
        return CameraImperfections.model_validate({name: getattr(self, name) for name in fields})


def _both(arm: ArmImperfections, camera: CameraImperfections) -> Imperfections:
    return Imperfections.model_validate(arm.model_dump() | camera.model_dump())


IDEAL: Final = Imperfections()

BY_NAME: Final = {
    "none": IDEAL,
    "mild": _both(arm_imperfections.MILD, camera_imperfections.MILD),
    "all": _both(arm_imperfections.ALL, camera_imperfections.ALL),
}


def load_imperfections(name: str) -> Imperfections:
    """Return imperfections by name, or from a file that ends in .toml.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name.
    gonio.errors.BadFileError
        When the file is missing, is not TOML, or a key is unknown or out of range.
    """
    if name.endswith(".toml"):
        path = Path(name)
        data = parse_toml(read_text(path, _REMEDY), path, _REMEDY)
        return check(Imperfections, data, path, _REMEDY)
    if name not in BY_NAME:
        raise BadInputError(
            f"imperfections {name!r} are not known; use {', '.join(BY_NAME)}, or the path of a "
            ".toml file"
        )
    return BY_NAME[name]
