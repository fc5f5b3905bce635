"""Which poses are free: the angle between the arms, boxes, travel."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gonio.boxes import ball_distance_mm, box_distance_mm
from gonio.clearance import check_pose, limits_of, not_free, required_angle
from gonio.directions import from_degrees
from gonio.errors import BadInputError
from gonio.rig import KeepOut, Rig, default_rig
from gonio.swept import leg_blocked

RIG = default_rig()
BOX = {"min_mm": (500, 500, 200), "max_mm": (700, 800, 900)}


def rig_with(axis=None, **arm):
    """Return the built-in rig with keys of the arm, or of one axis: ("view_phi", {...})."""
    data = RIG.model_dump()
    data["arm"].update(arm)
    if axis:
        data["axis"][axis[0]].update(axis[1])
    return Rig.model_validate(data)


angles = st.tuples(
    st.floats(0, 90), st.floats(0, 360), st.floats(0, 90), st.floats(0, 360)
)  # fmt: skip

REQUIRED = [
    # keys of the arm, degrees
    ({}, 0.0),
    ({"arm_width_mm": 5000, "lamp_width_mm": 5000}, 0.0),
    ({"min_separation_deg": 12.0}, 12.0),
    ({"min_separation_deg": 1.0}, math.degrees(math.atan(70 / 2000))),
    ({"min_separation_deg": 1.0, "arm_width_mm": 0, "lamp_width_mm": 0}, 1.0),
    ({"min_separation_deg": 30.0, "arm_width_mm": 2000, "lamp_width_mm": 2000}, 45.0),
]


@pytest.mark.parametrize(("arm", "degrees"), REQUIRED)
def test_the_angle_that_arms_keep(arm, degrees):
    assert math.degrees(required_angle(rig_with(**arm))) == pytest.approx(degrees)


def test_the_nearer_head_decides():
    data = rig_with(min_separation_deg=1.0).model_dump()
    data["lamps"]["distance_m"] = 0.5
    assert required_angle(Rig.model_validate(data)) == pytest.approx(math.atan(70 / 500))


TRAVEL, APART = "beyond the travel of an axis", "closer than 12 deg (arm.min_separation_deg)"
BOXED = "inside a keep-out box (arm.keep_out)"
NARROW = ("light_phi", {"min_deg": 90.0, "max_deg": 100.0})
POSES = [
    # rig, pose, reason
    (RIG, (0, 0, 0, 0), None),
    (RIG, (91.5, 0, 0, 0), TRAVEL),
    (RIG, (30, 365.5, 0, 0), TRAVEL),
    (rig_with(NARROW), (30, 0, 30, 180), TRAVEL),
    (rig_with(NARROW), (30, 0, 30, 95), None),
    (rig_with(min_separation_deg=12.0), (0, 0, 0, 0), APART),
    (rig_with(min_separation_deg=12.0), (0, 0, 0, 180), APART),
    (rig_with(min_separation_deg=12.0), (90, 0, 90, 360), APART),
    (rig_with(min_separation_deg=12.0), (12, 0, 0, 90), None),
    (rig_with(min_separation_deg=12.0), (11.99, 0, 0, 90), APART),
    (rig_with(min_separation_deg=12.0), (6, 100, 6, 280), None),
    (rig_with(min_separation_deg=12.0), (99, 0, 99, 0), TRAVEL),
    (rig_with(keep_out=[BOX]), (55, 45, 0, 0), BOXED),
    (rig_with(keep_out=[BOX]), (0, 0, 55, 45), BOXED),
    (rig_with(keep_out=[BOX]), (55, 45, 55, 45), BOXED),
    (rig_with(keep_out=[BOX]), (55, 225, 0, 0), None),
    (rig_with(keep_out=[BOX], min_separation_deg=12.0), (55, 45, 55, 45), APART),
    # the head itself, and a box behind the head
    (rig_with(keep_out=[{"min_mm": (-5, -5, 2030), "max_mm": (5, 5, 2100)}]), (0, 0, 90, 0), BOXED),
    (rig_with(keep_out=[{"min_mm": (-5, -5, 2050), "max_mm": (5, 5, 2100)}]), (0, 0, 90, 0), None),
]


@pytest.mark.parametrize(("rig", "pose", "reason"), POSES)
def test_a_pose_and_its_reason(rig, pose, reason):
    reasons = not_free(np.array([pose], float), rig)
    assert [name for name, short in reasons.items() if short[0]] == ([reason] if reason else [])
    if reason is None:
        check_pose(pose, rig)
    else:
        says = "beyond the axis' travel" if reason == TRAVEL else reason
        with pytest.raises(BadInputError, match=f".*{says.replace('(', '.').replace(')', '.')}"):
            check_pose(pose, rig)


@given(st.lists(angles, max_size=5))
def test_at_the_pole_the_azimuth_does_not_count(poses):
    rig = rig_with(min_separation_deg=12.0, keep_out=[BOX])
    one, other = np.array(poses, float).reshape(-1, 4), np.array(poses, float).reshape(-1, 4)
    one[:, 0] = other[:, 0] = 0.0
    other[:, 1] = 123.0
    for limit in limits_of(rig):
        a, b = (limit.margin(pose[:, limit.columns]) for pose in (one, other))
        assert a == pytest.approx(b, abs=1e-12)


boxes = st.tuples(*[st.floats(-2500, 2500)] * 3, *[st.floats(1, 2000)] * 3)


def box_of(numbers):
    low, size = np.array(numbers[:3]), np.array(numbers[3:])
    try:
        return KeepOut(min_mm=tuple(low), max_mm=tuple(low + size))
    except ValueError:
        assume(False)


@given(boxes, st.floats(0, 90), st.floats(0, 360), st.floats(50, 100), st.floats(100, 3000))
def test_the_distance_of_a_box_is_that_of_the_nearest_of_many_points(
    numbers, theta, phi, near, far
):
    box = box_of(numbers)
    towards = from_degrees([theta], [phi])
    points = np.linspace(near, far, 20001)[:, None] * towards
    beyond = points - np.clip(points, box.min_mm, box.max_mm)
    least = np.linalg.norm(beyond, axis=1).min()
    exact = box_distance_mm(towards, near, far, box)[0]
    assert exact == pytest.approx(least, abs=0.08)
    assert exact <= least + 1e-9
    assert ball_distance_mm(towards, near, far, box)[0] <= exact + 1e-9


def test_rays_along_the_axes_and_in_the_planes_of_a_box():
    box = KeepOut(min_mm=(200, -10, 0), max_mm=(300, 0, 50))
    towards = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0]])
    reach = box_distance_mm(towards, 100, 2000, box)
    assert reach == pytest.approx([0, math.hypot(200, 100), math.hypot(200, 50), 300])


@given(angles, angles, st.floats(0, 1))
def test_an_arm_that_turns_by_less_than_the_margin_touches_nothing(pose, other, part):
    rig = rig_with(min_separation_deg=20.0, keep_out=[BOX])
    a = np.array([pose], float)
    for limit in limits_of(rig):
        margin = limit.margin(a[:, limit.columns])[0]
        b = a + part * (np.array([other], float) - a)
        turned = sum(
            math.acos(
                np.clip(from_degrees(*a[0, [i, i + 1]]) @ from_degrees(*b[0, [i, i + 1]]), -1, 1)
            )
            for i in limit.columns[::2]
        )
        if turned < margin:
            assert limit.margin(b[:, limit.columns])[0] >= -1e-6


AT_THE_SAMPLE = [
    ((0, 0, 0), (1, 1, 1)),
    ((-3000, -3000, -10), (3000, 3000, 10)),
    ((-3000, -3000, -3000), (3000, 3000, 3000)),
    ((60, -10, -5), (90, 10, 1)),
    ((-10, -10, 95), (10, 10, 500)),
]


@pytest.mark.parametrize(("low", "high"), AT_THE_SAMPLE)
def test_a_box_at_the_sample_is_refused(low, high):
    with pytest.raises(ValueError, match="within 100 mm of the sample's centre"):
        KeepOut(min_mm=low, max_mm=high)


@pytest.mark.parametrize(
    ("low", "high"), [((-500, -500, -100), (500, 500, 0)), ((-10, -10, 100), (10, 10, 500))]
)
def test_a_table_below_or_a_box_further_out_is_none_of_these(low, high):
    KeepOut(min_mm=low, max_mm=high)


def test_arms_without_a_width_keep_out_of_boxes_too():
    data = default_rig().model_dump()
    box = {"min_mm": (300.0, -300.0, 100.0), "max_mm": (900.0, 300.0, 1500.0)}
    data["arm"] |= {"arm_width_mm": 0.0, "lamp_width_mm": 0.0, "keep_out": [box]}
    rig = Rig.model_validate(data)
    through = [[45.0, 0.0, 30.0, 180.0]]
    assert any(short[0] for short in not_free(through, rig).values())


@pytest.mark.parametrize("tolerance", [0.03, 0.3, 10.0])
def test_loose_encoders_open_no_box(tolerance):
    data = default_rig().model_dump()
    box = {"min_mm": (300.0, -300.0, 100.0), "max_mm": (900.0, 300.0, 1500.0)}
    data["arm"] |= {"keep_out": [box]}
    for axis in data["axis"].values():
        axis["in_position_deg"] = tolerance
    rig = Rig.model_validate(data)
    outside, inside = np.array([[45.0, 90.0, 30.0, 180.0]]), np.array([[45.0, 0.0, 30.0, 180.0]])
    assert leg_blocked(outside, inside, rig)[0]
