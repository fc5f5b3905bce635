import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import from_degrees, to_degrees
from gonio.errors import BadInputError
from planner.candidates import Candidates, paper_candidates
from planner.scene.demand import Demand
from planner.scene.pairs import sample_pairs
from planner.scene.scene import Scene

FEW = 10
FLAT = {"shape": "flat", "tilt_deg": 0}
LIGHT = {"kind": "direction", "elevation_deg": 45, "azimuth_deg": 90}
VIEWER = {"kind": "direction", "elevation_deg": 60}


def pairs_of(surface, light, viewer, log2_samples=FEW):
    scene = Scene.model_validate({"surface": [surface], "light": [light], "viewer": [viewer]})
    return sample_pairs(scene, log2_samples=log2_samples)


bearings = st.floats(-180, 180)
tilts = st.floats(0, 180)


@st.composite
def surfaces(draw):
    shape = draw(st.sampled_from(["flat", "cylinder", "sphere"]))
    surface = {
        "shape": shape,
        "tilt_deg": draw(tilts),
        "azimuth_deg": draw(bearings),
        "grain_deg": draw(bearings),
        "turn_deg": draw(st.floats(0, 360)),
        "centre_m": [draw(st.floats(-2, 2)) for _ in range(3)],
        "size_m": [draw(st.floats(0, 3)) for _ in range(2)],
        "weight": draw(st.sampled_from([0.1, 1.0, 1e30])),
    }
    return surface if shape == "flat" else surface | {"arc_deg": draw(st.floats(0, 360))}


lights = st.one_of(
    st.builds(
        lambda elevation, azimuth, spread: {
            "kind": "direction",
            "elevation_deg": elevation,
            "azimuth_deg": azimuth,
            "spread_deg": spread,
        },
        st.floats(-90, 90),
        bearings,
        st.floats(0, 180),
    ),
    st.sampled_from([{"kind": "ground"}, {"kind": "sky", "luminance": "overcast"}]),
)
viewers = st.one_of(
    st.builds(
        lambda elevation, azimuth: {
            "kind": "direction",
            "elevation_deg": elevation,
            "azimuth_deg": azimuth,
        },
        st.floats(-90, 90),
        bearings,
    ),
    st.builds(
        lambda x, y, z: {"kind": "position", "position_m": [x, y, z]},
        *[st.floats(-9, 9)] * 3,
    ),
)
scenes = st.tuples(
    st.lists(surfaces(), min_size=1, max_size=3),
    st.lists(lights, min_size=1, max_size=2),
    st.lists(viewers, min_size=1, max_size=2),
)


def sampled(lists):
    scene = Scene.model_validate(dict(zip(("surface", "light", "viewer"), lists, strict=True)))
    try:
        return sample_pairs(scene, log2_samples=FEW)
    except BadInputError:
        return None


@given(scenes)
@settings(max_examples=60)
def test_weights_add_to_one_and_directions_are_above_the_sample(lists):
    pairs = sampled(lists)
    if pairs is None:
        return
    assert pairs.weight.sum() == pytest.approx(1.0)
    for direction in (pairs.light, pairs.view):
        assert np.linalg.norm(direction, axis=1) == pytest.approx(1.0)
        assert (direction[:, 2] > 0).all()
    candidates = paper_candidates()
    demand = Demand.of(pairs, candidates, candidates)
    assert demand.weights.sum() == pytest.approx(1.0)
    # the same set on both sides: the other way round is the transpose
    assert demand.reverse == pytest.approx(demand.weights.T, abs=1e-12)


def turned(table, angle_deg):
    """Turn what a table of a scene says about the vertical, clockwise from above."""
    table = dict(table)
    if "azimuth_deg" in table:
        table["azimuth_deg"] = (table["azimuth_deg"] + angle_deg + 180) % 360 - 180
    angle = np.radians(angle_deg)
    for key in {"centre_m", "position_m"} & set(table):
        x, y, z = table[key]
        table[key] = [
            x * np.cos(angle) + y * np.sin(angle),
            y * np.cos(angle) - x * np.sin(angle),
            z,
        ]
    return table


@given(
    st.lists(surfaces(), min_size=1, max_size=3),
    st.floats(-80, 80),
    bearings,
    st.lists(viewers, min_size=1, max_size=2),
    bearings,
)
@settings(max_examples=60)
def test_turning_the_whole_scene_about_the_vertical_changes_nothing(
    surface, elevation, azimuth, viewer, angle
):
    light = {"kind": "direction", "elevation_deg": elevation, "azimuth_deg": azimuth}
    lists = (surface, [light], viewer)
    before = sampled(lists)
    after = sampled([[turned(each, angle) for each in part] for part in lists])
    if before is None or after is None:
        return
    if len(before.weight) == len(after.weight):  # what is edge-on may fall to either side
        assert after.light == pytest.approx(before.light, abs=1e-6)
        assert after.view == pytest.approx(before.view, abs=1e-6)
    for name in ("light", "view"):
        means = [each.weight @ getattr(each, name) for each in (before, after)]
        assert means[0] == pytest.approx(means[1], abs=1e-6)


