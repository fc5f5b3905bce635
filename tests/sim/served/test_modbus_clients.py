"""The protocol page's rules, as clients of four other libraries see them over TCP and RTU."""

from concurrent.futures import ThreadPoolExecutor

import pytest

READS = {
    "a register": ((1, 0x0002), [0]),
    "the whole table": ((2, 0x0000, 18), 18),
    "another unit": ((4, 0x0010), [0]),
    "half of a value": ((1, 0x0004), [0]),
    "over the table's end": ((1, 0x0011, 2), 2),
    "beyond the table": ((1, 0x0012), 2),
    "far beyond": ((1, 0xFFFF), 2),
    "input registers": ((1, 0x0001, 1, 4), 1),
}


@pytest.mark.parametrize(("request_", "expected"), READS.values(), ids=READS)
def test_reads(client, request_, expected):
    answer = client.read(*request_)
    assert (len(answer) if expected == 18 else answer) == expected


WRITES = {
    "half of a value": (0x0004, (7,), 3),
    "a value and a half": (0x0008, (0, 500, 0), 3),
    "a read-only register": (0x0001, (7,), 2),
    "a span with a read-only register": (0x0002, (1, 1), 2),
    "a span with a gap": (0x0010, (50, 0, 0), 2),
    "a mode that is none": (0x0002, (3,), 3),
    "no acceleration": (0x000A, (0, 0), 3),
    "a good value before a bad one": (0x0008, (0, 500, 0, 0), 3),
}


@pytest.mark.parametrize(("address", "words", "code"), WRITES.values(), ids=WRITES)
def test_a_refused_write_changes_nothing(client, address, words, code):
    before = client.read(3, 0x0002, 1), client.read(3, 0x0008, 4), client.read(3, 0x0010)
    assert client.write(3, address, *words) == code
    assert before == (client.read(3, 0x0002, 1), client.read(3, 0x0008, 4), client.read(3, 0x0010))


@pytest.mark.parametrize(
    ("address", "value", "code"), [(0x0005, 7, 3), (0x0001, 7, 2), (0x12, 0, 2)]
)
def test_refused_single_writes(client, address, value, code):
    assert client.write(3, address, value, single=True) == code


def test_writes_are_read_back(client):
    assert client.write(2, 0x0004, 0xFFFF, 0xFFFE) == "done"
    assert client.read(2, 0x0004, 2) == [0xFFFF, 0xFFFE]
    assert client.write(2, 0x0004, 0, 0) == "done"
    assert client.write(2, 0x0010, 0, single=True) == "done"


def test_a_velocity_reads_back_as_clamped(client):
    before = client.read(2, 0x0008, 2)
    assert client.write(2, 0x0008, 0xFFFF, 0xFFFF) == "done"
    assert client.read(2, 0x0008, 2) == [0, 60000]
    client.write(2, 0x0008, *before)


@pytest.mark.parametrize("function", [3, 4])
def test_an_unknown_unit(client, function):
    expected = 0x0B if client.wire == "tcp" else "silence"
    assert client.read(9, 0x0001, 1, function) == expected
    assert client.read(1, 0x0002) == [0]


def test_many_clients_at_once_get_their_own_replies(tcp, connect):
    def ask(unit):
        client = connect(tcp)
        for value in range(50):
            client.write(unit, 0x0004, unit, value)
            assert client.read(unit, 0x0004, 2) == [unit, value]
            client.read(unit, 0x0000, 18)
        client.write(unit, 0x0004, 0, 0)

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(ask, (1, 2, 3, 4)))
