"""The lamp head's driver against the twin's lamp line, through the transport seam."""

from functools import reduce
from operator import xor

import pytest

from gonio.devices import Identity
from gonio.errors import BadInputError, DeviceFaultError, TransportTimeoutError
from gonio.plan import LampSetting

TWO = (LampSetting(n=2, mA=350), LampSetting(n=11, mA=123.4))


def lit(bench):
    return {n: led.current_mA for n, led in enumerate(bench.twin.lamps.leds, 1) if led.on}


@pytest.fixture
def greeted(bench):
    bench.lamps.identify()
    bench.line.sent.clear()
    bench.line.received = 0
    return bench


def test_who_is_there(bench):
    assert bench.lamps.identify() == Identity("gonio", "simulated lamp head", "0001", "1.0")


def test_every_request_is_numbered_and_checksummed(bench):
    bench.lamps.identify()
    bench.lamps.apply(TWO)
    assert bench.line.sent[0] == b"#1 *IDN?*64"
    for number, line in enumerate(bench.line.sent, 1):
        assert line.startswith(b"#%d " % (number % 100))
        assert line[-3:-2] == b"*"


def test_greeting_closes_a_shutter_and_forgets_errors(bench):
    for line in (b"TRIG:EXP 100000000", b"NONSENSE", b"NONSENSE"):
        bench.twin.line.send(line)
        bench.twin.line.receive(0.2)
    bench.lamps.identify()
    assert bench.lamps.expose(0.01).frame == 2


def test_lamps_are_lit_and_others_switched_off(greeted):
    greeted.lamps.apply((LampSetting(n=5, mA=700),))
    greeted.lamps.apply(TWO)
    assert lit(greeted) == {2: 350.0, 11: 123.4}
    greeted.lamps.off()
    assert lit(greeted) == {}


def test_currents_are_set_to_a_tenth(greeted):
    greeted.lamps.apply((LampSetting(n=1, mA=100.26),))
    assert lit(greeted) == {1: 100.3}


def test_what_is_right_already_is_only_read(greeted):
    greeted.lamps.apply(TWO)
    greeted.line.sent.clear()
    greeted.lamps.apply(TWO)
    assert all(b"?" in line for line in greeted.line.sent)
    assert len(greeted.line.sent) == 14


def test_lamps_that_the_watchdog_took_are_lit_again(greeted):
    greeted.lamps.apply(TWO)
    greeted.clock.sleep(31.0)
    greeted.lamps.apply(TWO)
    assert lit(greeted) == {2: 350.0, 11: 123.4}


def test_a_lamp_that_the_rig_does_not_have(make_bench, rig_with):
    bench = make_bench(rig_with("lamps", lamp=({"n": 1, "x_mm": 0.0, "y_mm": 0.0},)))
    with pytest.raises(BadInputError, match="lamp 2 is not in the rig file"):
        bench.lamps.apply(TWO)


def test_an_exposure(greeted):
    greeted.lamps.apply(TWO)
    began = greeted.clock.now()
    first = greeted.lamps.expose(0.2)
    assert 0.2 < greeted.clock.now() - began < 0.3
    assert first.frame == 1
    assert [n for n, flux in enumerate(first.flux, 1) if flux] == [2, 11]
    assert first.flux[1] == pytest.approx(0.53, abs=0.01)
    assert greeted.lamps.expose(0.01).frame == 2


def test_a_dark_exposure(greeted):
    greeted.lamps.off()
    assert greeted.lamps.expose(0.1).flux == (0.0,) * 11


def test_the_lamps_stay_on_through_an_exposure_longer_than_the_watchdog(greeted):
    greeted.lamps.apply(TWO)
    exposure = greeted.lamps.expose(120.0)
    assert exposure.flux[1] > 0.5
    # asked now and then, not all the time
    assert len([line for line in greeted.line.sent if b"TRIG:STAT?" in line]) < 20


def test_a_busy_camera_is_asked_again(greeted):
    greeted.lamps.expose(0.01)
    exposure = greeted.lamps.expose(0.01)
    assert exposure.frame == 2
    tries = [line for line in greeted.line.sent if b"TRIG:EXP" in line]
    assert len(tries) > 2


