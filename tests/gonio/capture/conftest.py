"""A twin with a camera that makes tiny files, and captures on it."""

from dataclasses import dataclass, field

import pytest

from gonio.capture import Capture, Instrument
from gonio.capture.frames import FrameTaker
from gonio.capture.usage import Usage, usages_of
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.devices import LocalFolder
from gonio.notes import Notes
from gonio.rig import default_rig_text, load_rig
from sim import tether
from sim.faults import faulty_wires
from sim.twin import Twin
from tests.tiny import TinyCamera

NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")


class Nobody:
    by_hand = False

    def place(self, what):
        pass


@dataclass
class Stage:
    """A session and a twin to capture it on.

    Attributes
    ----------
    took_s, exposed
        Rig time of the last run, and how often its shutter was opened.
    """

    session: object
    folder: object
    seed: int = 0
    meddle: object = lambda twin, instrument: None
    faults: tuple = ()
    clock: object = field(default=None, init=False)
    took_s: float = field(default=0.0, init=False)
    exposed: int = field(default=0, init=False)

    def run(self):
        """Capture what is missing, on a twin that was just switched on."""
        rig, clock = self.session.rig(), VirtualClock()
        self.clock = clock
        self.folder.mkdir(exist_ok=True)
        twin = Twin(rig, TinyCamera(), clock, self.folder, self.seed)
        folder = LocalFolder(self.folder)
        wires = faulty_wires(twin, rig, folder, clock, self.faults, self.seed)
        instrument = Instrument.of(wires.bus, wires.line, wires.folder, rig, clock)
        self.meddle(twin, instrument)
        with self.session.journal(writing=True) as journal:
            try:
                return Capture(self.session, instrument, Nobody(), journal).run()
            finally:
                self.took_s = clock.now()
                self.struck = dict(wires.struck)
                self.exposed = int((*twin.lamps.shutter.status.split(), 0)[1])

    def run_and_stop(self, after):
        """Press Ctrl-C at the first move when so many frames of shots are there."""

        def meddle(twin, instrument):
            move = instrument.arm.move

            def and_stop(*where):
                if len(self.shots()) >= after:
                    raise KeyboardInterrupt
                move(*where)

            instrument.arm.move = and_stop

        before, self.meddle = self.meddle, meddle
        with pytest.raises(KeyboardInterrupt):
            self.run()
        self.meddle = before

    def noted(self):
        """Return the faults in the journal, as (what, did)."""
        with self.session.journal() as journal:
            return [(event.data["what"], event.data["did"]) for event in journal.events("fault")]

    def usage(self):
        """Return what the time of all runs went into."""
        with self.session.journal() as journal:
            return Usage.sum(usages_of(journal))

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


@pytest.fixture
def slow_camera(monkeypatch):
    """Let a file take 1.5 to 2 s, as those of real cameras do."""
    monkeypatch.setattr(tether, "_QUICKEST_S", 1.5)
    monkeypatch.setattr(tether, "_SLOWEST_S", 2.0)


@pytest.fixture
def serial_order(monkeypatch):
    """Let every file be waited for before anything else happens."""
    take = FrameTaker.take

    def and_fetch(self, frames, folder):
        take(self, frames, folder)
        self.fetch()

    monkeypatch.setattr(FrameTaker, "take", and_fetch)
