"""What a capture that something ended says: how to go on."""

import sys

import pytest

from gonio.capture import Capture, Instrument
from gonio.cli import main
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.devices import LocalFolder
from gonio.errors import BadInputError, DeviceFaultError, StorageError
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text, load_rig
from nnbrdf.analytic import Lambert
from planner.make import make_plan
from sim.camera import SimCamera
from sim.twin import Twin

RIG = default_rig_text()
NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")


@pytest.fixture
def start(tmp_path):
    """Run a capture of four shots on a twin, to which `meddle` has been done."""

    def run(meddle=lambda twin: None, rig_text=RIG):
        plan = make_plan(default_rig(), views=2, lights=2)
        session = create_session(tmp_path / "a b", plan, rig_text, NOTES)
        clock, rig, frames = VirtualClock(), default_rig(), tmp_path / "frames"
        frames.mkdir()
        twin = Twin(rig, SimCamera(rig, Lambert((0.2, 0.2, 0.2)), 0), clock, frames, 0)
        meddle(twin)
        instrument = Instrument.of(twin.bus, twin.line, LocalFolder(frames), rig, clock)
        operator = type("Nobody", (), {"place": lambda self, what: None, "by_hand": False})()
        with session.journal(writing=True) as journal:
            Capture(session, instrument, operator, journal).run()

    return run


def told(error, tmp_path):
    (note,) = error.__notes__
    return note == f"go on with: gonio capture --resume -o '{tmp_path}/a b'"


def test_a_device_fault(start, tmp_path):
    with pytest.raises(DeviceFaultError, match="interlock open") as caught:
        start(lambda twin: twin.set_interlock(True))
    assert told(caught.value, tmp_path)


def test_a_full_disk(start, tmp_path, monkeypatch):
    usage = type("Usage", (), {"free": 1000})()
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    with pytest.raises(StorageError) as caught:
        start()
    assert str(caught.value).endswith(f"or remove the session with: rm -r '{tmp_path}/a b'")
    assert told(caught.value, tmp_path)


REFUSED = {
    "a full disk": ((), 3, "free; free some space or choose another folder with -o\n"),
    "out of reach": (("--rig", "short.toml"), 2, "view_theta 45 deg is beyond the axis' travel"),
}


@pytest.mark.parametrize(("options", "code", "says"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_measured_leaves_nothing_behind(
    tmp_path, monkeypatch, capsys, options, code, says
):
    if not options:
        usage = type("Usage", (), {"free": 1000})()
        monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(RIG.replace("max_deg = 91.0", "max_deg = 44.0", 1))
    rig = default_rig() if not options else load_rig(tmp_path / "short.toml")
    plan = make_plan(default_rig()).model_copy(update={"rig_sha256": rig.sha256})
    plan.save(tmp_path / "plan.json")
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr(sys, "argv", ["gonio", "capture", "--sim", "-o", "a/b", *options])
    with pytest.raises(SystemExit) as caught:
        main()
    assert caught.value.code == code
    assert says in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == before


def test_a_plan_out_of_reach_is_not_gone_on_with(start):
    with pytest.raises(BadInputError) as caught:
        start(rig_text=RIG.replace("max_deg = 91.0", "max_deg = 44.0", 1))
    assert not hasattr(caught.value, "__notes__")


def test_a_plan_for_another_rig_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slow.toml").write_text(
        RIG.replace("max_velocity_deg_s = 20.0", "max_velocity_deg_s = 2.0")
    )
    make_plan(default_rig(), views=2, lights=2).save(tmp_path / "plan.json")
    monkeypatch.setattr(sys, "argv", ["gonio", "capture", "--sim", "--rig", "slow.toml"])
    with pytest.raises(SystemExit) as caught:
        main()
    assert caught.value.code == 2
    assert "plan.json: was made for another rig" in capsys.readouterr().err
    assert not (tmp_path / "session").exists()