def test_a_camera_that_stays_busy(make_bench, rig_with):
    bench = make_bench(None, rig_with("camera", file_timeout_s=1000.0))
    bench.lamps.identify()
    bench.twin.tether.loses_files = True
    bench.lamps.expose(0.01)
    began = bench.clock.now()
    with pytest.raises(DeviceFaultError, match="camera busy"):
        bench.lamps.expose(0.01)
    assert 10.0 < bench.clock.now() - began < 11.0


def lose_cooling(bench):
    bench.twin.lamps.leds[1].lose_cooling(bench.clock.now())


DURING = [
    (
        "interlock",
        lambda bench: bench.twin.set_interlock(True),
        r"lamps: lamp 2, 11 went out in frame 1 \(400, interlock open\); close the door",
    ),
    (
        "burnt out",
        lambda bench: bench.twin.lamps.break_circuit(11),
        r"lamps: lamp 11 went out in frame 1 \(301, open circuit\); check the lamp",
    ),
    ("too hot", lose_cooling, r"lamps: lamp 2 went out in frame 1 \(300, over-temperature\); let"),
    (
        "switched off by somebody",
        lambda bench: bench.twin.lamps.all_off(),
        r"lamps: lamp 2, 11 went out in frame 1 \(no error queued\); check supply",
    ),
]


@pytest.mark.parametrize(("name", "event", "message"), DURING, ids=[name for name, *_ in DURING])
def test_a_frame_in_which_a_lamp_goes_out_is_refused(greeted, name, event, message):
    greeted.lamps.apply((LampSetting(n=2, mA=700), LampSetting(n=11, mA=350)))
    greeted.at(1.0, lambda: event(greeted))
    with pytest.raises(DeviceFaultError, match=message) as caught:
        greeted.lamps.expose(60.0)
    assert "\n" not in str(caught.value)


def test_what_happened_before_the_lamps_were_set_is_over(greeted):
    greeted.lamps.apply(TWO)
    greeted.twin.set_interlock(True)
    greeted.twin.set_interlock(False)
    greeted.lamps.apply(TWO)
    assert greeted.lamps.expose(0.01).flux[1] > 0.5


def test_an_open_interlock_refuses_light(greeted):
    greeted.twin.set_interlock(True)
    with pytest.raises(DeviceFaultError, match=r"LED2:STAT ON was refused \(400, interlock open\)"):
        greeted.lamps.apply(TWO)


def test_a_burnt_out_lamp_refuses(greeted):
    greeted.twin.lamps.break_circuit(11)
    with pytest.raises(DeviceFaultError, match=r"LED11:STAT ON was refused \(301, open circuit\)"):
        greeted.lamps.apply(TWO)


def test_a_head_that_restarts_during_an_exposure(greeted):
    greeted.at(0.5, greeted.twin.lamps.shutter.abort)
    with pytest.raises(DeviceFaultError, match="frame 1 was under way, and now the head says IDLE"):
        greeted.lamps.expose(1.0)


def test_a_shutter_that_stays_open(greeted):
    protocol = greeted.twin.line._protocol
    protocol._plain["TRIG:STAT?"] = lambda: "OPEN 1"
    with pytest.raises(DeviceFaultError, match="was to close after 1 s and is still open"):
        greeted.lamps.expose(1.0)
    assert greeted.clock.now() < 5.0


def test_something_else_on_the_port(bench):
    def chatter(timeout_s):
        bench.clock.sleep(0.01)
        return b"ok\x80"

    bench.twin.line.receive = chatter
    with pytest.raises(TransportTimeoutError, match="no answer; check device"):
        bench.lamps.identify()


@pytest.mark.parametrize("status", ["DONE 1 0.5", "DONE 1 nan", "DONE x", "DONE inf", "", "OK"])
def test_a_status_that_makes_no_sense(greeted, status):
    greeted.twin.line._protocol._plain["TRIG:STAT?"] = lambda: status
    with pytest.raises(DeviceFaultError, match=r"lamps: .*; (check|it may have)") as caught:
        greeted.lamps.expose(0.01)
    assert "\n" not in str(caught.value)


