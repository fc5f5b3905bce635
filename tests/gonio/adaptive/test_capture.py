"""`gonio capture --adaptive`: rounds until a target or a limit, and what kills them."""

import json
import shutil
import signal
import sqlite3

import pytest

from gonio.adaptive import rig_time
from gonio.capture.usage import Usage, usages_of
from gonio.files import sha256_file
from gonio.journal import Journal
from gonio.session import Session

FIRST = 9


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(result, code, says):
    assert (result.returncode, result.stderr.count("\n")) == (code, 1), result.stderr
    assert says in result.stderr


@pytest.fixture(scope="module")
def planned(all_forks, tmp_path_factory, prior):
    """Return a plan of nine shots, made once."""
    folder = tmp_path_factory.mktemp("planned")
    ok(all_forks.run(folder, "plan", "--shots", FIRST, "--prior", prior, "--no-page"))
    return folder / "plan.json"


@pytest.fixture(autouse=True)
def plan(planned, tmp_path):
    shutil.copy(planned, tmp_path)


@pytest.fixture
def adapt(gonio, prior):
    def run(*more, material="satin"):
        always = ("--sim", "--adaptive", "--prior", prior, "--material", material)
        return gonio("capture", *always, *more)

    return run


def chain(folder, name="session"):
    return Session(folder / name).chain()


def counts(folder, name="session"):
    return [len(plan.shots) for plan in chain(folder, name).plans]


def events(folder, kind, name="session"):
    with sqlite3.connect(folder / name / "journal.sqlite") as journal:
        rows = journal.execute("SELECT data FROM event WHERE kind = ? ORDER BY id", (kind,))
        return [json.loads(data) for (data,) in rows]


def test_a_target_that_is_reached_at_once(gonio, adapt, tmp_path):
    printed = ok(adapt("--until", "5", material="matte-paint"))
    assert counts(tmp_path) == [FIRST]
    assert "the target of 5 is reached" in printed
    assert f"round 1: {FIRST} shots, mean sd 0." in printed
    assert "complete" in ok(gonio("capture", "--sim", "--resume"))
    (end,) = events(tmp_path, "adaptive ended")
    assert (end["shots"], end["reason"]) == (FIRST, "the target of 5 is reached")


def test_a_target_out_of_reach_ends_at_the_limit_of_shots(gonio, adapt, tmp_path):
    printed = ok(adapt("--until", "0.001", "--batch", "4", "--max-shots", "15"))
    assert counts(tmp_path) == [FIRST, 4, 2]
    assert "the limit of 15 shots is reached" in printed
    told = [line for line in printed.splitlines() if line.startswith("round")]
    assert [line.split()[2] for line in told] == ["9", "13", "15"]
    indices = [shot.index for shot in chain(tmp_path).shots]
    assert indices == list(range(15))
    with Journal(tmp_path / "session/journal.sqlite") as journal:
        spent, runs = rig_time(journal.events()), usages_of(journal)
    assert 0 < spent < 2 * chain(tmp_path).estimated_s
    assert (len(runs), Usage.sum(runs).total_s) == (3, pytest.approx(spent))
    told = f"rig in use {Usage.sum(runs).sentence}"
    assert printed.count("rig in use") == printed.count(told) == 1
    ok(gonio("reconstruct", "--estimator", "paper", "--epochs", "2"))
    page = " ".join((tmp_path / "session/report.html").read_text().split())
    assert "Further plans were added until the limit of 15 shots is reached." in page
    assert f"<dt>rig in use</dt><dd>{Usage.sum(runs).sentence}</dd>" in page
    assert page.index("Plan 1: 4 shots") < page.index("Plan 2: 2 shots")


@pytest.mark.slow
def test_the_rig_time_is_kept(adapt, tmp_path):
    first_s = chain_estimate(tmp_path / "plan.json")
    hours = (first_s + 100) / 3600
    printed = ok(adapt("--until", "0.001", "--batch", "6", "--hours", hours))
    assert "no further shot fits into" in printed
    assert 1 < len(counts(tmp_path)) < 6
    with Journal(tmp_path / "session/journal.sqlite") as journal:
        assert rig_time(journal.events()) <= 3600 * hours


def chain_estimate(path):
    from gonio.plan import Plan

    return Plan.load(path).estimates.total_s


@pytest.mark.slow
def test_another_target_later(gonio, adapt, tmp_path):
    ok(adapt("--until", "5"))
    ok(gonio("capture", "--sim", "--resume", "--adaptive", "--until", "0.001", "--max-shots", "12"))
    assert counts(tmp_path) == [FIRST, 3]
    goals = events(tmp_path, "adaptive")
    assert [goal["until"] for goal in goals] == [5, 0.001]
    assert goals[0]["prior_sha256"] == goals[1]["prior_sha256"] != ""


def test_a_session_begun_without_goes_on_adaptively(gonio, prior, tmp_path):
    ok(gonio("capture", "--sim"))
    wish = ("--adaptive", "--until", "0.001", "--max-shots", "11", "--prior", prior)
    ok(gonio("capture", "--sim", "--resume", *wish))
    assert counts(tmp_path) == [FIRST, 2]


def test_the_first_plan_where_there_is_none(adapt, tmp_path):
    (tmp_path / "plan.json").unlink()
    printed = ok(adapt("--until", "5", "--max-shots", "12"))
    assert "begins with 12 pairs" in printed
    assert counts(tmp_path) == [12]


