"""Sessions on less than ideal twins, each of a sensor of its own and calibrated by its own frames.

Lamps, sensor and arms are the twin's own laws on a clock that this file moves: what is left out of
a whole twin are buses, lines and files.
"""

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from unittest.mock import patch

import numpy as np

from gonio.calibrate.exposing import Exposed
from gonio.calibrate.record import document_of
from gonio.calibrate.run import CalibrationRun
from gonio.clock import VirtualClock
from gonio.geometry import ArmPose
from gonio.plan import LampSetting
from gonio.reduce.calibrate import calibrate
from gonio.reduce.correction import Calibrated
from gonio.reduce.frames import Frame
from gonio.reduce.patch import PatchFinder
from gonio.reduce.raw import decode_raw
from gonio.reduce.reduce import measure, samples_of
from gonio.timemodel import DARK_FRAMES, WHITE_FRAMES
from gonio.uncertainty import Uncertainty
from sim.bending import bent_deg
from sim.camera import SimCamera
from sim.imperfections import load_imperfections
from sim.led import Led
from sim.warmth import SensorHeat, Warmth
from tests.draws import WHITE, Errors, drawn_shot, record_of, small_rig

ZERO_DEG = 0.01
ANGLE_DEG = {"none": 0.01, "mild": 0.011, "all": 0.03}
"""What a rig file should state: zeros of the axes, and how far arms of a set bend behind them."""

LAMP_COLOR = {"none": 0.0, "mild": 0.1, "all": 0.4}
FEW = {"DARK_FRAMES": 4, "LEVEL_FRAMES": 2, "FLAT_FRAMES": 3, "LAMP_FRAMES": 1}
"""Frames of a calibration, about half as many as `gonio calibrate` takes, to be quick."""

PATCH_MM = 20.0
"""At half a pixel a millimetre a third of the pixels that the built-in rig's patch has."""

_MOVE_S, _READ_S = 8.0, 0.5


def imperfect_rig(name, *, pixels=48, **camera):
    """The built-in rig's field of view on few pixels, and what its file should state."""
    stated = Uncertainty(
        reference=0.0025, flux_monitor=0.001, angle_deg=ANGLE_DEG[name], tilt_deg=0.01,
        height_mm=0.1, black_level_dn=1.0, lamp_color=LAMP_COLOR[name],
    )  # fmt: skip
    rig = small_rig(stated, 0.0, pixels=pixels, **camera)
    focal = {"focal_px": rig.camera.focal_px * pixels / 160.0}
    return rig.model_copy(
        update={
            "camera": rig.camera.model_copy(update=focal),
            "lamps": rig.lamps.model_copy(update={"warm_up_s": 100.0}),
        }
    )


@dataclass
class DrawnTwin:
    """A twin of a seed of its own, with errors that no calibration tells."""

    rig: object
    material: object
    sizes: object
    errors: Errors
    random: np.random.Generator
    holder: str = "reference"
    now: float = 0.0

    def __post_init__(self):
        seed = int(self.random.integers(2**31))
        self._camera = SimCamera(self.rig, self.material, seed, self.sizes.of_camera)
        self._leds, self._heat = [Led(self.now) for _ in range(11)], SensorHeat(self.now)
        self._lit, self._taken = False, 0

    def light(self, settings):
        """Light lamps, and wait until they are warm where none was lit before."""
        currents = {each.n: each.mA for each in settings}
        for n, led in enumerate(self._leds, start=1):
            led.set(self.now, current_mA=currents.get(n, 0.0), on=n in currents)
        if currents and not self._lit:
            self.now += self.rig.lamps.warm_up_s
        self._lit = bool(currents)

    def go(self, view_deg, light_deg):
        """Move both arms, which bend behind their encoders."""
        self.now += _MOVE_S
        self.told = [ArmPose.from_degrees(*each) for each in (view_deg, light_deg)]
        bent = [
            ArmPose.from_degrees(*bent_deg(*each, self.now, self.sizes))
            for each in (light_deg, view_deg)
        ]
        self._place = lambda: self.errors.true_poses(
            self.holder, *bent, 1000.0 * self.rig.lamps.distance_m
        )

    def expose(self, exposure_s, *, dark=False):
        """Take a frame; return it and what the lamps' monitors say."""
        opened, warmth = self._state(), self._heat.warmth(self.now)
        self._heat.use(self.now, in_use=True)
        self.now += exposure_s
        self._heat.use(self.now, in_use=False)
        doses, junctions_c = (np.array([b, a]) for b, a in zip(opened, self._state(), strict=True))
        flux = np.zeros(11) if dark else np.diff(doses, axis=0)[0] / exposure_s
        junctions_c = junctions_c.mean(axis=0)
        warmth = (warmth + self._heat.warmth(self.now)) / 2.0
        light, view, nearer = self._place()
        told = 1.0 + self.rig.uncertainty.flux_monitor * self.random.normal()
        # a reference that is brighter than stated looks as if more light fell on it
        scale = 1.0 + self.errors.reference if self.holder == "reference" else 1.0
        self._taken += 1
        self.now += _READ_S
        data = self._camera.frame(
            holder=self.holder, view=view, light=light, flux=flux * told * scale * nearer,
            exposure_s=exposure_s, key=str(self._taken), warmth=Warmth(junctions_c, warmth),
        )  # fmt: skip
        return decode_raw(data, Path("drawn.dng"), ""), tuple(flux.tolist())

    def _state(self):
        return [led.dose_s(self.now) for led in self._leds], [
            led.temperature_c(self.now) for led in self._leds
        ]

    # what a calibration asks of `gonio.calibrate.exposing.Exposer`
    def take(self, exposure_s, repeats, _name):
        return [self._one(exposure_s) for _ in range(repeats)]

    def _one(self, exposure_s):
        view, light = self.told
        since_start_s = self.now
        raw, flux = self.expose(exposure_s)
        return Exposed(raw, flux, view, light, since_start_s)


