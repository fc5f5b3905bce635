"""The twin as a whole: frames from the true poses, keys, and the same bits for the same seed."""

import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.errors import StorageError
from gonio.rig import default_rig
from sim.twin import Twin


def expose(twin, clock, exposure_us=200000):
    twin.line.send(b"TRIG:EXP %d" % exposure_us)
    assert twin.line.receive(0.2).startswith(b"OK")
    clock.sleep(exposure_us / 1e6 + 0.2)


def test_a_frame_appears_50_to_100_ms_after_the_shutter(twin, clock, tmp_path):
    twin.line.send(b"TRIG:EXP 200000")
    twin.line.receive(0.2)
    opened = clock.now()
    while not list(tmp_path.iterdir()):
        clock.sleep(0.001)
    assert 0.05 <= clock.now() - opened - 0.2 <= 0.102
    assert [path.name for path in tmp_path.iterdir()] == ["frame_000001.dng"]
    assert (tmp_path / "frame_000001.dng").read_bytes() == b"frame"


def test_the_camera_sees_the_true_pose_and_the_mean_flux(twin, clock, camera, units):
    for unit in units.values():
        unit.enable()
        unit.home()
        unit.write(0x0008, 0, 40000, 0, 40000)
    axes = default_rig().axis
    for name, unit in zip(twin.drives, units.values(), strict=True):
        assert unit.go(axes[name].to_counts(30.001))
    clock.sleep(60.0)
    for line in (b"LED2:CURR 350", b"LED2:STAT ON"):
        twin.line.send(line)
        assert twin.line.receive(0.2) == b"OK"
    twin.holder = "reference"
    expose(twin, clock)
    (scene,) = camera.asked
    assert scene["holder"] == "reference"
    assert scene["exposure_s"] == 0.2
    for arm in ("view", "light"):
        assert np.degrees(scene[arm].theta) == pytest.approx(30.001, abs=0.00026)
        assert np.degrees(scene[arm].phi) == pytest.approx(30.001, abs=0.00026)
    assert scene["flux"].shape == (11,)
    assert np.flatnonzero(scene["flux"]).tolist() == [1]
    assert scene["flux"][1] == pytest.approx(0.53, abs=0.01)


def test_keys_tell_exposures_apart_whatever_their_order(camera, clock, tmp_path):
    shots = [(100000, b"OFF"), (200000, b"OFF"), (100000, b"ON"), (100000, b"OFF")]

    def keys(order):
        camera.asked.clear()
        twin = Twin(default_rig(), camera, clock, tmp_path, seed=0)
        for exposure_us, state in order:
            twin.line.send(b"LED1:STAT " + state)
            twin.line.receive(0.2)
            expose(twin, clock, exposure_us)
        return [scene["key"] for scene in camera.asked]

    forward = keys(shots)
    assert len(set(forward)) == len(shots)
    assert set(keys(shots[::-1])) == set(forward)


def test_keys_know_holder_and_commanded_position(twin, clock, camera, homed):
    expose(twin, clock)
    twin.holder = "reference"
    expose(twin, clock)
    homed.go(60000)
    clock.sleep(5.0)
    expose(twin, clock)
    assert len({scene["key"] for scene in camera.asked}) == 3


def test_the_same_seed_gives_the_same_twin(camera, tmp_path):
    def story(seed):
        clock = VirtualClock()
        twin = Twin(default_rig(), camera, clock, tmp_path, seed)
        poses = [twin.pose("view"), twin.pose("light")]
        twin.line.send(b"TRIG:EXP 1000")
        files = {path.name for path in tmp_path.iterdir()}
        while {path.name for path in tmp_path.iterdir()} == files:
            clock.sleep(0.0001)
        (tmp_path / "frame_000001.dng").unlink()
        return poses, clock.now()

    assert story(3) == story(3)
    assert story(3)[0] != story(4)[0]


def test_arms_start_within_their_travel(camera, clock, tmp_path):
    rig = default_rig()
    for seed in range(20):
        twin = Twin(rig, camera, clock, tmp_path, seed)
        for name, drive in twin.drives.items():
            rig.check_reach(name, drive.axis.actual_deg(0.0))


def test_a_folder_that_is_gone_is_said_in_one_line(camera, clock, tmp_path):
    twin = Twin(default_rig(), camera, clock, tmp_path / "gone", seed=0)
    twin.line.send(b"TRIG:EXP 1000")
    with pytest.raises(StorageError, match="frame_000001"):
        clock.sleep(1.0)
