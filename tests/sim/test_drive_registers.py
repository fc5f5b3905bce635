"""The register table of the protocol page, word for word."""

import pytest

from gonio.errors import TransportTimeoutError
from gonio.rig import Rig, default_rig
from sim.twin import Twin

READABLE = [
    ("controlword", 0x0000, 1),
    ("statusword", 0x0001, 1),
    ("modes of operation", 0x0002, 1),
    ("modes display", 0x0003, 1),
    ("target position", 0x0004, 2),
    ("position actual", 0x0006, 2),
    ("profile velocity", 0x0008, 2),
    ("profile acceleration", 0x000A, 2),
    ("following error", 0x000C, 2),
    ("error code", 0x000E, 1),
    ("digital inputs", 0x000F, 1),
    ("watchdog", 0x0010, 1),
    ("settle", 0x0011, 1),
    ("everything", 0x0000, 18),
    ("a low word alone", 0x0007, 1),
    ("from the middle of one to the middle of the next", 0x0005, 2),
]

KEPT = [
    ("controlword", 0x0000, [0xFFFF]),
    ("mode 1", 0x0002, [1]),
    ("mode 6", 0x0002, [6]),
    ("target", 0x0004, [0x0001, 0x86A0]),
    ("least target", 0x0004, [0x8000, 0x0000]),
    ("greatest target", 0x0004, [0x7FFF, 0xFFFF]),
    ("no velocity", 0x0008, [0, 0]),
    ("greatest velocity", 0x0008, [0, 40000]),
    ("least acceleration", 0x000A, [0, 1]),
    ("greatest acceleration", 0x000A, [0xFFFF, 0xFFFF]),
    ("velocity and acceleration at once", 0x0008, [0, 1234, 1, 2]),
    ("watchdog off", 0x0010, [0]),
    ("longest watchdog", 0x0010, [65535]),
]

REFUSED_WRITES = [
    ("statusword", 0x0001, [0], 2),
    ("modes display", 0x0003, [1], 2),
    ("position actual", 0x0006, [0, 0], 2),
    ("following error", 0x000C, [0, 0], 2),
    ("error code", 0x000E, [0], 2),
    ("digital inputs", 0x000F, [0], 2),
    ("settle", 0x0011, [0], 2),
    ("beyond the table", 0x0012, [0], 2),
    ("far beyond the table", 0xFFFF, [0, 0], 2),
    ("over a read-only register", 0x0000, [6, 0, 1], 2),
    ("half a target before a read-only one", 0x0005, [0, 0], 2),
    ("past the end", 0x0010, [0, 0, 0], 2),
    ("high half of the target", 0x0004, [0], 3),
    ("low half of the target", 0x0005, [0], 3),
    ("high half of the velocity", 0x0008, [0], 3),
    ("a velocity and half an acceleration", 0x0008, [0, 99, 0], 3),
    ("half a velocity and an acceleration", 0x0009, [99, 0, 99], 3),
    ("mode 0", 0x0002, [0], 3),
    ("mode 3", 0x0002, [3], 3),
    ("acceleration 0", 0x000A, [0, 0], 3),
    ("good velocity, acceleration 0", 0x0008, [0, 99, 0, 0], 3),
    ("nothing", 0x0000, [], 3),
    ("more than function 16 carries", 0x0000, [0] * 124, 3),
]

REFUSED_READS = [
    ("nothing", 0x0000, 0, 3),
    ("more than function 3 carries", 0x0000, 126, 3),
    ("quantity is checked before address", 0x4000, 126, 3),
    ("beyond the table", 0x0012, 1, 2),
    ("past the end", 0x0011, 2, 2),
    ("past the last address", 0xFFFF, 2, 2),
]


@pytest.mark.parametrize(("name", "address", "count"), READABLE)
def test_every_register_is_read(unit, name, address, count):
    words = unit.bus.read(1, address, count)
    assert len(words) == count
    assert all(0 <= word <= 0xFFFF for word in words)


@pytest.mark.parametrize(("name", "address", "words"), KEPT)
def test_what_is_written_is_kept(unit, name, address, words):
    unit.write(address, *words)
    assert unit.bus.read(1, address, len(words)) == words


@pytest.mark.parametrize(("name", "address", "words", "code"), REFUSED_WRITES)
def test_a_refused_write_changes_nothing(unit, name, address, words, code):
    before = unit.read(0x0000, 12)
    assert unit.refusal(unit.write, address, *words) == code
    assert unit.read(0x0000, 12) == before


@pytest.mark.parametrize(("name", "address", "count", "code"), REFUSED_READS)
def test_a_refused_read(unit, name, address, count, code):
    assert unit.refusal(unit.read, address, count) == code


def test_resets(unit):
    unit.clock.sleep(10.0)
    words = unit.read(0x0000, 18)
    assert words[0x00] == words[0x02] == words[0x03] == words[0x0E] == words[0x10] == 0
    assert words[0x01] & 0x4F == 0x40
    assert words[0x04:0x06] == [0, 0]
    assert words[0x08:0x0A] != [0, 0]
    assert words[0x0A:0x0C] != [0, 0]
    assert words[0x0C:0x0E] == [0, 0]
    assert words[0x11] == 0


@pytest.mark.parametrize(("axis", "limit"), [(1, 40000), (2, 60000), (3, 40000), (4, 60000)])
def test_velocity_is_clamped_to_the_axis(unit, axis, limit):
    unit.bus.write(axis, 0x0008, [0xFFFF, 0xFFFF])
    assert unit.bus.read(axis, 0x0008, 2) == [0, limit]


def test_the_velocity_limit_is_rounded_up_to_a_count(camera, clock, tmp_path):
    text = default_rig().model_dump()
    text["axis"]["view_theta"] |= {"max_velocity_deg_s": 10.0002}
    twin = Twin(Rig.model_validate(text), camera, clock, tmp_path, seed=0)
    twin.bus.write(1, 0x0008, [1, 0])
    assert twin.bus.read(1, 0x0008, 2) == [0, 20001]


def test_a_unit_that_is_not_there(unit):
    assert unit.refusal(unit.bus.read, 5, 0x0001, 1) == 0x0B
    assert unit.refusal(unit.bus.write, 0, 0x0000, [6]) == 0x0B


def test_on_rtu_nobody_answers_for_it(camera, clock, tmp_path):
    text = default_rig().model_dump()
    text["arm"] |= {"transport": "rtu", "device": "/dev/ttyUSB1"}
    twin = Twin(Rig.model_validate(text), camera, clock, tmp_path, seed=0)
    with pytest.raises(TransportTimeoutError, match="unit 5"):
        twin.bus.read(5, 0x0001, 1)
    assert clock.now() == pytest.approx(0.502)


def test_a_request_takes_two_milliseconds(unit, clock):
    before = clock.now()
    unit.read(0x0001)
    unit.write(0x0000, 0)
    assert clock.now() - before == pytest.approx(0.004)
