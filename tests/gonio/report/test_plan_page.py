import re
from types import SimpleNamespace

import numpy as np
import pytest

from gonio.errors import StorageError
from gonio.plan import LeftOut
from gonio.report.figures import page_style
from gonio.report.plan_drawings import draw_pairs, draw_route
from gonio.report.plan_facts import cards, ends_s
from gonio.report.plan_page import write_plan_page
from gonio.report.planned import Planned, done_s
from gonio.rig import default_rig
from gonio.timemodel import estimate
from planner.candidates import Candidates, candidates_named, paper_candidates
from planner.make import make_plan
from planner.reach import reach_of

RIG = default_rig()
PAPER = paper_candidates()
HOSTILE = '<script>alert("1")</script> & <img src=http://evil.test/x.png> {{ 7 * 7 }} $\\foo'


def plan_of_all(lights, views):
    """Return a plan of all pairs, light by light: its route does not matter here."""
    small = make_plan(RIG, views=1, lights=1)
    first = small.shots[0]
    shots = tuple(
        first.model_copy(
            update={
                "index": light * len(views) + view,
                "light_theta_deg": float(lights.theta_deg[light]),
                "light_phi_deg": float(lights.phi_deg[light]),
                "view_theta_deg": float(views.theta_deg[view]),
                "view_phi_deg": float(views.phi_deg[view]),
            }
        )
        for light in range(len(lights))
        for view in range(len(views))
    )
    return small.model_copy(update={"shots": shots, "estimates": estimate(shots, RIG)})


@pytest.fixture
def page(tmp_path, standalone):
    """Write the page of a plan and return it, checked."""

    def write(plan, lights=PAPER, views=PAPER, rig=RIG, most_bytes=1_000_000):
        target = tmp_path / "plan.html"
        write_plan_page(target, plan, rig, lights, views, reach_of(lights, views, rig).reasons)
        assert target.stat().st_size < most_bytes
        return standalone(target.read_text())

    return write


PLANS = {
    # what make_plan is asked for, title, captions
    "one shot": ({"views": 1, "lights": 1}, "1 shot in", ["1 chosen of 81, 80 skipped"]),
    "sixth": ({}, "196 shots in", ["14 chosen of 81, 67 skipped"]),
    "free pairs": ({"criterion": "random", "shots": 50}, "50 shots in", ["chosen of 81"]),
}


@pytest.mark.parametrize("name", PLANS)
def test_the_page_stands_alone_and_says_what_the_plan_does(page, name):
    settings, title, captions = PLANS[name]
    plan = make_plan(RIG, **settings)
    told = page(plan)
    assert title in told.text
    for caption in captions:
        assert told.text.count(caption) == 2
    for left in plan.left_out:
        assert left.reason in told.text
        assert str(left.shots) in told.lines
    for digest in (plan.sha256, plan.rig_sha256):
        assert digest in told.lines
    assert plan.selection.criterion in told.lines
    assert plan.selection.route in told.lines
    assert "Adds to" not in told.text


def test_all_pairs_stay_small(page):
    told = page(plan_of_all(PAPER, PAPER), most_bytes=3_000_000)
    assert "6561 shots in" in told.text
    assert "81 chosen of 81, 0 skipped" in told.text


def test_many_candidates_stay_small(page):
    lights, views = candidates_named("fibonacci:1000"), candidates_named("rings:0x1,30x8,60x16")
    plan = make_plan(
        RIG, criterion="random", shots=60, light_candidates=lights, view_candidates=views
    )
    told = page(plan, lights, views)
    assert "of 1000" in told.text
    assert "of 25" in told.text


def test_a_plan_of_a_chain_names_its_parent(page):
    plan = make_plan(RIG, views=2, lights=2).model_copy(update={"parent": "f" * 64})
    assert "f" * 64 in page(plan).lines


def test_what_the_rig_cannot_take_is_crossed_and_counted(page):
    data = RIG.model_dump()
    data["axis"]["view_theta"]["max_deg"] = 62.0
    data["arm"]["min_separation_deg"] = 20.0
    rig = type(RIG).model_validate(data)
    told = page(make_plan(rig, views=6, lights=6), rig=rig)
    assert "6 chosen of 81, 51 skipped, 24 out of reach" in told.text
    assert "6 chosen of 81, 75 skipped." in told.text
    assert "beyond the travel of an axis" in told.text
    assert "closer than 20 deg" in told.text


