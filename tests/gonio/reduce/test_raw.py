import contextlib
import re

import cv2
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gonio.color import D65, adaptation
from gonio.errors import BadFileError
from gonio.files import sha256_bytes
from gonio.reduce.file_matrix import file_matrix
from gonio.reduce.raw import decode_raw, read_vouched
from sim.dng import dng_bytes


def read_raw(path, sha256=None):
    data = path.read_bytes()
    return decode_raw(read_vouched(path, sha256 or sha256_bytes(data), REMEDY), path, REMEDY)


REMEDY = "take it again"
MATRIX = np.array([[0.9, -0.3, -0.1], [-0.4, 1.2, 0.2], [0.0, 0.2, 0.6]])
MOSAIC = np.random.default_rng(1).integers(0, 1 << 16, (32, 48), np.uint16)


def dng(mosaic=MOSAIC, **changes):
    standard = {
        "black": 1024,
        "white": 65535,
        "exposure_s": 0.0200123,
        "iso": 100,
        "color_matrix": MATRIX,
        "as_shot_neutral": (0.5, 1.0, 0.6),
        "camera_model": "test",
        "unique_id": "0123456789abcdef0123456789abcdef",
    }
    return dng_bytes(mosaic, **standard | changes)


def jpeg():
    done, data = cv2.imencode(".jpg", np.zeros((32, 48, 3), np.uint8))
    assert done
    return data.tobytes()


def rgb_tiff():
    done, data = cv2.imencode(".tif", np.zeros((32, 48, 3), np.uint8))
    assert done
    return data.tobytes()


def without(tag):
    """A DNG whose tag is renamed to one that nobody knows."""
    data = bytearray(dng())
    at = data.index(tag.to_bytes(2, "little"), 8)
    data[at : at + 2] = (65000).to_bytes(2, "little")
    return bytes(data)


def flipped():
    data = bytearray(dng())
    data[-100] ^= 4
    return bytes(data)


def test_a_frame_comes_as_it_was_written(tmp_path):
    path = tmp_path / "frame.dng"
    path.write_bytes(dng())
    frame = read_raw(path, sha256_bytes(dng()))
    np.testing.assert_array_equal(frame.mosaic, MOSAIC)
    assert frame.mosaic.flags.owndata
    assert frame.exposure_s == pytest.approx(0.0200123, rel=1e-9)
    sensor = frame.sensor
    assert (sensor.width, sensor.height) == (48, 32)
    assert (sensor.black, sensor.white, sensor.iso) == (1024, 65535, 100)
    np.testing.assert_allclose(sensor.color_matrix, MATRIX.ravel(), atol=1e-9)
    assert sensor.saturation == pytest.approx(1024 + 0.98 * 64511)


def test_a_frame_need_not_state_a_color_matrix(tmp_path):
    path = tmp_path / "frame.dng"
    path.write_bytes(without(50721))
    assert read_raw(path).sensor.color_matrix == ()


@pytest.mark.parametrize("cfa", ["RGGB", "BGGR", "GRBG", "GBRG"])
def test_each_pixel_knows_its_filter(tmp_path, cfa):
    path = tmp_path / "frame.dng"
    path.write_bytes(dng(cfa=cfa))
    rows, columns = np.mgrid[0:4, 0:4]
    letters = np.array(list("RGB"))[read_raw(path).sensor.channel(rows, columns)]
    assert "".join(letters[:2, :2].ravel()) == cfa
    np.testing.assert_array_equal(letters, np.tile(letters[:2, :2], (2, 2)))