@given(st.floats(0, 89), bearings, bearings)
def test_a_surface_tilted_as_its_light_sees_it_at_normal_incidence(tilt, azimuth, grain):
    light = {"kind": "direction", "elevation_deg": 90 - tilt, "azimuth_deg": azimuth}
    surface = FLAT | {"tilt_deg": tilt, "azimuth_deg": azimuth, "grain_deg": grain}
    pairs = pairs_of(surface, light, light)
    assert pairs.light == pytest.approx(np.broadcast_to([0, 0, 1], pairs.light.shape), abs=1e-7)


@given(st.floats(0, 180), bearings, bearings, st.floats(-90, 90), bearings)
def test_light_and_view_that_change_places_change_places(tilt, azimuth, grain, elevation, bearing):
    surface = FLAT | {"tilt_deg": tilt, "azimuth_deg": azimuth, "grain_deg": grain}
    other = {"kind": "direction", "elevation_deg": elevation, "azimuth_deg": bearing}
    try:
        there, back = pairs_of(surface, LIGHT, other), pairs_of(surface, other, LIGHT)
    except BadInputError:
        return
    assert there.light == pytest.approx(back.view)
    assert there.view == pytest.approx(back.light)


EDGES = [
    # what, surface, light, viewer, theta and phi of the light in degrees
    ("table", {"tilt_deg": 0, "azimuth_deg": 180}, (45, 90), (45.0, 0.0)),
    ("table, grain north", {"tilt_deg": 0, "azimuth_deg": 180, "grain_deg": 90}, (45, 0), (45, 0)),
    ("wall, light from the east", {"tilt_deg": 90, "azimuth_deg": 180}, (0, 135), (45, 0)),
    ("wall, light from above", {"tilt_deg": 90, "azimuth_deg": 180}, (45, 180), (45, 90)),
    (
        "wall, grain upright",
        {"tilt_deg": 90, "azimuth_deg": 180, "grain_deg": 90},
        (45, 180),
        (45, 0),
    ),
    ("wall, light at the grazing", {"tilt_deg": 90, "azimuth_deg": 180}, (0, 91), (89, 0)),
    ("ceiling", {"tilt_deg": 180, "azimuth_deg": 180}, (-90, 0), (0, 0)),
]


@pytest.mark.parametrize(
    ("surface", "light", "angles"), [e[1:] for e in EDGES], ids=[e[0] for e in EDGES]
)
def test_where_the_light_is_in_the_frame_of_the_sample(surface, light, angles):
    direction = {"kind": "direction", "elevation_deg": light[0], "azimuth_deg": light[1]}
    pairs = pairs_of({"shape": "flat"} | surface, direction, direction)
    expected = from_degrees([angles[0]], [angles[1]])
    assert pairs.light == pytest.approx(np.broadcast_to(expected, pairs.light.shape), abs=1e-9)


def test_a_cylinder_all_round_is_seen_by_the_cosine():
    pillar = {"shape": "cylinder", "tilt_deg": 90, "arc_deg": 360}
    level = {"kind": "direction", "elevation_deg": 0}
    pairs = pairs_of(pillar, level, level, 14)
    # light and eye alike: weight is the square of the cosine, over an even angle
    cosine = pairs.light[:, 2]
    assert pairs.weight @ cosine == pytest.approx(8 / (3 * np.pi), rel=1e-3)
    assert np.abs(pairs.light[:, 1]).max() < 1e-9


def test_a_sphere_is_even_in_area():
    ball = {"shape": "sphere", "tilt_deg": 90, "arc_deg": 360}
    above = {"kind": "direction", "elevation_deg": 90}
    pairs = pairs_of(ball, above, above, 14)
    assert pairs.weight @ pairs.light[:, 2] == pytest.approx(3 / 4, rel=1e-3)


IRRADIANCE = [
    # a light of weight 1, and what it gives a level surface
    ({"kind": "direction", "elevation_deg": 30}, 0.5),
    ({"kind": "sky"}, 1.0),
    ({"kind": "sky", "luminance": "overcast"}, 1.0),
    ({"kind": "ceiling", "centre_m": [0, 0, 3], "size_m": [1e-3, 1e-3]}, 1e-6 / (9 * np.pi)),
    ({"kind": "sun", "latitude_deg": 0, "day_of_year": 81, "solar_hour": 12}, 1.0),
    ({"kind": "sun", "latitude_deg": 50, "solar_hour": [0, 3]}, 0.0),
    ({"kind": "ground"}, 0.0),
]


