import json
import math

import pytest

from gonio.errors import BadFileError
from gonio.files import canonical_json, sha256_bytes
from gonio.plan import LampSetting, Plan, RouteTime, Selection, Shot
from gonio.rig import AXES, default_rig
from gonio.timemodel import estimate, move_time, pose_angles_deg, route_times

RIG = default_rig()


def shot(index=0, light=(0.0, 0.0), view=(45.0, 90.0), exposures_s=(0.1,)):
    return Shot(
        index=index,
        light_theta_deg=light[0],
        light_phi_deg=light[1],
        view_theta_deg=view[0],
        view_phi_deg=view[1],
        exposures_s=exposures_s,
        lamps=(LampSetting(n=1, mA=700),),
    )


def plan(*shots, parent=None):
    shots = shots or (shot(),)
    return Plan(
        parent=parent,
        rig_sha256=RIG.sha256,
        selection=Selection(
            criterion="farthest", candidates="paper-81", views=1, lights=1, full_set=6561,
            reciprocal_pairs=0, route="as given",
        ),
        estimates=estimate(shots, RIG),
        shots=shots,
    )  # fmt: skip


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "plan.json"
    plan().save(path)
    return path


def test_round_trip(tmp_path):
    views = [(15.0 * i, 1.0 / 3.0) for i in range(5)]
    many = plan(*(shot(i, view=view, exposures_s=(0.1, 1e-6)) for i, view in enumerate(views)))
    many.save(tmp_path / "plan.json")
    back = Plan.load(tmp_path / "plan.json")
    assert back == many
    assert back.sha256 == many.sha256


def test_the_hash_is_of_the_canonical_rest(saved):
    data = json.loads(saved.read_text())
    stated = data.pop("sha256")
    assert stated == sha256_bytes(canonical_json(data)) == plan().sha256


def test_a_plan_without_turns_and_route_is_written_as_the_first_ones_were(saved):
    data = json.loads(saved.read_text())
    assert not {"view_turn", "light_turn"} & set(data["shots"][0])
    assert "route" not in data
    assert Plan.load(saved).shots[0].view_turn == 0


def test_turns_and_route_are_kept_and_hashed(tmp_path):
    turned = shot(view=(45.0, 0.0)).model_copy(update={"view_turn": 1, "light_turn": -1})
    made = plan(turned).model_copy(update={"route": RouteTime(moving_s=50.0, bound_s=40.0)})
    made.save(tmp_path / "plan.json")
    back = Plan.load(tmp_path / "plan.json")
    assert back == made
    assert back.route.gap == pytest.approx(0.2)
    assert len({back.sha256, plan(turned).sha256, plan(shot(view=(45.0, 0.0))).sha256}) == 3
    assert [back.shots[0].axis_deg(name) for name in AXES] == [45.0, 360.0, 0.0, -360.0]
    assert back.shots[0].direction_deg("view") == (45.0, 0.0)


def test_the_pole_is_one_direction_at_any_azimuth():
    assert shot(light=(0.0, 77.0)).direction_deg("light") == (0.0, 0.0)
    assert shot(light=(1.0, 77.0)).direction_deg("light") == (1.0, 77.0)


def test_a_route_that_takes_no_time_has_no_gap():
    assert RouteTime(moving_s=0.0, bound_s=0.0).gap == 0.0


def test_a_parent_changes_the_hash():
    assert plan(parent=plan().sha256).sha256 != plan().sha256


def put(*path):
    """Return an edit that sets the last of `path` at the place that the others name."""
    *where, key, value = path

    def edit(data):
        for step in where:
            data = data[step]
        data[key] = value

    return edit


def drop(*path):
    *where, key = path

    def edit(data):
        for step in where:
            data = data[step]
        del data[key]

    return edit


