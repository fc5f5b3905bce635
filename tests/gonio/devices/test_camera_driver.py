"""Frames from the camera's folder: in time, whole, and never an old one."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gonio.devices import FolderCamera, LocalFolder
from gonio.devices.camera import check_whole
from gonio.errors import DeviceFaultError, FrameLostError, StorageError
from gonio.rig import default_rig
from tests.tiny import tiny_dng


def test_a_frame_is_moved_out_whole(bench, tmp_path):
    bench.lamps.identify()
    frame = bench.camera.expose(0.01)
    began = bench.clock.now()
    bench.camera.fetch(frame, tmp_path / "shot.dng")
    assert check_whole(tmp_path / "shot.dng") is None
    assert list(bench.folder.iterdir()) == []
    assert bench.clock.now() - began < 0.12


def test_a_frame_that_never_comes(bench, tmp_path):
    bench.twin.tether.loses_files = True
    frame = bench.camera.expose(0.01)
    began = bench.clock.now()
    with pytest.raises(DeviceFaultError, match=r"frame_000001.dng: did not come within 10 s"):
        bench.camera.fetch(frame, tmp_path / "shot.dng")
    assert 10.0 <= bench.clock.now() - began < 10.1


def test_an_old_frame_of_the_same_number_is_not_taken(bench, tmp_path):
    old = bench.folder / "frame_000001.dng"
    old.write_bytes(b"old")
    with pytest.raises(FrameLostError, match=r"frame_000001.dng: lay in the camera's folder"):
        bench.camera.expose(0.01)
    assert not (tmp_path / "shot.dng").exists()


def test_other_frames_are_left_alone(bench, tmp_path):
    (bench.folder / "frame_000007.dng").write_bytes(b"other")
    frame = bench.camera.expose(0.01)
    bench.camera.fetch(frame, tmp_path / "shot.dng")
    assert [path.name for path in bench.folder.iterdir()] == ["frame_000007.dng"]


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_truncated_frame(make_bench, tmp_path, share):
    bench = make_bench()
    whole = tiny_dng(1, 0.01)
    bench.sensor.data = whole[: int(share * len(whole))]
    frame = bench.camera.expose(0.01)
    with pytest.raises(DeviceFaultError, match=r"shot.dng: (has \d+ bytes of|is not a raw file)"):
        bench.camera.fetch(frame, tmp_path / "shot.dng")


@pytest.mark.parametrize("data", [b"", b"hello", b"II*\0\xff\xff\xff\xff", bytes(4096)])
def test_a_foreign_file(bench, tmp_path, data):
    bench.sensor.data = data
    frame = bench.camera.expose(0.01)
    with pytest.raises(DeviceFaultError, match="is not a raw file") as caught:
        bench.camera.fetch(frame, tmp_path / "shot.dng")
    assert "\n" not in str(caught.value)


def test_what_an_earlier_run_left_is_moved_aside(bench):
    for names in (["frame_000001.dng", "frame_000002.dng"], ["frame_000001.dng", ".x.part"]):
        for name in names:
            (bench.folder / name).write_text(name)
        assert bench.camera.prepare() == 2
        assert LocalFolder(bench.folder).names() == set()
    assert bench.camera.prepare() == 0
    kept = sorted(str(path.relative_to(bench.folder)) for path in bench.folder.glob("*/*"))
    assert kept == [
        "aside_000/frame_000001.dng",
        "aside_000/frame_000002.dng",
        "aside_001/.x.part",
        "aside_001/frame_000001.dng",
    ]


def test_half_written_files_are_no_frames(bench):
    (bench.folder / ".frame_000001.part").write_text("half")
    (bench.folder / "frame_000001.dng.part").write_text("half")
    assert LocalFolder(bench.folder).names() == set()


def test_a_folder_that_is_not_there(tmp_path, bench):
    camera = FolderCamera(LocalFolder(tmp_path / "gone"), bench.lamps, default_rig(), bench.clock)
    with pytest.raises(DeviceFaultError, match="no such folder"):
        camera.prepare()


def test_a_target_that_cannot_be_written(bench, tmp_path):
    frame = bench.camera.expose(0.01)
    with pytest.raises(StorageError, match=r"shot.dng"):
        bench.camera.fetch(frame, tmp_path / "gone" / "shot.dng")


def with_a_bit_flipped(data, bit):
    spoiled = bytearray(data)
    spoiled[bit // 8] ^= 1 << bit % 8
    return bytes(spoiled)


def test_any_flipped_bit_of_the_pixels_is_seen(tmp_path):
    path, data = tmp_path / "shot.dng", tiny_dng(1, 0.01)
    for bit in range(8 * (len(data) - 128), 8 * len(data), 7):
        path.write_bytes(with_a_bit_flipped(data, bit))
        with pytest.raises(FrameLostError, match="has other pixels than the camera wrote"):
            check_whole(path)


def test_a_flipped_bit_anywhere_is_refused_in_one_line_or_leaves_the_pixels(tmp_path, capfd):
    path, data, said = tmp_path / "shot.dng", tiny_dng(1, 0.01), []
    for bit in range(0, 8 * (len(data) - 128), 3):
        path.write_bytes(with_a_bit_flipped(data, bit))
        try:
            check_whole(path)
        except FrameLostError as error:
            said.append(str(error))
    assert len(said) > 100
    assert not any("\n" in line for line in said)
    assert capfd.readouterr() == ("", "")