DAMAGED = {
    "half a file": (dng()[: len(dng()) // 2], "cut short"),
    "one byte short": (dng()[:-1], "cut short, by 1 bytes"),
    "header only": (dng()[:100], "is not a DNG"),
    "empty": (b"", "is not a DNG"),
    "text": (b"hello\n", "is not a DNG"),
    "a JPEG renamed": (jpeg(), "is not a DNG"),
    "a picture in TIFF": (rgb_tiff(), "holds no Bayer plane"),
    "no exposure time": (without(33434), "states no ExposureTime"),
    "no EXIF": (without(34665), "states no ExposureTime"),
    "a small color matrix": (dng(color_matrix=np.eye(2)), "has a ColorMatrix1 that is not 3 x 3"),
}


@pytest.mark.parametrize(("data", "problem"), DAMAGED.values(), ids=DAMAGED)
def test_damaged_and_foreign_files_are_named_in_one_line(tmp_path, capfd, data, problem):
    path = tmp_path / "frame.dng"
    path.write_bytes(data)
    with pytest.raises(BadFileError, match=re.escape(problem)) as caught:
        read_raw(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(BadFileError, match="no such file; take it again"):
        read_vouched(tmp_path / "gone.dng", "", REMEDY)
    with pytest.raises(BadFileError, match="cannot be read"):
        read_vouched(tmp_path, "", REMEDY)


def test_a_flipped_bit_is_seen_by_its_hash_alone(tmp_path):
    path = tmp_path / "frame.dng"
    path.write_bytes(flipped())
    assert (read_raw(path).mosaic != MOSAIC).sum() == 1
    with pytest.raises(BadFileError, match="has changed since the journal vouched for it"):
        read_raw(path, sha256_bytes(dng()))


@example(flips=[(120, 3)])
@given(flips=st.lists(st.tuples(st.integers(0, 560), st.integers(0, 7)), min_size=1, max_size=3))
@settings(max_examples=300, deadline=None)
def test_no_header_however_damaged_ends_in_a_traceback(tmp_path_factory, flips):
    data = bytearray(dng())
    for byte, bit in flips:
        data[byte] ^= 1 << bit
    path = tmp_path_factory.getbasetemp() / "damaged.dng"
    path.write_bytes(data)
    with contextlib.suppress(BadFileError):
        assert read_raw(path).exposure_s > 0


def rationals(matrix):
    return tuple(part for value in np.ravel(matrix) for part in (round(1e6 * value), 10**6))


A = np.array([0.44757 / 0.40745, 1.0, (1 - 0.44757 - 0.40745) / 0.40745])
FOR_A = rationals(MATRIX @ adaptation(A, D65))
FOR_D65 = rationals(MATRIX)
# matrices by tag with the lights that they were made for, and what says of which one it is
HELD = {
    "D65 alone": ({50721: FOR_D65, 50778: 21}, "ColorMatrix1"),
    "A and D65": ({50721: FOR_A, 50778: 17, 50722: FOR_D65, 50779: 21}, "ColorMatrix2"),
    "D65 and A": ({50721: FOR_D65, 50778: 21, 50722: FOR_A, 50779: 17}, "ColorMatrix1"),
    "A alone": ({50721: FOR_A, 50778: 17}, "ColorMatrix1 of illuminant A"),
    "A, one untold": (
        {50721: FOR_D65, 50722: FOR_A, 50779: 17},
        "ColorMatrix2 of illuminant A",
    ),
    "untold": ({50721: FOR_D65}, "ColorMatrix1"),
    "under clouds": ({50721: FOR_A, 50778: 17, 50722: FOR_D65, 50779: 10}, "ColorMatrix2"),
    "of a fluorescent": ({50721: FOR_D65, 50778: 12}, "ColorMatrix1"),
    "of tungsten": ({50721: FOR_A, 50778: 3}, "ColorMatrix1 of illuminant A"),
}


@pytest.mark.parametrize(("tags", "name"), HELD.values(), ids=HELD)
def test_of_several_matrices_the_one_nearest_to_d65_serves(tags, name):
    found = file_matrix(tags, None)
    assert found.name == name
    np.testing.assert_allclose(np.reshape(found.values, (3, 3)), MATRIX, atol=1e-5)


def test_of_two_standard_lights_the_nearer_one_is_taken():
    found = file_matrix({50721: FOR_A, 50778: 17, 50722: FOR_D65, 50779: 23}, None)
    assert found.name == "ColorMatrix2 of illuminant D50"
    daylight = file_matrix({50721: FOR_A, 50778: 17, 50722: FOR_D65, 50779: 1}, None)
    assert daylight.name == "ColorMatrix2 of illuminant D55"
    white = np.array([0.34567 / 0.35850, 1.0, (1 - 0.34567 - 0.35850) / 0.35850])
    np.testing.assert_allclose(np.reshape(found.values, (3, 3)) @ D65, MATRIX @ white, rtol=1e-6)


def test_a_frame_says_for_which_light_its_matrix_was_made(tmp_path):
    path, data = tmp_path / "frame.dng", bytearray(dng())
    # CalibrationIlluminant1, one short
    at = data.index((50778).to_bytes(2, "little") + b"\x03\x00\x01\x00\x00\x00")
    data[at + 8] = 17
    path.write_bytes(data)
    sensor = read_raw(path).sensor
    assert sensor.matrix_name == "ColorMatrix1 of illuminant A"
    np.testing.assert_allclose(np.reshape(sensor.color_matrix, (3, 3)) @ D65, MATRIX @ A, rtol=1e-6)
