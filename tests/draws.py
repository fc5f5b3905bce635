"""Sessions on the twin whose calibration errs, each time anew, and what their intervals hold."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from gonio.directions import normalize, paper_directions, to_degrees, to_spherical
from gonio.geometry import ArmPose
from gonio.journal import FrameRecord
from gonio.plan import LampSetting, Shot
from gonio.reduce.calibrate import calibrate
from gonio.reduce.correction import Uncorrected
from gonio.reduce.frames import Frame
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.raw import RawFrame, decode_raw
from gonio.reduce.reduce import measure, samples_of
from gonio.rig import default_rig
from gonio.timemodel import DARK_FRAMES, WHITE_FRAMES
from gonio.uncertainty import Uncertainty
from sim.camera import SimCamera
from sim.camera_imperfections import CameraImperfections

STATED = Uncertainty(
    reference=0.0025,
    flux_monitor=0.001,
    angle_deg=0.01,
    tilt_deg=0.01,
    height_mm=0.1,
    black_level_dn=1.0,
    stray_light=0.003,
)
STRAY_LIGHT = 0.01
WHITE = Shot(
    index=0, light_theta_deg=0, light_phi_deg=0, view_theta_deg=45, view_phi_deg=0,
    exposures_s=(0.2,), lamps=(LampSetting(n=1, mA=700.0),),
)  # fmt: skip
Z90 = 1.6448536269514722


def small_rig(stated=STATED, stray_light=STRAY_LIGHT, *, pixels=40, exposures_s=None):
    """The built-in rig with a sensor that sees little more than the patch, to be quick."""
    rig = default_rig()
    camera = {
        "width": pixels, "height": pixels, "centre_px": ((pixels - 1) / 2,) * 2,
        "stray_light": stray_light, "exposures_s": exposures_s or rig.camera.exposures_s,
    }  # fmt: skip
    return rig.model_copy(
        update={"camera": rig.camera.model_copy(update=camera), "uncertainty": stated}
    )


@dataclass(frozen=True)
class TiltedPose(ArmPose):
    """A pose as a tilted sample sees it; at the pole, too, the camera is turned as its arm is."""

    tilt_rad: tuple = (0.0, 0.0)

    @cached_property
    def right(self):
        return self._tilted(super().right)

    @cached_property
    def up(self):
        return self._tilted(super().up)

    @cached_property
    def direction(self):
        return self._tilted(super().direction)

    def _tilted(self, direction):
        # small turns about +x and +y add up
        return normalize(direction + np.cross([*self.tilt_rad, 0.0], direction))


@dataclass
class Errors:
    """What is wrong in one session, drawn from what the rig file states."""

    reference: float
    axis_rad: np.ndarray
    tilt_rad: dict
    height_mm: dict
    black_dn: float
    stray_light: float
    shutter: dict = field(default_factory=dict)

    @classmethod
    def draw(cls, rig, random):
        stated = rig.uncertainty
        holders = ("sample", "reference")
        return cls(
            reference=stated.reference * random.normal(),
            axis_rad=np.radians(stated.angle_deg) * random.normal(size=(2, 2)),
            tilt_rad={h: np.radians(stated.tilt_deg) * random.normal(size=2) for h in holders},
            height_mm={h: stated.height_mm * random.normal() for h in holders},
            black_dn=stated.black_level_dn * random.normal(),
            stray_light=max(rig.camera.stray_light + stated.stray_light * random.normal(), 0.0),
            shutter={s: stated.shutter * random.normal() for s in rig.camera.exposures_s}
            if stated.shutter
            else {},
        )

    def true_poses(self, holder, light, view, distance_mm):
        """Return where light and view truly are, seen from the sample, and the light's factor."""
        light, view = (
            TiltedPose(told.theta + off[0], told.phi + off[1], tuple(self.tilt_rad[holder]))
            for told, off in zip((light, view), self.axis_rad, strict=True)
        )
        down = self.height_mm[holder] * view.direction / view.direction[2]
        to_lamps = distance_mm * light.direction - down
        return _pose(to_lamps), view, distance_mm**2 / (to_lamps @ to_lamps)