# what a kill leaves behind: the command runs until a function is called, and is dead then
DEATHS = {
    "before a plan is written": ("gonio.plan.Plan.save", "self.parent"),
    "while it is written": ("gonio.files.sync_file", "path.name == '.001.json.part'"),
    "once it is there": ("gonio.capture.Capture.__init__", "len(session.chain().plans) > 1"),
    "in the first shot of a round": ("gonio.journal.Journal.append_frame", "frame.shot_index > 8"),
    "when all is reduced": ("gonio.adaptive.standing.Watch.take_stock", "True"),
}
WISH = (
    "capture", "--sim", "--adaptive", "--material", "satin", "--until", "0.001", "--batch", "3",
    "--max-shots", "15",
)  # fmt: skip


@pytest.fixture(scope="module")
def whole(all_forks, planned, tmp_path_factory, prior):
    """Return the chain of a capture that nobody killed."""
    folder = tmp_path_factory.mktemp("whole")
    shutil.copy(planned, folder)
    ok(all_forks.run(folder, *WISH, "--prior", prior))
    return chain(folder)


@pytest.mark.slow
def test_one_seed_makes_one_chain(gonio_from_nothing, whole, prior, tmp_path):
    ok(gonio_from_nothing(*WISH, "--prior", prior))
    assert chain(tmp_path) == whole


# the others are moments before or after
QUICK = ("while it is written",)


@pytest.mark.parametrize(
    ("where", "when"),
    [
        pytest.param(*death, id=name, marks=() if name in QUICK else pytest.mark.slow)
        for name, death in DEATHS.items()
    ],
)
def test_nothing_is_lost_whenever_it_is_killed(
    all_forks, gonio, whole, prior, tmp_path, where, when
):
    death = ("tests.gonio.adaptive.deaths:die", where, when)
    killed = all_forks.run(tmp_path, *WISH, "--prior", prior, before=death)
    assert killed.returncode == -signal.SIGKILL
    kept = {path.name: sha256_file(path) for path in (tmp_path / "session/plans").glob("0*.json")}
    printed = ok(gonio("capture", "--sim", "--resume"))
    assert "the limit of 15 shots is reached" in printed
    assert counts(tmp_path) == [len(plan.shots) for plan in whole.plans] == [FIRST, 3, 3]
    # the first decision rests on frames that both have to the bit
    assert chain(tmp_path).plans[:2] == whole.plans[:2]
    now = {path.name: sha256_file(path) for path in (tmp_path / "session/plans").glob("0*.json")}
    assert kept.items() <= now.items()
    assert "complete" in ok(gonio("capture", "--sim", "--resume"))


@pytest.mark.slow
def test_a_prior_that_is_another_now(gonio, adapt, prior, tmp_path):
    from nnbrdf.prior import MaterialPrior

    mine = tmp_path / "mine.npz"
    mine.write_bytes(prior.read_bytes())
    ok(adapt("--until", "5", "--prior", mine))
    MaterialPrior.generate(examples=30).save(mine)
    wish = ("--resume", "--adaptive", "--until", "0.001", "--max-shots", "11")
    refused(gonio("capture", "--sim", *wish), 4, "mine.npz: is not the prior")
    ok(gonio("capture", "--sim", *wish, "--prior", mine))
    assert counts(tmp_path) == [FIRST, 2]


BAD = {
    "a target without it": (("--until", "0.1"), "--until is an option of --adaptive"),
    "shots without it": (("--max-shots", "20"), "--max-shots is an option of --adaptive"),
    "a prior without it": (("--prior", "p.npz"), "--prior is an option of --adaptive"),
    "no target": (("--adaptive", "--until", "0"), "until"),
    "no number": (("--adaptive", "--until", "nan"), "until"),
    "no batch": (("--adaptive", "--batch", "0"), "batch"),
    "too few": (("--adaptive", "--max-shots", "3"), "max_shots"),
    "fewer than planned": (("--adaptive", "--max-shots", "8"), "more than --max-shots 8"),
    "no time": (("--adaptive", "--hours", "0"), "hours"),
    "too little time": (("--adaptive", "--hours", "0.01"), "more than --hours 0.01"),
    "no such prior": (("--adaptive", "--prior", "gone.npz"), "gone.npz: no such file"),
}


@pytest.mark.parametrize(("options", "says"), BAD.values(), ids=BAD)
def test_options_that_make_no_sense(gonio, tmp_path, options, says):
    refused(gonio("capture", "--sim", *options), 2, says)
    assert not (tmp_path / "session").exists()


def test_a_first_plan_too_small_to_go_on_from(gonio, prior, tmp_path):
    ok(gonio("plan", "--shots", "4", "--prior", prior))
    refused(gonio("capture", "--sim", "--adaptive"), 2, "the first plan has 4 shots")
    assert not (tmp_path / "session").exists()


def test_the_time_between_runs_is_not_the_rigs():
    from types import SimpleNamespace as Event

    told = [
        ("adaptive", 0.0), ("begun", 0.0), ("homed", 5.0), ("frame", 8.0),
        ("begun", 100.0), ("homed", 104.0), ("frame", 110.0), ("finished", 111.0),
        ("rejected", 111.0), ("adaptive ended", 500.0),
    ]  # fmt: skip
    assert rig_time(Event(kind=kind, at_s=at_s) for kind, at_s in told) == 8.0 + 11.0
