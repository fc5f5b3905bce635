"""`gonio plan --continue` and the chain of plans that it makes."""

import json
import shutil
import sqlite3

import numpy as np
import pytest

from gonio.files import sha256_file
from gonio.plan import Plan
from gonio.rig import default_rig_text
from gonio.samples import Samples
from gonio.session import Session

FIRST = 9


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(result, code, says):
    assert (result.returncode, result.stderr.count("\n")) == (code, 1), result.stderr
    assert says in result.stderr


@pytest.fixture(scope="module")
def measured(all_forks, tmp_path_factory, prior):
    """Return a session of nine shots, made once."""
    folder = tmp_path_factory.mktemp("measured")
    for command in (
        ("plan", "--shots", FIRST, "--prior", prior, "--no-page"),
        ("capture", "--sim", "--material", "matte-paint"),
    ):
        ok(all_forks.run(folder, *command))
    return folder / "session"


@pytest.fixture
def session(measured, tmp_path):
    shutil.copytree(measured, tmp_path / "session")
    return tmp_path / "session"


@pytest.fixture
def go_on(gonio, prior):
    return lambda *more: gonio("plan", "--continue", "session", "--prior", prior, *more)


def pairs(plan):
    return [
        (s.light_theta_deg, s.light_phi_deg, s.view_theta_deg, s.view_phi_deg) for s in plan.shots
    ]


def frames(session):
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT data FROM event WHERE kind = 'frame' ORDER BY id").fetchall()
    return [json.loads(data) for (data,) in rows]


def plan_files(session):
    return {path.name: sha256_file(path) for path in (session / "plans").iterdir()}


def test_a_plan_goes_on_from_what_was_measured(gonio, go_on, session):
    before = plan_files(session)
    printed = ok(go_on("--shots", "5"))
    assert before.items() <= plan_files(session).items()
    first, second = Session(session).chain().plans
    assert second.parent == first.sha256
    assert [shot.index for shot in second.shots] == list(range(FIRST, FIRST + 5))
    old = set(pairs(first))
    assert not old & set(pairs(second))
    assert not old & {(c, d, a, b) for a, b, c, d in pairs(second)}
    chosen = second.selection
    assert f"{chosen.deviation_before:.3f} now, {chosen.deviation_after:.3f} expected" in printed
    assert 0 < chosen.deviation_after < chosen.deviation_before
    assert second.sha256 in printed
    assert printed.splitlines()[-1] == "go on with: gonio capture --sim --resume"
    # no frame of a white reference or of the dark is counted again
    assert second.estimates.frames == 5 * 4


def test_twice_then_captured_reduced_and_reported(gonio, go_on, session):
    ok(go_on("--shots", "3"))
    kept = frames(session)
    printed = ok(gonio("capture", "--sim", "--resume"))
    assert "session: 12 frames of matte-paint" in printed
    ok(go_on("--shots", "2"))
    ok(gonio("capture", "--sim", "--resume"))
    taken = frames(session)
    assert taken[: len(kept)] == kept
    assert [f["shot_index"] for f in taken[len(kept) :]] == np.repeat(
        range(FIRST, FIRST + 5), 4
    ).tolist()
    assert "complete" in ok(gonio("capture", "--sim", "--resume"))
    assert "shots planned  14" in ok(gonio("reduce"))
    samples = Samples.load(session / "samples.nc")
    assert samples.shot_index.tolist() == list(range(FIRST + 5))
    chain = Session(session).chain()
    assert samples.provenance["plan"] == chain.last.sha256
    ok(gonio("reconstruct", "--estimator", "paper", "--epochs", "2"))
    page = (session / "report.html").read_text()
    places = [page.index(f"Plan {n}: {shots} shots") for n, shots in enumerate((FIRST, 3, 2))]
    assert places == sorted(places)
    assert f"{chain.plans[1].selection.deviation_before:.3f}, expected" in " ".join(page.split())
    assert all(plan.sha256 in page for plan in chain.plans)


