"""How long a worker of gonio reduce --btf takes a bracket, and how much memory, by their number.

A worker reduces brackets of three frames to as many texels as pixels; the same three files serve
all brackets. Run: OMP_NUM_THREADS=1 python tests/benchmarks/study_btf.py
"""

import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time

import cv2
import numpy as np

from gonio.color import XYZ_FROM_SRGB
from gonio.files import sha256_bytes
from gonio.journal import FrameRecord
from gonio.photogrammetry.grid import TexelGrid
from gonio.plan import LampSetting, Shot
from gonio.reduce.btf.block import reduce_block
from gonio.reduce.btf.job import Job, Maps
from gonio.reduce.btf.layout import Layout
from gonio.reduce.btf.store import make_store
from gonio.reduce.color import camera_from_srgb
from gonio.reduce.dark import Dark
from gonio.reduce.frames import Frames
from gonio.rig import default_rig
from sim.dng import dng_bytes

CASES = [(1000, 8), (1000, 16), (1000, 32), (2000, 4), (2000, 8)]
"""Pixels along a side, and brackets."""

EXPOSURES = (0.02, 0.2, 2.0)
BLACK, WHITE, READ_VARIANCE = 1024, 65535, 12.0
LAMPS = tuple(LampSetting(n=n, mA=700.0) for n in range(1, 12))


def main():
    """Start a new process for each case, so that each has a peak of its own."""
    print("side   brackets   s of a core   s a bracket   peak MB")  # noqa: T201
    for side, number in CASES:
        command = [sys.executable, __file__, str(side), str(number)]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
        seconds, peak_mb = float(said[0]), float(said[1])
        print(f"{side:4}{number:11}{seconds:14.2f}{seconds / number:14.3f}{peak_mb:10.0f}")  # noqa: T201


def worker(side, number):
    """Reduce so many brackets and tell processor time and peak memory."""
    cv2.setNumThreads(1)
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        job, layout, shots, records = prepared(root, side, number)
        dark = Dark(np.full((side, side), float(BLACK)), READ_VARIANCE, 4)
        make_store(job.store, layout, Maps(dict.fromkeys(EXPOSURES, dark), None))
        began = process_time()
        for block in layout.blocks(shots, records):
            assert not reduce_block(job, block).problems
        seconds = process_time() - began
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(seconds, peak_mb)  # noqa: T201


def prepared(root, side, number):
    """Return job, layout, shots and records of a session whose shots share three files."""
    rig = default_rig()
    size = {"width": side, "height": side, "centre_px": (side / 2 - 0.5,) * 2}
    camera = rig.camera.model_copy(update={**size, "focal_px": 25.0 * side})
    rig = rig.model_copy(update={"camera": camera})
    files = [frame_file(root, side, exposure_s) for exposure_s in EXPOSURES]
    poses = [pose(index) for index in range(number)]
    shots = [
        Shot(index=index, exposures_s=EXPOSURES, lamps=LAMPS, **where)
        for index, where in enumerate(poses)
    ]
    records = [
        FrameRecord(
            role="shot", shot_index=index, attempt=1, repeat=0, exposure_s=exposure_s,
            file=file, sha256=sha256, flux=(1.0,) * 11, **where,
        )
        for index, where in enumerate(poses)
        for exposure_s, (file, sha256) in zip(EXPOSURES, files, strict=True)
    ]  # fmt: skip
    frames = Frames(root, camera, records, "")
    frames.of_shot(shots[0])
    job = Job(
        root=root, store=root / "btf.zarr", made_from="", rig=rig, sensor=frames.sensor,
        grid=TexelGrid(side), gain=1.0, saturation=frames.sensor.saturation, linearity=None,
            stray_light=0.0,         strengths=(1.0,) * 11, rate_per_brdf=np.full(3, 1e10),
        relative_variance=np.full(3, 1e-6),
        camera_from_space=camera_from_srgb(frames.sensor.color_matrix),
        darks=dict.fromkeys(EXPOSURES, (READ_VARIANCE, 4)), remedy="", geometry=None,
    )  # fmt: skip
    return job, Layout.of_shots(shots, job.grid), shots, records


def pose(index):
    """Eight views of each light, as a plan of all pairs has them side by side."""
    light, view = divmod(index, 8)
    return {
        "light_theta_deg": 10.0 + light, "light_phi_deg": 0.0,
        "view_theta_deg": 5.0 * view, "view_phi_deg": 90.0,
    }  # fmt: skip


def frame_file(root, side, exposure_s):
    """Write a frame; return its name and SHA-256."""
    light = np.random.default_rng(0).normal(30_000 * exposure_s, 100.0, (side, side))
    data = dng_bytes(
        np.clip(BLACK + light, 0, WHITE).astype(np.uint16), black=BLACK, white=WHITE,
        exposure_s=exposure_s, iso=100, color_matrix=np.linalg.inv(XYZ_FROM_SRGB),
        as_shot_neutral=np.ones(3), camera_model="study", unique_id=f"{0:032x}",
    )  # fmt: skip
    (root / f"{exposure_s}.dng").write_bytes(data)
    return f"{exposure_s}.dng", sha256_bytes(data)


if __name__ == "__main__":
    worker(*map(int, sys.argv[1:])) if sys.argv[1:] else main()
