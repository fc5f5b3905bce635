"""The parts of the reduction that need no files: dark, gain, patch, light, color, white."""

from types import SimpleNamespace

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.errors import BadInputError
from gonio.geometry import ArmPose
from gonio.materials import Lambertian
from gonio.reduce.color import Coloring, camera_from_srgb
from gonio.reduce.dark import mean_dark
from gonio.reduce.doubt import Doubt
from gonio.reduce.gain import PhotonTransfer
from gonio.reduce.light import Source
from gonio.reduce.merge import merge
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.raw import Sensor
from gonio.reduce.reading import Reading
from gonio.reduce.stray import stray_on, surrounds
from gonio.reduce.white import respond
from gonio.rig import default_rig
from sim import sensor as twin

RIG = default_rig()
SENSOR = Sensor(160, 160, "RGGB", 1024, 65535, 100, tuple(twin.CAMERA_FROM_XYZ.ravel()))
ALL_LIT = (1.0,) * 11


def repeats(mean, count, gain, read, random):
    """Frames of `mean` electrons, the shutter off by a percent from one to the next."""
    for _ in range(count):
        electrons = random.poisson(mean * random.uniform(0.99, 1.01))
        noise = read * random.normal(size=mean.shape)
        yield np.round(1024 + gain * electrons + noise).astype(np.uint16)


def test_dark_frames_give_mean_and_read_noise():
    random = np.random.default_rng(1)
    fixed = random.uniform(0, 40, (100, 100))
    stack = [np.round(1024 + fixed + 5 * random.normal(size=fixed.shape)) for _ in range(4)]
    dark = mean_dark(stack)
    assert dark.read_variance == pytest.approx(25 + 1 / 12, rel=0.03)
    assert dark.mean_variance == pytest.approx(0.25 * dark.read_variance)
    assert (dark.mean - 1024 - fixed).std() == pytest.approx(2.5, rel=0.05)


def test_darks_without_noise_still_have_that_of_rounding():
    assert mean_dark([np.full((4, 4), 1024, np.uint16)] * 2).read_variance == pytest.approx(1 / 12)


@pytest.mark.parametrize("gain", [0.2, 1.0752, 8.0])
@pytest.mark.parametrize("electrons", [400, 6000])
def test_photon_transfer_finds_the_gain(gain, electrons):
    random = np.random.default_rng(2)
    dark = mean_dark(list(repeats(np.zeros((100, 100)), 4, gain, 3.0, random)))
    # lit unevenly, as the corners of a picture are
    mean = electrons * np.linspace(0.2, 1.0, 10_000).reshape(100, 100)
    transfer = PhotonTransfer()
    transfer.add(list(repeats(mean, 4, gain, 3.0, random)), dark, 65_000)
    assert transfer.gain == pytest.approx(gain, rel=0.04)


def test_photon_transfer_leaves_saturated_pixels_out():
    random = np.random.default_rng(3)
    dark = mean_dark(list(repeats(np.zeros((100, 100)), 4, 1.0, 3.0, random)))
    mean = np.linspace(1000, 60_000, 10_000).reshape(100, 100)
    stack = [np.minimum(frame, 40_000) for frame in repeats(mean, 4, 1.0, 3.0, random)]
    transfer = PhotonTransfer()
    transfer.add(stack, dark, 39_000)
    assert transfer.gain == pytest.approx(1.0, rel=0.05)


def test_exposures_that_are_partly_saturated_count_where_there_are_no_others():
    random = np.random.default_rng(3)
    dark = mean_dark(list(repeats(np.zeros((100, 100)), 4, 1.0, 3.0, random)))
    # at the limit, pixels that stay below it in all repeats are the less noisy ones
    limit = [
        np.minimum(f, 41_200) for f in repeats(np.full((100, 100), 40_000), 4, 1.0, 3.0, random)
    ]
    transfer = PhotonTransfer()
    transfer.add(limit, dark, 41_100)
    assert transfer.gain < 0.8
    transfer.add(list(repeats(np.full((100, 100), 4_000), 4, 1.0, 3.0, random)), dark, 41_100)
    assert transfer.gain == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize(("electrons", "count"), [(1, 4), (5000, 1)], ids=["dark", "no repeats"])
