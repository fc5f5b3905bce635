"""How long one core takes to reduce a 2000 x 2000 bracket of three, and rawpy alone to decode it.

Processor time, all in one run and turn about, so that a busy machine slows all alike. Set
OMP_NUM_THREADS=1.
"""

from io import BytesIO
from pathlib import Path
from time import process_time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
import rawpy

from gonio.camera import Camera
from gonio.files import sha256_bytes
from gonio.journal import FrameRecord
from gonio.photogrammetry.grid import TexelGrid
from gonio.photogrammetry.rectification import Rectifier
from gonio.plan import LampSetting, Shot
from gonio.reduce import raw
from gonio.reduce.balance import balance
from gonio.reduce.btf.develop import Tiles
from gonio.reduce.btf.job import Job, Maps
from gonio.reduce.btf.radiance import texels_of
from gonio.reduce.btf.shard import Shard
from gonio.reduce.calibrate import Calibration
from gonio.reduce.color import Coloring, camera_from_srgb
from gonio.reduce.correction import Uncorrected
from gonio.reduce.dark import Dark
from gonio.reduce.frames import Frames
from gonio.reduce.hdr import Exposed, Pixels, merge_pixels
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.reading import take_reading
from gonio.reduce.reduce import _measure
from gonio.reduce.white import Response
from gonio.rig import default_rig
from sim import sensor
from sim.dng import dng_bytes

SIDE, EXPOSURES, ROUNDS = 2000, (0.02, 0.2, 2.0), 15
GAIN, READ_VARIANCE = sensor.GAIN, 12.0
UP = np.array([0.0, 0.0, 1.0])


class Bracket:
    """Three files, and what a reduction of them takes."""

    def __init__(self, root):
        rig = default_rig()
        size = {"width": SIDE, "height": SIDE, "centre_px": (SIDE / 2 - 0.5,) * 2}
        camera = rig.camera.model_copy(update={**size, "focal_px": 50_000.0})
        self.rig = rig.model_copy(update={"camera": camera})
        lamps = tuple(LampSetting(n=n, mA=700.0) for n in range(1, 12))
        pose = {"light_theta_deg": 45, "light_phi_deg": 0, "view_theta_deg": 30, "view_phi_deg": 20}
        self.shot = Shot(index=0, exposures_s=EXPOSURES, lamps=lamps, **pose)
        records = [_take(root, number, pose) for number in range(len(EXPOSURES))]
        self.paths = [root / record.file for record in records]
        self.contents = [path.read_bytes() for path in self.paths]
        self.frames = Frames(root, camera, records, "take it again")
        self.bracket = self.frames.of_shot(self.shot)
        dark = Dark(np.full((SIDE, SIDE), float(sensor.BLACK_LEVEL)), READ_VARIANCE, 4)
        matrix = camera_from_srgb(self.frames.sensor.color_matrix)
        coloring = Coloring("linear sRGB", "ColorMatrix1", matrix, np.eye(3))
        rate = SimpleNamespace(value=np.full(3, 1e10))
        response = Response(balance(coloring, rate.value, np.ones(3)), rate, (), UP, UP)
        self.calibration = Calibration(
            dict.fromkeys(EXPOSURES, dark), GAIN, response, None, Uncorrected(), (), None
        )
        flat = Dark(dark.mean.astype(np.float32), READ_VARIANCE, 4)
        self.maps, self.root = Maps(dict.fromkeys(EXPOSURES, flat), None), root
        self.tiles = Tiles.empty(SIDE, 64)
        self.pixels = Pixels(GAIN, self.frames.sensor.saturation)
        self.job = Job(
            root=root, store=root, made_from="", rig=self.rig, sensor=self.frames.sensor,
            grid=TexelGrid(SIDE), gain=GAIN, saturation=self.pixels.saturation, linearity=None,
            stray_light=0.0,
            strengths=(1.0,) * 11, rate_per_brdf=response.rate_per_brdf,
            relative_variance=np.full(3, 1e-6),
            camera_from_space=response.camera_from_space,
            darks=dict.fromkeys(EXPOSURES, (READ_VARIANCE, 4)), remedy="", geometry=None,
        )  # fmt: skip
        self.merged = self.merge()
        self.rectifier = Rectifier(
            self.merged.value, self.merged.variance, self.frames.sensor.pattern,
            Camera(camera), self.bracket[0].view, self.job.grid,
        )  # fmt: skip

    def decode(self):
        for path in self.paths:
            with rawpy.imread(str(path)) as decoded:
                np.array(decoded.raw_image)

    def reduce(self):
        patches = PatchFinder(self.rig.camera, usual_patch_mm(self.rig.camera))
        _measure(self.shot, self.frames, patches, self.rig, self.calibration)

    def reduce_to_texels(self):
        texels_of(self.frames.of_shot(self.shot), self.maps, self.job, self.tiles)

    def frames_of_shot(self):
        self.frames.of_shot(self.shot)

    def merge(self):
        bracket = [
            Exposed(
                frame.raw.mosaic, self.maps.darks[frame.record.exposure_s].mean,
                frame.raw.exposure_s, READ_VARIANCE,
            )
            for frame in self.bracket
        ]  # fmt: skip
        return merge_pixels(bracket, self.pixels)

    def rectify(self):
        for first in range(0, SIDE, 64):
            self.rectifier.rows(first, min(first + 64, SIDE))

    def bilinear(self):
        camera, grid = Camera(self.rig.camera), self.job.grid
        columns, rows = camera.plane_pixels(grid.x_mm, -grid.x_mm, self.bracket[0].view)
        places = columns.astype(np.float32), rows.astype(np.float32)
        for picture in (self.merged.value, self.merged.variance):
            for _ in "RGB":
                cv2.remap(picture, *places, cv2.INTER_LINEAR)

    def write(self):
        with Shard(self.root / "value", 1, 32) as value, Shard(self.root / "sigma", 1, 32) as sigma:
            value.put(0, self.tiles.value)
            sigma.put(0, self.tiles.sigma)

    def read(self):
        for path in self.paths:
            path.read_bytes()

    def hash(self):
        for content in self.contents:
            sha256_bytes(content)

    def tags(self):
        for content in self.contents:
            raw._tags(content, Path(), "")

    def decode_again(self):
        for content in self.contents:
            with rawpy.imread(BytesIO(content)) as decoded:
                np.array(decoded.raw_image)

    def measure(self):
        patches = PatchFinder(self.rig.camera, usual_patch_mm(self.rig.camera))
        for frame in self.bracket:
            dark = self.calibration.darks[frame.record.exposure_s]
            take_reading(frame, dark, patches, self.rig)


