"""The timing that plans count with: named, found, or none."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.api.following import Tell
    from gonio.rig import Rig
    from gonio.timing import Timing


def timing_for(rig: Rig, rig_path: Path | None, named: Path | None, tell: Tell) -> Timing | None:
    """Return what was measured of a rig: as named, or found beside its file or in this folder.

    One that is merely found and is damaged or of another rig is told and not used.

    Raises
    ------
    gonio.errors.BadInputError
        When the one named is missing, damaged or of another rig.
    """
    from gonio.errors import BadInputError
    from gonio.timing import TIMING_NAME

    if named is not None:
        return _of_this_rig(named, rig, rig_path)
    folders = [*([rig_path.parent] if rig_path else []), Path()]
    for path in dict.fromkeys(folder / TIMING_NAME for folder in folders):
        if path.exists():
            try:
                return _of_this_rig(path, rig, rig_path)
            except BadInputError as error:
                tell(f"not used: {error}")
    return None


def _of_this_rig(path: Path, rig: Rig, rig_path: Path | None) -> Timing:
    from gonio.errors import BadInputError
    from gonio.timing import Timing

    timing = Timing.load(path)
    if timing.rig_sha256 != rig.sha256:
        measured = "gonio rig bench" + (f" --rig {rig_path}" if rig_path else "")
        raise BadInputError(
            f"{path}: is of the rig {timing.rig_sha256[:12]}, not of this one, "
            f"{rig.sha256[:12]}; measure this one with: {measured}"
        )
    return timing
