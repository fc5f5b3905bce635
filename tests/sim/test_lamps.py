"""Lamps that warm up, fail and go out; exposures and what they measure."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.led import Led

OK = b"OK"


@pytest.fixture
def ask(twin):
    def request(line):
        twin.line.send(line)
        return twin.line.receive(0.2)

    return request


@pytest.fixture
def errors(ask):
    def codes():
        found = []
        while (code := int(ask(b"SYST:ERR?").partition(b",")[0])) != 0:
            found.append(code)
        return found

    return codes


def fluxes(status):
    state, frame, values = status.decode().split(" ")
    assert state == "DONE"
    return int(frame), [float(value) for value in values.split(",")]


def light(ask, *lamps, current=b"700"):
    for n in lamps:
        assert ask(b"LED%d:CURR %s" % (n, current)) == OK
        assert ask(b"LED%d:STAT ON" % n) == OK


def test_a_lamp_warms_up_and_droops(ask, clock):
    light(ask, 3)
    cold = float(ask(b"LED3:FLUX?"))
    assert cold == pytest.approx(1.0, abs=0.006)
    clock.sleep(20.0)
    assert float(ask(b"LED3:TEMP?")) == pytest.approx(65.0 - 42.0 * math.exp(-1), abs=0.1)
    clock.sleep(600.0)
    assert ask(b"LED3:TEMP?") == b"65.0"
    assert float(ask(b"LED3:FLUX?")) == pytest.approx(0.9, abs=0.01)


def test_flux_is_one_at_the_reference_point():
    led = Led(0.0)
    led.set(0.0, current_mA=700.0, on=True)
    at_25 = 20.0 * math.log(42.0 / 40.0)
    assert led.temperature_c(at_25) == pytest.approx(25.0)
    assert led.flux(at_25) == pytest.approx(1.0)


def test_less_current_less_light(ask):
    light(ask, 1, current=b"350")
    assert 0.5 < float(ask(b"LED1:FLUX?")) < 0.6


@given(
    st.lists(
        st.tuples(st.floats(0.01, 30.0), st.floats(0.0, 700.0), st.booleans()),
        min_size=1,
        max_size=4,
    ),
    st.sampled_from([0.0, 0.5, 3.0]),
)
def test_the_dose_is_the_integral_of_the_flux(changes, electronics_s):
    led, now, total = Led(0.0), 0.0, 0.0
    led.electronics_s = electronics_s
    for duration, current, on in changes:
        led.set(now, current_mA=current, on=on)
        steps = 2000
        middle = [now + duration * (i + 0.5) / steps for i in range(steps)]
        total += sum(led.flux(time) for time in middle) * duration / steps
        now += duration
    assert led.dose_s(now) == pytest.approx(total, rel=1e-4, abs=1e-6)


@given(st.floats(1e-6, 1e-3), st.floats(0, 10), st.floats(1, 700), st.floats(1, 700))
def test_the_light_follows_a_new_current_exponentially(time_s, units, before_mA, after_mA):
    slow, quick = Led(0.0), Led(0.0)
    slow.electronics_s = time_s
    for led in (slow, quick):
        led.set(0.0, current_mA=before_mA, on=True)
    start = quick.flux(60.0)
    for led in (slow, quick):
        led.set(60.0, current_mA=after_mA)
    end = quick.flux(60.0)
    expected = end + (start - end) * math.exp(-units)
    assert slow.flux(60.0 + units * time_s) == pytest.approx(expected, rel=1e-3)


@given(st.lists(st.tuples(st.floats(0.0, 10.0), st.floats(0.0, 700.0)), min_size=2, max_size=5))
def test_with_slow_electronics_no_light_jumps(changes):
    led, now = Led(0.0), 0.0
    led.electronics_s = 3.0
    led.set(now, on=True)
    for duration, current in changes:
        now += duration
        before = led.flux(now)
        led.set(now, current_mA=current)
        assert led.flux(now) == pytest.approx(before, abs=1e-9)


def test_the_camera_is_told_how_warm_lamps_and_sensor_were(ask, clock, camera):
    light(ask, 1)
    cool = float(ask(b"LED1:TEMP?"))
    ask(b"TRIG:EXP 20000000")
    clock.sleep(20.2)
    warm = float(ask(b"LED1:TEMP?"))
    first = camera.asked[-1]["warmth"]
    assert first.junctions_c[0] == pytest.approx((cool + warm) / 2, abs=0.3)
    assert (first.junctions_c[1:] == 23.0).all()
    assert first.sensor == pytest.approx((1 - math.exp(-20 / 300)) / 2, abs=1e-3)
    clock.sleep(600.0)
    ask(b"TRIG:EXP 1000")
    clock.sleep(0.2)
    left = 2 * first.sensor * math.exp(-600.2 / 300)
    assert camera.asked[-1]["warmth"].sensor == pytest.approx(left, rel=0.01)


def test_an_exposure_from_open_to_done(ask, clock):
    light(ask, 1, 5)
    assert ask(b"TRIG:EXP 500000") == b"OK 1"
    assert ask(b"TRIG:STAT?") == b"OPEN 1"
    clock.sleep(0.5)
    frame, flux = fluxes(ask(b"TRIG:STAT?"))
    assert frame == 1
    assert [n for n, value in enumerate(flux, 1) if value] == [1, 5]
    clock.sleep(100.0)
    assert fluxes(ask(b"TRIG:STAT?")) == (1, flux), "DONE stays"
    assert ask(b"TRIG:EXP 1") == b"OK 2"


def test_the_flux_is_the_mean_over_the_exposure(ask, clock):
    light(ask, 1)
    ask(b"TRIG:EXP 2000000")
    clock.sleep(0.5)
    ask(b"LED1:STAT OFF")
    clock.sleep(2.0)
    _, flux = fluxes(ask(b"TRIG:STAT?"))
    assert flux[0] == pytest.approx(0.25, abs=0.003)


def test_an_exposure_is_not_shortened_by_looking_late(ask, clock):
    light(ask, 1)
    ask(b"TRIG:EXP 1000000")
    clock.sleep(1000.0)
    _, flux = fluxes(ask(b"TRIG:STAT?"))
    assert flux[0] == pytest.approx(1.0, abs=0.01)


def test_abort(ask, clock, tmp_path):
    ask(b"TRIG:EXP 1000000")
    assert ask(b"TRIG:ABRT") == OK
    assert ask(b"TRIG:STAT?") == b"IDLE"
    assert ask(b"TRIG:EXP 1000") == b"OK 2"
    clock.sleep(5.0)
    assert [path.name for path in tmp_path.iterdir()] == ["frame_000002.dng"]
    assert ask(b"TRIG:ABRT") == OK
    assert fluxes(ask(b"TRIG:STAT?"))[0] == 2, "without an open shutter nothing changes"


def test_the_camera_is_busy_until_the_file_is_there(ask, clock, tmp_path):
    busy = b'ERR 500,"Camera busy"'
    ask(b"TRIG:EXP 200000")
    assert ask(b"TRIG:EXP 200000") == busy
    clock.sleep(0.2)
    assert ask(b"TRIG:STAT?").startswith(b"DONE 1")
    assert ask(b"TRIG:EXP 200000") == busy
    clock.sleep(0.1)
    assert (tmp_path / "frame_000001.dng").exists()
    assert ask(b"TRIG:EXP 200000") == b"OK 2"


def test_a_file_that_never_comes_keeps_it_busy_for_the_file_timeout(ask, clock, twin):
    twin.tether.loses_files = True
    ask(b"TRIG:EXP 200000")
    clock.sleep(10.1)
    assert ask(b"TRIG:EXP 200000").startswith(b"ERR 500")
    clock.sleep(0.1)
    assert ask(b"TRIG:EXP 200000") == b"OK 2"


def test_the_interlock_forces_the_lamps_off(ask, errors, twin):
    light(ask, 1, 2)
    twin.set_interlock(True)
    assert ask(b"LED1:STAT?") == b"0"
    assert errors() == [400]
    assert ask(b"LED1:STAT ON") == b'ERR 400,"Interlock open"'
    assert ask(b"LED1:CURR 100") == OK
    assert ask(b"TRIG:EXP 1000") == b"OK 1"
    assert errors() == [400]
    twin.set_interlock(False)
    assert ask(b"LED1:STAT?") == b"0"
    assert ask(b"LED1:STAT ON") == OK


def test_over_temperature(ask, errors, twin, clock):
    light(ask, 4)
    clock.sleep(300.0)
    twin.lamps.leds[3].lose_cooling(clock.now())
    # from 65 towards 107 deg C: 85 is passed after 12.9 s
    clock.sleep(12.8)
    assert ask(b"LED4:STAT?") == b"1"
    clock.sleep(0.2)
    assert ask(b"LED4:STAT?") == b"0"
    assert errors() == [300]
    assert ask(b"LED4:STAT ON") == b'ERR 300,"Lamp over-temperature"'
    clock.sleep(5.2)
    assert float(ask(b"LED4:TEMP?")) > 70.0
    assert ask(b"LED4:STAT ON").startswith(b"ERR 300")
    clock.sleep(0.4)
    assert float(ask(b"LED4:TEMP?")) < 70.0
    assert ask(b"LED4:STAT ON") == OK


def test_a_lamp_that_trips_during_an_exposure_shows_in_its_flux(ask, errors, twin, clock):
    light(ask, 4)
    clock.sleep(300.0)
    twin.lamps.leds[3].lose_cooling(clock.now())
    ask(b"TRIG:EXP 25800000")
    clock.sleep(30.0)
    _, flux = fluxes(ask(b"TRIG:STAT?"))
    # half the time lit, at 75 deg C on average
    assert flux[3] == pytest.approx(0.5 * 0.87, abs=0.01)
    assert errors() == [300]


def test_an_open_circuit(ask, errors, twin):
    light(ask, 7)
    twin.lamps.break_circuit(7)
    assert ask(b"LED7:STAT?") == b"0"
    assert errors() == [301]
    assert ask(b"LED7:STAT ON") == b'ERR 301,"Lamp open circuit"'


def test_the_watchdog_switches_off_and_says_nothing(ask, errors, clock):
    assert ask(b"SYST:WDOG 1000") == OK
    light(ask, 1)
    clock.sleep(0.9)
    assert ask(b"LED1:STAT?") == b"1"
    clock.sleep(0.9)
    assert ask(b"NONSENSE").startswith(b"ERR")
    clock.sleep(0.2)
    assert ask(b"LED1:STAT?") == b"0"
    assert errors() == [100]


def test_the_watchdog_bites_within_an_exposure_nobody_asks_about(ask, clock):
    ask(b"SYST:WDOG 1000")
    light(ask, 1)
    ask(b"TRIG:EXP 4000000")
    clock.sleep(5.0)
    _, flux = fluxes(ask(b"TRIG:STAT?"))
    assert flux[0] == pytest.approx(0.25, abs=0.005)
