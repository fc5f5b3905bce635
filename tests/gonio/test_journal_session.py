import contextlib
import json
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.errors import BadFileError, BadInputError, ResumeRefusedError, StorageError
from gonio.journal import FrameRecord, Journal
from gonio.notes import Notes
from gonio.plan import LampSetting, Plan, Selection, Shot
from gonio.rig import default_rig, default_rig_text
from gonio.session import Session
from gonio.timemodel import estimate

RIG = default_rig()
NOTES = Notes(sample="felt", orientation="grain along +x", mounting="flat", operator="Ada")


def make_plan(parent=None, view_theta_deg=45.0, index=0, rig=RIG):
    shots = (
        Shot(
            index=index, light_theta_deg=0, light_phi_deg=0, view_theta_deg=view_theta_deg,
            view_phi_deg=0, exposures_s=(0.1,), lamps=(LampSetting(n=1, mA=700),),
        ),
    )  # fmt: skip
    selection = Selection(
        criterion="farthest", candidates="paper-81", views=1, lights=1, full_set=6561,
        reciprocal_pairs=0, route="as given",
    )  # fmt: skip
    return Plan(
        parent=parent,
        rig_sha256=rig.sha256,
        selection=selection,
        estimates=estimate(shots, RIG),
        shots=shots,
    )


PLAN = make_plan()
FRAME = FrameRecord(
    role="shot", shot_index=3, attempt=1, repeat=0, exposure_s=0.02, file="raw/x.dng",
    sha256="ab" * 32, flux=(1.0,) * 11, view_theta_deg=45.01, view_phi_deg=0.0,
    light_theta_deg=0.0, light_phi_deg=0.01,
)  # fmt: skip


@pytest.fixture
def session(tmp_path):
    return create_session(tmp_path / "session", PLAN, default_rig_text(), NOTES)


