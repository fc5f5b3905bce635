"""The checks of `gonio reduce`: each finds what it is for, and nothing else does."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from gonio.checks import Checks
from gonio.rig import AXES, default_rig_text
from gonio.samples import Flag
from nnbrdf.analytic import Lambert
from sim.materials import load_material

from .conftest import Flat, reduced, with_pixels

SIZE = 160
AROUND = [(light, 20, view, 7 * view) for light in (5, 35, 65) for view in (2, 12, 22, 32, 42)]
GREY = Lambert((0.4, 0.4, 0.4))
BLACK_LEVEL = 1024


def failing(checks):
    return {name for name, check in checks.items() if not check.ok}


def retake(shots, index, change):
    """Take a shot once more, with its pixels changed."""
    shot = shots.plan.shots[index]
    pose = {name: shot.axis_deg(name) for name in AXES}
    shots.take("shot", pose, 0.2, index=index, attempt=2, change=with_pixels(change, SIZE))


@pytest.fixture
def around(photographer):
    return photographer(AROUND, GREY, exposures_s=(0.2,), seed=1).calibrate().shoot()


def brightened(by):
    return lambda mosaic: BLACK_LEVEL + by * (mosaic - BLACK_LEVEL)


def shaken(mosaic):
    # over the pixels of each color, which are two apart
    blurred = mosaic.copy()
    for row in (0, 1):
        for column in (0, 1):
            plane = np.s_[row::2, column::2]
            blurred[plane] = gaussian_filter(mosaic[plane], 1.0, mode="nearest")
    return blurred


def half_hidden(mosaic):
    hidden = mosaic.copy()
    hidden[:, :40] = hidden[:40] = BLACK_LEVEL
    return hidden


def test_nothing_is_found_where_nothing_is(around):
    samples, checks = reduced(around)
    assert failing(checks) == set()
    assert not (samples.flag & Flag.SUSPECT).any()
    assert "too few" not in checks["holder"].found
    assert "no edge" not in checks["focus"].found
    verdicts = {name: check.verdict for name, check in checks.items()}
    assert {verdicts[name] for name in ("holder", "focus", "blur", "saturation")} == {"ok"}
    # no pair stands there twice, and no light has views enough
    assert {verdicts[name] for name in ("repeats", "drift", "albedo")} == {"-"}


@pytest.mark.parametrize(
    ("change", "names"),
    # a shake carries ink onto the paper, too
    [(shaken, "blur, holder"), (half_hidden, "holder"), (brightened(1.2), "holder")],
)
def test_a_shot_that_went_wrong_is_offered_for_a_retake(around, change, names):
    retake(around, 7, change)
    samples, checks = reduced(around)
    assert failing(checks) == set(names.split(", "))
    assert all(checks[name].shots == (7,) for name in failing(checks))
    assert (samples.flag & Flag.SUSPECT).any(axis=1).tolist() == [i == 7 for i in range(15)]
    (suspect,) = Checks.load(around.session.checks_path).suspects
    assert suspect.files == ("raw/shot_000007_0.2_r0_a2.dng",)
    assert suspect.problem == names


def test_what_all_shots_suffer_from_is_no_matter_of_a_retake(photographer):
    shots = photographer(AROUND, GREY, exposures_s=(0.2,)).calibrate()
    shots.shoot(change=with_pixels(shaken, SIZE))
    samples, checks = reduced(shots)
    assert failing(checks) == {"focus"}
    assert "focus the camera" in checks["focus"].remedy
    assert not (samples.flag & Flag.SUSPECT).any()


def test_drift_through_the_scan(photographer):
    pairs = [pair for each in AROUND for pair in ((20, 0, 40, 90), each)]
    shots = photographer(pairs, GREY, exposures_s=(0.2,)).calibrate()
    gains = iter(np.linspace(1.0, 0.95, len(pairs)))

    def dimmer_each_time(mosaic):
        return brightened(next(gains))(mosaic)

    shots.shoot(change=with_pixels(dimmer_each_time, SIZE))
    _, checks = reduced(shots)
    assert {"drift", "drift of holder"} <= failing(checks)
    for name in ("drift", "drift of holder"):
        assert float(checks[name].found.split("%")[0]) == pytest.approx(-5.0, abs=0.6)


def test_a_pair_that_does_not_repeat(photographer):
    pairs = [*AROUND[:3], *4 * [(20, 0, 40, 90)]]
    shots = photographer(pairs, GREY, exposures_s=(0.2,)).calibrate().shoot()
    retake(shots, 4, brightened(1.05))
    _, checks = reduced(shots)
    assert failing(checks) == {"repeats"}
    assert checks["repeats"].shots == (4,)


class OneWay:
    """A material that no light could have."""

    def evaluate(self, light, view):
        brdf = 0.1 * (1.0 + light[..., 2:]) + 0.0 * view[..., 2:]
        return np.broadcast_to(brdf, (*brdf.shape[:-1], 3))


@pytest.mark.parametrize(("material", "ok"), [(GREY, True), (OneWay(), False)])
def test_reciprocity(photographer, material, ok):
    pairs = [(20, 0, 40, 90), (40, 90, 20, 0), (0, 50, 30, 10), (30, 10, 0, 0)]
    shots = photographer(pairs, material, exposures_s=(0.2,)).calibrate().shoot()
    _, checks = reduced(shots)
    assert checks["reciprocity"].ok == ok
    assert "of 2 pairs differ" in checks["reciprocity"].found
    # all pairs fail: that is the rig or the sample
    assert not checks["reciprocity"].retake


def test_more_light_than_came(photographer):
    pairs = [(30, 0, view, phi) for view in (10, 45, 70) for phi in (0, 90, 180, 270)]
    shots = photographer(pairs, Flat(2.0), exposures_s=(0.005, 0.02)).calibrate().shoot()
    _, checks = reduced(shots)
    assert failing(checks) == {"albedo"}
    # 2 pi in all, of which at most what twelve equal views leave
    found = float(checks["albedo"].found.split()[2])
    assert 1.0 < found < 2 * np.pi * (1 - 2 / np.sqrt(12))
    # white has unequal channels in XYZ, and reflects no more for that
    _, in_xyz = reduced(shots, "--space", "xyz")
    assert float(in_xyz["albedo"].found.split()[2]) == pytest.approx(found, rel=0.02)


def test_a_narrow_highlight_is_no_light_from_nowhere(photographer):
    pairs = [(30, 180, view, phi) for view in (10, 30, 70) for phi in (0, 90, 180, 270)]
    mirror = load_material("near-mirror")
    shots = photographer(pairs, mirror, exposures_s=(2e-4, 0.02, 0.2)).calibrate().shoot()
    _, checks = reduced(shots)
    assert checks["albedo"].ok


def test_less_light_than_none(photographer):
    shots = photographer(AROUND, Flat(0.01), exposures_s=(0.2,)).calibrate().shoot()
    retake(shots, 3, lambda mosaic: mosaic - 1100)
    _, checks = reduced(shots)
    assert checks["negative"].shots == (3,)
    assert checks["negative"].retake


def test_what_all_shots_share_hides_no_change(photographer):
    # 3 % of the reference would hide up to 17 %
    pairs = 5 * [(20, 0, 40, 90)]
    stated = default_rig_text() + "\n[uncertainty]\nreference = 0.03\n"
    shots = photographer(pairs, GREY, exposures_s=(0.2,), rig_text=stated).calibrate()
    gains = iter(np.linspace(1.0, 0.97, len(pairs)))

    def dimmer_each_time(mosaic):
        return brightened(next(gains))(mosaic)

    shots.shoot(change=with_pixels(dimmer_each_time, SIZE))
    # so many pixels that their noise hides nothing either
    _, checks = reduced(shots, "--patch-mm", "20")
    assert failing(checks) == {"repeats", "drift"}


STATED = "\n[uncertainty]\nlamp_color = 0.3\n"


@pytest.mark.parametrize(
    ("brightness", "stated", "verdict"), [(1.0, "", "ok"), (0.95, "", "-"), (0.95, STATED, "ok")]
)
def test_lamps_that_were_warmer_than_for_the_white(photographer, brightness, stated, verdict):
    rig_text = default_rig_text() + stated
    shots = photographer(AROUND[:5], GREY, exposures_s=(0.2,), rig_text=rig_text).calibrate()
    shots.shoot(brightness=brightness)
    _, checks = reduced(shots)
    warmth = checks["warmth"]
    assert warmth.verdict == verdict
    off = float(warmth.found.removeprefix("the lamps' flux is ").split("%")[0])
    assert off == pytest.approx(100 * abs(np.log(brightness)), abs=0.7)
    assert ("[lamps] warm_up_s" in warmth.remedy) == (verdict == "-")
