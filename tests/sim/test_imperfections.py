"""What is less than ideal about the arms: the law of each, and a twin that has them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.clock import VirtualClock
from gonio.devices import Arm
from gonio.errors import BadFileError
from gonio.geometry import ArmPose
from gonio.rig import default_rig
from sim.bending import bent_deg, warming_k
from sim.blur import blurred
from sim.encoder import Encoder
from sim.imperfections import IDEAL, Imperfections, load_imperfections
from sim.motion import go, rest
from sim.play import Play
from sim.twin import Twin

COUNTS = st.floats(-1e5, 1e5)
HALF = st.floats(0.0, 1e3)
SHIFTS = st.lists(
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)), min_size=1, max_size=8
).map(np.array)


@given(COUNTS, st.floats(-1e5, 1e5), COUNTS, HALF, st.floats(0.0, 1.0))
def test_a_load_trails_by_half_the_play_at_most(start, speed, target, half, share):
    motion = go(2.0, start, speed, target, 1e4, 1e4)
    now = 2.0 + share * (motion.end_s - 2.0)
    load, driven = Play(half, start).load(motion, now), motion.at(now)[0]
    assert abs(load - driven) <= half * (1 + 1e-12) + 1e-9
    assert Play(0.0, start).load(motion, now) == driven


@given(COUNTS, HALF, st.floats(-1.0, 1.0))
def test_within_its_play_nothing_moves_a_load(start, half, share):
    assert Play(half, start).load(rest(start + share * half), 0.0) == pytest.approx(start, abs=1e-9)


def test_a_motion_that_turns_takes_the_load_along_before_it_turns():
    play = Play(10.0, 0.0)
    motion = go(0.0, 0.0, 100.0, -10.0, 100.0, 100.0)
    assert play.load(motion, motion.end_s) == 0.0  # driven to 50, load to 40, and back over -10
    play.settle(60.0)
    assert play.load(motion, motion.end_s) == 0.0


@given(COUNTS, st.floats(0.0, 1e6), st.floats(0.1, 50.0))
def test_two_readings_at_one_time_are_one(position, now, noise):
    one, other = (Encoder(0.0, noise, (7, 1)) for _ in range(2))
    assert one.count(position, now) == other.count(position, now)


def test_noise_has_its_size_and_no_offset():
    encoder = Encoder(0.0, 20.0, (7, 1))
    read = np.array([encoder.count(1000.0, 0.01 * i) for i in range(4000)])
    assert abs(read.mean() - 1000.0) < 4 * 20.0 / math.sqrt(4000)
    assert read.std() == pytest.approx(20.0, rel=0.05)


@given(COUNTS, st.integers(1, 64))
def test_steps_are_whole_and_near(position, step):
    read = Encoder(float(step)).count(position, 0.0)
    assert read % step == 0
    assert abs(read - position) <= 0.5 * step + 1e-6


@given(SHIFTS)
def test_blur_keeps_the_light_and_what_is_even(shifts):
    image = np.zeros((41, 41))
    image[20, 20] = 1000.0
    assert blurred(image, shifts).sum() == pytest.approx(1000.0)
    assert blurred(np.full((9, 9), 5.0), shifts) == pytest.approx(5.0)


@given(SHIFTS)
def test_blur_moves_the_centre_by_the_mean_shift(shifts):
    image = np.zeros((41, 41))
    image[20, 20] = 1.0
    seen = blurred(image, shifts)
    centre = [(seen * axis).sum() - 20.0 for axis in np.mgrid[:41, :41]]
    assert centre == pytest.approx(shifts.mean(axis=0), abs=2e-3)


@given(st.floats(0.0, 90.0), st.floats(0.0, 360.0), st.floats(0.0, 1e6))
def test_without_imperfections_nothing_bends(theta, phi, now):
    assert bent_deg(theta, phi, now, Imperfections()) == (theta, phi)


def test_weight_bends_a_level_arm_most_and_an_upright_one_not():
    sags = Imperfections(arm_sag_urad=1000.0)
    bent = [bent_deg(theta, 0.0, 0.0, sags)[0] - theta for theta in (0.0, 30.0, 90.0)]
    assert bent == pytest.approx([0.0, math.degrees(5e-4), math.degrees(1e-3)])


def test_an_arm_warms_up_and_follows_the_room_late():
    warm = Imperfections(arm_warm_up_k=10.0, arm_thermal_s=1000.0)
    assert warming_k(0.0, warm) == 0.0
    assert warming_k(1000.0, warm) == pytest.approx(10.0 * (1 - math.exp(-1)))
    room = Imperfections(arm_room_k=3.0, arm_thermal_s=1000.0)
    seconds = np.arange(0.0, 86400.0, 10.0)
    kelvin = np.array([warming_k(now, room) for now in seconds])
    outside = 3.0 * np.sin(2 * np.pi * seconds / 86400.0)
    slope = np.gradient(kelvin, seconds)
    assert slope == pytest.approx((outside - kelvin) / 1000.0, abs=1e-5)


@pytest.mark.parametrize("arm", ["view", "light"])
def test_an_arm_that_stands_askew_is_elsewhere_than_its_encoders_say(arm, tmp_path):
    sizes = {f"arm_{arm}_theta_offset_deg": 1.0, f"arm_{arm}_centre_x_mm": 2.0}
    askew, straight = (
        Twin(default_rig(), None, VirtualClock(), tmp_path, seed=3, imperfections=imperfections)
        for imperfections in (Imperfections(**sizes), IDEAL)
    )
    true, by_encoders = askew.pose(arm), straight.pose(arm)
    moved = ArmPose(by_encoders.theta + math.radians(1.0), by_encoders.phi)
    assert true.place(2000.0) == pytest.approx(moved.place(2000.0) + np.array([2.0, 0.0, 0.0]))
    other = "light" if arm == "view" else "view"
    assert askew.pose(other) == straight.pose(other)


TARGET = default_rig().axis.view_theta.to_counts(33.0)


class Shaken:
    """Notes how far the picture was off."""

    def __init__(self):
        self.shakes = []

    def frame(self, *, shake_rad=None, **scene):
        self.shakes.append(shake_rad)
        return b"frame"


def moved(tmp_path, imperfections):
    """Home and move the camera's arm, and take a frame at once when it is there."""
    clock, camera = VirtualClock(), Shaken()
    twin = Twin(default_rig(), camera, clock, tmp_path, 1, imperfections=imperfections)
    arm = Arm(twin.bus, default_rig(), clock)
    arm.enable()
    arm.home()
    arm.go({"view_theta": 33.0})
    twin.line.send(b"TRIG:EXP 100000")
    clock.sleep(1.0)
    return twin, clock, camera


