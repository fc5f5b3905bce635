import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.devices.registers import from_words, to_words
from gonio.devices.states import DriveState, state_of

INT32 = st.integers(-(2**31), 2**31 - 1)


@given(INT32)
def test_signed_values_survive(value):
    assert from_words(to_words(value, 2), signed=True) == value


@given(st.integers(0, 2**32 - 1))
def test_unsigned_values_survive(value):
    assert from_words(to_words(value, 2), signed=False) == value


def test_the_high_word_comes_first():
    assert to_words(0x12345678, 2) == [0x1234, 0x5678]
    assert to_words(-2, 2) == [0xFFFF, 0xFFFE]
    assert to_words(0xABCD, 1) == [0xABCD]


STATES = [
    (0b0000_0000, DriveState.NOT_READY),
    (0b0010_0000, DriveState.NOT_READY),
    (0b0100_0000, DriveState.SWITCH_ON_DISABLED),
    (0b0110_0000, DriveState.SWITCH_ON_DISABLED),
    (0b0010_0001, DriveState.READY),
    (0b0010_0011, DriveState.SWITCHED_ON),
    (0b0010_0111, DriveState.ENABLED),
    (0b0000_0111, DriveState.QUICK_STOP),
    (0b0000_1111, DriveState.FAULT_REACTION),
    (0b0010_1111, DriveState.FAULT_REACTION),
    (0b0000_1000, DriveState.FAULT),
    (0b0010_1000, DriveState.FAULT),
]


@pytest.mark.parametrize("others", [0x0000, 0xFF90, 0x0210, 0x8100])
@pytest.mark.parametrize(("bits", "state"), STATES)
def test_states_are_told_under_their_masks(bits, state, others):
    assert state_of(bits | others) is state
