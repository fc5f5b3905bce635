"""`gonio capture --rehearse`: all that a capture does on the twin, but for the pictures."""

import json
import sqlite3

import pytest

from gonio.files import sha256_file

FAULTS = """
[[fault]]
kind = "bus time-out"
rate = 0.001

[[fault]]
kind = "frame truncated"
rate = 0.02

[[fault]]
kind = "frame bit-flipped"
rate = 0.02

[[fault]]
kind = "power cut"
at = [40]
"""


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(result, code, says):
    assert (result.returncode, result.stderr.count("\n")) == (code, 1), result.stderr
    assert says in result.stderr


def events(session):
    """Return the journal's events, without the hash of what a frame shows."""
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT at_s, utc, kind, data FROM event ORDER BY id").fetchall()
    return [
        (at_s, utc, kind, json.loads(data) | {"sha256": None}) for at_s, utc, kind, data in rows
    ]


def journal_hash(session):
    return sha256_file(session / "journal.sqlite")


@pytest.fixture
def rehearse(gonio):
    def run(*more, name="session"):
        return gonio("capture", "--sim", "--rehearse", "-o", name, *more)

    return run


def test_64_shots_with_faults_are_the_same_to_the_bit_for_a_seed(gonio, tmp_path):
    (tmp_path / "faults.toml").write_text(FAULTS)
    ok(gonio("plan", "--density", "8", "--criterion", "farthest", "--no-page"))
    hashes = set()
    for name in ("one", "again"):
        (tmp_path / name).mkdir()
        said = ok(gonio(
            "capture", "--sim", "--rehearse", "--plan", "../plan.json", "--seed", 5,
            "--faults", "../faults.toml", cwd=tmp_path / name,
        ))  # fmt: skip
        hashes.add(journal_hash(tmp_path / name / "session"))
    assert len(hashes) == 1
    assert "faults met" in said
    assert "rig in use" in said
    assert "288 frames rehearsed in" in said
    assert "nothing to reconstruct" in said


def test_it_does_what_a_capture_does_at_the_same_times(gonio, rehearse, tmp_path):
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--no-page"))
    said = ok(gonio("capture", "--sim", "-o", "measured"))
    rehearsed = ok(rehearse(name="rehearsed"))
    assert events(tmp_path / "measured") == events(tmp_path / "rehearsed")
    ok(rehearse("--seed", "1", name="other"))
    assert journal_hash(tmp_path / "other") != journal_hash(tmp_path / "rehearsed")
    (usage,) = (line for line in said.splitlines() if line.startswith("rig in use"))
    assert usage in rehearsed
    assert "gonio reconstruct" in said
    assert "gonio reconstruct" not in rehearsed


def test_it_is_gone_on_with_as_one_and_reconstructed_never(gonio, rehearse, tmp_path):
    (tmp_path / "full.toml").write_text('[[fault]]\nkind = "disk full"\nat = [40]\n')
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--no-page"))
    assert rehearse("--faults", "full.toml").returncode == 3
    assert "rehearsed" in ok(gonio("capture", "--sim", "--resume"))
    for command in ("reduce", "reconstruct"):
        refused(gonio(command, "session"), 2, "is a rehearsal, whose frames show nothing")
    refused(gonio("plan", "--continue", "session"), 2, "is a rehearsal")
    assert "complete" in ok(rehearse("--resume"))


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--rehearse", "--rig", "rig.toml"), "--rehearse is an option of --sim"),
        (("--sim", "--rehearse", "--material", "satin"), "--material does not go with --rehearse"),
        (("--sim", "--rehearse", "--adaptive"), "--adaptive does not go with --rehearse"),
    ],
)
def test_what_it_cannot_do_is_refused(gonio, options, says):
    refused(gonio("capture", *options), 2, says)


def test_a_measurement_is_not_gone_on_with_as_a_rehearsal(gonio, rehearse):
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--no-page"))
    ok(gonio("capture", "--sim"))
    refused(rehearse("--resume"), 4, "was not begun as a rehearsal")
