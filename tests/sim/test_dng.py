import io

import numpy as np
import pytest
import rawpy
import tifffile

from sim.dng import dng_bytes

MATRIX = np.array([[0.9, -0.3, -0.1], [-0.4, 1.2, 0.2], [0.0, 0.2, 0.6]])
XYZ_OF_SRGB = np.array(
    [[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]]
)
NEUTRAL = np.array([0.55, 1.0, 0.65])
UNIQUE = "0123456789abcdef0123456789abcdef"


def dng(mosaic, **changes):
    settings = {
        "black": 1024,
        "white": 65535,
        "exposure_s": 0.0200123,
        "iso": 100,
        "color_matrix": MATRIX,
        "as_shot_neutral": NEUTRAL,
        "camera_model": "gonio twin",
        "unique_id": UNIQUE,
    }
    return dng_bytes(mosaic, **settings | changes)


@pytest.fixture
def mosaic():
    return np.random.default_rng(1).integers(0, 1 << 16, (48, 64), np.uint16)


def tags_of(data):
    with tifffile.TiffFile(io.BytesIO(data)) as tiff:
        return {tag.code: tag.value for tag in tiff.pages[0].tags}


def test_rawpy_reads_the_very_pixels(mosaic):
    with rawpy.imread(io.BytesIO(dng(mosaic))) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)
        np.testing.assert_array_equal(raw.raw_image_visible, mosaic)


def test_rawpy_reads_levels_pattern_and_color(mosaic):
    # LibRaw keeps no ColorMatrix1 of a DNG (its cam_xyz stays 0), but inverts it, rows scaled
    # so that sRGB white is camera white
    camera_of_srgb = MATRIX @ XYZ_OF_SRGB
    expected = np.linalg.inv(camera_of_srgb / camera_of_srgb.sum(axis=1, keepdims=True))
    with rawpy.imread(io.BytesIO(dng(mosaic))) as raw:
        assert raw.black_level_per_channel == [1024] * 4
        assert raw.white_level == 65535
        assert raw.color_desc == b"RGBG"
        # LibRaw tells the two greens apart
        np.testing.assert_array_equal(raw.raw_pattern, [[0, 1], [3, 2]])
        np.testing.assert_allclose(raw.color_matrix[:, :3], expected, atol=2e-4)
        gains = np.array(raw.camera_whitebalance[:3])
        np.testing.assert_allclose(gains / gains[1], 1 / NEUTRAL, rtol=1e-6)


@pytest.mark.parametrize("cfa", ["RGGB", "BGGR", "GRBG", "GBRG"])
def test_the_pattern_is_the_one_asked_for(mosaic, cfa):
    with rawpy.imread(io.BytesIO(dng(mosaic, cfa=cfa))) as raw:
        letters = [chr(raw.color_desc[i]) for i in raw.raw_pattern.ravel()]
    assert "".join(letters) == cfa


@pytest.mark.parametrize("exposure_s", [1e-6, 0.002, 1 / 3, 0.2000537, 2.0, 300.0])
def test_the_exif_directory_says_the_true_time(mosaic, exposure_s):
    exif = tags_of(dng(mosaic, exposure_s=exposure_s))[34665]
    numerator, denominator = exif["ExposureTime"]
    assert numerator / denominator == pytest.approx(exposure_s, rel=1e-9)
    assert exif["ISOSpeedRatings"] == 100
    assert exif["ImageUniqueID"] == UNIQUE


def test_tags_of_the_protocol(mosaic):
    tags = tags_of(dng(mosaic))
    assert tags[33421] == (2, 2)
    assert tags[33422] == b"\x00\x01\x01\x02"
    assert (tags[50714], tags[50717], tags[50778]) == (1024, 65535, 21)
    assert tags[50706] == b"\x01\x04\x00\x00"
    assert tags[50708] == "gonio twin"
    matrix = np.reshape(tags[50721], (9, 2))
    np.testing.assert_allclose(matrix[:, 0] / matrix[:, 1], MATRIX.ravel(), atol=1e-9)
    crop_and_opcodes = {50719, 50720, 50829, 51008, 51009, 51022}
    assert not crop_and_opcodes & tags.keys()


def test_one_strip_that_ends_the_file(mosaic):
    data = dng(mosaic)
    tags = tags_of(data)
    (offset,), (length,) = tags[273], tags[279]
    assert length == mosaic.nbytes
    assert offset + length == len(data)
