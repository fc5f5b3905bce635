"""A resume builds on nothing that changed: it says what, or takes it again."""

import shutil

import pytest

from gonio.files import sha256_file
from gonio.rig import load_rig
from gonio.samples import Samples
from gonio.session import Session
from tests.system.test_kill import FRAMES, RIG, capture, ok, resume, shots_of
from tests.system.test_reference import white_table

KILLED_AT = 22
"""An event in the midst of the shots."""


@pytest.fixture(scope="module")
def made(forks, tmp_path_factory):
    """Return a folder of a capture that was killed and of one that was not; white is a table."""
    folder = tmp_path_factory.mktemp("made")
    text = RIG.replace("reference = 0.99", 'reference = "white.npz"')
    (folder / "rig.toml").write_text(text)
    white_table(0.9).save(folder / "white.npz")
    plan = ("--density", "2", "--criterion", "farthest", "--rig", "rig.toml", "--no-page")
    ok(forks.run(folder, "plan", *plan))
    ok(forks.run(folder, *capture("whole"), drift=False))
    forks.run(folder, *capture("killed"), kill_at=(KILLED_AT, "after"), drift=False)
    return folder


@pytest.fixture
def killed(made, tmp_path):
    return copied(made / "killed", tmp_path)


@pytest.fixture
def whole(made, tmp_path):
    return copied(made / "whole", tmp_path)


def copied(root, folder):
    shutil.copytree(root, folder / "session")
    return Session(folder / "session")


def content(session):
    files = (path for path in session.root.rglob("*") if path.is_file())
    # SQLite's shared memory, and the lock, tell nothing of a session
    return {path: path.read_bytes() for path in files if path.suffix and "-shm" not in path.name}


def check_refused(forks, session, command, says):
    before = content(session)
    ended = forks.run(session.root.parent, *command)
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (4, "", 1), ended.stderr
    assert says in ended.stderr
    assert content(session) == before