def test_photon_transfer_says_what_it_needs(electrons, count):
    random = np.random.default_rng(4)
    dark = mean_dark(list(repeats(np.zeros((50, 50)), 4, 1.0, 3.0, random)))
    transfer = PhotonTransfer()
    transfer.add(list(repeats(np.full((50, 50), electrons), count, 1.0, 3.0, random)), dark, 60_000)
    with pytest.raises(BadInputError, match="two repeats that are bright and not saturated"):
        _ = transfer.gain


@pytest.mark.parametrize("view_deg", [(0, 0), (0, 77), (30, 200), (60, 45), (75, 13)])
def test_the_patch_is_the_square_in_the_middle(view_deg):
    pose = ArmPose.from_degrees(*view_deg)
    patch = PatchFinder(RIG.camera, 5.0).find(pose, SENSOR)
    assert (np.abs(patch.points_mm[:, :2]) <= 2.5).all()
    assert (patch.points_mm[:, 2] == 0).all()
    # 2 px/mm across the view, foreshortened along it
    assert len(patch.points_mm) == pytest.approx(100 * np.cos(pose.theta), rel=0.25)
    assert len(patch.points_mm) * RIG.camera.focal_px**-2 == pytest.approx(
        patch.solid_angle, rel=0.25
    )
    assert np.degrees(np.arccos(patch.view @ pose.direction)) < 0.02
    np.testing.assert_array_equal(patch.channel, SENSOR.channel(patch.rows, patch.columns))


# at 75 deg across the rows red and blue have a single one each, and nothing moves their middles
@pytest.mark.parametrize(
    ("view_deg", "left_mm"),
    [((0, 0), 0.1), ((30, 200), 0.1), ((60, 45), 0.1), ((75, 13), 0.1), ((75, 180), 1.0)],
)
def test_all_channels_look_at_one_middle(view_deg, left_mm):
    patch = PatchFinder(RIG.camera, 5.0).find(ArmPose.from_degrees(*view_deg), SENSOR)
    middles = np.stack([patch.mean(where) for where in patch.points_mm[:, :2].T], axis=-1)
    np.testing.assert_allclose(patch.mean(np.ones(len(patch.rows))), 1.0)
    # as seen from 2 m, 0.1 mm are 0.003 deg
    assert np.ptp(middles, axis=0).max() < 2.0 * left_mm
    assert (patch.pixels <= np.bincount(patch.channel) + 1e-9).all()
    assert (patch.pixels > np.bincount(patch.channel) / 2).all()


def test_the_patch_is_found_where_the_whole_picture_has_it():
    from gonio.camera import Camera

    spec = RIG.camera.model_copy(update={"distortion": (0.2, -0.1, 1e-3, -1e-3, 0.0)})
    pose = ArmPose.from_degrees(50, 120)
    patch = PatchFinder(spec, 30.0).find(pose, SENSOR)
    everywhere = Camera(spec).plane_points(pose)
    rows, columns = np.nonzero((np.abs(everywhere) <= 15.0).all(axis=-1))
    np.testing.assert_array_equal([patch.rows, patch.columns], [rows, columns])
    np.testing.assert_allclose(patch.points_mm, everywhere[rows, columns], atol=1e-9)


@pytest.mark.parametrize("side_mm", [0.0, -1.0, 71.0, float("nan"), float("inf")])
def test_patches_that_no_sample_has_are_refused(side_mm):
    with pytest.raises(BadInputError, match="does not fit the sample"):
        PatchFinder(RIG.camera, side_mm)


