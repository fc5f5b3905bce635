import pytest

from gonio.errors import BadFileError, BadInputError
from gonio.rig import AXES, default_rig, default_rig_text, load_rig

TEXT = default_rig_text()

WRONG = [
    # name, what stands in the file, what is put there, the field named, what is said of it
    ("missing key", "focal_px = 4000.0", "", "camera.focal_px", "is missing"),
    ("missing table", "[holder]", "[holders]", "holder", "is missing"),
    ("missing axis", "[axis.light_phi]", "[axis.spare]", "axis.light_phi", "is missing"),
    ("unknown key", "[lamps]", "[lamps]\ncolour = 1", "lamps.colour", "is not a known key"),
    ("word for number", "port = 502", 'port = "x"', "arm.port", "is no number"),
    ("port too high", "port = 502", "port = 70000", "arm.port", "out of range, 1 to 65535"),
    ("no host", 'host = "127.0.0.1"', "", "arm", "tcp needs host and port"),
    ("no device", '"tcp"', '"rtu"', "arm", "rtu needs device"),
    ("unknown transport", '"tcp"', '"can"', "arm.transport", "'tcp' or 'rtu'"),
    ("no scale", "= 2000.0", "= 0.0", "axis.view_theta", "1 to 1e9 is allowed"),
    ("scale not a number", "= 2000.0", "= nan", "axis.view_theta.counts_per_deg", "nan is out"),
    ("travel reversed", "max_deg = 91.0", "max_deg = -2.0", "axis.view_theta", "below max_deg"),
    ("counts overflow", "= 2000.0", "= 1e9", "axis.view_theta", "does not fit 32-bit counts"),
    ("no speed", "max_velocity_deg_s = 20.0", "max_velocity_deg_s = 0.0",
     "axis.view_theta.max_velocity_deg_s", "0.0 is out of range"),
    ("speed of light", "max_velocity_deg_s = 20.0", "max_velocity_deg_s = 1e300",
     "axis.view_theta.max_velocity_deg_s", "out of range"),
    ("infinite travel", "max_deg = 91.0", "max_deg = inf", "axis.view_theta.max_deg", "out of"),
    ("unit twice", "unit = 2", "unit = 1", "axis", "a unit of its own"),
    ("lamp twice", "n = 2,", "n = 1,", "lamps.lamp", "two lamps have the same n"),
    ("lamp twelve", "n = 11,", "n = 12,", "lamps.lamp.10.n", "12 is out of range, 1 to 11"),
    ("three coefficients", "distortion = []", "distortion = [1.0, 2.0, 3.0]",
     "camera.distortion", "[k1, k2, p1, p2, k3]"),
    ("exposures fall", "[0.002, 0.02,", "[0.02, 0.002,", "camera.exposures_s", "short to long"),
    ("no exposures", "[0.002, 0.02, 0.2, 2.0]", "[]", "camera.exposures_s", "at least 1"),
    ("exposure too long", "0.2, 2.0]", "0.2, 2e6]", "camera.exposures_s.3", "1e-06 to 300"),
    ("box turned", "keep_out = []", "keep_out = [{min_mm = [0, 0, 1], max_mm = [1, 1, 1]}]",
     "arm.keep_out.0", "below the same of max_mm"),
    ("glare alone", "height = 160", "height = 160\nstray_light = 0.9", "camera.stray_light", "0.5"),
    ("sigma below 0", "[holder]", "[uncertainty]\nangle_deg = -1\n[holder]",
     "uncertainty.angle_deg", "out of range, 0 to 1"),
    ("reference too white", "reference = 0.99", "reference = 2.0", "holder.reference", "1.2"),
]  # fmt: skip


def test_the_built_in_rig_loads_and_is_the_papers():
    rig = default_rig()
    assert rig.arm.min_separation_deg == 0.0
    assert len(rig.lamps.lamp) == 11
    assert [rig.axis[name].unit for name in AXES] == [1, 2, 3, 4]