@dataclass
class DrawnFrames:
    """In place of `gonio.reduce.frames.Frames`: frames that the twin takes when they are asked for.

    Each is a whole DNG, decoded as a file would be.
    """

    rig: object
    material: object
    errors: Errors
    random: np.random.Generator
    remedy: str = ""
    problems: dict = field(default_factory=lambda: {"dark": [], "white": []})
    sensor: object = None

    def __post_init__(self):
        glare = CameraImperfections(camera_glare=self.errors.stray_light)
        seed = int(self.random.integers(2**31))
        self._camera = SimCamera(self.rig, self.material, seed, glare)
        self._taken = 0

    def of_shot(self, shot):
        return [self._take("shot", shot, exposure_s) for exposure_s in shot.exposures_s]

    def of_calibration(self, role, exposure_s):
        count = DARK_FRAMES if role == "dark" else WHITE_FRAMES
        return [self._take(role, WHITE, exposure_s) for _ in range(count)]

    def _take(self, role, shot, exposure_s):
        flux = np.zeros(11) if role == "dark" else 0.97 + 0.02 * self.random.random(11)
        record = record_of(role, shot, exposure_s, flux)
        pose = ArmPose.from_degrees(record.view_theta_deg, record.view_phi_deg)
        told, holder = Frame(record, None, pose), "sample" if role == "shot" else "reference"
        light, view, nearer = self.errors.true_poses(
            holder, told.light, told.view, 1000.0 * self.rig.lamps.distance_m
        )
        monitor = 1.0 + self.rig.uncertainty.flux_monitor * self.random.normal()
        # a reference that is brighter than stated looks as if more light fell on it
        scale = 1.0 + self.errors.reference if role == "white" else 1.0
        # a shutter that is open for longer than it says lets more light in
        scale *= 1.0 + self.errors.shutter.get(exposure_s, 0.0)
        self._taken += 1
        data = self._camera.frame(
            holder=holder, view=view, light=light, flux=flux * monitor * scale * nearer,
            exposure_s=exposure_s, key=str(self._taken),
        )  # fmt: skip
        raw = decode_raw(data, Path("drawn.dng"), "")
        self.sensor = raw.sensor
        drift = self.errors.black_dn if role == "dark" else 0.0
        return Frame(record, RawFrame(raw.mosaic - drift, raw.exposure_s, raw.sensor), pose)


def drawn_samples(rig, material, random, shots=8, errors=None):
    """Return a session's samples and the true values at the directions that they tell."""
    errors = errors or Errors.draw(rig, random)
    plan = [drawn_shot(index, rig, random) for index in range(shots)]
    frames = DrawnFrames(rig, material, errors, random)
    patches = PatchFinder(rig.camera, usual_patch_mm(rig.camera))
    calibration = calibrate(frames, rig, patches, rig.camera.exposures_s, Uncorrected())
    rows, problems = measure(plan, frames, patches, rig, calibration)
    assert not problems, problems
    samples = samples_of(rows, calibration)
    return samples, material.evaluate(samples.light, samples.view)


def interval_score(value, sigma, truth):
    """Return the mean score of 90 % intervals, relative to the truth; less is better.

    Gneiting and Raftery 2007, equation 43.
    """
    beyond = (np.abs(value - truth) - Z90 * sigma).clip(0.0)
    return float(np.mean((2.0 * Z90 * sigma + 20.0 * beyond) / truth))


def constant_sigma(value, truth):
    """Return the best sigma that is one and the same share of every value, found in hindsight."""
    shares = np.geomspace(1e-4, 0.3, 200)
    scores = [interval_score(value, share * np.abs(value), truth) for share in shares]
    return float(shares[np.argmin(scores)]) * np.abs(value)


def covered(value, sigma, truth):
    """Return the share of true values within the 90 % intervals."""
    return float(np.mean(np.abs(value - truth) <= Z90 * sigma))


def drawn_shot(index, rig, random):
    (light_theta, view_theta), (light_phi, view_phi) = to_degrees(
        paper_directions()[random.integers(81, size=2)]
    )
    return Shot(
        index=index, light_theta_deg=light_theta, light_phi_deg=light_phi,
        view_theta_deg=view_theta, view_phi_deg=view_phi, exposures_s=rig.camera.exposures_s,
        lamps=WHITE.lamps,
    )  # fmt: skip


def record_of(role, shot, exposure_s, flux):
    return FrameRecord(
        role=role, shot_index=shot.index, attempt=1, repeat=0, exposure_s=exposure_s,
        file="drawn.dng", sha256="", flux=tuple(flux), view_theta_deg=shot.view_theta_deg,
        view_phi_deg=shot.view_phi_deg, light_theta_deg=shot.light_theta_deg,
        light_phi_deg=shot.light_phi_deg,
    )  # fmt: skip


def _pose(direction):
    theta, phi = to_spherical(direction)
    return ArmPose(float(theta), float(phi))