@dataclass
class TwinFrames:
    """In place of `gonio.reduce.frames.Frames`: frames that a twin takes when asked for them."""

    twin: DrawnTwin
    remedy: str = ""
    problems: dict = field(default_factory=lambda: {"dark": [], "white": []})
    sensor: object = None

    def of_shot(self, shot):
        self.twin.holder = "sample"
        return [self._take("shot", shot, exposure_s) for exposure_s in shot.exposures_s]

    def of_calibration(self, role, exposure_s):
        self.twin.holder = "reference"
        count = DARK_FRAMES if role == "dark" else WHITE_FRAMES
        return [self._take(role, WHITE, exposure_s) for _ in range(count)]

    def _take(self, role, shot, exposure_s):
        wanted = (
            (shot.view_theta_deg, shot.view_phi_deg), (shot.light_theta_deg, shot.light_phi_deg)
        )  # fmt: skip
        if self.twin.told != [ArmPose.from_degrees(*each) for each in wanted]:
            self.twin.go(*wanted)
        raw, flux = self.twin.expose(exposure_s, dark=role == "dark")
        # the black level has moved since the dark frames
        drift = self.twin.errors.black_dn if role == "dark" else 0.0
        self.sensor = raw.sensor
        moved = dataclasses.replace(raw, mosaic=raw.mosaic - drift)
        return Frame(record_of(role, shot, exposure_s, flux), moved, self.twin.told[0])


def drawn_calibration(twin):
    """Return a correction that the twin's own frames told, as `gonio calibrate` takes them."""
    with patch.multiple("gonio.calibrate.run", **FEW):
        findings = CalibrationRun(twin, twin.rig).measure()
    document = document_of(findings, VirtualClock().utc(), None)
    maps = findings.dark.offset, findings.dark.rate, findings.response
    # as files hold them
    rounded = (np.asarray(each, np.float32).astype(np.float64) for each in maps)
    return Calibrated(document, Path(), *rounded, findings.bad)


def calibrated_samples(name, material, random, shots=8, rig=None, patch_mm=PATCH_MM, **sizes):
    """Return samples of a session with its own calibration, and the truth where they are told.

    `sizes` are of imperfections that are other ones than those of that name.
    """
    rig = rig or imperfect_rig(name)
    zeros = rig.uncertainty.model_copy(update={"angle_deg": ZERO_DEG})
    errors = Errors.draw(rig.model_copy(update={"uncertainty": zeros}), random)
    imperfections = load_imperfections(name).model_copy(update=sizes)
    twin = DrawnTwin(rig, material, imperfections, errors, random)
    correction = drawn_calibration(twin)
    # what was warm then is not now
    twin.light(())
    twin.now += 3600.0
    twin.go((45.0, 0.0), (0.0, 0.0))
    twin.light([LampSetting(n=lamp.n, mA=700.0) for lamp in rig.lamps.lamp])
    plan = [drawn_shot(index, rig, random) for index in range(shots)]
    frames, patches = TwinFrames(twin), PatchFinder(rig.camera, patch_mm, correction.bad)
    calibration = calibrate(frames, rig, patches, rig.camera.exposures_s, correction)
    rows, problems = measure(plan, frames, patches, rig, calibration)
    assert not problems, problems
    samples = samples_of(rows, calibration)
    return samples, material.evaluate(samples.light, samples.view), correction
