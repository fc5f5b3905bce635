"""A twin with a camera that makes tiny files, and captures on it."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from gonio.capture import Capture, Instrument
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.devices import Arm, FolderCamera, LampHead, LocalFolder
from gonio.notes import Notes
from gonio.rig import default_rig_text, load_rig
from sim.dng import dng_bytes
from sim.twin import Twin

NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")
DNG = dng_bytes(
    np.arange(64, dtype=np.uint16).reshape(8, 8),
    black=0,
    white=65535,
    exposure_s=0.1,
    iso=100,
    color_matrix=np.eye(3),
    as_shot_neutral=np.ones(3),
    camera_model="test",
    unique_id="0" * 32,
)


class TinyCamera:
    """Makes whole, tiny files."""

    def frame(self, **scene):
        return DNG


class Nobody:
    def place(self, what):
        pass


@dataclass
class Stage:
    """A session and a twin to capture it on.

    Attributes
    ----------
    took_s
        Rig time of the last run.
    """

    session: object
    folder: object
    seed: int = 0
    meddle: object = lambda twin, instrument: None
    took_s: float = field(default=0.0, init=False)

    def run(self):
        """Capture what is missing, on a twin that was just switched on."""
        rig, clock = self.session.rig(), VirtualClock()
        self.folder.mkdir(exist_ok=True)
        twin = Twin(rig, TinyCamera(), clock, self.folder, self.seed)
        instrument = Instrument(
            arm=Arm(twin.bus, rig, clock),
            lamps=LampHead(twin.line, rig, clock),
            camera=FolderCamera(LocalFolder(self.folder), rig, clock),
            clock=clock,
        )
        self.meddle(twin, instrument)
        with self.session.journal(writing=True) as journal:
            try:
                return Capture(self.session, instrument, Nobody(), journal).run()
            finally:
                self.took_s = clock.now()

    def shots(self):
        """Return the frames of shots that the journal vouches for, as (shot, exposure)."""
        with self.session.journal() as journal:
            return [(r.shot_index, r.exposure_s) for r in journal.frames() if r.role == "shot"]


@pytest.fixture
def stage(tmp_path):
    """Make a stage of a plan: stage(plan, rig_text, seed)."""
    count = 0

    def make(plan_of, rig_text=None, seed=0):
        nonlocal count
        count += 1
        text = rig_text or default_rig_text()
        (tmp_path / "rig.toml").write_text(text)
        plan = plan_of(load_rig(tmp_path / "rig.toml"))
        session = create_session(tmp_path / f"session-{count}", plan, text, NOTES)
        return Stage(session, tmp_path / f"frames-{count}", seed)

    return make
