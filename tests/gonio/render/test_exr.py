"""OpenEXR, read back by Mitsuba's own reader."""

import numpy as np
import pytest

from gonio.render.exr import write_exr


def test_mitsuba_reads_what_was_written(tmp_path):
    mitsuba = pytest.importorskip("mitsuba", reason="needs the extra mitsuba")
    mitsuba.set_variant("scalar_rgb")
    picture = np.random.default_rng(0).lognormal(size=(5, 7, 4))
    for channels in (3, 4):
        path = tmp_path / f"{channels}.exr"
        write_exr(path, picture[..., :channels])
        read = np.array(mitsuba.Bitmap(str(path)))
        assert np.array_equal(read, picture[..., :channels].astype("f4"))