@pytest.mark.parametrize(("light", "irradiance"), IRRADIANCE, ids=[str(e[0]) for e in IRRADIANCE])
def test_the_weight_of_a_light_is_the_irradiance_that_it_says(light, irradiance):
    scene = Scene.model_validate({"surface": [FLAT], "light": [light], "viewer": [VIEWER]})
    random = np.random.default_rng(0).random((1 << 16, 2))
    direction, strength = scene.light[0].arriving(random, np.zeros((len(random), 3)))
    found = np.mean(strength * direction[:, 2].clip(min=0))
    assert found == pytest.approx(irradiance, rel=0.01, abs=1e-12)


def test_an_endless_ceiling_is_an_even_sky():
    ceiling = {"kind": "ceiling", "centre_m": [0, 0, 3], "size_m": [60, 60]}
    scene = Scene.model_validate({"surface": [FLAT], "light": [ceiling], "viewer": [VIEWER]})
    random = np.random.default_rng(0).random((1 << 18, 2))
    direction, strength = scene.light[0].arriving(random, np.zeros((len(random), 3)))
    assert np.mean(strength * direction[:, 2]) == pytest.approx(0.99, abs=0.02)


def test_the_sun_rises_in_the_east_and_stands_south_at_noon():
    from planner.scene.lights import Sun

    sun = Sun(kind="sun", latitude_deg=50, day_of_year=172, solar_hour=(0, 24))
    hours = np.array([6.0, 12.0, 18.0, 0.0])
    random = np.stack([np.zeros(4), hours / 24], axis=1)
    (morning, noon, evening, night), strength = sun.arriving(random, np.zeros((4, 3)))
    assert morning[0] > 0.8
    assert evening[0] < -0.8
    assert noon == pytest.approx(
        [0, -np.sin(np.radians(26.55)), np.cos(np.radians(26.55))], abs=2e-3
    )
    assert night[2] < 0
    assert strength[3] == 0
    assert 0 < strength[0] < strength[1] < 1


def test_a_walker_sees_more_of_what_is_near():
    line = {"kind": "path", "points_m": [[-10, -1], [10, -1]], "height_m": 0}
    wall = {"shape": "flat", "tilt_deg": 90, "azimuth_deg": 180}
    pairs = pairs_of(wall, {"kind": "direction", "elevation_deg": 0, "azimuth_deg": 180}, line, 14)
    # over x: a cosine and the inverse square make (1 + x^2)^-3/2, whose mean |x| is this
    x = np.linspace(-10, 10, 200001)
    density = (1 + x**2) ** -1.5
    expected = np.sum(density * np.abs(x)) / np.sum(density)
    offset = np.abs(pairs.view[:, 0]) / pairs.view[:, 2]
    assert pairs.weight @ offset == pytest.approx(expected, rel=0.01)


def test_a_viewer_counts_by_weight_wherever_it_stands():
    near = {"kind": "position", "position_m": [0, 0, 1]}
    far = {"kind": "position", "position_m": [5e5, 0, 5e5], "weight": 3}
    scene = Scene.model_validate({"surface": [FLAT], "light": [LIGHT], "viewer": [near, far]})
    pairs = sample_pairs(scene, log2_samples=12)
    above = pairs.view[:, 2] > 0.9
    cosine = np.cos(np.radians(45))
    assert pairs.weight[above].sum() == pytest.approx(1 / (1 + 3 * cosine), rel=0.02)


WEIGHTS = [
    # weights of two surfaces, share of the second
    ((1.0, 3.0), 0.75),
    ((0.0, 1.0), 1.0),
    ((1e30, 1e30), 0.5),
    ((1e30, 1e-30), 0.0),
]


@pytest.mark.parametrize(("weights", "share"), WEIGHTS)
def test_surfaces_share_by_weight(make_scene, weights, share):
    wall = {"shape": "flat", "tilt_deg": 45, "azimuth_deg": 180}
    surface = [FLAT | {"weight": weights[0]}, wall | {"weight": weights[1]}]
    scene = make_scene(
        surface,
        {"kind": "direction", "elevation_deg": 67.5, "azimuth_deg": 180},
        {"kind": "direction", "elevation_deg": 67.5, "azimuth_deg": 180},
    )
    pairs = sample_pairs(scene, log2_samples=12)
    second = pairs.light[:, 1] > 0
    assert pairs.weight[second].sum() == pytest.approx(share, abs=0.01)


