"""Each imperfection as it shows in the camera's files."""

import numpy as np
import pytest

from gonio.geometry import ArmPose
from gonio.materials import Lambertian
from sim import sensor
from sim.camera import SimCamera
from sim.camera_imperfections import ALL, MILD, NONE, CameraImperfections
from sim.warmth import Warmth

from .frames import NORMAL, OBLIQUE, OFF, RIG, frame, raw_of

COOL_C = np.full(11, 25.0)
GRAZING = ArmPose.from_degrees(75, 0)


def camera(seed=1, reflectance=0.5, **sizes):
    return SimCamera(RIG, Lambertian(reflectance), seed, CameraImperfections(**sizes))


def electrons(data):
    return (raw_of(data) - sensor.BLACK_LEVEL) / sensor.GAIN


def greens(image):
    return (image[0::2, 1::2] + image[1::2, 0::2]) / 2


def middle(image):
    return image[66:94, 66:94]


def correlation(one, other):
    return np.corrcoef(one.ravel(), other.ravel())[0, 1]


def test_without_sizes_it_is_the_ideal_camera_to_the_bit():
    ideal = SimCamera(RIG, Lambertian(0.5), 1)
    warm = Warmth(np.full(11, 60.0), 1.0)
    assert frame(camera(), warmth=warm) == frame(ideal)
    assert frame(SimCamera(RIG, Lambertian(0.5), 1, ALL)) != frame(ideal)


def test_an_almost_ideal_camera_sees_what_the_ideal_one_does():
    # the smallest size takes the way through the lens
    one, other = (electrons(frame(it)) for it in (camera(), camera(camera_glare=1e-9)))
    assert np.abs(one - other).max() < 1.5 / sensor.GAIN


def test_the_fixed_pattern_is_that_of_the_sensor_in_every_frame():
    sizes = {"camera_prnu": 0.03, "camera_dsnu_e": 20.0, "camera_column_e": 10.0}
    ideal = {key: electrons(frame(camera(), key=key)) for key in "ab"}
    first, second = (electrons(frame(camera(**sizes), key=key)) - ideal[key] for key in "ab")
    other = electrons(frame(camera(seed=2, **sizes), key="a")) - ideal["a"]
    assert correlation(middle(first), middle(second)) > 0.8
    green = np.s_[0::2, 1::2]
    level = middle(ideal["a"])[green].mean()
    assert middle(first)[green].std() == pytest.approx(0.03 * level, rel=0.25)
    assert abs(correlation(middle(first), middle(other))) < 0.15


def test_offsets_show_without_light_and_do_not_grow_with_time():
    it = camera(camera_dsnu_e=20.0, camera_column_e=20.0)
    short, long = (electrons(frame(it, flux=OFF, s=s, key=str(s))) for s in (0.002, 2.0))
    for dark in (short, long):
        assert dark.mean() == pytest.approx(0.0, abs=0.1)
        assert dark.std() == pytest.approx(np.hypot(20.0, 20.0), rel=0.15)
    assert correlation(short, long) > 0.95


def test_a_sensor_in_use_has_more_dark_current_and_its_shot_noise():
    it = camera(camera_dark_e_per_s=100.0, camera_sensor_rise_c=12.0)
    levels = []
    for warmth in (0.0, 0.5, 1.0):
        dark = electrons(frame(it, flux=OFF, s=10.0, warmth=Warmth(COOL_C, warmth)))
        levels.append(dark.mean())
        assert dark.var() == pytest.approx(dark.mean() + sensor.READ_NOISE_E**2, rel=0.05)
    np.testing.assert_allclose(np.divide(levels[1:], levels[:-1]), 2.0, rtol=0.01)


def test_hot_pixels_glow_in_the_same_places():
    it = camera(camera_dark_e_per_s=1.0, camera_hot_share=0.002, camera_hot_times=1000.0)
    first, second = (electrons(frame(it, flux=OFF, s=2.0, key=key)) > 200.0 for key in "ab")
    assert 20 < first.sum() < 100
    assert (first & second).sum() > 0.9 * first.sum()