EDITS = [
    # name, edit, what is said
    ("tampered angle", put("shots", 0, "view_theta_deg", 46.0), "sha256: does not match"),
    ("tampered hash", put("sha256", "0" * 64), "sha256: does not match"),
    ("no hash", drop("sha256"), "sha256: is missing"),
    ("other schema", put("schema", "gonio.plan/2"), "'gonio.plan/2', not 'gonio.plan/1'"),
    ("no schema", drop("schema"), "has schema None"),
    ("no rig", drop("rig_sha256"), "rig_sha256: is missing"),
    ("no lamps", drop("shots", 0, "lamps"), "shots.0.lamps: is missing"),
    ("no angle", drop("shots", 0, "light_phi_deg"), "shots.0.light_phi_deg: is missing"),
    ("no shots", put("shots", []), "shots: "),
    ("unknown key", put("shots", 0, "iso", 100), "shots.0.iso: is not a known key"),
    ("transmission", put("shots", 0, "view_theta_deg", 120.0), "view_theta_deg 120 .*transmission"),
    ("lit from below", put("shots", 0, "light_theta_deg", 90.5), "light_theta_deg .*transmission"),
    ("below zero", put("shots", 0, "view_theta_deg", -1.0), "shots.0.view_theta_deg: "),
    ("a full turn", put("shots", 0, "view_phi_deg", 360.0), "shots.0.view_phi_deg: "),
    ("eleven turns", put("shots", 0, "light_turn", 11), "shots.0.light_turn: "),
    ("half a turn", put("shots", 0, "view_turn", 0.5), "shots.0.view_turn: "),
    ("twelve lamps", put("shots", 0, "lamps", 0, "n", 12), "shots.0.lamps.0.n: "),
    ("too bright", put("shots", 0, "lamps", 0, "mA", 701.0), "shots.0.lamps.0.mA: "),
    ("no exposure", put("shots", 0, "exposures_s", []), "shots.0.exposures_s: "),
    ("word for a number", put("shots", 0, "view_theta_deg", "x"), "shots.0.view_theta_deg: "),
    ("not a number", put("shots", 0, "view_theta_deg", math.nan), "shots.0.view_theta_deg: "),
    ("half a character", put("selection", "route", "\ud800"), "does not match"),
    ("negative time", put("estimates", "moving_s", -1.0), "estimates.moving_s: "),
]


@pytest.mark.parametrize(("edit", "says"), [c[1:] for c in EDITS], ids=[c[0] for c in EDITS])
def test_an_edited_plan_is_refused_in_one_line(saved, edit, says):
    data = json.loads(saved.read_text())
    edit(data)
    saved.write_text(json.dumps(data))
    with pytest.raises(BadFileError, match=says) as caught:
        Plan.load(saved)
    assert str(caught.value).startswith(str(saved))
    assert str(caught.value).endswith("make a new one with: gonio plan")
    assert "\n" not in str(caught.value)


def test_an_index_stands_for_one_shot():
    with pytest.raises(ValueError, match="two shots have the same index"):
        plan(shot(3), shot(3, view=(30.0, 0.0)))


FOREIGN = [
    ("missing", None, "no such file"),
    ("no JSON", b"{", "is not JSON"),
    ("a list", b"[1]", "no object at the top"),
    ("not text", b"\xff\xfe", "is not text"),
    ("deep", b"[" * 100_000, "is not JSON"),
    ("long number", b"9" * 5000, "is not JSON"),
    ("no object for shots", b'{"schema": "gonio.plan/1", "shots": 7}', "rig_sha256: is missing"),
]


@pytest.mark.parametrize(("content", "says"), [c[1:] for c in FOREIGN], ids=[c[0] for c in FOREIGN])
def test_a_file_that_is_no_plan(tmp_path, content, says):
    path = tmp_path / "plan.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadFileError, match=says):
        Plan.load(path)


MOVES = [
    # distance in deg, seconds at 20 deg/s and 20 deg/s2
    (0.0, 0.0),
    (5.0, 1.0),
    (20.0, 2.0),
    (-20.0, 2.0),
    (60.0, 4.0),
]


@pytest.mark.parametrize(("distance", "seconds"), MOVES)
def test_trapezoid_moves(distance, seconds):
    assert move_time(distance, RIG.axis["view_theta"]) == pytest.approx(seconds)


def test_a_move_takes_as_long_as_its_slowest_axis():
    shots = (shot(0), shot(1, light=(60.0, 30.0), view=(40.0, 90.0)), shot(2))
    times = route_times(pose_angles_deg(shots), RIG)
    assert times.tolist() == pytest.approx([4.0, 4.0])


def test_estimates_add_up():
    shots = (shot(0, exposures_s=(0.1, 1.0)), shot(1, exposures_s=(0.1, 1.0)))
    expected = estimate(shots, RIG)
    # 2 shots and 8 calibration frames of both exposures
    assert expected.frames == 2 * 2 + 8 * 2
    assert expected.exposing_s == pytest.approx((2 + 8) * 1.1)
    assert expected.storage_bytes >= expected.frames * 2 * RIG.camera.width * RIG.camera.height
    names = ("moving", "settling", "exposing", "overhead", "homing")
    parts = [getattr(expected, f"{name}_s") for name in names]
    assert expected.total_s == pytest.approx(sum(parts))
    assert expected.total_lo_s < expected.total_s < expected.total_hi_s


def test_between_shots_that_differ_in_nothing_nothing_moves():
    one, two = (estimate([shot(i) for i in range(n)], RIG) for n in (1, 2))
    assert (one.moving_s, one.settling_s) == (two.moving_s, two.settling_s)
