"""A session measured by a real RunEngine on the twin."""

import contextlib

import numpy as np
import pytest

from gonio.bluesky import bench, scan
from gonio.capture import Instrument
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.devices import LocalFolder
from gonio.errors import DeviceFaultError
from gonio.notes import Notes
from gonio.rig import AXES, default_rig_text, load_rig
from gonio.watch.state import Watched
from planner.make import make_plan
from sim.faults import Fault, faulty_wires
from sim.twin import Twin
from tests.tiny import TinyCamera

pytest.importorskip("bluesky")

import bluesky.plan_stubs as bps
import bluesky.preprocessors as bpp
from bluesky import RunEngine
from bluesky.utils import FailedStatus, RunEngineInterrupted

# of the status word, as CiA 402 has it
ENABLED = 0x27
NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")
# the first of a shot's two frames
PAUSED_AFTER = 21
RIG = (
    default_rig_text()
    .replace("[0.002, 0.02, 0.2, 2.0]", "[0.02, 0.2]")
    .replace("[lamps]\n", "[lamps]\nwarm_up_s = 5.0\n")
)


class Nobody:
    by_hand = False

    def __init__(self):
        self.placed = []

    def place(self, what):
        self.placed.append(what)


class Lab:
    """A session of four shots, and a twin that is switched on for each run."""

    def __init__(self, root):
        (root / "rig.toml").write_text(RIG)
        rig = load_rig(root / "rig.toml")
        plan = make_plan(rig, views=2, lights=2)
        self.session = create_session(root / "session", plan, RIG, NOTES)
        self.frames, self.documents = root / "frames", []
        self.frames.mkdir()
        self.engine = RunEngine(context_managers=[])
        self.engine.subscribe(lambda name, document: self.documents.append((name, document)))

    @contextlib.contextmanager
    def driven(self, *faults):
        clock = VirtualClock(self.session.clock_s())
        self.twin = Twin(self.session.rig(), TinyCamera(), clock, self.frames, 0)
        files = LocalFolder(self.frames)
        wires = faulty_wires(self.twin, self.session.rig(), files, clock, faults, 0)
        instrument = Instrument.of(wires.bus, wires.line, wires.folder, self.session.rig(), clock)
        self.operator = Nobody()
        yield instrument, self.operator

    def named(self, name):
        return [document for kind, document in self.documents if kind == name]

    def events(self, stream):
        (uid,) = {d["uid"] for d in self.named("descriptor") if d["name"] == stream}
        # what a RunEngine goes back over it tells again, under the same numbers
        found = {d["seq_num"]: d["data"] for d in self.named("event") if d["descriptor"] == uid}
        return list(found.values())

    def recorded(self):
        with self.session.journal() as journal:
            return list(journal.frames())

    def kinds(self):
        with self.session.journal() as journal:
            kinds = [event.kind for event in journal.events()]
        return [kind for kind in kinds if kind not in ("frame", "fault")]

    @property
    def is_safe(self):
        lit = any(led.on for led in self.twin.lamps.leds)
        enabled = any(self.twin.bus.read(n, 1, 1)[0] & 0x6F == ENABLED for n in range(1, 5))
        return not lit and not enabled


@pytest.fixture
def lab(tmp_path):
    return Lab(tmp_path)


def test_a_session_is_measured(lab):
    with bench(lab.session, lab.driven()) as devices:
        lab.engine(scan(devices))
    assert lab.operator.placed == ["reference", "sample"]
    shots = [record for record in lab.recorded() if record.role == "shot"]
    events = lab.events("primary")
    assert [event["camera_sha256"] for event in events] == [record.sha256 for record in shots]
    assert [event["camera_file"] for event in events] == [record.file for record in shots]
    for event, record in zip(events, shots, strict=True):
        for axis in AXES:
            # the arm rests while its frames are taken; encoders are noisy
            found, noted = event[f"arm_{axis}_deg"], getattr(record, f"{axis}_deg")
            assert abs(found - noted) < 0.01
        assert np.count_nonzero(event["lamps_mA"]) == np.count_nonzero(event["camera_flux"])
    (start,) = lab.named("start")
    assert start["plan_sha256"] == lab.session.chain().last.sha256
    assert len(lab.events("dark"))
    assert len(lab.events("white"))
    assert lab.is_safe
    assert lab.kinds() == ["begun", "homed", "finished"]
    assert Watched(lab.session).state()["phase"] == "finished"