def test_near_the_full_well_a_line_bends():
    scene = {"view": NORMAL, "light": OBLIQUE}
    for s, is_full in ((0.02, False), (1.0, True)):
        one, other = (
            middle(electrons(frame(it, s=s, **scene)))[0::2, 1::2].mean()
            for it in (camera(), camera(camera_full_well=0.05))
        )
        fill = one / sensor.FULL_WELL_E
        assert (fill > 0.8) == is_full
        assert 1.0 - other / one == pytest.approx(0.05 * fill**4, abs=0.0005)


def test_the_corners_are_darker():
    one, other = (electrons(frame(it, view=NORMAL)) for it in (camera(), vignetted()))
    ratio = greens(other).clip(1) / greens(one).clip(1)
    assert ratio[38:42, 38:42].mean() == pytest.approx(1.0, abs=0.01)
    corner = ratio[:3, :3].mean()
    cosine = np.cos(np.arctan(np.hypot(77, 77) / RIG.camera.focal_px))
    assert corner == pytest.approx((1 - 0.4 * (77 / 79.5) ** 2) * cosine**4, abs=0.04)


def vignetted():
    return camera(camera_vignetting=0.4, camera_cos4=True)


def test_the_far_edge_of_a_tilted_sample_is_out_of_focus_and_its_middle_is_not():
    # 34 mm behind the focus; an aperture of 70 mm spreads that over 2.4 px
    sharp, soft = (electrons(frame(it, view=GRAZING)) for it in (camera(), wide_open()))
    np.testing.assert_allclose(middle(soft).mean(), middle(sharp).mean(), rtol=0.01)
    assert steepest(soft) < 0.8 * steepest(sharp)
    flat = [electrons(frame(it, view=NORMAL)) for it in (camera(), wide_open())]
    assert np.abs(flat[0] - flat[1]).max() < 1.5 / sensor.GAIN


def wide_open():
    return camera(reflectance=0.5, camera_focal_mm=98.0, camera_f_number=1.4)


def steepest(image):
    profile = greens(image)[:, 30:50].mean(axis=1)
    return np.abs(np.diff(profile[:35])).max()


def test_stray_light_falls_where_nothing_is():
    it = camera(camera_glare=0.04)
    clean, veiled = (electrons(frame(each, view=GRAZING)) for each in (camera(), it))
    nowhere = np.s_[:10, :]
    assert clean[nowhere].mean() == pytest.approx(0.0, abs=0.5)
    assert veiled[nowhere].mean() == pytest.approx(0.04 * clean.mean(), rel=0.02)
    assert veiled.mean() == pytest.approx(clean.mean(), rel=0.002)


def test_a_halo_falls_off_with_distance():
    it = camera(camera_halo=0.1, camera_halo_width=0.03)
    rows = greens(electrons(frame(it, view=GRAZING))).mean(axis=1)
    assert abs(rows[:5]).max() < 0.01 * rows[21]
    assert (np.diff(rows[18:22]) > 0).all()


def test_a_warm_lamp_has_another_color():
    it = camera(lamp_red_per_c=-0.002, lamp_blue_per_c=0.001)
    shares = []
    for junction_c in (25.0, 65.0):
        seen = middle(electrons(frame(it, warmth=Warmth(np.full(11, junction_c), 0.0))))
        cells = [seen[0::2, 0::2], greens(seen), seen[1::2, 1::2]]
        srgb = np.linalg.solve(sensor.CAMERA_FROM_SRGB, [cell.mean() for cell in cells])
        shares.append(srgb / srgb[1])
    np.testing.assert_allclose(shares[0], 1.0, rtol=0.01)
    np.testing.assert_allclose(shares[1] / shares[0], [0.92, 1.0, 1.04], rtol=0.01)


@pytest.mark.parametrize("sizes", [NONE, MILD, ALL], ids=["none", "mild", "all"])
def test_what_is_given_by_name_grows_from_none_to_all(sizes):
    sized = sizes.model_dump()
    for key in sized.keys() - {"camera_f_number"}:
        assert abs(getattr(NONE, key)) <= abs(sized[key]) <= abs(getattr(ALL, key))
    assert NONE.aperture_mm <= sizes.aperture_mm <= ALL.aperture_mm
