"""A capture keeps the arms apart and out of boxes: the twin's true pose, recorded densely."""

import numpy as np
import pytest

from gonio.capture import Capture, Instrument, check_reach
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.devices import Arm, LocalFolder
from gonio.directions import from_spherical
from gonio.errors import BadInputError, DeviceFaultError
from gonio.notes import Notes
from gonio.paths import Way
from gonio.plan import Plan
from gonio.rig import AXES, Rig, default_rig, default_rig_text, load_rig
from nnbrdf.analytic import Lambert
from planner.make import make_plan
from sim.camera import SimCamera
from sim.twin import Twin

EVERY_S = 0.01
LOW, HIGH = np.array([-900.0, -200.0, 100.0]), np.array([-500.0, 200.0, 900.0])
NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")

# light theta homes at 95 deg, so that the arms are apart when the capture begins
RIG_TEXT = (
    default_rig_text()
    .replace("min_separation_deg = 0.0", "min_separation_deg = 12.0")
    .replace(
        "keep_out = []",
        f"keep_out = [{{ min_mm = {LOW.tolist()}, max_mm = {HIGH.tolist()} }}]",
    )
    .replace("-2000.0\nzero_counts = -6000", "2000.0\nzero_counts = -190000")
    .replace("width = 160\nheight = 160", "width = 16\nheight = 16")
    .replace("centre_px = [79.5, 79.5]", "centre_px = [7.5, 7.5]")
    .replace("exposures_s = [0.002, 0.02, 0.2, 2.0]", "exposures_s = [0.02]")
)  # fmt: skip

POSES = [
    # view, light: they change places, pass above, and go round the box
    (60, 40, 60, 60),
    (60, 60, 60, 40),
    (75, 300, 30, 40),
    (30, 30, 75, 300),
    (60, 130, 45, 90),
    (60, 230, 45, 90),
    (60, 130, 60, 230),
    (60, 230, 60, 130),
    (0, 0, 15, 300),
    (15, 300, 0, 0),
]


def plan_of(poses, rig):
    plan = make_plan(rig, views=1, lights=1)
    angles = [
        {f"{name}_deg": float(a) for name, a in zip(AXES, pose, strict=True)} for pose in poses
    ]
    shots = [
        plan.shots[0].model_copy(update={"index": index, **each})
        for index, each in enumerate(angles)
    ]
    return Plan.model_validate(plan.model_dump(by_alias=True) | {"shots": shots})


class Recorder:
    """Lays nothing under the camera, and writes down where the arms are from then on."""

    by_hand = False

    def __init__(self, twin, clock):
        self.twin, self.clock, self.poses = twin, clock, []

    def place(self, what):
        if not self.poses:
            self.look()

    def look(self):
        view, light = self.twin.pose("view"), self.twin.pose("light")
        self.poses.append((view.theta, view.phi, light.theta, light.phi))
        self.clock.call_at(self.clock.now() + EVERY_S, self.look)


@pytest.fixture
def capture(tmp_path):
    """Run a capture of POSES; return the true poses, radians, shape (n, 4), as in AXES."""

    def run():
        (tmp_path / "rig.toml").write_text(RIG_TEXT)
        rig = load_rig(tmp_path / "rig.toml")
        session = create_session(tmp_path / "s", plan_of(POSES, rig), RIG_TEXT, NOTES)
        clock, frames = VirtualClock(), tmp_path / "frames"
        frames.mkdir()
        twin = Twin(rig, SimCamera(rig, Lambert((0.2, 0.2, 0.2)), 0), clock, frames, 0)
        instrument = Instrument.of(twin.bus, twin.line, LocalFolder(frames), rig, clock)
        recorder = Recorder(twin, clock)
        with session.journal(writing=True) as journal:
            Capture(session, instrument, recorder, journal).run()
            taken = [record for record in journal.frames() if record.role == "shot"]
        for record, pose in zip(taken, POSES, strict=True):
            there = [getattr(record, f"{name}_deg") for name in AXES]
            assert there == pytest.approx(pose, abs=0.03)
        return np.array(recorder.poses)

    return run


def nearest_deg(poses):
    """Return the least angle between the arms."""
    view, light = from_spherical(*poses[:, :2].T), from_spherical(*poses[:, 2:].T)
    return np.degrees(np.arccos(np.clip((view * light).sum(axis=1), -1, 1))).min()


def nearest_mm(poses, half_width_mm):
    """Return the least distance of heads and lines of sight to the box, by many points on them."""
    towards = from_spherical(*poses.T)
    points = np.linspace(100.0, 2000.0, 400)[:, None] * towards[:, None]
    beyond = points - np.clip(points, LOW, HIGH)
    return np.sqrt((beyond**2).sum(axis=-1)).min() - half_width_mm


def clearances(poses):
    some = poses[::5]
    return nearest_deg(poses), nearest_mm(some[:, :2], 40.0), nearest_mm(some[:, 2:], 30.0)


def test_the_arms_keep_apart_and_out_of_the_box(capture):
    poses = capture()
    assert len(poses) > 5000
    degrees, view_mm, light_mm = clearances(poses)
    assert degrees >= 12.0
    assert view_mm >= 0.0
    assert light_mm >= 0.0


