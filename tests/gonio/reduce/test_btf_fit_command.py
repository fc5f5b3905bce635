import itertools

import cv2
import numpy as np
import pytest

from nnbrdf.analytic import Lambert
from nnbrdf.fused import is_available

from .conftest import SMALL_RIG

DIRECTIONS = [(0, 0), (30, 0), (30, 90), (30, 200)]
SIDE = 12


@pytest.mark.skipif(not is_available(), reason="the kernel was not compiled")
def test_the_middle_is_fitted_and_a_picture_relit(photographer, gonio):
    pairs = [(*light, *view) for light, view in itertools.product(DIRECTIONS, DIRECTIONS)]
    albedo = np.array([0.4, 0.3, 0.2])
    shots = photographer(pairs, Lambert(tuple(albedo)), exposures_s=(0.2,), rig_text=SMALL_RIG)
    root = shots.calibrate().shoot().session.root

    refused = gonio("btf", "fit", root)
    assert refused.returncode == 2
    assert f"make it with: gonio reduce --btf {root}" in refused.stderr

    assert gonio("reduce", "--btf", root).returncode == 0
    done = gonio("btf", "fit", "--side", SIDE, "--steps", 60, root)
    assert done.returncode == 0, done.stderr
    off = float(done.stdout.split("off by ")[1].split("%")[0])
    assert off < 5
    with np.load(root / "btf-model" / "weights.npz") as weights:
        assert weights["layer_0"].shape == (SIDE, SIDE, 3, 7)
        assert np.median(weights["white"]) == pytest.approx(4 * 0.3 / np.pi, rel=0.05)
    relit = cv2.imread(str(root / "btf-model" / "relit.png"))
    assert relit is not None
    assert relit.std() > 10

    too_large = gonio("btf", "fit", "--side", 1000, root)
    assert too_large.returncode == 2
    assert "use 1 to 140" in too_large.stderr

    for path in (root / "btf.zarr/value/c").rglob("*"):
        if path.is_file():
            content = bytearray(path.read_bytes())
            # one bit of each square, and none of the index at the end
            for place in range(100, len(content) - 10_000, 10_000):
                content[place] ^= 0x40
            path.write_bytes(content)
    flipped = gonio("btf", "fit", "--side", SIDE, "--steps", 60, root)
    assert (flipped.returncode, flipped.stderr.count("\n")) == (2, 1)
    assert "btf.zarr/value: has changed since it was written" in flipped.stderr