def test_an_ideal_twin_shakes_no_frame(tmp_path):
    _, _, camera = moved(tmp_path, IDEAL)
    assert camera.shakes == [None]


def test_a_frame_right_after_a_move_is_shaken(tmp_path):
    _, _, camera = moved(tmp_path, Imperfections(arm_resonance_hz=4.5, arm_damping=0.01))
    (shake,) = camera.shakes
    # 20 deg/s2 / (2 pi 4.5 Hz)^2 is 437 urad; both ends of a ramp add up, and a third is seen
    assert 1e-4 < np.abs(shake[:, 0]).max() < 2 / 3 * 437e-6


def test_friction_and_backlash_leave_the_load_short_of_its_target(tmp_path):
    trails = Imperfections(arm_backlash_deg=0.01, arm_friction_deg=0.005)
    twin, clock, _ = moved(tmp_path, trails)
    # half of 0.01 deg and 0.005 deg are 20 counts
    assert twin.drives["view_theta"].axis.actual(clock.now()) == pytest.approx(TARGET - 20)


def test_the_encoder_does_not_see_what_bends_behind_it(tmp_path):
    twin, clock, _ = moved(tmp_path, Imperfections(arm_sag_urad=1000.0))
    theta = twin.drives["view_theta"].axis.actual_deg(clock.now())
    bent = twin.pose("view").theta - math.radians(theta)
    assert bent == pytest.approx(1e-3 * math.sin(math.radians(theta)))


BAD = {
    "unknown": ("arm_color = 1", "arm_color: is not a known key"),
    "range": ("arm_damping = 2.0", "out of range"),
    "slow": ("arm_resonance_hz = 0.1", "use 0, or 0.5 to 100"),
    "text": ('arm_sag_urad = "much"', "is no number"),
    "no TOML": ("arm", "is not TOML"),
}


@pytest.mark.parametrize(("text", "message"), BAD.values(), ids=BAD)
def test_a_bad_file_is_told_in_one_line(tmp_path, text, message):
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(BadFileError, match=message):
        load_imperfections(str(path))
