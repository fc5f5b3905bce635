"""The twin in process against the same rig on its own clock."""

import time
from collections import Counter
from functools import reduce
from operator import xor

import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.devices import Arm, LampHead
from gonio.directions import paper_angles_deg
from gonio.geometry import ArmPose
from gonio.plan import LampSetting
from gonio.rig import AXES, default_rig
from sim.camera import SimCamera
from sim.imperfections import BY_NAME
from sim.materials import load_material
from sim.twin import Twin

LAMPS = [LampSetting(n=n, mA=350) for n in range(1, 12)]
EXPOSURES_S = (0.002, 0.02, 0.2, 2.0)


class NoCamera:
    def frame(self, **scene):
        return b""


class Watch(Counter):
    """Adds up the seconds that things took, by name."""

    def time(self, name, action, *arguments):
        began = time.perf_counter()
        action(*arguments)
        self[name] += time.perf_counter() - began


def us_each(action, count=20000):
    began = time.perf_counter()
    for _ in range(count):
        action()
    return (time.perf_counter() - began) / count * 1e6


def test_one_request(tmp_path):
    twin = Twin(default_rig(), NoCamera(), VirtualClock(), tmp_path, seed=0)
    question = b"#7 LED1:STAT?"
    question += b"*%02X" % reduce(xor, question)

    def ask():
        twin.line.send(question)
        twin.line.receive(0.2)

    costs = {
        "statusword": us_each(lambda: twin.bus.read(1, 0x0001, 1)),
        "position": us_each(lambda: twin.bus.read(1, 0x0006, 2)),
        "settle": us_each(lambda: twin.bus.read(1, 0x0011, 1)),
        "lamp line": us_each(ask),
    }
    print("\n" + ", ".join(f"{name} {cost:.1f} us" for name, cost in costs.items()))  # noqa: T201


def test_196_shots_without_frames(tmp_path):
    rig, clock, watch = default_rig(), VirtualClock(), Watch()
    twin = Twin(rig, NoCamera(), clock, tmp_path, seed=0)
    arm, lamps = Arm(twin.bus, rig, clock), LampHead(twin.line, rig, clock)
    lamps.identify()
    arm.enable()
    arm.home()
    theta, phi = paper_angles_deg()
    began_s = clock.now()
    for view, light in np.random.default_rng(0).integers(81, size=(196, 2)):
        angles = (theta[view], phi[view], theta[light], phi[light])
        watch.time("moves", arm.move, dict(zip(AXES, angles, strict=True)))
        watch.time("lamps set", lamps.apply, LAMPS)
        for exposure_s in EXPOSURES_S:
            watch.time("exposures", lamps.expose, exposure_s)
    rig_s, total_s = clock.now() - began_s, watch.total()
    parts = ", ".join(f"{name} {took:.2f} s" for name, took in watch.items())
    print(f"\n196 shots: {parts}; rig time {rig_s:.0f} s, {rig_s / total_s:.0f} times")  # noqa: T201


@pytest.mark.parametrize(("side", "frames"), [(160, 40), (2000, 2)])
def test_a_frame_of_a_pose_of_its_own_and_the_next_of_its_bracket(side, frames):
    rig, costs = rig_of(side), {}
    for name, imperfections in BY_NAME.items():
        camera = SimCamera(rig, load_material("wood-veneer"), 0, imperfections.of_camera)
        costs[name] = np.median([ms_of(camera, turn) for turn in range(frames)], axis=0)
    told = ", ".join(
        f"{name} {first:.0f} and {again:.0f}" for name, (first, again) in costs.items()
    )
    print(f"\n{side} px, ms of processor time: {told}")  # noqa: T201


def rig_of(side):
    """The built-in rig with a sensor of as many pixels a side, for the same field of view."""
    rig = default_rig()
    finer = {"width": side, "height": side, "focal_px": 25.0 * side}
    camera = rig.camera.model_copy(update=finer | {"centre_px": ((side - 1) / 2,) * 2})
    return rig.model_copy(update={"camera": camera})


def ms_of(camera, turn):
    view, light = ArmPose.from_degrees(75, turn), ArmPose.from_degrees(45, 180)
    scene = {"holder": "sample", "view": view, "light": light, "flux": np.ones(11)}
    took = []
    for exposure_s in (0.02, 0.2):
        began = time.process_time()
        camera.frame(**scene, exposure_s=exposure_s, key=f"{turn} {exposure_s}")
        took.append(1000.0 * (time.process_time() - began))
    return took