def test_a_hostile_name_is_only_a_name(page):
    plan = make_plan(RIG, views=2, lights=2)
    selection = plan.selection.model_copy(
        update={"candidates": HOSTILE, "criterion": HOSTILE, "route": HOSTILE}
    )
    left_out = (LeftOut(reason=HOSTILE, shots=3),)
    told = page(plan.model_copy(update={"selection": selection, "left_out": left_out}))
    assert told.text.count(HOSTILE) == 4


def test_what_an_omission_spares_is_told(page):
    plan = make_plan(RIG, views=2, lights=2)
    left = LeftOut(reason="not asked for", shots=7, spared_shots=5, spared_min=3.0,
                   error_inside=0.001, error_outside=0.25)  # fmt: skip
    told = page(plan.model_copy(update={"left_out": (left,)}))
    assert "spares 5 shots, 3 min" in told.text
    assert "+0.0010 in what counts, +0.2500 elsewhere" in told.text


def test_one_plan_gives_the_same_bytes(tmp_path):
    plan = make_plan(RIG, views=3, lights=3)
    for name in ("a", "b"):
        write_plan_page(tmp_path / name, plan, RIG, PAPER, PAPER)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_page_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StorageError, match=r"plan\.html"):
        write_plan_page(
            tmp_path / "file/plan.html", make_plan(RIG, views=1, lights=1), RIG, PAPER, PAPER
        )


def test_shots_end_in_their_order_and_the_last_with_the_estimate():
    plan = make_plan(RIG, views=4, lights=5)
    done = done_s(plan, RIG)
    assert (np.diff(done) > 0).all()
    assert done[-1] == pytest.approx(plan.estimates.total_s, rel=0.02)
    assert done[0] > sum(plan.shots[0].exposures_s)


def test_the_map_has_a_color_for_each_pair():
    lights, views = candidates_named("rings:0x1,40x6"), candidates_named("rings:10x4,50x7")
    plan = make_plan(
        RIG, criterion="random", shots=9, light_candidates=lights, view_candidates=views
    )
    refused = np.zeros((7, 11), bool)
    planned = Planned.of(plan, RIG, lights, views, {"in the way": refused})
    refused[planned.light.of_shot[0] - 1] = True
    with page_style():
        picture = np.array(draw_pairs(planned).axes[0].images[0].get_array())
    taken = np.zeros((7, 11), bool)
    taken[planned.light.of_shot, planned.view.of_shot] = True
    assert picture.shape == (7, 11, 4)
    assert (picture[taken][:, 3] == 1).all()
    assert len(np.unique(picture[taken], axis=0)) == 9
    assert len(np.unique(picture[refused & ~taken], axis=0)) == 1
    assert len(np.unique(picture[~refused & ~taken], axis=0)) == 1
    assert (picture[refused & ~taken][0] != picture[~refused & ~taken][0]).any()


def test_the_route_is_marked_where_it_begins_and_ends():
    two = Candidates("two", np.array([10.0, 60.0]), np.array([0.0, 90.0]))
    plan = plan_of_all(two, two)
    planned = Planned.of(plan, RIG, two, two, {})
    assert planned.light.of_shot.tolist() == [0, 0, 1, 1]
    assert planned.view.of_shot.tolist() == [0, 1, 0, 1]
    with page_style():
        *_, start, end = draw_route(planned.light).axes[0].lines
    # shots lie a few degrees around their direction
    assert np.hypot(start.get_xdata() - 10.0, start.get_ydata()) < 5.0
    assert np.hypot(end.get_xdata(), end.get_ydata() - 60.0) < 5.0


def test_an_interval_is_told_where_there_is_one():
    estimates = SimpleNamespace(total_lo_s=60.0, total_hi_s=180.0)
    assert ends_s(estimates) == (60.0, 180.0)
    plan = make_plan(RIG, views=1, lights=1)
    assert all(re.fullmatch(r"\S.*", value) for _, value, _ in cards(plan))