def test_a_surface_that_none_sees_does_not_hide_the_others(make_scene):
    surface = [FLAT | {"tilt_deg": 180, "weight": 1e30}, FLAT | {"weight": 1e-30}]
    assert sample_pairs(make_scene(surface, LIGHT, VIEWER), log2_samples=FEW).weight.sum() > 0.99


NOTHING = [
    ("faces away", FLAT | {"tilt_deg": 180}, LIGHT, VIEWER, "lights stand before a surface in 0%"),
    ("below the horizon", FLAT, LIGHT | {"elevation_deg": -5}, VIEWER, "lights .* in 0%"),
    ("night", FLAT, {"kind": "sun", "latitude_deg": 50, "solar_hour": [0, 2]}, VIEWER, "no pair"),
    ("polar night", FLAT, {"kind": "sun", "latitude_deg": 90, "day_of_year": 355}, VIEWER, "no pa"),
    ("edge-on", FLAT | {"tilt_deg": 90}, LIGHT | {"elevation_deg": 90}, VIEWER, "no pair"),
    ("no eye", FLAT, LIGHT, {"kind": "position", "position_m": [0, 0, -1]}, "viewers in 0%"),
    ("eye in the surface", FLAT, LIGHT, {"kind": "position", "position_m": [0, 0, 0]}, "in 0%"),
]


@pytest.mark.parametrize(
    ("surface", "light", "viewer", "says"), [n[1:] for n in NOTHING], ids=[n[0] for n in NOTHING]
)
def test_a_scene_that_asks_for_nothing_says_why(surface, light, viewer, says):
    with pytest.raises(BadInputError, match=says):
        pairs_of(surface, light, viewer)


HUGE = 1e6


def test_scenes_of_any_size(make_scene):
    tower = {
        "shape": "cylinder",
        "tilt_deg": 90,
        "arc_deg": 180,
        "centre_m": [0, 0, HUGE],
        "size_m": [HUGE, HUGE],
    }
    viewer = [
        {"kind": "around", "distance_m": [0, HUGE], "height_m": [-HUGE, HUGE]},
        {"kind": "path", "points_m": [[0, 0], [0, 0]]},
    ]
    ceiling = {"kind": "ceiling", "centre_m": [0, 0, HUGE], "size_m": [1e-6, 1e-6]}
    pairs = sample_pairs(make_scene([tower] * 300, [ceiling, LIGHT], viewer), log2_samples=14)
    assert np.isfinite(pairs.weight).all()
    assert pairs.weight.sum() == pytest.approx(1.0)


def test_tiny_tilts_and_spreads_keep_their_digits():
    light = {"kind": "direction", "elevation_deg": 90, "spread_deg": 1e-4}
    pairs = pairs_of(FLAT | {"tilt_deg": 1e-6}, light, light)
    theta_deg, _ = to_degrees(pairs.light)
    assert theta_deg.max() == pytest.approx(1e-4, rel=0.1)
    assert pairs.weight @ theta_deg == pytest.approx(2e-4 / 3, rel=0.05)


def test_one_seed_gives_one_set_of_samples(make_scene):
    scene = make_scene(FLAT, {"kind": "sky"}, VIEWER)
    first, again, other = (sample_pairs(scene, seed, FEW) for seed in (1, 1, 2))
    assert (first.light == again.light).all()
    assert (first.weight == again.weight).all()
    assert not (first.light == other.light).all()


def test_isotropic_materials_ask_for_any_azimuth():
    pairs = pairs_of(FLAT, LIGHT, VIEWER, 12)
    around = pairs.turned()
    assert around.light[:, 2] == pytest.approx(pairs.light[:, 2])
    assert np.sum(around.light * around.view, axis=1) == pytest.approx(
        np.sum(pairs.light * pairs.view, axis=1)
    )
    assert np.abs(around.light[:, :2].mean(axis=0)).max() < 0.05
    sense = [np.cross(each.light, each.view)[:, 2] for each in (pairs, around)]
    assert sense[0] == pytest.approx(sense[1])


def test_all_demand_on_one_pair():
    candidates = paper_candidates()
    demand = Demand.of(pairs_of(FLAT, LIGHT, VIEWER), candidates, candidates)
    assert np.count_nonzero(demand.weights) == 1
    light, view = np.argwhere(demand.weights)[0]
    # east is the marked edge, and the viewer stands south of a surface that faces up
    assert candidates.theta_deg[[light, view]].tolist() == [45.0, 30.0]
    assert candidates.phi_deg[[light, view]].tolist() == [0.0, 270.0]
    asked = demand.asked()
    assert asked[light, view]
    assert asked[view, light]
    assert asked.sum() < 300