@pytest.mark.parametrize(("side_mm", "theta_deg"), [(0.4, 0), (1.0, 80), (5.0, 90), (5.0, 91)])
def test_patches_out_of_sight_are_refused(side_mm, theta_deg):
    with pytest.raises(BadInputError, match="too few pixels; use a larger --patch-mm"):
        PatchFinder(RIG.camera, side_mm).find(ArmPose.from_degrees(theta_deg, 0), SENSOR)


def test_irradiance_is_inverse_square_and_cosine():
    middle = np.zeros((1, 3))
    only = tuple(float(n == 0) for n in range(11))
    straight = Source(RIG.lamps, ArmPose.from_degrees(0, 0), only).irradiance(middle)
    assert straight == pytest.approx(1 / 2000.0**2)
    oblique = Source(RIG.lamps, ArmPose.from_degrees(60, 30), only).irradiance(middle)
    assert oblique == pytest.approx(straight / 2)
    off_axis = Source(RIG.lamps, ArmPose.from_degrees(0, 0), only).irradiance(
        np.array([[2000.0, 0.0, 0.0]])
    )
    assert off_axis == pytest.approx(straight / 2**1.5)


def test_lamps_add_up():
    points = np.array([[1.0, 2.0, 0.0], [-2.0, 1.0, 0.0]])
    pose = ArmPose.from_degrees(40, 10)
    single = [
        Source(RIG.lamps, pose, tuple(0.5 * (n == lamp) for n in range(11))).irradiance(points)
        for lamp in range(11)
    ]
    together = Source(RIG.lamps, pose, ALL_LIT).irradiance(points)
    np.testing.assert_allclose(np.sum(single, axis=0) * 2, together)


def test_a_light_below_the_plane_gives_none():
    source = Source(RIG.lamps, ArmPose.from_degrees(92, 0), ALL_LIT)
    assert source.irradiance(np.zeros((1, 3))) == 0


def test_the_light_comes_from_the_centre_of_what_is_lit():
    pose = ArmPose.from_degrees(45, 0)
    np.testing.assert_allclose(
        Source(RIG.lamps, pose, ALL_LIT).directions(np.zeros((1, 3)))[0], pose.direction, atol=1e-6
    )
    # lamp 2 alone is 15 mm to the right, which at phi 0 is +y
    right = Source(RIG.lamps, pose, (0, 0.3, *[0] * 9)).directions(np.zeros((1, 3)))[0]
    assert right[1] == pytest.approx(15 / np.hypot(2000, 15))


@pytest.mark.parametrize(
    ("lit", "square_mm"),
    [(range(1, 12), 661.3), ([1], 0.0), ([2, 7], 0.0), ([2, 1, 7], 0.0), ([1, 2, 4], 107.0)],
    ids=["all", "one", "two", "three in line", "three"],
)
def test_solid_angle_of_the_lit_lamps(lit, square_mm):
    flux = tuple(float(n + 1 in lit) for n in range(11))
    source = Source(RIG.lamps, ArmPose.from_degrees(0, 0), flux)
    assert source.solid_angle == pytest.approx(square_mm / 4e6, rel=1e-3, abs=1e-12)


def test_the_crosstalk_of_the_twin_is_found_in_its_color_matrix():
    expected = twin.CAMERA_FROM_SRGB / twin.CAMERA_NEUTRAL[:, None]
    np.testing.assert_allclose(camera_from_srgb(SENSOR.color_matrix), expected, atol=1e-12)


@pytest.mark.parametrize(
    "matrix",
    [np.zeros(9), np.ones(9), -twin.CAMERA_FROM_XYZ.ravel(), np.full(9, np.nan)],
    ids=["zero", "singular", "negative", "nan"],
)
def test_useless_color_matrices_are_refused(matrix):
    with pytest.raises(BadInputError, match="color matrix does not tell colors apart"):
        camera_from_srgb(tuple(matrix))


