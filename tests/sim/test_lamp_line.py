"""The lamp line of the protocol page: requests and answers, byte for byte."""

from functools import reduce
from operator import xor

import pytest

from gonio.errors import TransportTimeoutError

UNKNOWN = b'ERR 100,"Unknown command"'
CHECKSUM = b'ERR 101,"Bad checksum"'
RANGE = b'ERR 200,"Number out of range"'


@pytest.fixture
def ask(twin):
    def request(line):
        twin.line.send(line)
        return twin.line.receive(0.2)

    return request


def summed(text):
    return text + b"*%02X" % reduce(xor, text)


CONVERSATIONS = [
    ("identity", [(b"*IDN?", b"gonio,simulated lamp head,0001,1.0")]),
    ("reset", [(b"LED1:CURR?", b"0.0"), (b"LED1:STAT?", b"0"), (b"LED1:FLUX?", b"0.00000")]),
    ("current", [(b"LED1:CURR 350", b"OK"), (b"LED1:CURR?", b"350.0")]),
    ("one decimal", [(b"LED11:CURR 0.1", b"OK"), (b"LED11:CURR?", b"0.1")]),
    ("least current", [(b"LED1:CURR 0", b"OK"), (b"LED1:CURR?", b"0.0")]),
    ("most current", [(b"LED1:CURR 700.0", b"OK"), (b"LED1:CURR?", b"700.0")]),
    ("on and off", [(b"LED2:STAT ON", b"OK"), (b"LED2:STAT?", b"1")]),
    ("off", [(b"LED2:STAT ON", b"OK"), (b"LED2:STAT OFF", b"OK"), (b"LED2:STAT?", b"0")]),
    (
        "all off",
        [
            (b"LED2:STAT ON", b"OK"),
            (b"LED9:STAT ON", b"OK"),
            (b"ALL:OFF", b"OK"),
            (b"LED2:STAT?", b"0"),
            (b"LED9:STAT?", b"0"),
        ],
    ),
    ("no light when off", [(b"LED1:CURR 700", b"OK"), (b"LED1:FLUX?", b"0.00000")]),
    ("cold junction", [(b"LED1:TEMP?", b"23.0")]),
    ("no exposure yet", [(b"TRIG:STAT?", b"IDLE")]),
    ("nothing to abort", [(b"TRIG:ABRT", b"OK"), (b"TRIG:STAT?", b"IDLE")]),
    ("watchdog", [(b"SYST:WDOG 0", b"OK"), (b"SYST:WDOG 3600000", b"OK")]),
    ("no error", [(b"SYST:ERR?", b'0,"No error"')]),
    ("carriage return", [(b"LED1:STAT?\r", b"0")]),
    ("number", [(b"#7 LED1:STAT?", b"#7 0"), (b"#99 ALL:OFF", b"#99 OK")]),
    ("number as written", [(b"#07 LED1:STAT?", b"#07 0")]),
    ("known checksum", [(b"LED1:STAT?*6B", b"0*30")]),
    ("checksum and number", [(summed(b"#42 LED1:STAT?"), summed(b"#42 0"))]),
    ("checksum in small letters", [(summed(b"*IDN?").lower().replace(b"idn", b"IDN"),
                                    summed(b"gonio,simulated lamp head,0001,1.0"))]),
    ("checksum before a carriage return", [(summed(b"ALL:OFF") + b"\r", summed(b"OK"))]),
    ("bad checksum", [(b"LED1:STAT?*00", summed(CHECKSUM))]),
    ("bad checksum with a number", [(b"#5 ALL:OFF*00", summed(b"#5 " + CHECKSUM))]),
    ("empty", [(b"", UNKNOWN)]),
    ("empty but for a number", [(b"#5 ", b"#5 " + UNKNOWN)]),
    ("empty but for a checksum", [(b"*00", summed(UNKNOWN))]),
    ("unknown", [(b"LED1:COLOR?", UNKNOWN)]),
    ("small letters", [(b"all:off", UNKNOWN)]),
    ("lamp 0", [(b"LED0:STAT?", RANGE)]),
    ("lamp 12", [(b"LED12:STAT ON", RANGE)]),
    ("too much current", [(b"LED1:CURR 700.1", RANGE), (b"LED1:CURR?", b"0.0")]),
    ("negative current", [(b"LED1:CURR -1", RANGE)]),
    ("two decimals", [(b"LED1:CURR 1.25", UNKNOWN)]),
    ("no number", [(b"LED1:CURR", UNKNOWN)]),
    ("not a number", [(b"LED1:CURR ON", UNKNOWN)]),
    ("a question with an answer in it", [(b"LED1:CURR? 5", UNKNOWN)]),
    ("neither on nor off", [(b"LED1:STAT 1", UNKNOWN)]),
    ("a query as a command", [(b"LED1:TEMP 20", UNKNOWN)]),
    ("two spaces", [(b"LED1:CURR  5", UNKNOWN)]),
    ("space at the end", [(b"ALL:OFF ", UNKNOWN)]),
    ("no exposure", [(b"TRIG:EXP 0", RANGE)]),
    ("too long an exposure", [(b"TRIG:EXP 300000001", RANGE)]),
    ("half a microsecond", [(b"TRIG:EXP 0.5", UNKNOWN)]),
    ("too long a watchdog", [(b"SYST:WDOG 3600001", RANGE)]),
    ("three digits are no number", [(b"#100 ALL:OFF", UNKNOWN)]),
    ("a number without a space", [(b"#7ALL:OFF", UNKNOWN)]),
    ("one digit is no checksum", [(b"ALL:OFF*1", UNKNOWN)]),
    ("three digits are no checksum", [(b"ALL:OFF*123", UNKNOWN)]),
    ("eight bits", [("LED1:STAT\u00a0ON".encode("latin-1"), UNKNOWN)]),
    ("longest line", [(b"X" * 119, UNKNOWN)]),
]  # fmt: skip


