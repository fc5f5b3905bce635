"""Whose file a file is: by shutter speeds as cameras write them, by dates of clocks gone wrong."""

from datetime import datetime, timedelta

import numpy as np
import pytest
import tifffile
from hypothesis import given
from hypothesis import strategies as st

from gonio.devices import LatentFrame
from gonio.devices.frame_check import FrameCheck
from gonio.devices.shutter_speeds import seconds_of, speed_for
from gonio.errors import BadInputError, FrameLostError

RIGHT = datetime(2026, 3, 1, 23, 59, 30)


@pytest.mark.parametrize(
    ("speed", "seconds"),
    [("1/250", 0.004), ("0.0100s", 0.01), ('2"', 2.0), ("30", 30.0), ("10/13", 10 / 13),
     ("1/1.3", 1 / 1.3), ("0.3 s", 0.3), ("bulb", None), ("0", None), ("1/0", None)],
)  # fmt: skip
def test_speeds_as_cameras_write_them(speed, seconds):
    assert seconds_of(speed) == (seconds and pytest.approx(seconds))


@given(st.lists(st.integers(1, 8000), min_size=1), st.floats(1e-4, 1.5))
def test_a_speed_is_chosen_that_keeps_the_exposure_or_none(parts, exposure_s):
    choices = ["bulb", *(f"1/{part}" for part in parts)]
    near = [part for part in parts if abs(1 / part - exposure_s) <= 0.01 * exposure_s + 1e-4]
    if near:
        best = min(abs(1 / part - exposure_s) for part in parts)
        assert abs(seconds_of(speed_for(exposure_s, choices)) - exposure_s) == pytest.approx(best)
    else:
        with pytest.raises(BadInputError, match="camera: has no exposure of"):
            speed_for(exposure_s, choices)


def admit(check, folder, number, triggered_s, date, exposure_s=1.0):
    path = folder / f"{number}.tif"
    text = date.strftime("%Y:%m:%d %H:%M:%S")
    tifffile.imwrite(path, np.full((2, 2), number, np.uint16), datetime=text)
    frame = LatentFrame(number, path.name, exposure_s, triggered_s, (0.0,) * 11)
    check.admit(frame, path)


@given(
    wrong_s=st.floats(-1e9, 1e9),
    waits_s=st.lists(st.floats(1.0, 4000.0), min_size=1, max_size=5),
    writes_s=st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6),
)
def test_a_clock_need_not_be_right(tmp_path_factory, wrong_s, waits_s, writes_s):
    check, folder, now = FrameCheck(), tmp_path_factory.mktemp("frames"), 0.0
    for number, wait_s in enumerate(waits_s):
        now += wait_s
        date = RIGHT + timedelta(seconds=wrong_s + now + writes_s[number])
        admit(check, folder, number, now, date)


@given(wait_s=st.floats(5.0, 1e5))
def test_the_file_of_an_earlier_exposure_is_too_old(tmp_path_factory, wait_s):
    check, folder = FrameCheck(), tmp_path_factory.mktemp("frames")
    admit(check, folder, 1, 0.0, RIGHT)
    with pytest.raises(FrameLostError, match=r"2.tif: is \d+ s older than its exposure"):
        admit(check, folder, 2, wait_s, RIGHT)


def test_a_clock_that_is_set_back_costs_one_frame(tmp_path):
    check, hour = FrameCheck(), timedelta(hours=1)
    admit(check, tmp_path, 1, 0.0, RIGHT)
    with pytest.raises(FrameLostError, match="older"):
        admit(check, tmp_path, 2, 10.0, RIGHT - hour)
    admit(check, tmp_path, 3, 20.0, RIGHT - hour + timedelta(seconds=10))


def test_the_same_content_without_a_unique_id(tmp_path):
    check = FrameCheck()
    admit(check, tmp_path, 7, 0.0, RIGHT)
    (tmp_path / "8.tif").write_bytes((tmp_path / "7.tif").read_bytes())
    with pytest.raises(FrameLostError, match=r"8.tif: has the content of frame 7 \(7.tif\)"):
        check.admit(LatentFrame(8, "8.tif", 1.0, 1.0, (0.0,) * 11), tmp_path / "8.tif")