def test_what_an_earlier_plan_lacks_is_taken_first_and_counts_as_coming(
    gonio, go_on, session, rewritten
):
    lost = "kind = 'frame' AND data LIKE '%shot_000008%'"
    rewritten(session / "journal.sqlite", f"DELETE FROM event WHERE {lost}")
    done = len(frames(session))
    ok(go_on("--shots", "4"))
    first, second = Session(session).chain().plans
    assert not set(pairs(first)) & set(pairs(second))
    ok(gonio("capture", "--sim", "--resume"))
    order = [frame["shot_index"] for frame in frames(session)[done:]]
    assert order == np.repeat(range(8, FIRST + 4), 4).tolist()


@pytest.mark.slow
def test_equal_sessions_make_equal_plans(go_on, session):
    ok(go_on("--shots", "4"))
    once = plan_files(session)
    (session / "plans/001.json").unlink()
    (session / "samples.nc").unlink()
    ok(go_on("--shots", "4"))
    assert plan_files(session) == once


def next_plan(session, **changes):
    """Return a plan that goes on from the last: its first shot once more."""
    chain = Session(session).chain()
    shot = chain.shots[0].model_copy(update={"index": chain.next_index} | changes.pop("shot", {}))
    told = {"parent": chain.last.sha256, "shots": (shot,)} | changes
    return chain.plans[0].model_copy(update=told)


FOREIGN = {
    "of another parent": ({"parent": "ab" * 32}, "parent is abababababab, not the plan before"),
    "for another rig": ({"rig_sha256": "cd" * 32}, "is for rig cdcdcdcdcdcd, not the session's"),
    "that counts again": ({"shot": {"index": 2}}, "shot 2 is in a plan before it"),
}


@pytest.mark.parametrize(("changes", "says"), FOREIGN.values(), ids=FOREIGN)
def test_a_plan_is_refused(gonio, go_on, session, tmp_path, changes, says):
    plan = next_plan(session, **changes)
    plan.save(tmp_path / "next.json")
    before = plan_files(session)
    refused(gonio("capture", "--sim", "--resume", "--plan", "next.json"), 4, f"next.json: {says}")
    assert plan_files(session) == before
    plan.save(session / "plans/001.json")
    for command in (("capture", "--sim", "--resume"), ("reduce",), ("reconstruct",)):
        refused(gonio(*command), 4, f"001.json: {says}")
    refused(go_on(), 4, f"001.json: {says}")


def test_a_plan_brought_along_is_added_once(gonio, session, tmp_path):
    plan = next_plan(session)
    plan.save(tmp_path / "next.json")
    for _ in range(2):
        ok(gonio("capture", "--sim", "--resume", "--plan", "next.json"))
    assert Session(session).chain().last == plan
    assert [f["attempt"] for f in frames(session) if f["shot_index"] == FIRST] == [1] * 4


def test_a_plan_that_was_measured_is_vouched_for(gonio, go_on, session):
    path = session / "plans/001.json"
    next_plan(session).save(path)
    other = next_plan(session, shot={"view_phi_deg": 180.0})
    ok(gonio("capture", "--sim", "--resume"))
    for spoil, says in ((other.save, "has changed"), (lambda path: path.unlink(), "is missing")):
        spoil(path)
        for command in (("capture", "--sim", "--resume"), ("reduce",)):
            refused(gonio(*command), 4, f"001.json: {says}")
        refused(go_on(), 4, f"001.json: {says}")


@pytest.mark.parametrize(("option", "value"), [("material", "satin"), ("seed", "5")])
def test_a_plan_brought_along_is_not_added_when_the_capture_is_refused(
    gonio, session, tmp_path, option, value
):
    next_plan(session).save(tmp_path / "next.json")
    before = plan_files(session)
    result = gonio("capture", "--sim", "--resume", "--plan", "next.json", f"--{option}", value)
    refused(result, 4, f"was begun with {option}")
    assert plan_files(session) == before


def test_a_plan_brought_along_that_the_rig_cannot_take_is_not_added(gonio, tmp_path):
    text = default_rig_text().replace("max_deg = 91.0", "max_deg = 50.0", 1)
    (tmp_path / "rig.toml").write_text(text)
    reach = ("--criterion", "farthest", "--max-theta", "45")
    ok(gonio("plan", "--density", "2", "--rig", "rig.toml", *reach))
    ok(gonio("capture", "--sim", "--rig", "rig.toml"))
    next_plan(tmp_path / "session", shot={"view_theta_deg": 60.0}).save(tmp_path / "next.json")
    before = plan_files(tmp_path / "session")
    says = "shot 4: view_theta 60 deg is beyond the axis' travel"
    refused(gonio("capture", "--sim", "--resume", "--plan", "next.json"), 2, says)
    assert plan_files(tmp_path / "session") == before


