import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.rig import default_rig
from planner.candidates import candidates_named
from planner.field import Field, cosine_demand, paper_field
from planner.make import make_plan
from planner.subset import angles_between

SETS = [
    # name, directions, largest theta
    ("paper-81", 81, 75.0),
    ("PAPER-81", 81, 75.0),
    ("klems", 145, 82.5),
    ("rings:0x1,30x8,60x16", 25, 60.0),
    ("rings:12.5x3", 3, 12.5),
    ("fibonacci:1", 1, 60.0),
    ("fibonacci:300", 300, 89.9),
]


@pytest.mark.parametrize(("name", "count", "largest"), SETS, ids=[s[0] for s in SETS])
def test_sets_by_name(name, count, largest):
    candidates = candidates_named(name)
    assert len(candidates) == count
    assert candidates.theta_deg.max() == pytest.approx(largest, abs=0.1)
    assert candidates.name == name.lower()
    assert ((candidates.phi_deg >= 0) & (candidates.phi_deg < 360)).all()
    angles = angles_between(candidates.directions, candidates.directions)
    assert angles[~np.eye(count, dtype=bool)].min(initial=1.0) > 1e-3


def test_the_klems_basis_has_its_nine_rings():
    theta, counts = np.unique(candidates_named("klems").theta_deg, return_counts=True)
    assert theta.tolist() == [0, 10, 20, 30, 40, 50, 60, 70, 82.5]
    assert counts.tolist() == [1, 8, 16, 20, 24, 24, 24, 16, 12]


@given(st.integers(50, 1500))
def test_a_spiral_covers_equal_solid_angles(count):
    directions = candidates_named(f"fibonacci:{count}").directions
    # heights of equal areas are equally spaced, and no direction crowds another
    np.testing.assert_allclose(directions[:, 2], 1 - (np.arange(count) + 0.5) / count)
    gap = angles_between(directions, directions) + 9 * np.eye(count)
    assert gap.min() > 0.6 * np.sqrt(2 * np.pi / count)


def test_a_file_of_directions(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("name, phi_deg, theta_deg\na, 90, 0\nb, -90, 45\n\nc, 720, 45\n")
    candidates = candidates_named(str(path))
    assert candidates.theta_deg.tolist() == [0, 45, 45]
    assert candidates.phi_deg.tolist() == [90, 270, 0]
    plan = make_plan(default_rig(), views="all", lights="2", light_candidates=candidates)
    assert plan.selection.candidates == "lights mine.csv, views paper-81"
    assert (plan.selection.lights, plan.selection.views) == (2, 81)
    assert plan.selection.full_set == 3 * 81


BAD = [
    ("none", "hemisphere", "use paper-81, klems, rings"),
    ("no count", "fibonacci:", "N from 1 to 4000"),
    ("no number", "fibonacci:1e3", "N from 1 to 4000"),
    ("too many", "fibonacci:4001", "N from 1 to 4000"),
    ("no ring", "rings:", "is no ring"),
    ("half a ring", "rings:30", "'30' is no ring"),
    ("below", "rings:91x4", "beyond 90 deg"),
    ("empty ring", "rings:30x0", "of 1 to 4000"),
    ("many rings", "rings:10x3000,20x3000", "6000 directions are too many"),
    ("ring twice", "rings:30x4,30x8", "theta 30, phi 0 deg stands there twice"),
    ("pole many times", "rings:0x4", "all azimuths are one"),
    ("no file", "nowhere.csv", "no such file"),
]


@pytest.mark.parametrize(("name", "says"), [b[1:] for b in BAD], ids=[b[0] for b in BAD])
def test_sets_that_are_none(name, says):
    with pytest.raises(BadInputError, match=says):
        candidates_named(name)


BAD_FILES = [
    ("empty", "", "no columns theta_deg and phi_deg"),
    ("no head", "0,0\n30,90\n", "no columns"),
    ("head only", "theta_deg,phi_deg\n", "holds no direction"),
    ("a word", "theta_deg,phi_deg\n0,0\n30,east\n", "line 3: '30,east' are no two angles"),
    ("a short line", "theta_deg,phi_deg\n30\n", "line 2"),
    ("NaN", "theta_deg,phi_deg\nnan,0\n", "line 2: theta is 0 to 90"),
    ("below", "theta_deg,phi_deg\n95,0\n", "line 2: theta is 0 to 90"),
    ("twice", "theta_deg,phi_deg\n30,0\n30,360\n", "stands there twice"),
]


@pytest.mark.parametrize(
    ("text", "says"), [b[1:] for b in BAD_FILES], ids=[b[0] for b in BAD_FILES]
)
def test_files_that_are_none(tmp_path, text, says):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(BadInputError, match=says):
        candidates_named(str(path))


def test_what_never_ends_is_not_read(tmp_path):
    (tmp_path / "endless.csv").symlink_to("/dev/zero")
    with pytest.raises(BadInputError, match="no regular file"):
        candidates_named(str(tmp_path / "endless.csv"))
    with (tmp_path / "vast.csv").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(BadInputError, match="larger than 4000 directions ever are"):
        candidates_named(str(tmp_path / "vast.csv"))


def test_pairs_are_light_by_light():
    lights, views = candidates_named("rings:0x1,40x2"), candidates_named("paper-81")
    light, view = Field(lights, views, np.ones((3, 81), bool)).pairs
    assert light.shape == view.shape == (243, 3)
    np.testing.assert_allclose(light[81:162] - lights.directions[1], 0)
    np.testing.assert_allclose(view[81:162], paper_directions())


def test_reciprocal_pairs_of_two_sets():
    lights, views = candidates_named("rings:0x1,40x2"), candidates_named("rings:0x1,40x2,60x3")
    every = Field(lights, views, np.ones((3, 6), bool))
    # the three that both sets have: three unordered pairs of different ones
    assert every.reciprocal(every.allowed) == 3
    assert paper_field().reciprocal(np.eye(81, dtype=bool)) == 0


def test_a_weight_by_cosines():
    candidates = candidates_named("rings:0x1,60x1,90x1")
    np.testing.assert_allclose(
        cosine_demand(candidates, candidates), np.outer([1, 0.5, 0], [1, 0.5, 0]), atol=1e-12
    )