def files_of(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_events_survive_reopening(tmp_path):
    clock = VirtualClock(5.0)
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(clock, "begin", operator="Ada")
        clock.sleep(2.0)
        journal.append_frame(clock, FRAME)
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(clock, "end")
    with Journal(tmp_path / "j") as journal:
        events = list(journal.events())
        assert [event.kind for event in events] == ["begin", "frame", "end"]
        assert [event.at_s for event in events] == [5.0, 7.0, 7.0]
        assert events[0].utc.isoformat() == "2000-01-01T00:00:05+00:00"
        assert events[0].data == {"operator": "Ada"}
        assert journal.frames() == [FRAME]


def test_an_event_is_safe_when_the_process_dies_right_after(tmp_path):
    program = """
import os, sys
from pathlib import Path
from gonio.clock import VirtualClock
from gonio.journal import Journal
journal = Journal(Path(sys.argv[1]), writing=True)
for number in range(20):
    journal.append(VirtualClock(), "shot", number=number)
os.kill(os.getpid(), 9)
"""
    subprocess.run([sys.executable, "-c", program, tmp_path / "j"], check=False)
    with Journal(tmp_path / "j") as journal:
        assert [event.data["number"] for event in journal.events("shot")] == list(range(20))


def test_the_journal_is_synced_and_written_ahead(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        read = journal._connection.execute
        assert read("PRAGMA journal_mode").fetchone() == ("wal",)
        assert read("PRAGMA synchronous").fetchone() == (2,)


def test_a_journal_that_is_missing_or_none(tmp_path):
    with pytest.raises(BadFileError, match="no such file"):
        Journal(tmp_path / "j")
    assert not (tmp_path / "j").exists()
    (tmp_path / "j").write_bytes(b"a text that is no database" * 100)
    for writing in (False, True):
        with pytest.raises(BadFileError, match="is not a journal"):
            Journal(tmp_path / "j", writing=writing)
    (tmp_path / "j").write_bytes(b"")
    with Journal(tmp_path / "j") as journal:
        assert list(journal.events()) == []  # a capture that ended before its first event


@pytest.mark.parametrize("change", ["DELETE FROM event", "UPDATE event SET kind = 'x'"])
def test_the_journal_only_grows(tmp_path, change):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(VirtualClock(), "begun")
    with (
        sqlite3.connect(tmp_path / "j") as other,
        pytest.raises(sqlite3.IntegrityError, match="append-only"),
    ):
        other.execute(change)


DAMAGE = {
    "half a row": ("data = '{'", r"record 2 is damaged: data is not JSON \(Expecting"),
    "bytes for a row": ("data = x'ff00'", "record 2 is damaged: data is not JSON"),
    "a list for a row": ("data = '[]'", "record 2 is damaged: data: Input should be a valid dict"),
    "no time": ("at_s = 'noon'", "record 2 is damaged: at_s: Input should be a valid number"),
    "no date": ("utc = 'May'", "record 2 is damaged: utc: Input should be a valid datetime"),
    "a frame without a file": (
        """data = '{"role": "dark"}'""",
        r"record 2 is damaged: shot_index: is missing \(and 10 more\)",
    ),
    "no text": ("kind = CAST(x'ff' AS TEXT)", "is damaged after record 1 "),
}


@pytest.mark.parametrize(("change", "says"), DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_record_is_named(tmp_path, tampered, change, says):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(VirtualClock(), "begun")
        journal.append_frame(VirtualClock(), FRAME)
    tampered(tmp_path / "j", f"UPDATE event SET {change} WHERE id = 2")
    with Journal(tmp_path / "j") as journal, pytest.raises(BadFileError, match=says) as caught:
        list(journal.events()), journal.frames()
    assert str(caught.value).startswith(f"{tmp_path}/j: ")
    assert str(caught.value).endswith(
        "; put a copy of the file back, or measure anew into another folder"
    )


def write_events(path, count):
    with Journal(path, writing=True) as journal:
        for number in range(count):
            journal.append(VirtualClock(float(number)), "shot", number=number)


NOT_THE_ONE = "is not the one that was written there"
TAMPERING = {
    "a row edited": (["UPDATE event SET data = '{}' WHERE id = 3"], f"record 3 {NOT_THE_ONE}"),
    "a time": (["UPDATE event SET at_s = at_s + 1 WHERE id = 3"], f"record 3 {NOT_THE_ONE}"),
    "a hash": (["UPDATE event SET sha256 = 'ab' WHERE id = 3"], f"record 3 {NOT_THE_ONE}"),
    "no hash": (["UPDATE event SET sha256 = NULL WHERE id = 3"], f"record 3 {NOT_THE_ONE}"),
    "bytes": (["UPDATE event SET data = x'ff00' WHERE id = 3"], f"record 3 {NOT_THE_ONE}"),
    "no text": (["UPDATE event SET kind = CAST(x'ff' AS TEXT) WHERE id = 3"], "is damaged"),
    "a row removed": (["DELETE FROM event WHERE id = 3"], "record 3 is missing"),
    "the first": (["DELETE FROM event WHERE id = 1"], "record 1 is missing"),
    "the last": (["DELETE FROM event WHERE id = 5"], "record 5 is missing"),
    "all": (["DELETE FROM event"], "record 1 is missing"),
    "a row removed, the others moved up": (
        ["DELETE FROM event WHERE id = 3", "UPDATE event SET id = id - 1 WHERE id > 3"],
        f"record 3 {NOT_THE_ONE}",
    ),
    "two rows swapped": (
        [f"UPDATE event SET id = {new} WHERE id = {old}" for old, new in ((2, 9), (4, 2), (9, 4))],
        f"record 2 {NOT_THE_ONE}",
    ),
    "a row put in between": (
        [
            "UPDATE event SET id = id + 10 WHERE id > 2",
            "UPDATE event SET id = id - 9 WHERE id > 10",
            "INSERT INTO event SELECT 3, at_s, utc, kind, data, sha256 FROM event WHERE id = 2",
        ],
        f"record 3 {NOT_THE_ONE}",
    ),
}


@pytest.mark.parametrize(("changes", "says"), TAMPERING.values(), ids=TAMPERING)
def test_tampering_with_the_journal_is_found_and_named(tmp_path, tampered, changes, says):
    write_events(tmp_path / "j", 5)
    with Journal(tmp_path / "j") as journal:
        journal.check_chain()
    for change in changes:
        tampered(tmp_path / "j", change)
    with Journal(tmp_path / "j") as journal, pytest.raises(BadFileError, match=says):
        journal.check_chain()


def test_a_removed_row_is_not_hidden_by_those_that_come_after(tmp_path, tampered):
    write_events(tmp_path / "j", 3)
    tampered(tmp_path / "j", "DELETE FROM event WHERE id = 3")
    write_events(tmp_path / "j", 2)
    with (
        Journal(tmp_path / "j") as journal,
        pytest.raises(BadFileError, match="record 3 is missing"),
    ):
        journal.check_chain()


def test_two_who_take_turns_write_one_chain(tmp_path):
    with Journal(tmp_path / "j", writing=True) as one:
        one.append(VirtualClock(), "begun")
        write_events(tmp_path / "j", 2)
        one.append(VirtualClock(), "finished")
    with Journal(tmp_path / "j") as journal:
        journal.check_chain()


@pytest.fixture
def old_journal(tmp_path):
    """Return a journal of before rows had hashes, with three events."""
    with contextlib.closing(sqlite3.connect(tmp_path / "old", isolation_level=None)) as connection:
        connection.execute(
            "CREATE TABLE event (id INTEGER PRIMARY KEY AUTOINCREMENT, at_s REAL NOT NULL, "
            "utc TEXT NOT NULL, kind TEXT NOT NULL, data TEXT NOT NULL)"
        )
        row = (1.0, "2000-01-01T00:00:01+00:00", "shot", "{}")
        for _ in range(3):
            connection.execute("INSERT INTO event (at_s, utc, kind, data) VALUES (?, ?, ?, ?)", row)
    return tmp_path / "old"


def test_a_journal_of_before_rows_had_hashes_is_read(old_journal):
    before = old_journal.read_bytes()
    with Journal(old_journal) as journal:
        journal.check_chain()
        assert [event.id for event in journal.events("shot")] == [1, 2, 3]
    assert old_journal.read_bytes() == before


def test_what_is_added_to_it_vouches_for_what_was_there(old_journal, tampered):
    write_events(old_journal, 2)
    with Journal(old_journal) as journal:
        journal.check_chain()
        assert [event.id for event in journal.events()] == [1, 2, 3, 4, 5]
    tampered(old_journal, "UPDATE event SET at_s = 2.0 WHERE id = 1")
    with Journal(old_journal) as journal, pytest.raises(BadFileError, match="record 4 is not"):
        journal.check_chain()


def test_a_rejection_without_its_file_is_named(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(VirtualClock(), "rejected", problem="dark")
    with Journal(tmp_path / "j") as journal, pytest.raises(BadFileError, match=r"record 1 .* file"):
        journal.rejected()


def test_pages_that_are_overwritten_are_a_damage(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        for _ in range(100):
            journal.append_frame(VirtualClock(), FRAME)
    data = bytearray((tmp_path / "j").read_bytes())
    data[-3 * 4096 : -2 * 4096] = b"x" * 4096
    (tmp_path / "j").write_bytes(data)
    with (
        Journal(tmp_path / "j") as journal,
        pytest.raises(BadFileError, match=r"is damaged after record \d"),
    ):
        journal.frames()


def test_reading_leaves_nothing_behind(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(VirtualClock(), "begun")
    before = files_of(tmp_path)
    with Journal(tmp_path / "j") as journal:
        assert len(list(journal.events())) == 1
        assert files_of(tmp_path) == before
    assert files_of(tmp_path) == before


def test_what_is_being_written_is_read_as_far_as_it_goes(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        for count in range(1, 4):
            journal.append(VirtualClock(), "begun")
            with Journal(tmp_path / "j") as reader:
                assert len(list(reader.events())) == count


def test_a_journal_that_cannot_grow(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal._connection.execute("PRAGMA max_page_count = 4")
        with pytest.raises(StorageError, match="free some space"):
            journal.append(VirtualClock(), "shot", text="x" * 100_000)


def test_a_new_session_holds_what_it_was_begun_with(session):
    assert session.chain().plans == (PLAN,)
    assert session.rig() == RIG
    assert session.notes() == NOTES
    assert json.loads(session.notes_path.read_text())["schema"] == "gonio.session/1"
    assert session.raw.is_dir()
    assert session.calibration.is_dir()
    assert Session.open(session.root) == session


def test_an_existing_session_is_never_overwritten(session):
    before = files_of(session.root)
    with pytest.raises(BadInputError, match=r"never overwritten; .*gonio capture --resume -o"):
        create_session(session.root, make_plan(view_theta_deg=30.0), default_rig_text(), NOTES)
    assert files_of(session.root) == before


COMMANDS = {
    "the default": ("session", False, "gonio capture --resume"),
    "the default, named otherwise": ("./session/", False, "gonio capture --resume"),
    "the default, simulated": ("session", True, "gonio capture --sim --resume"),
    "another": ("metal", True, "gonio capture --sim --resume -o metal"),
    "one in quotes": ("my metal", False, "gonio capture --resume -o 'my metal'"),
}


@pytest.mark.parametrize(("root", "simulated", "command"), COMMANDS.values(), ids=COMMANDS)
def test_the_command_to_go_on_with(tmp_path, monkeypatch, root, simulated, command):
    monkeypatch.chdir(tmp_path)
    session = Session(Path(root))
    if simulated:
        session.sim.mkdir(parents=True)
    assert session.resume_command == command


def test_neither_is_any_other_file_or_folder(tmp_path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/thesis").write_text("mine")
    for name in ("file", "folder"):
        with pytest.raises(BadInputError, match="never overwritten"):
            create_session(tmp_path / name, PLAN, default_rig_text(), NOTES)
    assert set(files_of(tmp_path).values()) == {b"mine"}


def test_an_empty_folder_will_do(tmp_path):
    (tmp_path / "empty").mkdir()
    made = create_session(tmp_path / "empty", PLAN, default_rig_text(), NOTES)
    assert made.chain().plans == (PLAN,)


def test_a_folder_that_is_no_session(tmp_path):
    with pytest.raises(BadFileError, match="no such folder"):
        Session.open(tmp_path / "none")
    with pytest.raises(BadFileError, match="is not a session"):
        Session.open(tmp_path)


def test_the_chain_of_plans(session):
    second = make_plan(parent=PLAN.sha256, view_theta_deg=30.0, index=1)
    assert session.add_plan(second) == session.plans / "001.json"
    third = make_plan(parent=second.sha256, view_theta_deg=60.0, index=7)
    assert session.add_plan(third) == session.plans / "002.json"
    chain = session.chain()
    assert chain.plans == (PLAN, second, third)
    assert [shot.index for shot in chain.shots] == [0, 1, 7]
    assert (chain.next_index, chain.next_name) == (8, "003.json")


OTHER_RIG = RIG.model_copy(update={"arm": RIG.arm.model_copy(update={"min_separation_deg": 5.0})})
STRANGERS = {
    "no parent": (make_plan(index=1), "parent is None, not the plan before it"),
    "another parent": (make_plan(parent="0" * 64, index=1), "parent is 000000000000, not"),
    "another rig": (make_plan(PLAN.sha256, index=1, rig=OTHER_RIG), "is for rig .*, not the"),
    "a shot again": (make_plan(PLAN.sha256), "shot 0 is in a plan before it"),
}


@pytest.mark.parametrize(("plan", "says"), STRANGERS.values(), ids=STRANGERS)
def test_a_plan_that_does_not_go_on_from_the_one_before(session, plan, says):
    before = files_of(session.root)
    with pytest.raises(ResumeRefusedError, match=rf"001\.json: {says}"):
        session.add_plan(plan)
    assert files_of(session.root) == before
    plan.save(session.plans / "001.json")
    with pytest.raises(ResumeRefusedError, match=rf"001\.json: {says}") as caught:
        session.chain()
    assert caught.value.exit_code == 4


def test_a_chain_with_a_gap(session):
    make_plan(PLAN.sha256, index=1).save(session.plans / "002.json")
    with pytest.raises(
        ResumeRefusedError, match=r"001\.json: is missing, though 002\.json is there"
    ):
        session.chain()


def test_half_a_plan_is_none(session):
    (session.plans / ".001.json.part").write_text("half a pl")
    assert session.chain().plans == (PLAN,)


def test_an_exposure_keeps_its_place_when_a_plan_is_added(session):
    second = make_plan(parent=PLAN.sha256, index=1)
    shot = second.shots[0].model_copy(update={"exposures_s": (0.05, 0.1, 0.02)})
    session.add_plan(second.model_copy(update={"shots": (shot,)}))
    assert session.chain().exposures_s == (0.1, 0.02, 0.05)


def test_resuming_with_the_same_is_allowed(session):
    session.check_same(PLAN, RIG)
    session.check_same(None, None)


def test_resuming_with_another_plan_or_rig_is_refused(session):
    for plan, rig, says in (
        (make_plan(view_theta_deg=30.0), None, "was begun with plan"),
        (None, OTHER_RIG, "was begun with rig"),
    ):
        with pytest.raises(ResumeRefusedError, match=says) as caught:
            session.check_same(plan, rig)
        assert caught.value.exit_code == 4


def test_after_an_added_plan_the_first_alone_is_another(session):
    second = make_plan(parent=PLAN.sha256, view_theta_deg=30.0, index=1)
    session.add_plan(second)
    session.check_same(second, None)
    with pytest.raises(ResumeRefusedError):
        session.check_same(PLAN, None)


def test_the_lock_keeps_another_process_out_and_goes_with_it(session):
    program = """
import sys
from pathlib import Path
from gonio.session import Session
with Session(Path(sys.argv[1])).lock():
    print("held", flush=True)
    sys.stdin.readline()
"""
    with subprocess.Popen(
        [sys.executable, "-c", program, session.root],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as other:  # fmt: skip
        assert other.stdout.readline() == "held\n"
        with pytest.raises(BadInputError, match="another gonio works on this"), session.lock():
            pass
        other.kill()
    with session.lock():
        pass


def test_timings_are_kept_by_stage(session):
    assert session.timings() == {}
    session.note_timing("capture", 1.23456)
    session.note_timing("reduce", 2.0)
    session.note_timing("capture", 3.0)
    assert session.timings() == {"capture": 3.0, "reduce": 2.0}


BAD_TIMINGS = ["[]", "{", '{"capture": "long"}', '{"capture": null}']


@pytest.mark.parametrize("text", BAD_TIMINGS)
def test_timings_that_are_none(session, text):
    session.timings_path.write_text(text)
    with pytest.raises(BadFileError, match=r"timings\.json"):
        session.timings()


def test_a_foreign_database_is_no_journal_of_frames(tmp_path):
    with sqlite3.connect(tmp_path / "j") as connection:
        connection.execute("CREATE TABLE event (name TEXT)")
    connection.close()
    with (
        Journal(tmp_path / "j", writing=True) as journal,
        pytest.raises(BadFileError, match="is damaged"),
    ):
        list(journal.events())


def test_a_frame_record_of_another_shape(tmp_path):
    with Journal(tmp_path / "j", writing=True) as journal:
        journal.append(VirtualClock(), "frame", file="x")
        with pytest.raises(BadFileError, match=r"record 1 .* role: is missing"):
            journal.frames()