def test_grazing_demand_goes_to_the_rim():
    candidates = paper_candidates()
    low = {"kind": "direction", "elevation_deg": 0.1}
    demand = Demand.of(pairs_of(FLAT, low, low), candidates, candidates)
    light, view = np.argwhere(demand.weights)[0]
    assert candidates.theta_deg[[light, view]].tolist() == [75.0, 75.0]


def test_sets_of_lights_and_views_may_differ():
    views = Candidates("three", np.array([0.0, 30.0, 60.0]), np.array([0.0, 270.0, 0.0]))
    lights = Candidates("one", np.array([45.0]), np.array([0.0]))
    demand = Demand.of(pairs_of(FLAT, LIGHT, VIEWER), lights, views)
    assert demand.weights.tolist() == [[0.0, 1.0, 0.0]]
    assert demand.asked().shape == (1, 3)


@given(st.floats(0.001, 0.3))
@settings(max_examples=20)
def test_what_is_left_out_holds_no_more_than_its_share(share):
    candidates = paper_candidates()
    dome = {"kind": "sky", "luminance": "overcast"}
    demand = Demand.of(
        pairs_of(FLAT, dome, VIEWER | {"spread_deg": 10}, 13), candidates, candidates
    )
    asked, all_asked = demand.asked(share), demand.asked(0.0)
    assert asked.sum() < all_asked.sum()
    assert not (asked & ~all_asked).any()
    assert demand.weights[~asked].sum() < 3 * share


LEVEL = {"kind": "direction", "elevation_deg": 0, "azimuth_deg": 180}
WALL = {"shape": "flat", "tilt_deg": 90, "azimuth_deg": 180}


def test_a_wall_that_turns_all_round_is_a_pillar():
    pairs = pairs_of(WALL | {"turn_deg": 360}, LEVEL, LEVEL, 14)
    assert pairs.weight @ pairs.light[:, 2] == pytest.approx(8 / (3 * np.pi), rel=1e-3)


def test_what_stands_off_the_axis_of_a_turntable_goes_round_with_it():
    eye = {"kind": "position", "position_m": [0, -3, 0]}
    pairs = pairs_of(WALL | {"turn_deg": 360, "centre_m": [0, -1, 0]}, LEVEL, eye, 14)
    # a pillar of radius 1 seen from 3: up to the angle whose cosine is 1/3
    assert pairs.light[:, 2].min() == pytest.approx(1 / 3, abs=0.01)


def test_a_walker_counts_as_much_as_one_who_stands(make_scene):
    walker = {"kind": "path", "points_m": [[-10, -1], [10, -1]], "height_m": 0}
    stands = {"kind": "position", "position_m": [0, -1, 0]}
    pairs = sample_pairs(make_scene(WALL, LEVEL, [walker, stands]), log2_samples=14)
    square = 1 + np.linspace(-10, 10, 200001) ** 2
    cosine = np.sum(square**-1.5) / np.sum(square**-1.0)
    walks = np.abs(pairs.view[:, 0]) > 1e-9
    assert pairs.weight[walks].sum() == pytest.approx(cosine / (1 + cosine), rel=0.02)


def test_a_walker_keeps_an_even_pace():
    walker = {"kind": "path", "points_m": [[0, -1], [1, -1], [1, -1], [4, -1]], "height_m": 0}
    scene = Scene.model_validate({"surface": [WALL], "light": [LEVEL], "viewer": [walker]})
    random = np.random.default_rng(0).random((1 << 14, 3))
    seen = scene.viewer[0].seen(random, np.zeros((len(random), 3)))
    assert np.mean(seen.direction[:, 0] * seen.distance) == pytest.approx(2.0, abs=0.05)


def test_what_is_left_out_is_told_by_demand_spread_over_neighbours():
    far = Candidates("two", np.array([45.0, 45.0]), np.array([0.0, 180.0])).directions
    weights = np.array([[0.97, 0.01], [0.01, 0.01]])
    demand = Demand(weights, weights, far, far)
    spread = np.exp(-2.0)  # of the neighbour, two deviations off
    near, other = 1 / (1 + spread), spread / (1 + spread)
    kernel = np.array([[near, other], [other, near]])
    held = np.cumsum(np.sort((kernel @ weights @ kernel.T).ravel()))
    for count, share in enumerate(held[:2], start=1):
        assert demand.asked(share * 0.99).sum() == 5 - count
        assert demand.asked(share * 1.01).sum() == 4 - count
