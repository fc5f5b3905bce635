import pytest

from gonio.errors import BadFileError
from planner.scene.scene import load_scene

SURFACE = 'surface = [{shape = "flat", tilt_deg = 0}]\n'
LIGHT = 'light = [{kind = "direction", elevation_deg = 45}]\n'
VIEWER = 'viewer = [{kind = "direction", elevation_deg = 60}]\n'


def scene(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return load_scene(path)


def test_the_shortest_scene(tmp_path):
    found = scene(tmp_path, SURFACE + LIGHT + VIEWER)
    assert [len(each) for each in (found.surface, found.light, found.viewer)] == [1, 1, 1]


def test_a_number_is_a_span_of_no_width(tmp_path):
    walker = 'viewer = [{kind = "path", points_m = [[0, 1], [0, 2]], height_m = 1.7}]\n'
    assert scene(tmp_path, SURFACE + LIGHT + walker).viewer[0].height_m == (1.7, 1.7)


def surface(keys):
    return f"surface = [{{{keys}}}]\n{LIGHT}{VIEWER}"


def light(keys):
    return f"{SURFACE}light = [{{{keys}}}]\n{VIEWER}"


def viewer(keys):
    return f"{SURFACE}{LIGHT}viewer = [{{{keys}}}]\n"


BAD = [
    # text, what the line says
    ("", "surface: is missing (and 2 more)"),
    ("surface = []\n" + LIGHT + VIEWER, "surface: "),
    (SURFACE + LIGHT + "viewer = 3", "viewer: "),
    (surface("tilt_deg = 0"), "surface.0: 'shape' is missing"),
    (surface('shape = "cube", tilt_deg = 0'), "surface.0: Input tag 'cube' found using 'shape'"),
    (surface('shape = "flat"'), "surface.0.flat.tilt_deg: is missing"),
    (surface('shape = "flat", tilt_deg = 0, tilt = 0'), "tilt: is not a known key"),
    (surface('shape = "flat", tilt_deg = 181'), "181 is out of range, 0 to 180"),
    (surface('shape = "flat", tilt_deg = nan'), "nan is out of range"),
    (surface('shape = "flat", tilt_deg = 0, arc_deg = 9'), "arc_deg: is not a known key"),
    (surface('shape = "sphere", tilt_deg = 0'), "surface.0.sphere.arc_deg: is missing"),
    (surface('shape = "flat", tilt_deg = 0, weight = nan'), "weight: nan is out of range"),
    (surface('shape = "flat", tilt_deg = 0, weight = -1'), "weight: -1 is out of range"),
    (surface('shape = "flat", tilt_deg = 0, weight = inf'), "weight: inf is out of range"),
    (surface('shape = "flat", tilt_deg = 0, weight = 0'), "every surface has weight 0"),
    (light('kind = "direction", elevation_deg = 0, weight = 0'), "every light has weight 0"),
    (light('kind = "sun", latitude_deg = 50, day_of_year = [9, 3]'), "[9, 3] is the wrong way"),
    (light('kind = "sun", latitude_deg = 50, solar_hour = 25'), "25 is out of range, 0 to 24"),
    (light('kind = "ceiling", centre_m = [0, 0, 3], size_m = [0, 1]'), "two lengths above 0"),
    (viewer('kind = "path", points_m = [[0, 1]]'), "points_m: Tuple should have at least 2"),
    (viewer('kind = "around", distance_m = -1'), "-1 is out of range"),
    (viewer('kind = "direction", elevation_deg = "up"'), "elevation_deg: "),
    ("surface = [", "is not TOML"),
]


@pytest.mark.parametrize(("text", "says"), BAD, ids=[says for _, says in BAD])
def test_what_is_wrong_is_said_in_one_line(tmp_path, text, says):
    with pytest.raises(BadFileError) as error:
        scene(tmp_path, text)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
    assert str(error.value).endswith("docs/topics/scenes.md")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(BadFileError, match="no such file"):
        load_scene(tmp_path / "none.toml")
