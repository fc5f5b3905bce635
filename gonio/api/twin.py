"""The simulated rig of a session: which material it carries, and how it is put together."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from gonio.api.rehearsal import UnsyncedFolder
from gonio.calibration import TwinIdentity
from gonio.capture import Instrument
from gonio.clock import VirtualClock
from gonio.devices import LocalFolder
from gonio.errors import ResumeRefusedError
from gonio.files import canonical_json, sha256_bytes, sha256_file, write_json
from gonio.materials import reference_material
from gonio.reference import rig_with_reference
from gonio.validation import Document, check, parse_json, read_text
from sim.blank import BlankCamera
from sim.camera import SimCamera
from sim.faults import faulty_wires
from sim.imperfections import IDEAL, Imperfections, load_imperfections
from sim.materials import EMBEDDED, load_material
from sim.truth import write_truth
from sim.twin import Twin

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.capture.instrument import Holder
    from gonio.protocols import Material
    from gonio.rig import Rig
    from gonio.session import Session
    from gonio.transports import FrameFolder
    from sim.faults import Fault
    from sim.tether import Camera

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
    imperfections
        Of arms, camera and lamps; whole, so that a resume needs no file of them.
    """

    material: str
    sha256: str
    seed: int = Field(ge=0)
    imperfections: Imperfections = Field(default=IDEAL, exclude_if=lambda it: it == IDEAL)

    @property
    def camera(self) -> TwinIdentity:
        """Which simulated sensor it has."""
        return twin_identity(self.seed, self.imperfections)

    @classmethod
    def of(cls, material: str, seed: int, imperfections: str | None) -> TwinSettings:
        """Make the settings of a material and imperfections as a user names them."""
        name = _whole(material)
        less_than_ideal = load_imperfections(imperfections or "none")
        return cls(material=name, sha256=_digest(name), seed=seed, imperfections=less_than_ideal)


def unstated(imperfections: Imperfections, rig: Rig) -> str:
    """Return what is not ideal about a twin and leaves sigma too small, as its rig file is silent.

    Empty where nothing is.
    """
    uncertainty = rig.uncertainty
    colors = imperfections.lamp_red_per_c or imperfections.lamp_blue_per_c
    bends = imperfections.arm_sag_urad or imperfections.arm_expansion_urad_k
    silent = [
        ("its lamps change color ([lamps] warm_up_s, [uncertainty] lamp_color)",
         colors and not uncertainty.lamp_color),
        ("its arms bend ([uncertainty] angle_deg)", bends and not uncertainty.angle_deg),
    ]  # fmt: skip
    told = " and ".join(words for words, is_so in silent if is_so)
    return (
        f"the twin is less than its rig file states: {told}; sigma leaves that out" if told else ""
    )


def twin_identity(seed: int, imperfections: Imperfections) -> TwinIdentity:
    """Return which simulated sensor a seed and imperfections make."""
    sizes = imperfections.of_camera.model_dump(mode="json")
    return TwinIdentity(seed=seed, imperfections_sha256=sha256_bytes(canonical_json(sizes)))


def remember(session: Session, settings: TwinSettings, material: Material) -> None:
    """Store the twin's settings and its truth in a new session."""
    write_truth(session.truth_path, material)
    # what is as in an ideal twin is left out: such a session is as those of earlier versions
    write_json(_path(session), settings.model_dump(exclude_defaults=True))


def recall(
    session: Session, material: str | None, seed: int | None, imperfections: str | None
) -> TwinSettings:
    """Return the settings a session was begun with.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        When another material, seed or imperfections are asked for now, or the table's file has
        changed.
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
    if imperfections and load_imperfections(imperfections) != settings.imperfections:
        raise ResumeRefusedError(
            f"{session.root}: was begun with other imperfections; resume without --imperfections, "
            "or start a new session with -o"
        )
    if _digest(settings.material) != settings.sha256:
        raise ResumeRefusedError(
            f"{session.root}: {settings.material} is not the file it was begun with; put that "
            "back, or start a new session with -o"
        )
    return settings


def carried(session: Session) -> Material | None:
    """Return the embedded material that a session's twin carried; None for a table."""
    name = recall(session, None, None, None).material
    return EMBEDDED[name].material if name in EMBEDDED else None


@contextlib.contextmanager
def simulated(
    session: Session, settings: TwinSettings, faults: Sequence[Fault] = ()
) -> Iterator[tuple[Instrument, SimOperator]]:
    """Put the twin together, on a clock that goes on where the session's journal ends.

    Parameters
    ----------
    session, settings
        What is measured, and of what.
    faults
        What may go wrong.
    """
    rig = rig_with_reference(session)
    frames = session.sim / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    clock = VirtualClock(session.clock_s())
    camera, folder = _camera(session, rig, settings, frames)
    twin = Twin(
        rig, camera, clock, frames, settings.seed, _taken(session),
        imperfections=settings.imperfections,
    )  # fmt: skip
    wires = faulty_wires(twin, rig, folder, clock, faults, settings.seed)
    yield Instrument.of(wires.bus, wires.line, wires.folder, rig, clock), SimOperator(twin)
    shutil.rmtree(frames)


def _camera(
    session: Session, rig: Rig, settings: TwinSettings, frames: Path
) -> tuple[Camera, FrameFolder]:
    """Return the twin's camera, and the folder that its files are fetched from."""
    if session.notes().rehearsal:
        return BlankCamera(settings.seed), UnsyncedFolder(frames)
    material = load_material(settings.material)
    camera = SimCamera(rig, material, settings.seed, settings.imperfections.of_camera)
    return camera, LocalFolder(frames)


@contextlib.contextmanager
def simulated_rig(
    rig: Rig, seed: int, imperfections: Imperfections = IDEAL
) -> Iterator[tuple[Instrument, SimOperator, Path]]:
    """Put a twin together without a session; yields a folder for its frames as well."""
    with tempfile.TemporaryDirectory() as folder:
        frames, scratch = Path(folder) / "frames", Path(folder) / "scratch"
        frames.mkdir()
        scratch.mkdir()
        clock = VirtualClock()
        camera = SimCamera(rig, reference_material(rig), seed, imperfections.of_camera)
        twin = Twin(rig, camera, clock, frames, seed, imperfections=imperfections)
        instrument = Instrument.of(twin.bus, twin.line, LocalFolder(frames), rig, clock)
        yield instrument, SimOperator(twin), scratch


class SimOperator:
    """The twin changes the sample itself."""

    by_hand = False

    def __init__(self, twin: Twin) -> None:
        self._twin = twin

    def place(self, what: Holder) -> None:
        """Put the reference or the sample into the twin's holder."""
        self._twin.holder = what


def _whole(material: str) -> str:
    """Return a table's whole path, so that a resume finds it from any folder."""
    return str(Path(material).resolve()) if Path(material).suffix else material


def _digest(material: str) -> str:
    path = Path(material)
    return sha256_file(path) if path.suffix and path.is_file() else ""


def _taken(session: Session) -> Counter[tuple[bool, int]]:
    """Count the frames of the reference so far, by whether it was lit and by exposure in us."""
    if not session.journal_path.is_file():
        return Counter()
    with session.journal() as journal:
        records = [record for record in journal.frames() if record.role != "shot"]
    return Counter((record.role == "white", round(1e6 * record.exposure_s)) for record in records)


def _path(session: Session) -> Path:
    return session.sim / "twin.json"