def white_reading(signal, saturated=False):
    return Reading(
        signal=np.array(signal),
        exposure=np.full(3, 0.5),
        pixels=np.full(3, 30),
        saturated=np.full(3, saturated),
        read_variance=10.0,
        dark_variance=2.5,
        surround=np.zeros(3),
        stray=np.zeros(3),
        light=from_degrees(0, 0),
        view=from_degrees(45, 0),
        arms_rad=np.zeros(4),
        light_solid_angle=0.0,
        view_solid_angle=0.0,
    )


def by(matrix):
    return Coloring("linear sRGB", "test", matrix, np.eye(3))


def test_the_reference_comes_back_as_itself():
    matrix = camera_from_srgb(SENSOR.color_matrix)
    response = respond([white_reading([500.0, 900.0, 600.0])], 1.0, Lambertian(0.99), by(matrix))
    rate = merge([white_reading([500.0, 900.0, 600.0])], 1.0)
    np.testing.assert_allclose(response.brdf(rate), 0.99 / np.pi)


def test_a_colored_reference_is_allowed_for():
    class Pink:
        def evaluate(self, light, view):
            return np.array([0.3, 0.2, 0.25])

    matrix = camera_from_srgb(SENSOR.color_matrix)
    signal = 1000.0 * matrix @ [0.3, 0.2, 0.25] * [0.5, 1.0, 0.6]
    response = respond([white_reading(signal)], 1.0, Pink(), by(matrix))
    rate = merge([white_reading(signal)], 1.0)
    np.testing.assert_allclose(response.brdf(rate), [0.3, 0.2, 0.25])


@pytest.mark.parametrize(
    ("reading", "state"),
    [
        (white_reading([60_000.0] * 3, saturated=True), "saturated"),
        (white_reading([-0.1] * 3), "dark"),
    ],
    ids=["saturated", "dark"],
)
def test_a_useless_white_reference_is_named(reading, state):
    with pytest.raises(BadInputError, match=f"the white reference is {state}"):
        respond([reading], 1.0, Lambertian(0.99), by(np.eye(3)))


@pytest.mark.parametrize("times", [(1.0, 2.0, 16.0), (16.0, 1.0, 2.0), (16.0, 32.0)])
def test_what_paper_sheds_is_told_by_exposures_that_show_it(times):
    scene = np.full((8, 8), 10.0)
    scene[:, 4:] = 100.0
    end, black = 1000.0, 64.0
    raws = [
        SimpleNamespace(
            mosaic=black + np.minimum(time * scene, end), sensor=SimpleNamespace(pattern="RGGB")
        )
        for time in times
    ]
    dark = SimpleNamespace(mean=np.full((8, 8), black))
    means = surrounds(raws, [dark] * len(times), times, None, black + end)
    # where none shows all, the shortest is the nearest
    shown = [time for time in times if time * 100.0 < end] or [min(times)]
    for time, mean in zip(times, means, strict=True):
        rate = np.minimum(shown[0] * scene, end).mean() / shown[0]
        np.testing.assert_allclose(mean, time * rate, rtol=1e-12)


def test_stray_light_that_is_none_give_or_take_a_little_may_be_a_little():
    raw = SimpleNamespace(mosaic=np.full((8, 8), 164.0), sensor=SimpleNamespace(pattern="RGGB"))
    known = SimpleNamespace(
        stray_light=0.0, halo=None, linearity=None, saturation=lambda _: 1e3,
        doubt=Doubt(stray_light=0.001),
    )  # fmt: skip
    found = stray_on(None, raw, SimpleNamespace(mean=np.full((8, 8), 64.0)), RIG, known)
    np.testing.assert_allclose(found.surround, 100.0)
    assert not found.taken.any()


@pytest.mark.parametrize(("px_per_mm", "side_mm"), [(0.5, 10), (2, 10), (3, 20 / 3), (25, 5)])
def test_a_patch_has_twenty_pixels_along_each_side_where_it_may(px_per_mm, side_mm):
    camera = default_rig().camera
    finer = camera.model_copy(update={"focal_px": 1000 * camera.distance_m * px_per_mm})
    assert usual_patch_mm(finer) == pytest.approx(side_mm)
