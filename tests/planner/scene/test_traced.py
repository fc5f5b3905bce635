import sys

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.errors import BadFileError, BadInputError, MissingExtraError
from planner.candidates import paper_candidates
from planner.scene.demand import Demand
from planner.scene.traced import trace_pairs

CAMERA = """
<sensor type="orthographic">
    <transform name="to_world">
        <scale value="0.3"/>
        <lookat origin="{eye}" target="0, 0, 0" up="0, 1, 0"/>
    </transform>
    <film type="hdrfilm">
        <integer name="width" value="16"/><integer name="height" value="16"/>
    </film>
</sensor>
"""
PAINT = '<bsdf type="{bsdf}" id="paint"><bsdf type="diffuse"/></bsdf>'
PLANE = '<shape type="rectangle"><ref id="paint"/></shape>'
SUN = """
<emitter type="directional">
    <vector name="direction" value="{way}"/><rgb name="irradiance" value="1"/>
</emitter>
"""
ABOVE, FRONT = "0, -0.5, 0.8660254", "0, -0.7071068, -0.7071068"


@pytest.fixture
def mitsuba():
    """Skip where the renderer is missing."""
    return pytest.importorskip("mitsuba")


def write(folder, *parts):
    path = folder / "scene.xml"
    path.write_text(f'<scene version="3.0.0">{"".join(parts)}</scene>')
    return path


def plane_under_sun(folder, eye=ABOVE, way=FRONT, bsdf="twosided"):
    return write(
        folder, CAMERA.format(eye=eye), PAINT.format(bsdf=bsdf), PLANE, SUN.format(way=way)
    )


def test_a_plane_under_a_sun_is_all_demand_on_one_pair(tmp_path, mitsuba):
    pairs = trace_pairs(plane_under_sun(tmp_path), "paint", paths=200)
    light, view = from_degrees([45.0, 30.0], [90.0, 270.0])
    assert pairs.light == pytest.approx(np.broadcast_to(light, pairs.light.shape), abs=1e-5)
    assert pairs.view == pytest.approx(np.broadcast_to(view, pairs.view.shape), abs=1e-5)
    assert len(pairs.weight) == 200
    assert pairs.weight.sum() == pytest.approx(1.0)
    candidates = paper_candidates()
    assert Demand.of(pairs, candidates, candidates).weights.max() == pytest.approx(1.0)


def test_the_back_is_the_front_turned_over(tmp_path, mitsuba):
    path = plane_under_sun(tmp_path, eye="0, -0.5, -0.8660254", way="0, -0.7071068, 0.7071068")
    pairs = trace_pairs(path, "paint", paths=50)
    light, view = from_degrees([45.0, 30.0], [270.0, 90.0])
    assert pairs.light == pytest.approx(np.broadcast_to(light, pairs.light.shape), abs=1e-5)
    assert pairs.view == pytest.approx(np.broadcast_to(view, pairs.view.shape), abs=1e-5)


MIRROR = """
<bsdf type="twosided" id="glass"><bsdf type="conductor"/></bsdf>
<shape type="rectangle">
    <transform name="to_world"><rotate y="1" angle="90"/><translate x="1"/></transform>
    <ref id="glass"/>
</shape>
"""
WALL = """
<bsdf type="twosided" id="plaster"><bsdf type="diffuse"/></bsdf>
<shape type="rectangle">
    <transform name="to_world">
        <scale value="50"/><rotate y="1" angle="-90"/><translate x="1"/>
    </transform>
    <ref id="plaster"/>
</shape>
"""


def test_light_that_a_wall_throws_back_counts(tmp_path, mitsuba):
    # the sun shines along the plane, so only the wall in the east is lit
    parts = CAMERA.format(eye=ABOVE), PAINT.format(bsdf="twosided"), PLANE, WALL
    path = write(tmp_path, *parts, SUN.format(way="1, 0, 0"))
    pairs = trace_pairs(path, "paint", paths=2000)
    assert (pairs.light[:, 0] > 0).all()
    # an endless wall seen from beside it: light by the cosine, from the east half
    assert pairs.weight @ pairs.light[:, 2] == pytest.approx(2 / 3, abs=0.03)
    with pytest.raises(BadInputError, match="no light that falls on material 'paint'"):
        trace_pairs(path, "paint", paths=200, depth=1)


def test_what_is_seen_in_a_mirror_counts(tmp_path, mitsuba):
    camera = CAMERA.format(eye="-0.8660254, 0, 0.5")
    parts = camera, PAINT.format(bsdf="twosided"), PLANE, MIRROR, SUN.format(way="0, 0, -1")
    pairs = trace_pairs(write(tmp_path, *parts), "paint", paths=500)
    assert pairs.light == pytest.approx(np.broadcast_to([0, 0, 1], pairs.light.shape), abs=1e-5)
    assert (pairs.view[:, 0] < 0).all()


BAD = [
    # parts, material, what the line says
    ((PAINT.format(bsdf="twosided"), PLANE), "paint", "has no camera"),
    ((CAMERA.format(eye=ABOVE), PAINT.format(bsdf="twosided"), PLANE), "paint", "has no light"),
    (("<shape",), "paint", "cannot be loaded"),
    (('<bsdf type="unheard-of"/>',), "paint", "cannot be loaded"),
]


@pytest.mark.parametrize(("parts", "material", "says"), BAD, ids=range(len(BAD)))
def test_scenes_that_cannot_be_traced(tmp_path, mitsuba, parts, material, says):
    with pytest.raises(BadFileError, match=says) as error:
        trace_pairs(write(tmp_path, *parts), material)
    assert "\n" not in str(error.value)


def test_a_material_that_is_not_there_lists_those_that_are(tmp_path, mitsuba):
    with pytest.raises(BadFileError, match="no shape with material 'cloth', but with paint"):
        trace_pairs(plane_under_sun(tmp_path), "cloth")


def test_a_sun_behind_the_plane_lights_nothing(tmp_path, mitsuba):
    path = plane_under_sun(tmp_path, way="0, -0.7071068, 0.7071068")
    with pytest.raises(BadInputError, match="in sight and lit"):
        trace_pairs(path, "paint", paths=50)


def test_one_seed_gives_one_set_of_samples(tmp_path, mitsuba):
    path = plane_under_sun(tmp_path)
    first, again = (trace_pairs(path, "paint", seed=3, paths=50) for _ in range(2))
    assert (first.weight == again.weight).all()
    assert (first.light == again.light).all()


def test_without_the_renderer_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(MissingExtraError, match=r"needs mitsuba.*gonio\[mitsuba\]"):
        trace_pairs(tmp_path / "scene.xml", "paint")