def test_what_is_there_is_not_taken_again(lab):
    with bench(lab.session, lab.driven()) as devices:
        lab.engine(scan(devices))
    before = lab.recorded()
    with bench(lab.session, lab.driven()) as devices:
        lab.engine(scan(devices))
    assert lab.recorded() == before
    assert lab.operator.placed == []
    assert lab.kinds() == ["begun", "homed", "finished", "begun", "finished"]


def test_a_pause_is_dark_and_goes_back_to_the_pose(lab):
    saved = 0

    def pausing(message):
        nonlocal saved
        saved += message.command == "save"
        if message.command == "save" and saved == PAUSED_AFTER:
            return None, bps.pause()
        return None, None

    with bench(lab.session, lab.driven()) as devices:
        with pytest.raises(RunEngineInterrupted):
            lab.engine(bpp.plan_mutator(scan(devices), pausing))
        assert lab.is_safe
        before = [record.sha256 for record in lab.recorded()]
        lab.engine.resume()
    shots = [(r.shot_index, r.exposure_s) for r in lab.recorded() if r.role == "shot"]
    assert len(shots) == len(set(shots)) == 8
    assert [record.sha256 for record in lab.recorded()][: len(before)] == before
    assert [event["camera_sha256"] for event in lab.events("primary")] == [
        record.sha256 for record in lab.recorded() if record.role == "shot"
    ]
    assert lab.is_safe
    assert lab.kinds() == ["begun", "homed", "paused", "resumed", "finished"]


def test_a_stall_fails_the_run_and_leaves_the_rig_safe(lab):
    stall = Fault(kind="stall", axis="light_theta", at=(3,), lasts_s=600.0)
    with bench(lab.session, lab.driven(stall)) as devices, pytest.raises(FailedStatus) as failed:
        lab.engine(scan(devices))
    assert isinstance(failed.value.__cause__, DeviceFaultError)
    assert lab.is_safe
    assert lab.named("stop")[-1]["exit_status"] == "fail"
    assert lab.kinds() == ["begun", "homed", "stopped"]
    # and another run takes what is left
    with bench(lab.session, lab.driven()) as devices:
        lab.engine(scan(devices))
    assert len([record for record in lab.recorded() if record.role == "shot"]) == 8


def test_a_move_under_way_is_stopped(lab):
    with bench(lab.session, lab.driven()) as devices:
        assert devices.arm.stage().exception(None) is None
        clock = devices.arm._instrument.meanwhile
        sleep, waits = clock.sleep, []

        def and_stop(seconds):
            waits.append(seconds)
            if len(waits) == 3:
                devices.arm.stop()
            sleep(seconds)

        clock.sleep = and_stop
        moving = devices.arm.set(dict.fromkeys(AXES, 10.0))
        assert "stopped by the RunEngine" in str(moving.exception(None))
        assert not moving.success
        angles = devices.arm.read()
        assert all(angles[f"arm_{axis}_deg"]["value"] < 9.0 for axis in AXES)
        assert lab.is_safe


def test_a_stop_after_a_move_fails_nothing(lab):
    with bench(lab.session, lab.driven()) as devices:
        assert devices.arm.stage().exception(None) is None
        assert devices.arm.set(dict.fromkeys(AXES, 1.0)).exception(None) is None
        devices.arm.stop(success=True)
        assert devices.lamps.set(devices.chain.shots[0].lamps).exception(None) is None
        assert devices.arm.set(dict.fromkeys(AXES, 2.0)).exception(None) is None