@pytest.mark.parametrize(("name", "talk"), CONVERSATIONS, ids=[name for name, _ in CONVERSATIONS])
def test_a_conversation(ask, name, talk):
    for request, answer in talk:
        assert ask(request) == answer


def test_at_most_120_bytes_with_the_line_feed(ask):
    padding = b"0" * (119 - len(b"TRIG:EXP 1"))
    assert ask(b"TRIG:EXP " + padding + b"1") == b"OK 1"
    assert ask(b"TRIG:EXP 0" + padding + b"1") == UNKNOWN
    assert ask(b"#3 TRIG:EXP " + padding + b"1") == b"#3 " + UNKNOWN


def test_errors_are_queued_in_order(ask):
    ask(b"NONSENSE")
    ask(b"LED0:STAT?")
    ask(b"ALL:OFF*00")
    assert ask(b"SYST:ERR?") == b'100,"Unknown command"'
    assert ask(b"SYST:ERR?") == b'200,"Number out of range"'
    assert ask(b"SYST:ERR?") == b'101,"Bad checksum"'
    assert ask(b"SYST:ERR?") == b'0,"No error"'


def test_the_queue_overflows_into_its_last_entry(ask):
    for _ in range(32):
        ask(b"NONSENSE")
    ask(b"LED0:STAT?")
    ask(b"LED0:STAT?")
    codes = [ask(b"SYST:ERR?").partition(b",")[0] for _ in range(33)]
    assert codes == [b"100"] * 31 + [b"350", b"0"]


def test_a_full_queue_that_is_read_has_room_again(ask):
    for _ in range(33):
        ask(b"NONSENSE")
    ask(b"SYST:ERR?")
    ask(b"LED0:STAT?")
    codes = [ask(b"SYST:ERR?").partition(b",")[0] for _ in range(33)]
    assert codes == [b"100"] * 30 + [b"350", b"200", b"0"]


def test_answers_come_in_order(twin):
    for number in (1, 2, 3):
        twin.line.send(b"#%d LED1:STAT?" % number)
    assert [twin.line.receive(0.2) for _ in range(3)] == [b"#1 0", b"#2 0", b"#3 0"]


def test_every_byte_takes_its_time(twin, clock):
    twin.line.send(b"*IDN?")
    assert clock.now() == pytest.approx(6 / 11520)
    answer = twin.line.receive(0.2)
    assert clock.now() == pytest.approx((6 + len(answer) + 2) / 11520)


def test_without_a_question_there_is_no_answer(twin, clock):
    with pytest.raises(TransportTimeoutError, match="no answer"):
        twin.line.receive(0.2)
    assert clock.now() == pytest.approx(0.2)
