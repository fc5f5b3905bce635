"""The simulated rig of a session: which material it carries, and how it is put together."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from gonio.capture import Instrument
from gonio.clock import VirtualClock
from gonio.devices import Arm, FolderCamera, LampHead, LocalFolder
from gonio.errors import ResumeRefusedError
from gonio.files import sha256_file, write_json
from gonio.materials import reference_material
from gonio.reference import rig_with_reference
from gonio.validation import Document, check, parse_json, read_text
from sim.camera import SimCamera
from sim.materials import load_material
from sim.truth import write_truth
from sim.twin import Twin

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.capture.instrument import Holder
    from gonio.protocols import Material
    from gonio.rig import Rig
    from gonio.session import Session

_REMEDY = "this session was not made with --sim, or its sim folder is damaged"


class TwinSettings(Document):
    """What a session's twin is made of, so that a resume makes the same.

    Attributes
    ----------
    material
        An embedded name, or the whole path of a table.
    sha256
        Of the table's file; empty for an embedded name.
    seed
        Of all noise.
    """

    material: str
    sha256: str
    seed: int = Field(ge=0)

    @classmethod
    def of(cls, material: str, seed: int) -> TwinSettings:
        """Make the settings of a material as a user names it."""
        name = _whole(material)
        return cls(material=name, sha256=_digest(name), seed=seed)


def remember(session: Session, settings: TwinSettings, material: Material) -> None:
    """Store the twin's settings and its truth in a new session."""
    write_truth(session.truth_path, material)
    write_json(_path(session), settings.model_dump())


def recall(session: Session, material: str | None, seed: int | None) -> TwinSettings:
    """Return the settings a session was begun with.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        When another material or seed is asked for now, or the table's file has changed.
    """
    path = _path(session)
    settings = check(
        TwinSettings, parse_json(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY
    )
    asked = {"material": None if material is None else _whole(material), "seed": seed}
    for name, value in asked.items():
        begun = getattr(settings, name)
        if value is not None and value != begun:
            raise ResumeRefusedError(
                f"{session.root}: was begun with {name} {begun}, not {value}; resume without "
                f"--{name}, or start a new session with -o"
            )
    if _digest(settings.material) != settings.sha256:
        raise ResumeRefusedError(
            f"{session.root}: {settings.material} is not the file it was begun with; put that "
            "back, or start a new session with -o"
        )
    return settings


@contextlib.contextmanager
def simulated(session: Session, settings: TwinSettings) -> Iterator[tuple[Instrument, SimOperator]]:
    """Put the twin together, on a clock that goes on where the session's journal ends."""
    rig = rig_with_reference(session)
    frames = session.sim / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    clock = VirtualClock(_last_time(session))
    camera = SimCamera(rig, load_material(settings.material), settings.seed)
    twin = Twin(rig, camera, clock, frames, settings.seed, _taken(session))
    yield _driven(twin, rig, frames, clock), SimOperator(twin)
    shutil.rmtree(frames)


@contextlib.contextmanager
def simulated_rig(rig: Rig, seed: int) -> Iterator[tuple[Instrument, SimOperator, Path]]:
    """Put a twin together without a session; yields a folder for its frames as well."""
    with tempfile.TemporaryDirectory() as folder:
        frames, scratch = Path(folder) / "frames", Path(folder) / "scratch"
        frames.mkdir()
        scratch.mkdir()
        clock = VirtualClock()
        twin = Twin(rig, SimCamera(rig, reference_material(rig), seed), clock, frames, seed)
        yield _driven(twin, rig, frames, clock), SimOperator(twin), scratch


def _driven(twin: Twin, rig: Rig, frames: Path, clock: VirtualClock) -> Instrument:
    return Instrument(
        arm=Arm(twin.bus, rig, clock),
        lamps=LampHead(twin.line, rig, clock),
        camera=FolderCamera(LocalFolder(frames), rig, clock),
        clock=clock,
    )


class SimOperator:
    """The twin changes the sample itself."""

    def __init__(self, twin: Twin) -> None:
        self._twin = twin

    def place(self, what: Holder) -> None:
        """Put the reference or the sample into the twin's holder."""
        self._twin.holder = what


def _whole(material: str) -> str:
    """Return a table's whole path, so that a resume finds it from any folder."""
    return str(Path(material).resolve()) if material.endswith(".npz") else material


def _digest(material: str) -> str:
    path = Path(material)
    return sha256_file(path) if material.endswith(".npz") and path.is_file() else ""


def _taken(session: Session) -> Counter[tuple[bool, int]]:
    """Count the frames of the reference so far, by whether it was lit and by exposure in us."""
    if not session.journal_path.is_file():
        return Counter()
    with session.journal() as journal:
        records = [record for record in journal.frames() if record.role != "shot"]
    return Counter((record.role == "white", round(1e6 * record.exposure_s)) for record in records)


def _path(session: Session) -> Path:
    return session.sim / "twin.json"


def _last_time(session: Session) -> float:
    if not session.journal_path.is_file():
        return 0.0
    with session.journal() as journal:
        return max((event.at_s for event in journal.events()), default=0.0)
