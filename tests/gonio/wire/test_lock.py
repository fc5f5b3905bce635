"""Who drives a rig drives it alone."""

import os
import re
import subprocess
import sys

import pytest

from gonio.errors import BadInputError
from gonio.rig import default_rig, default_rig_text, load_rig
from gonio.wire import hold_rig
from gonio.wire.lock import holders

HOLDER = """
import sys
from gonio.rig import load_rig
from gonio.wire import hold_rig
with hold_rig(load_rig(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def runtime_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))


def rig_at(lamps="/dev/lamps-of-a-test", **arm):
    rig = default_rig()
    return rig.model_copy(
        update={
            "arm": rig.arm.model_copy(update=arm),
            "lamps": rig.lamps.model_copy(update={"device": str(lamps)}),
        }
    )


@pytest.fixture
def rtu(tmp_path):
    """A rig whose ports have other names, too."""
    for name in ("bus", "lamps"):
        (tmp_path / name).touch()
        (tmp_path / f"by-id-{name}").symlink_to(name)
    blank = {"transport": "rtu", "host": None, "port": None}
    return lambda bus, lamps: rig_at(tmp_path / lamps, device=str(tmp_path / bus), **blank)


TCP = {"host": "127.0.0.1", "port": 502}
SAME = {
    "the bus": (TCP, TCP | {"lamps": "/dev/others"}),
    "the lamps": (TCP, TCP | {"port": 503}),
    "the bus by another name": (TCP, TCP | {"host": "localhost", "lamps": "/dev/others"}),
}


def refused(rig):
    who = re.escape(f"another gonio drives this rig (process {os.getpid()})")
    with pytest.raises(BadInputError, match=who), hold_rig(rig):
        pass


@pytest.mark.parametrize(("first", "second"), SAME.values(), ids=SAME)
def test_the_same_wire_is_the_same_rig(first, second):
    with hold_rig(rig_at(**first)):
        refused(rig_at(**second))
    with hold_rig(rig_at(**second)):
        pass


def test_a_serial_port_is_one_by_all_its_names(rtu):
    with hold_rig(rtu("bus", "lamps")):
        refused(rtu("by-id-bus", "elsewhere"))
        refused(rtu("elsewhere", "by-id-lamps"))


def test_other_wires_are_another_rig():
    with hold_rig(rig_at(**TCP)), hold_rig(rig_at("/dev/others", host="127.0.0.1", port=503)):
        pass


@pytest.mark.parametrize("host", ["nobody-knows.invalid", "a..b"])
def test_a_name_that_leads_nowhere_can_be_held(host):
    with hold_rig(rig_at(host=host, port=502)):
        refused(rig_at(host=host, port=502))


def test_a_lock_goes_with_a_killed_process(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(default_rig_text())
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"held\n"
        assert holders(load_rig(path)) == [process.pid]
        with pytest.raises(BadInputError, match=f"process {process.pid}"), hold_rig(load_rig(path)):
            pass
        process.kill()
        process.wait()
        assert holders(load_rig(path)) == []
        with hold_rig(load_rig(path)):
            pass


@pytest.fixture
def of_another_user(monkeypatch):
    """Locks in a sticky folder that another user left: none can be written or made anew."""

    def hindered(path, flags, *mode, open_=os.open):
        if "gonio-rig-" in str(path) and flags & (os.O_CREAT | os.O_RDWR):
            raise PermissionError(13, "Permission denied", str(path))
        return open_(path, flags, *mode)

    return lambda: monkeypatch.setattr(os, "open", hindered)


def test_another_users_lock_is_held_as_well_as_ones_own(of_another_user):
    rig = rig_at(**TCP)
    with hold_rig(rig):
        pass
    of_another_user()
    with hold_rig(rig), pytest.raises(BadInputError, match="another gonio"), hold_rig(rig):
        pass


def test_who_held_it_before_is_not_taken_for_who_holds_it(of_another_user, tmp_path):
    rig = rig_at(**TCP)
    with hold_rig(rig):
        pass
    # a process that does not have it open is in there, as one that ended and had its id used again
    for lock in tmp_path.glob("gonio-rig-*.lock"):
        lock.write_text(f"{os.getppid()}\n")
    of_another_user()
    with hold_rig(rig):
        assert holders(rig) == []
        with pytest.raises(BadInputError, match="process unknown"), hold_rig(rig):
            pass