def test_something_else_that_speaks_the_dialect(bench):
    bench.line.back = {0: lambda answer: b"#1 OK" + b"*%02X" % (0x12 ^ 0x20 ^ 0x04)}
    with pytest.raises(DeviceFaultError, match="'OK' is not how a lamp head introduces itself"):
        bench.lamps.identify()


SPOILED = [
    ("request lost", "out", lambda line: None),
    ("request garbled", "out", lambda line: line.replace(b":", b";")),
    ("request garbled into eight bits", "out", lambda line: b"\xff" + line[1:]),
    ("checksum of the request lost", "out", lambda line: line[:-1]),
    ("answer lost", "back", lambda answer: None),
    ("answer garbled", "back", lambda answer: answer[:-4] + b"x" + answer[-3:]),
    ("answer cut short", "back", lambda answer: answer[:4]),
]


@pytest.mark.parametrize(("name", "way", "spoil"), SPOILED, ids=[name for name, *_ in SPOILED])
def test_what_the_line_spoils_once_is_made_good(make_bench, name, way, spoil):
    for number in range(27):
        bench = make_bench()
        bench.lamps.identify()
        bench.lamps.expose(0.01)
        bench.clock.sleep(1.0)
        first = len(bench.line.sent) if way == "out" else bench.line.received
        getattr(bench.line, way)[first + number] = spoil
        bench.lamps.apply(TWO)
        exposure = bench.lamps.expose(0.1)
        assert lit(bench) == {2: 350.0, 11: 123.4}
        # exactly one exposure, however its trigger went
        assert exposure.frame == 2
        assert exposure.flux[1] > 0.5
        assert number + first < (len(bench.line.sent) if way == "out" else bench.line.received)


def test_a_late_answer_is_not_taken_for_the_next_one(greeted):
    late = []
    greeted.line.back = {0: late.append}
    # comes back before the answer to the repeated request
    greeted.line.out = {1: lambda line: greeted.twin.line._answers.append(late[0]) or line}
    greeted.lamps.apply(TWO)
    assert lit(greeted) == {2: 350.0, 11: 123.4}
    assert [line[:-3].partition(b" ")[2] for line in greeted.line.sent[:2]] == [b"SYST:ERR?"] * 2


def test_a_line_that_stays_silent(bench):
    bench.line.out = dict.fromkeys(range(100), lambda line: None)
    with pytest.raises(TransportTimeoutError, match="no answer"):
        bench.lamps.identify()


LATE = {
    "of a command": (b"LED2:STAT ON", b'ERR 400,"Interlock open"', 2),
    "of a command that came garbled": (b"LED2:STAT ON", b'ERR 101,"Bad checksum"', 2),
    "of a query, which is read back": (b"LED2:CURR?", b'ERR 400,"Interlock open"', 3),
}


def summed(text):
    return text + b"*%02X" % reduce(xor, text)


@pytest.mark.parametrize(("command", "error", "sent"), LATE.values(), ids=LATE)
def test_a_late_error_is_not_taken_for_that_of_the_next_request(greeted, command, error, sent):
    """The first try is answered by an error that comes only after the second was sent."""
    tries = []

    def delay(request):
        if command not in request:
            return request
        tries.append(request)
        if len(tries) == 2:
            number = tries[0].partition(b" ")[0]
            greeted.twin.line._answers.append(summed(number + b" " + error))
        return None if len(tries) == 1 else request

    greeted.line.out = dict.fromkeys(range(200), delay)
    greeted.lamps.apply(TWO)
    assert lit(greeted) == {2: 350.0, 11: 123.4}
    # once lost, once more: nothing else was sent because of the error
    assert [request.partition(b" ")[2][:-3] for request in greeted.line.sent].count(command) == sent


def test_an_error_that_lost_its_number_is_that_of_the_open_request(greeted):
    """Then nobody waits until the time for the answer is over."""
    greeted.line.out = {0: lambda request: b"*" + request}
    began_s = greeted.clock.now()
    greeted.lamps.apply(TWO)
    assert lit(greeted) == {2: 350.0, 11: 123.4}
    assert greeted.clock.now() - began_s < 0.5