def test_exposures_that_a_plan_adds_are_calibrated_then(gonio, session, tmp_path):
    plan = next_plan(session, shot={"exposures_s": (0.05, 0.2)})
    plan.save(session / "plans/001.json")
    before = {path.name: sha256_file(path) for path in (session / "calibration").iterdir()}
    done = len(frames(session))
    # before they are taken, what is there can still be reduced
    assert "left out       1" in ok(gonio("reduce"))
    ok(gonio("capture", "--sim", "--resume"))
    after = {path.name: sha256_file(path) for path in (session / "calibration").iterdir()}
    assert before.items() <= after.items()
    new = [(frame["role"], frame["exposure_s"]) for frame in frames(session)[done:]]
    calibration = [(role, 0.05) for role in ("dark", "white") for _ in range(4)]
    assert new == [*calibration, ("shot", 0.05), ("shot", 0.2)]
    ok(gonio("reduce"))
    samples = Samples.load(session / "samples.nc")
    apart = np.abs(samples.value[-1] - samples.value[0])
    assert (apart < 4 * np.hypot(samples.sigma[-1], samples.sigma[0])).all()


DAMAGE = {
    "changed": lambda text: text.replace('"index": 9', '"index": 10'),
    "cut short": lambda text: text[: len(text) // 2],
    "empty": lambda text: "",
    "something else": lambda text: "[]",
}


@pytest.mark.parametrize("spoil", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_chain_is_refused_and_left_alone(gonio, go_on, session, spoil):
    path = session / "plans/001.json"
    next_plan(session).save(path)
    path.write_text(spoil(path.read_text()))
    before = plan_files(session)
    for command in (("capture", "--sim", "--resume"), ("reduce",)):
        refused(gonio(*command), 4, "001.json")
    refused(go_on(), 4, "001.json")
    assert plan_files(session) == before


def test_a_plan_missing_from_the_middle(gonio, session):
    next_plan(session).save(session / "plans/002.json")
    refused(gonio("capture", "--sim", "--resume"), 4, "001.json: is missing, though 002.json")


OPTIONS = {
    "a density": (("--density", "3"), "--density does not go with --continue"),
    "views": (("--views", "3"), "--views does not go with --continue"),
    "a rig": (("--rig", "r.toml"), "--rig does not go with --continue"),
    "a file": (("-o", "p.json"), "--output does not go with --continue"),
    "a criterion": (("--criterion", "farthest"), "criterion farthest knows nothing"),
    "no shots": (("--shots", "0"), "shots is 0"),
    "more than are left": (("--shots", "7000"), "all pairs that are left to take"),
    "no such prior": (("--prior", "gone.npz"), "gone.npz: no such file"),
}


@pytest.mark.parametrize(("options", "says"), OPTIONS.values(), ids=OPTIONS)
def test_options_that_make_no_sense(gonio, session, options, says):
    before = plan_files(session)
    refused(gonio("plan", "--continue", "session", *options), 2, says)
    assert plan_files(session) == before


def test_too_little_to_go_on_from(gonio, go_on, prior, tmp_path):
    refused(go_on(), 2, "session: no such folder")
    ok(gonio("plan", "--shots", "4", "--prior", prior))
    ok(gonio("capture", "--sim"))
    refused(go_on(), 2, "there are 4 samples")
    assert list(plan_files(tmp_path / "session")) == ["000.json"]


def test_a_session_at_work_is_left_alone(go_on, session):
    with Session(session).lock():
        refused(go_on(), 2, "another gonio works on this session")


def test_the_plan_says_what_was_known(go_on, session):
    ok(go_on("--shots", "2"))
    plan = Plan.load(session / "plans/001.json")
    reasons = {each.reason: each.shots for each in plan.left_out}
    # nine pairs and their reverses, but for those that are their own
    assert FIRST <= reasons["measured or planned before, as they are or reversed"] <= 2 * FIRST
    assert sum(reasons.values()) + 2 == 6561
