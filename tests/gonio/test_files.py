import contextlib
import errno
import hashlib
import json
import math
import os
import sqlite3

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.errors import StorageError
from gonio.files import (
    canonical_json,
    move_into,
    sha256_bytes,
    sha256_file,
    write_bytes,
    write_json,
    write_with,
)

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)  # fmt: skip


@pytest.fixture
def old(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    return path


def assert_untouched(path):
    assert path.read_bytes() == b"old"
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_a_writer_that_fails_leaves_the_old_file(old):
    def write(aside):
        aside.write_bytes(b"half")
        raise ValueError("gave up")

    with pytest.raises(ValueError, match="gave up"):
        write_with(old, write)
    assert_untouched(old)


def test_an_interrupted_writer_leaves_the_old_file(old):
    def write(aside):
        aside.write_bytes(b"half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_with(old, write)
    assert_untouched(old)


REFUSALS = [
    # name, error number, what is said
    ("full", errno.ENOSPC, "the disk is full; free some space"),
    ("broken", errno.EIO, "Input/output error"),
    ("read-only", errno.EROFS, "Read-only file system"),
]


@pytest.mark.parametrize(
    ("number", "says"), [c[1:] for c in REFUSALS], ids=[c[0] for c in REFUSALS]
)
@pytest.mark.parametrize("write", [lambda p: write_bytes(p, b"new"), lambda p: write_json(p, 1)])
def test_a_disk_that_refuses_leaves_the_old_file(old, monkeypatch, write, number, says):
    def refuse(_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(StorageError, match=says) as caught:
        write(old)
    assert str(caught.value).startswith(f"{old}: ")
    assert caught.value.exit_code == 3
    assert_untouched(old)


def test_content_is_synced_before_it_gets_its_name(old, monkeypatch):
    seen = []
    monkeypatch.setattr(os, "fsync", lambda _: seen.append(old.read_bytes()))
    write_bytes(old, b"new")
    # first the new file, while the old one still has the name; then the folder
    assert seen == [b"old", b"new"]


def test_folders_are_made(tmp_path):
    write_bytes(tmp_path / "a/b/c", b"x")
    assert (tmp_path / "a/b/c").read_bytes() == b"x"


def test_a_folder_in_the_way(tmp_path):
    (tmp_path / "x").mkdir()
    with pytest.raises(StorageError, match="is there and is no file"):
        write_bytes(tmp_path / "x", b"")
    assert [p.name for p in tmp_path.iterdir()] == ["x"]


def test_a_journal_is_never_replaced(tmp_path):
    path = tmp_path / "journal.sqlite"
    with contextlib.closing(sqlite3.connect(path)) as journal:
        journal.execute("CREATE TABLE frames (file)")
        journal.commit()
    before = path.read_bytes()
    with pytest.raises(StorageError, match="as a session's journal is"):
        write_bytes(path, b"a table")
    assert path.read_bytes() == before


def test_a_file_where_a_folder_should_be(old):
    with pytest.raises(StorageError):
        write_bytes(old / "below", b"")
    assert_untouched(old)


def test_moving_a_file(tmp_path, old):
    target = tmp_path / "new"
    move_into(old, target)
    assert target.read_bytes() == b"old"
    assert not old.exists()
    with pytest.raises(StorageError, match=str(target)):
        move_into(old, target)


@given(JSON)
def test_canonical_json_keeps_the_value_and_ignores_the_order(value):
    assert json.loads(canonical_json(value)) == value
    if isinstance(value, dict):
        assert canonical_json(dict(reversed(value.items()))) == canonical_json(value)


def test_canonical_json_byte_for_byte():
    assert canonical_json({"b": [1, 2.5], "a": "µ"}) == '{"a":"µ","b":[1,2.5]}'.encode()


def test_half_a_character_is_escaped(tmp_path):
    """As in a file name that is not text, which Python hands on in this way."""
    assert canonical_json("\udcff") == b'"\\udcff"'
    write_json(tmp_path / "x", "\udcff")
    assert json.loads((tmp_path / "x").read_text()) == "\udcff"


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_json_has_no_such_numbers(tmp_path, number):
    with pytest.raises(ValueError, match="not JSON compliant"):
        canonical_json([number])
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "x", [number])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("length", [0, 1, (1 << 20) - 1, (1 << 20) + 1])
def test_hashes_of_files_and_bytes_agree(tmp_path, length):
    data = bytes(length)
    (tmp_path / "x").write_bytes(data)
    assert sha256_file(tmp_path / "x") == sha256_bytes(data) == hashlib.sha256(data).hexdigest()