def _take(root, number, pose):
    exposure_s = EXPOSURES[number]
    light = np.random.default_rng(number).normal(30_000 * exposure_s, 100.0, (SIDE, SIDE))
    data = dng_bytes(
        np.clip(sensor.BLACK_LEVEL + light, 0, sensor.WHITE_LEVEL).astype(np.uint16),
        black=sensor.BLACK_LEVEL, white=sensor.WHITE_LEVEL, exposure_s=exposure_s, iso=100,
        color_matrix=sensor.CAMERA_FROM_XYZ, as_shot_neutral=sensor.CAMERA_NEUTRAL,
        camera_model="bench", unique_id=f"{number:032x}",
    )  # fmt: skip
    (root / f"{number}.dng").write_bytes(data)
    return FrameRecord(
        role="shot", shot_index=0, attempt=1, repeat=0, exposure_s=exposure_s,
        file=f"{number}.dng", sha256=sha256_bytes(data), flux=(1.0,) * 11, **pose,
    )  # fmt: skip


@pytest.fixture
def bracket(tmp_path):
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield Bracket(tmp_path)
    cv2.setNumThreads(threads)


def best_ms(*steps, rounds=ROUNDS):
    """Of each step the best of some rounds, all steps in every round."""
    taken = []
    for _ in range(rounds):
        taken.append([])
        for step in steps:
            began = process_time()
            step()
            taken[-1].append(1e3 * (process_time() - began))
    return np.min(taken, axis=0)


def test_a_sample_takes_at_most_twice_what_decoding_takes(bracket):
    stages = [
        bracket.read, bracket.hash, bracket.tags, bracket.decode_again, bracket.measure,
    ]  # fmt: skip
    decode, whole, *parts = best_ms(bracket.decode, bracket.reduce, *stages)
    print(f"\nrawpy {decode:.1f} ms, whole reduction {whole:.1f} ms, ratio {whole / decode:.2f}")  # noqa: T201
    for stage, part in zip(stages, parts, strict=True):
        print(f"  {stage.__name__:14} {part:6.1f} ms  {part / whole:4.0%}")  # noqa: T201
    assert whole <= 2.0 * decode


def test_texels(bracket):
    """Rectified and developed is what is left of the whole."""
    stages = [bracket.frames_of_shot, bracket.merge, bracket.rectify, bracket.write]
    decode, whole, bilinear, *parts = best_ms(
        bracket.decode, bracket.reduce_to_texels, bracket.bilinear, *stages, rounds=5
    )
    print(f"\nrawpy {decode:.1f} ms, texels {whole:.0f} ms, ratio {whole / decode:.1f}")  # noqa: T201
    for stage, part in zip(stages, parts, strict=True):
        print(f"  {stage.__name__:14} {part:6.1f} ms  {part / whole:4.0%}")  # noqa: T201
    ratio = parts[2] / bilinear
    print(f"rectification is {ratio:.2f} of OpenCV's bilinear look at six planes")  # noqa: T201