def edit(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def put_a_folder(path):
    path.unlink()
    path.mkdir()


SPOILED = {
    "missing": lambda path: path.unlink(),
    "edited": edit,
    "a folder": put_a_folder,
    "truncated": lambda path: path.write_bytes(path.read_bytes()[:-100]),
    "empty": lambda path: path.write_bytes(b""),
}
spoiled = pytest.mark.parametrize("spoil", SPOILED.values(), ids=SPOILED)

INPUTS = (
    "plans/000.json", "rig.toml", "calibration/reference.npz", "calibration/reference.json",
)  # fmt: skip


@spoiled
@pytest.mark.parametrize("name", INPUTS)
def test_what_a_session_is_measured_with(forks, killed, name, spoil):
    spoil(killed.root / name)
    for command in (resume("session"), ("reduce",), ("reconstruct",)):
        check_refused(forks, killed, command, f"{name}: ")


@spoiled
def test_the_settings_of_the_twin_matter_to_a_resume_alone(forks, killed, spoil):
    spoil(killed.sim / "twin.json")
    check_refused(forks, killed, resume("session"), "sim/twin.json: ")
    ok(forks.run(killed.root.parent, "reduce"))


def test_a_session_of_the_twin_without_it_is_not_taken_to_a_rig(forks, killed):
    shutil.rmtree(killed.sim)
    for command in (resume("session"), ("capture", "--resume")):
        check_refused(forks, killed, command, "sim/twin.json: is missing")


def another_plan(session):
    plan = session.chain().last
    plan.model_copy(update={"shots": plan.shots[::-1]}).save(session.plans / "000.json")
    return "plans/000.json: has changed since the capture began"


def another_rig(session):
    text = session.rig_path.read_text()
    session.rig_path.write_text(text.replace("distance_m = 2.0", "distance_m = 2.1"))
    assert session.rig().sha256 != load_rig(session.root.parent / "rig.toml").sha256
    return "rig.toml: has changed since the capture began"


def another_reference(session):
    white_table(0.8).save(session.reference_path)
    note = session.reference_path.with_suffix(".json")
    digest = sha256_file(session.reference_path)
    note.write_text(f'{{"named": "white.npz", "sha256": "{digest}"}}')
    return "calibration/reference.json: has changed since the capture began"


OTHERS = [another_plan, another_rig, another_reference]


@pytest.mark.parametrize("put", OTHERS)
def test_another_that_is_whole_is_refused_as_well(forks, made, killed, put):
    shutil.copy(made / "rig.toml", killed.root.parent)
    says = put(killed)
    for command in (resume("session"), ("reduce",)):
        check_refused(forks, killed, command, says)


BEFORE = {
    "the rig": (another_rig, "rig.toml: is not the rig that the plan was made for"),
    "the reference": (
        lambda session: edit(session.reference_path),
        "reference.npz: is not the white reference that the session was begun with",
    ),
    "the rig, cut short": (
        lambda session: session.rig_path.write_text("[arm"),
        "rig.toml: is not TOML",
    ),
    "the plan": (lambda session: edit(session.plans / "000.json"), "plans/000.json: "),
}


@pytest.mark.parametrize(("change", "says"), BEFORE.values(), ids=BEFORE)
def test_before_the_first_event_they_vouch_for_each_other(forks, made, tmp_path, change, says):
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    forks.run(tmp_path, *capture("session"), kill_at=(1, "before"))
    session = Session(tmp_path / "session")
    change(session)
    check_refused(forks, session, resume("session"), says)


def frames_of(session):
    """Return the content of the frames of shots, by name."""
    return {path.name: path.read_bytes() for path in session.raw.glob("*.dng") if path.is_file()}


@spoiled
def test_a_frame_of_a_shot_is_taken_again_and_no_other(forks, made, killed, spoil):
    name = min(frames_of(killed))
    spoil(killed.raw / name)
    ok(forks.run(killed.root.parent, *resume("session"), drift=False))
    keys = shots_of(killed)
    assert (len(keys), len({*keys})) == (FRAMES + 1, FRAMES)
    now, once = frames_of(killed), frames_of(Session(made / "whole"))
    now.pop(name, None)
    del once[name]
    del now[name.replace("_a1", "_a2")]
    assert now == once
    ok(forks.run(killed.root.parent, "reduce"))
    assert sorted(Samples.load(killed.samples_path).attempt) == [1, 1, 1, 2]


def test_all_frames_of_shots_with_their_folder(forks, killed):
    shutil.rmtree(killed.raw)
    ok(forks.run(killed.root.parent, *resume("session"), drift=False))
    assert len({*shots_of(killed)}) == FRAMES
    assert len(frames_of(killed)) == FRAMES - 16


@spoiled
@pytest.mark.parametrize("role", ["dark", "white"])
def test_a_calibration_frame_that_changed_is_not_replaced_in_silence(forks, killed, role, spoil):
    path = killed.calibration / f"{role}_000000_e1_r2_a1.dng"
    spoil(path)
    if path.exists():
        says = f"calibration/{path.name}: has changed since the journal vouched for it"
        check_refused(forks, killed, resume("session"), says)
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    ok(forks.run(killed.root.parent, *resume("session"), drift=False))
    assert (killed.calibration / path.name.replace("_a1", "_a2")).is_file()
    assert len({*shots_of(killed)}) == FRAMES


@spoiled
def test_a_journal_that_is_not_whole(forks, whole, spoil):
    spoil(whole.journal_path)
    for command in (resume("session"), ("reduce",), ("reconstruct",)):
        check_refused(forks, whole, command, "session/journal.sqlite: ")


TAMPERING = {
    "an edited row": (
        "UPDATE event SET data = replace(data, 'repeat', 'repeal') WHERE id = 21",
        "record 21 is not the one that was written there",
    ),
    "a removed row": ("DELETE FROM event WHERE id = 9", "record 9 is missing"),
    "the last row removed": ("DELETE FROM event WHERE id = 22", "record 22 is missing"),
    "a moved row": ("UPDATE event SET id = 30 WHERE id = 12", "record 12 is missing"),
}


@pytest.mark.parametrize(("change", "says"), TAMPERING.values(), ids=TAMPERING)
def test_a_journal_that_was_tampered_with(forks, killed, tampered, change, says):
    tampered(killed.journal_path, change)
    for command in (resume("session"), ("reduce",), ("reconstruct",)):
        check_refused(forks, killed, command, f"session/journal.sqlite: {says}")