def test_straight_on_they_would_not(capture, monkeypatch):
    monkeypatch.setattr(
        "gonio.capture.instrument.free_way", lambda start, goal, rig: Way(np.array([goal]), 0.0)
    )
    degrees, view_mm, light_mm = clearances(capture())
    assert degrees < 6.0
    assert view_mm < -10.0
    assert light_mm < -10.0


def rig_with(**arm):
    data = default_rig().model_dump()
    data["arm"].update(arm)
    return Rig.model_validate(data)


REFUSED = [
    # keys of the arm, poses, what the line says
    (
        {"min_separation_deg": 50.0},
        [(60, 0, 0, 0)],
        r"^white reference: view 45/0, light 0/0 deg .* is closer than 50 deg",
    ),
    (
        {"min_separation_deg": 12.0},
        [(60, 0, 0, 0), (30, 0, 30, 10)],
        r"^shot 1: view 30/0, light 30/10 deg .* is closer than 12 deg \(arm.min_separation_deg\)",
    ),
    (
        {"keep_out": [{"min_mm": LOW.tolist(), "max_mm": HIGH.tolist()}]},
        [(60, 0, 0, 0), (0, 0, 60, 180)],
        r"^shot 1: view 0/0, light 60/180 deg .* is inside a keep-out box \(arm.keep_out\)",
    ),
    ({}, [(60, 0, 0, 0), (60, 0, 90, 359)], None),
]  # fmt: skip


@pytest.mark.parametrize(("arm", "poses", "says"), REFUSED)
def test_a_plan_is_refused_by_shot_and_reason(arm, poses, says):
    rig = rig_with(**arm)
    plan = plan_of(poses, default_rig())
    if says is None:
        check_reach(plan.shots, rig)
        return
    with pytest.raises(BadInputError, match=says):
        check_reach(plan.shots, rig)


def test_a_shot_that_no_way_leads_to_is_named():
    """A light behind a window: it stands free, and cannot get there."""
    left, right, above, below = ((100, 2500, 0, 2500), (-2500, -100, 0, 2500),
                                 (-100, 100, 560, 2500), (-100, 100, 0, 400))  # fmt: skip
    frame = [
        {"min_mm": (-900, y0, z0), "max_mm": (-800, y1, z1)}
        for y0, y1, z0, z1 in (left, right, above, below)
    ]
    plan = plan_of([(60, 0, 0, 0), (60, 0, 60, 180)], default_rig())
    says = "^shot 0 to shot 1: there is no free way from view 60/0, light 0/0 deg"
    with pytest.raises(BadInputError, match=says):
        check_reach(plan.shots, rig_with(keep_out=frame))
    check_reach(plan.shots, rig_with(keep_out=[*frame[:2], frame[3]]))


def test_axes_that_start_too_far_apart_stop(tmp_path):
    """A slow bus: the arms may leave the way that was found clear."""
    rig, clock = rig_with(min_separation_deg=12.0), VirtualClock()
    twin = Twin(rig, None, clock, tmp_path, 0)
    arm = Arm(SlowBus(twin.bus, clock), rig, clock)
    arm.enable()
    arm.home()
    with pytest.raises(DeviceFaultError, match=r"started within 0\.\d+ s.*look for what delays"):
        arm.move({"view_theta": 40.0, "view_phi": 10.0})
    before = arm.angles_deg()
    clock.sleep(5.0)
    assert arm.angles_deg() == before
    assert before["view_theta"] < 39.0


class SlowBus:
    def __init__(self, bus, clock):
        self.bus, self.clock = bus, clock

    def read(self, unit, address, count):
        return self.bus.read(unit, address, count)

    def write(self, unit, address, values):
        self.clock.sleep(0.05)
        self.bus.write(unit, address, values)


def test_poses_on_the_way_are_passed_one_after_the_other_without_settling(tmp_path):
    rig, clock = default_rig(), VirtualClock()
    twin = Twin(rig, None, clock, tmp_path, 0)
    arm = Arm(twin.bus, rig, clock)
    arm.enable()
    arm.home()
    took = []
    for via in ([], [{"view_theta": 80.0}, {"view_theta": 80.0, "view_phi": 90.0}]):
        arm.move(dict.fromkeys(AXES, 0.0))
        recorder = Recorder(twin, clock)
        recorder.place("sample")
        began = clock.now()
        arm.move({"view_theta": 20.0, "view_phi": 90.0}, via)
        took.append(clock.now() - began)
    poses = np.degrees(recorder.poses)
    lifted = poses[np.isclose(poses[:, 0], 80.0, atol=0.01)]
    assert lifted[:, 1].min() < 1.0
    assert lifted[:, 1].max() > 89.0
    # 80, 90 and 60 deg rather than 90 alone, and no more waiting than before
    assert took[1] - took[0] == pytest.approx(5.0 + 4.0 + 4.0 - 4.0, abs=0.5)


def test_via_beyond_the_travel_is_refused_before_anything_moves(tmp_path):
    rig, clock = default_rig(), VirtualClock()
    twin = Twin(rig, None, clock, tmp_path, 0)
    arm = Arm(twin.bus, rig, clock)
    arm.enable()
    arm.home()
    before = arm.angles_deg()
    with pytest.raises(BadInputError, match="view_theta 92 deg is beyond"):
        arm.move({"view_theta": 20.0}, [{"view_theta": 30.0}, {"view_theta": 92.0}])
    assert arm.angles_deg() == before
