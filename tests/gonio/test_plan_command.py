import json
import subprocess
import sys

import numpy as np
import pytest

from gonio.clearance import not_free
from gonio.plan import Plan
from gonio.rig import default_rig_text, load_rig
from gonio.timemodel import pose_angles_deg
from gonio.words import several
from nnbrdf.prior import MaterialPrior

SUBSETS = [
    # options, views, lights, shots
    ((), 14, 14, 196),
    (("--density", "vs-ia", "--criterion", "farthest", "--no-page"), 14, 81, 1134),
    (("--density", "va-is", "--criterion", "farthest", "--no-page"), 81, 14, 1134),
    (("--density", "3", "--views", "5", "--no-page"), 5, 3, 15),
    (("--views", "2", "--lights", "4", "--no-page"), 2, 4, 8),
]


@pytest.mark.parametrize(
    ("options", "views", "lights", "shots"), SUBSETS, ids=[" ".join(s[0]) for s in SUBSETS]
)
def test_the_file_and_the_table_agree(gonio, tmp_path, options, views, lights, shots):
    result = gonio("plan", *options)
    assert result.returncode == 0, result.stderr
    plan = Plan.load(tmp_path / "plan.json")
    assert (plan.selection.views, plan.selection.lights, len(plan.shots)) == (views, lights, shots)
    assert f"{shots}, {shots / 6561:.1%} of the full set" in result.stdout
    assert f"{several(plan.selection.reciprocal_pairs, 'pair')}, by reciprocity" in result.stdout
    assert plan.sha256 in result.stdout
    moving_s, bound_s = plan.route.moving_s, plan.route.bound_s
    assert f"{moving_s:.1f} s of moves; {bound_s:.1f} s at the least" in result.stdout
    assert 0.95 * moving_s < bound_s <= moving_s
    for word in ("moving", "settling", "exposing", "overhead", "homing", "storage", "not chosen"):
        assert word in result.stdout


def test_the_plan_is_what_others_expect_to_read(gonio, tmp_path):
    assert gonio("plan", "--density", "2", "--no-page", "-o", "deep/p.json").returncode == 0
    plan = json.loads((tmp_path / "deep/p.json").read_text())
    assert plan["schema"] == "gonio.plan/1"
    assert {"sha256", "shots", "selection", "left_out", "estimates", "route"} <= set(plan)
    assert set(plan["shots"][0]) - {"view_turn", "light_turn"} == {
        "index", "light_theta_deg", "light_phi_deg", "view_theta_deg", "view_phi_deg",
        "exposures_s", "lamps",
    }  # fmt: skip
    assert set(plan["shots"][0]["lamps"][0]) == {"n", "mA"}


def test_a_plan_that_is_there_is_replaced_and_again_the_same(gonio, tmp_path):
    (tmp_path / "plan.json").write_text("old")
    assert gonio("plan", "--density", "2").returncode == 0
    first = [(tmp_path / name).read_bytes() for name in ("plan.json", "plan.html")]
    assert gonio("plan", "--density", "2").returncode == 0
    assert [(tmp_path / name).read_bytes() for name in ("plan.json", "plan.html")] == first
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan.html", "plan.json"]


def test_a_refused_plan_leaves_the_old_one(gonio, tmp_path):
    (tmp_path / "plan.json").write_text("old")
    assert gonio("plan", "--density", "lots").returncode == 2
    assert (tmp_path / "plan.json").read_text() == "old"


def test_a_rig_of_ones_own(gonio, tmp_path):
    text = default_rig_text().replace("min_separation_deg = 0.0", "min_separation_deg = 45")
    (tmp_path / "rig.toml").write_text(text)
    result = gonio("plan", "--rig", "rig.toml", "--criterion", "farthest", "--no-page")
    assert result.returncode == 0
    shots = Plan.load(tmp_path / "plan.json").shots
    assert len(shots) == 196
    assert all(not reasons.any() for reasons in not_free_of(shots, tmp_path / "rig.toml"))


def test_a_rig_that_cannot_see_the_white_reference(gonio, tmp_path):
    text = default_rig_text().replace("min_separation_deg = 0.0", "min_separation_deg = 46")
    (tmp_path / "rig.toml").write_text(text)
    refused = gonio("plan", "--rig", "rig.toml", "--criterion", "farthest", "--no-page")
    assert refused.returncode == 2
    assert "white reference: view 45/0, light 0/0 deg (theta/phi) is closer" in refused.stderr
    assert not (tmp_path / "plan.json").exists()


def not_free_of(shots, rig):
    return not_free(pose_angles_deg(shots), load_rig(rig)).values()


def test_the_plot_shows_the_chosen_directions(gonio, tmp_path):
    from matplotlib.image import imread

    blue = []
    few = ("--lights", "2", "--criterion", "farthest", "--no-page")
    for views in (5, 50):
        assert gonio("plan", "--views", views, *few, "--plot", "d.png").returncode == 0
        image = imread(tmp_path / "d.png")
        blue.append(int(np.sum(image[..., 2] > image[..., 0] + 0.3)))
    assert 5 < blue[1] / blue[0] < 20


def test_the_page_lies_beside_the_plan_unless_told(gonio, tmp_path):
    spread = ("plan", "--density", "2", "--criterion", "farthest")
    result = gonio(*spread, "-o", "deep/p.json")
    assert "wrote deep/p.html" in result.stdout
    assert "4 shots in" in (tmp_path / "deep/p.html").read_text()
    assert gonio(*spread, "--no-page", "-o", "q.json").returncode == 0
    assert not (tmp_path / "q.html").exists()


def test_a_plan_called_html_has_no_room_for_its_page(gonio, tmp_path):
    spread = ("plan", "--density", "2", "--criterion", "farthest", "-o", "plan.html")
    result = gonio(*spread)
    assert result.returncode == 2
    assert "--no-page" in result.stderr
    assert not list(tmp_path.iterdir())
    assert gonio(*spread, "--no-page").returncode == 0


def test_planning_leaves_torch_alone(tmp_path):
    code = (
        "import sys\n"
        "from gonio.cli.plan import command\n"
        "command(['--density', '2', '-o', sys.argv[1]], standalone_mode=False)\n"
        "sys.exit('torch' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path / "p.json")], check=False)
    assert done.returncode == 0


def test_a_plan_names_the_prior_that_it_was_made_with(gonio, tmp_path):
    prior = MaterialPrior.generate(examples=60, seed=3)
    prior.save(tmp_path / "ours.npz")
    rings = ("--candidates", "rings:0x1,30x4", "--no-page")
    asked = gonio("plan", *rings, "--shots", "8", "--prior", "ours.npz")
    assert asked.returncode == 0, asked.stderr
    assert Plan.load(tmp_path / "plan.json").selection.prior_sha256 == prior.sha256
    every = gonio("plan", *rings, "--density", "all", "--prior", "ours.npz")
    assert "all pairs are measured, so the prior had no say" in every.stdout
    assert Plan.load(tmp_path / "plan.json").selection.prior_sha256 is None
    assert "prior_sha256" not in (tmp_path / "plan.json").read_text()


def test_free_pairs_are_not_said_to_be_of_a_density(gonio, tmp_path):
    said = gonio("plan", "--candidates", "rings:0x1,30x4", "--no-page", "--shots", "8")
    assert "17 not chosen" in " ".join(said.stdout.split())
    assert "density" not in said.stdout + (tmp_path / "plan.json").read_text()
