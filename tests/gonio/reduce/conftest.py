import numpy as np
import pytest
from click.testing import CliRunner

from gonio.checks import Checks
from gonio.cli.reduce import command
from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.files import sha256_bytes, write_bytes
from gonio.geometry import ArmPose
from gonio.journal import FrameRecord
from gonio.notes import Notes
from gonio.plan import Estimates, LampSetting, Plan, Selection, Shot
from gonio.rig import AXES, default_rig, default_rig_text
from gonio.samples import Samples
from gonio.timemodel import DARK_FRAMES, WHITE_FRAMES, exposures_of
from sim.camera import SimCamera

EXPOSURES = (0.002, 0.02, 0.2, 2.0)
NOTES = Notes(sample="test", orientation="+x", mounting="flat", operator="nobody")
SMALL_RIG = default_rig_text().replace("= 160", "= 40").replace("[79.5, 79.5]", "[19.5, 19.5]")
"""The built-in rig with a sensor that sees little more than the patch, to be quick."""

WHITE_DEG = {"light_theta": 0.0, "light_phi": 0.0, "view_theta": 45.0, "view_phi": 0.0}


class Flat:
    """A material of one BRDF, however high."""

    def __init__(self, brdf):
        self.brdf = brdf

    def evaluate(self, light, view):
        return np.full(np.broadcast_shapes(light.shape, view.shape), self.brdf)


def reduced(shots, *options):
    """Run the command on a session; return samples, and checks by name."""
    done = CliRunner().invoke(command, [str(shots.session.root), *options])
    if done.exception is not None:
        raise done.exception
    checks = Checks.load(shots.session.checks_path)
    return Samples.load(shots.session.samples_path), {check.name: check for check in checks.checks}


def with_pixels(change, size):
    """Return what alters a file's pixels: change(mosaic) of a sensor of size x size."""

    def changed(data):
        header, pixels = data[: -2 * size**2], data[-2 * size**2 :]
        mosaic = change(np.frombuffer(pixels, "<u2").reshape(size, size).astype(np.float64))
        return header + np.clip(np.round(mosaic), 0, 65535).astype("<u2").tobytes()

    return changed


def make_plan(pairs_deg, exposures_s=EXPOSURES, lamps=range(1, 12)):
    """Pairs of (light_theta, light_phi, view_theta, view_phi)."""
    shots = tuple(
        Shot(
            index=index,
            light_theta_deg=pair[0],
            light_phi_deg=pair[1],
            view_theta_deg=pair[2],
            view_phi_deg=pair[3],
            exposures_s=exposures_s,
            lamps=tuple(LampSetting(n=n, mA=700.0) for n in lamps),
        )
        for index, pair in enumerate(pairs_deg)
    )
    return Plan(
        rig_sha256=default_rig().sha256,
        selection=Selection(
            criterion="test", candidates="test", views=0, lights=0, full_set=6561,
            reciprocal_pairs=0, route="test",
        ),
        estimates=Estimates(
            moving_s=0, settling_s=0, exposing_s=0, overhead_s=0, frames=0, storage_bytes=0
        ),
        shots=shots,
    )  # fmt: skip


class Photographer:
    """Takes a session's frames as a capture would, straight from the twin's camera."""

    def __init__(self, root, plan, material, *, seed=0, rig_text=None):
        rig_text = rig_text or default_rig_text()
        self.session = create_session(root, plan, rig_text, NOTES)
        self.rig, self.plan, self._material = self.session.rig(), plan, material
        self.camera = SimCamera(self.rig, material, seed)
        self._random = np.random.default_rng(seed)
        self._clock = VirtualClock()
        self.journal = self.session.journal(writing=True)
        self.journal.append(self._clock, "begun")

    def calibrate(self, darks=DARK_FRAMES, whites=WHITE_FRAMES):
        for exposure_s in exposures_of(self.plan.shots):
            for repeat in range(darks):
                self.take("dark", WHITE_DEG, exposure_s, repeat=repeat, lamps=())
            for repeat in range(whites):
                self.take("white", WHITE_DEG, exposure_s, repeat=repeat)
        return self

    def shoot(self, **changes):
        for shot in self.plan.shots:
            pose = {name: shot.axis_deg(name) for name in AXES}
            lamps = [lamp.n for lamp in shot.lamps]
            for exposure_s in shot.exposures_s:
                self.take("shot", pose, exposure_s, index=shot.index, lamps=lamps, **changes)
        return self

    def take(
        self, role, pose, exposure_s, *, index=0, repeat=0, attempt=1, lamps=range(1, 12),
        change=None, brightness=1.0,
    ):  # fmt: skip
        """Take and journal a frame; `change` alters the file's content before it is hashed."""
        # lamps warm up and fade, each a little differently
        flux = np.zeros(11)
        lit = [n - 1 for n in lamps]
        flux[lit] = np.round(brightness * (0.97 + 0.02 * self._random.random(len(lit))), 5)
        angles = {name: self._encoder_deg(name, pose[name]) for name in AXES}
        name = f"{role}_{index:06d}_{exposure_s:g}_r{repeat}_a{attempt}.dng"
        data = self.camera.frame(
            holder="sample" if role == "shot" else "reference",
            view=ArmPose.from_degrees(angles["view_theta"], angles["view_phi"]),
            light=ArmPose.from_degrees(angles["light_theta"], angles["light_phi"]),
            flux=flux,
            exposure_s=exposure_s,
            key=name,
        )
        if change is not None:
            data = change(data)
        folder = self.session.raw if role == "shot" else self.session.calibration
        write_bytes(folder / name, data)
        record = FrameRecord(
            role=role, shot_index=index, attempt=attempt, repeat=repeat, exposure_s=exposure_s,
            file=str((folder / name).relative_to(self.session.root)),
            sha256=sha256_bytes(data), flux=tuple(flux),
            **{f"{name}_deg": angle for name, angle in angles.items()},
        )  # fmt: skip
        self.journal.append_frame(self._clock, record)
        return folder / name

    def _encoder_deg(self, name, degrees):
        # an arm stops within its window, not on the target
        axis = self.rig.axis[name]
        return axis.to_degrees(axis.to_counts(degrees + self._random.uniform(-0.02, 0.02)))


@pytest.fixture
def photographer(tmp_path):
    """Make a Photographer for pairs of directions and a material."""
    made = []

    def make(pairs_deg, material, *, exposures_s=EXPOSURES, lamps=range(1, 12), **settings):
        plan = make_plan(pairs_deg, exposures_s, lamps)
        made.append(Photographer(tmp_path / f"session{len(made)}", plan, material, **settings))
        return made[-1]

    yield make
    for one in made:
        one.journal.close()