def test_a_file_of_the_built_in_text_is_the_built_in_rig(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(TEXT)
    assert load_rig(path) == default_rig()


def test_the_hash_is_of_what_the_rig_is_not_of_how_it_is_written(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text("# mine\n" + TEXT.replace("2000.0", "2_000.00"))
    assert load_rig(path).sha256 == default_rig().sha256
    path.write_text(TEXT + "[uncertainty]\nreference = 0.0\n")
    assert load_rig(path).sha256 == default_rig().sha256
    path.write_text(TEXT.replace("502", "503"))
    assert load_rig(path).sha256 != default_rig().sha256
    path.write_text(TEXT + "[uncertainty]\nreference = 0.005\n")
    assert load_rig(path).sha256 != default_rig().sha256


@pytest.mark.parametrize(
    ("old", "new", "field", "says"), [c[1:] for c in WRONG], ids=[c[0] for c in WRONG]
)
def test_a_wrong_field_is_named_in_one_line(tmp_path, old, new, field, says):
    assert old in TEXT
    path = tmp_path / "rig.toml"
    path.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(BadFileError) as caught:
        load_rig(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: {field}")
    assert says in line
    assert "\n" not in line


FOREIGN = [
    # name, content (None: no file), what is said
    ("missing", None, "no such file"),
    ("not TOML", b"[arm", "is not TOML"),
    ("deep", b"a = " + b"[" * 100_000, "is not TOML"),
    ("long number", b"a = " + b"9" * 5000, "is not TOML"),
    ("not text", b"\xff\xfe\x00", "is not text"),
    ("empty", b"", "arm: is missing (and 4 more)"),
]


@pytest.mark.parametrize(("content", "says"), [c[1:] for c in FOREIGN], ids=[c[0] for c in FOREIGN])
def test_a_file_that_is_no_rig(tmp_path, content, says):
    path = tmp_path / "rig.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadFileError) as caught:
        load_rig(path)
    assert says in str(caught.value)
    assert "docs/topics/rig-file.md" in str(caught.value)


@pytest.mark.parametrize("axis", AXES)
def test_counts_and_degrees(axis):
    spec = default_rig().axis[axis]
    assert spec.to_counts(0.0) == spec.zero_counts
    for degrees in (-0.5, 0.0, 12.3456, 90.0):
        back = spec.to_degrees(spec.to_counts(degrees))
        assert back == pytest.approx(degrees, abs=0.5 / abs(spec.counts_per_deg) + 1e-12)


def test_a_negative_scale_turns_the_other_way():
    light, view = (default_rig().axis[name] for name in ("light_theta", "view_theta"))
    assert light.to_counts(10.0) < light.zero_counts
    assert view.to_counts(10.0) > view.zero_counts


@pytest.mark.parametrize("degrees", [-1.0, 0.0, 91.0])
def test_within_travel(degrees):
    default_rig().check_reach("view_theta", degrees)


@pytest.mark.parametrize("degrees", [-1.001, 91.001, float("nan")])
def test_beyond_travel(degrees):
    with pytest.raises(BadInputError, match=r"view_theta .* travel of -1 to 91 deg"):
        default_rig().check_reach("view_theta", degrees)


def test_a_byte_order_mark_is_no_part_of_the_file(tmp_path):
    (tmp_path / "rig.toml").write_bytes(b"\xef\xbb\xbf" + default_rig_text().encode())
    assert load_rig(tmp_path / "rig.toml") == default_rig()


@pytest.mark.parametrize("value", ["true", '"20"'])
def test_a_number_is_a_number(tmp_path, value):
    text = default_rig_text().replace("max_velocity_deg_s = 20.0", f"max_velocity_deg_s = {value}")
    (tmp_path / "rig.toml").write_text(text)
    with pytest.raises(BadFileError, match=r"max_velocity_deg_s: .* is no number"):
        load_rig(tmp_path / "rig.toml")


@pytest.mark.parametrize(
    "text", ['changer = "command"', 'changer = "manual"\nchanger_command = ["x"]']
)
def test_a_changer_and_its_command_go_together(tmp_path, text):
    rig = default_rig_text().replace('changer = "manual"', text)
    assert rig != default_rig_text()
    (tmp_path / "rig.toml").write_text(rig)
    with pytest.raises(BadFileError, match="go together"):
        load_rig(tmp_path / "rig.toml")
