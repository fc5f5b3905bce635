"""`gonio capture --retake`: what a check flags is taken anew, and nothing else is."""

import numpy as np
import pytest

from gonio.files import sha256_file
from gonio.samples import Flag, Samples
from gonio.session import Session

SPOILED = "raw/shot_000004_e2_r0_a1.dng"
HEADER_AND = 2 * 160 * 160


def ok(result):
    assert result.returncode == 0, result.stderr
    return [" ".join(line.split()) for line in result.stdout.splitlines()]


@pytest.fixture
def session(gonio, tmp_path, rewritten):
    """Nine shots; half of the light of one frame was lost before its file was vouched for."""
    ok(gonio("plan", "--density", "3", "--criterion", "farthest", "--no-page"))
    ok(gonio("capture", "--sim"))
    path = tmp_path / "session" / SPOILED
    before, data = sha256_file(path), path.read_bytes()
    mosaic = np.frombuffer(data[-HEADER_AND:], "<u2")
    path.write_bytes(data[:-HEADER_AND] + (1024 + (mosaic - 1024.0) / 2).astype("<u2").tobytes())
    change = "UPDATE event SET data = replace(data, ?, ?)"
    rewritten(tmp_path / "session/journal.sqlite", change, (before, sha256_file(path)))
    return Session(tmp_path / "session")


def taken_as(session, attempt):
    return {path.name[5:11] for path in session.raw.glob(f"*_a{attempt}.dng")}


def test_a_flagged_shot_is_taken_anew(gonio, session):
    told = ok(gonio("reduce"))
    assert "take 1 shot again with: gonio capture --sim --retake" in told
    assert any(line.startswith("flag exposures 1 shot") for line in told)
    flags = Samples.load(session.samples_path).flag
    assert (flags & Flag.SUSPECT).any(axis=1).tolist() == [i == 4 for i in range(9)]
    assert "1 flagged shot to take again" in ok(gonio("capture", "--sim", "--retake"))
    assert taken_as(session, 2) == {"000004"}
    assert (session.root / SPOILED).is_file()
    with session.journal() as journal:
        assert SPOILED in journal.rejected()
        assert len(journal.rejected()) == 4
    assert not [line for line in ok(gonio("reduce")) if line.startswith("flag")]
    samples = Samples.load(session.samples_path)
    assert samples.attempt.tolist() == [2 if i == 4 else 1 for i in range(9)]
    assert not (samples.flag & Flag.SUSPECT).any()


def test_nothing_is_taken_twice(gonio, session):
    ok(gonio("reduce"))
    ok(gonio("capture", "--sim", "--retake"))
    again = ok(gonio("capture", "--sim", "--retake"))
    assert "0 flagged shots to take again" in again
    refused = gonio("capture", "--sim", "--retake", "--adaptive")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "leave out --adaptive" in refused.stderr
    assert taken_as(session, 2) == {"000004"}
    assert taken_as(session, 3) == set()


def test_what_was_not_reduced_has_nothing_to_take_again(gonio, session):
    refused = gonio("capture", "--sim", "--retake")
    assert refused.returncode == 2
    assert "has no checks yet, which say what to take again; run: gonio reduce" in refused.stderr
    assert taken_as(session, 2) == set()


def test_checks_of_other_samples_are_refused(gonio, session):
    ok(gonio("reduce"))
    stale = session.checks_path.read_bytes()
    ok(gonio("capture", "--sim", "--retake"))
    ok(gonio("reduce"))
    session.checks_path.write_bytes(stale)
    refused = gonio("capture", "--sim", "--retake")
    assert refused.returncode == 2
    assert "checks.json: is not of the samples that are there; run: gonio reduce" in refused.stderr


def test_the_report_shows_the_checks(gonio, session):
    ok(gonio("reconstruct", "--estimator", "paper", "--epochs", "2"))
    page = session.report_path.read_text()
    assert ">Checks</h3>" in page
    assert "1 shot whose exposures disagree; take them again" in page
