from dataclasses import dataclass
from itertools import permutations

import numpy as np
import pytest

from gonio.geometry import ArmPose
from gonio.materials import Lambertian, MeasuredTable
from nnbrdf.analytic import Lambert
from sim import sensor
from sim.camera import SimCamera
from sim.materials import load_material
from sim.scene import render

from .frames import ALL_ON, NORMAL, OFF, RIG, frame, raw_of, tags_of

COLOR = (0.6, 0.3, 0.1)
XYZ_FROM_SRGB = [
    [0.4124, 0.3576, 0.1805],
    [0.2126, 0.7152, 0.0722],
    [0.0193, 0.1192, 0.9505],
]


def ratio(pair):
    return pair[0] / pair[1]


def camera_rgb_per_s(data, half=30):
    """Mean of the middle pixels of each channel, black taken off, over the true time."""
    tags = tags_of(data)
    image = raw_of(data) - tags[50714]
    rows, columns = (side // 2 for side in image.shape)
    patch = image[rows - half : rows + half, columns - half : columns + half]
    green = (patch[0::2, 1::2].mean() + patch[1::2, 0::2].mean()) / 2
    rgb = np.array([patch[0::2, 0::2].mean(), green, patch[1::2, 1::2].mean()])
    return rgb / ratio(tags[34665]["ExposureTime"])


def linear_srgb(data, rgb):
    """Camera RGB to linear sRGB by what the file says, and nothing else."""
    matrix = np.reshape(tags_of(data)[50721], (3, 3, 2))
    return np.linalg.solve(matrix[..., 0] / matrix[..., 1] @ XYZ_FROM_SRGB, rgb)


@dataclass(frozen=True)
class LightSlope:
    """Brighter where the light comes from +x: shows which way the sample lies in the picture."""

    def evaluate(self, light, view):
        light, view = np.broadcast_arrays(light, view)
        return np.repeat(0.2 + 8 * light[..., :1], 3, axis=-1)


def test_the_white_reference_and_the_file_alone_give_the_brdf():
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    white = frame(camera, holder="reference", key="white")
    sample = frame(camera, key="sample")
    white_srgb = linear_srgb(white, camera_rgb_per_s(white))
    brdf = linear_srgb(sample, camera_rgb_per_s(sample)) / white_srgb * 0.99 / np.pi
    # the spread from frame to frame, of 900 pixels of red and blue with crosstalk to undo
    spread = np.array([0.0009, 0.0008, 0.0033])
    assert (np.abs(brdf * np.pi / COLOR - 1) < 4 * spread).all()
    np.testing.assert_allclose(white_srgb / white_srgb[1], 1, rtol=4e-3)


def test_the_white_reference_fills_half_the_well():
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    raw = raw_of(frame(camera, holder="reference"))
    middle = raw[64:96:2, 65:96:2].mean() - sensor.BLACK_LEVEL
    assert middle / (sensor.WHITE_LEVEL - sensor.BLACK_LEVEL) == pytest.approx(0.5, abs=0.01)


def test_as_shot_neutral_is_what_a_neutral_patch_gives():
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    data = frame(camera, holder="reference")
    neutral = np.array(tags_of(data)[50728]).reshape(3, 2)
    measured = camera_rgb_per_s(data)
    np.testing.assert_allclose(measured / measured[1], neutral[:, 0] / neutral[:, 1], rtol=4e-3)


def test_the_matrix_has_real_crosstalk():
    assert (sensor.CAMERA_FROM_SRGB > 0).all()
    for i, j in permutations(range(3), 2):
        assert 0.1 <= sensor.CAMERA_FROM_SRGB[i, j] <= 0.35


@pytest.mark.parametrize("theta_deg", [30, 60, 75])
def test_irradiance_falls_with_the_cosine(theta_deg):
    camera = SimCamera(RIG, Lambertian(0.5), seed=1)
    straight = camera_rgb_per_s(frame(camera, key="straight"))
    oblique = camera_rgb_per_s(frame(camera, light=ArmPose.from_degrees(theta_deg, 90), key="o"))
    np.testing.assert_allclose(oblique / straight, np.cos(np.radians(theta_deg)), rtol=5e-3)


def test_lamps_add_up_and_scale():
    camera = SimCamera(RIG, Lambertian(0.5), seed=1)
    full = camera_rgb_per_s(frame(camera))
    one = np.zeros(11)
    one[4] = 0.8
    np.testing.assert_allclose(
        camera_rgb_per_s(frame(camera, flux=one, s=2.0, key="one")) / full, 0.8 / 11, rtol=5e-3
    )


def test_each_pixel_has_a_light_direction_of_its_own():
    # from above with phi 0, the picture's right is +y and its up -x: rows run along +x
    camera = SimCamera(RIG, LightSlope(), seed=1)
    image = raw_of(frame(camera, view=NORMAL)) - sensor.BLACK_LEVEL
    green = image[20:140:2, 21:140:2]
    x_mm = (np.arange(20, 140, 2) - 79.5) / 2
    seen = green.mean(axis=1)
    expected = 0.2 - 8 * x_mm / np.hypot(x_mm, 2000)
    np.testing.assert_allclose(seen / seen[30], expected / expected[30], rtol=0.01)
    columns = green.mean(axis=0)
    np.testing.assert_allclose(columns / columns[30], 1, rtol=0.01)


def test_the_sample_ends_at_35_mm_and_the_board_begins():
    camera = SimCamera(RIG, Lambertian(0.8), seed=1)
    image = raw_of(frame(camera, view=NORMAL)) - sensor.BLACK_LEVEL
    green = image[80, 1::2]
    bright = np.flatnonzero(green > 0.5 * green.max()) * 2 + 1
    # 2 px/mm about column 79.5
    assert (bright[0], bright[-1]) == (11, 149)
    # beside it is a black square, and below that the paper of a white one
    assert green[0] / green[40] == pytest.approx(0.05 / 0.8, rel=0.1)
    assert image[91, 0] / green[40] == pytest.approx(0.85 / 0.8, rel=0.05)


def test_saturated_pixels_stay_at_white_level():
    camera = SimCamera(RIG, load_material("near-mirror"), seed=1)
    view, light = ArmPose.from_degrees(30, 180), ArmPose.from_degrees(30, 0)
    raw = raw_of(frame(camera, view=view, light=light, s=2.0))
    assert (raw[70:90, 70:90] == 65535).all()
    assert raw.max() == 65535


def test_dark_frames_are_black_level_and_read_noise():
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    raw = raw_of(frame(camera, flux=OFF, s=2.0))
    noise = sensor.GAIN * sensor.READ_NOISE_E
    assert raw.mean() == pytest.approx(1024, abs=4 * noise / raw.shape[0])
    assert raw.std() == pytest.approx(np.hypot(noise, np.sqrt(1 / 12)), rel=0.02)


def test_shot_noise_is_that_of_the_electrons():
    camera = SimCamera(RIG, Lambert((0.9, 0.9, 0.9)), seed=1)
    first, second = (raw_of(frame(camera, key=key))[60:100:2, 61:100:2] for key in "ab")
    electrons = (first.mean() - sensor.BLACK_LEVEL) / sensor.GAIN
    spread = np.var(first - second) / 2 / sensor.GAIN**2
    assert spread == pytest.approx(electrons + sensor.READ_NOISE_E**2, rel=0.25)


def test_noise_hangs_on_seed_and_key_and_not_on_the_order():
    def camera(seed=1):
        return SimCamera(RIG, load_material("wood-veneer"), seed)

    warming = ALL_ON - np.linspace(0.001, 0.004, 11)
    shots = [
        {"key": "a"},
        {"key": "b", "flux": warming},
        {"key": "c", "view": ArmPose.from_degrees(10, 5)},
        {"key": "d", "flux": OFF},
    ]
    one, other = camera(), camera()
    forth = [frame(one, **shot) for shot in shots]
    back = [frame(other, **shot) for shot in reversed(shots)]
    assert forth == back[::-1]
    assert frame(camera(), key="e") != forth[0]
    assert frame(camera(seed=2), key="a") != forth[0]
    unique = {tags_of(data)[34665]["ImageUniqueID"] for data in forth}
    assert len(unique) == 4


def test_a_bracket_is_rendered_once(monkeypatch):
    rendered = []
    monkeypatch.setattr(
        "sim.camera.render",
        lambda *args: rendered.append(args) or render(*args),
    )
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    for s in (0.002, 0.02, 0.2):
        frame(camera, s=s, flux=ALL_ON - s / 100, key=str(s))
    frame(camera, flux=OFF, key="dark")
    assert len(rendered) == 1


@pytest.mark.parametrize("exposure_s", [1e-6, 0.002, 0.2, 2.0])
def test_the_shutter_is_nearly_on_time(exposure_s):
    camera = SimCamera(RIG, Lambert(COLOR), seed=1)
    true = [
        ratio(tags_of(frame(camera, flux=OFF, s=exposure_s, key=str(i)))[34665]["ExposureTime"])
        for i in range(20)
    ]
    assert max(abs(s - exposure_s) for s in true) <= 0.005 * exposure_s + 50e-6
    assert min(true) > 0
    assert len(set(true)) == 20


@pytest.mark.parametrize("view_deg", [(75, 30), (89.9, 0), (90, 0), (91, 200), (-1, 0)])
@pytest.mark.parametrize("light_deg", [(0, 0), (90, 90), (91, 0)])
@pytest.mark.parametrize(
    "material",
    [load_material("wood-veneer"), MeasuredTable.of(np.full((81, 81, 3), 0.1))],
    ids=["analytic", "table"],
)
def test_grazing_poses(view_deg, light_deg, material):
    camera = SimCamera(RIG, material, seed=1)
    view, light = ArmPose.from_degrees(*view_deg), ArmPose.from_degrees(*light_deg)
    raw = raw_of(frame(camera, view=view, light=light))
    assert raw.shape == (160, 160)
    if view_deg[0] > 90 or light_deg[0] > 90.5:
        assert raw.max() < 1100


def test_a_picture_that_does_not_move_is_to_the_bit_one_without_a_shake():
    camera = SimCamera(RIG, Lambert(COLOR), 0)
    assert frame(camera, shake_rad=np.zeros((4, 2))) == frame(camera)


def test_a_shake_moves_each_color_over_its_own_pixels():
    camera = SimCamera(RIG, Lambert(COLOR), 0)
    still = frame(camera)
    # 9 pixels to and fro: an odd number, at which its neighbor has another color
    shaken = frame(camera, shake_rad=np.array([[0.00225, 0.0], [-0.00225, 0.0]]))
    assert camera_rgb_per_s(shaken) == pytest.approx(camera_rgb_per_s(still), rel=2e-3)
    assert np.abs(raw_of(shaken) - raw_of(still)).max() > 100
