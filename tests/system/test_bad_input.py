"""Bad input through the command line: one line that says what, where and what to do."""

import json
import re

import pytest

from gonio.rig import default_rig_text

RIG = default_rig_text()


def rig(old, new):
    assert old in RIG
    return {"rig.toml": RIG.replace(old, new, 1)}


PLAN = ("plan", "--density", "2")
USE_PLAN = ("capture", "--sim", "--plan", "plan.json")
USE_RIG = ("plan", "--rig", "rig.toml")
IMPERFECT = ("capture", "--sim", "--imperfections")
TABLE = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,r,g,b\n"
ROW = "10,0,20,30,0.1,0.2,0.3\n"
FROM_TABLE = ("reconstruct", "table.csv")

CASES = [
    # name, files, command, exit code, what the line says
    ("density beyond the set", {}, ("plan", "--density", "82"), 2, "81"),
    ("density zero", {}, ("plan", "--density", "0"), 2, "81"),
    ("density nonsense", {}, ("plan", "--density", "lots"), 2, "sixth"),
    ("views beyond the set", {}, ("plan", "--views", "1000"), 2, "81"),
    ("unknown criterion", {}, ("plan", "--criterion", "best"), 2, "farthest"),
    ("no rig file", {}, USE_RIG, 2, "rig.toml: no such file"),
    ("rig is no TOML", {"rig.toml": "arm = ["}, USE_RIG, 2, "rig.toml: is not TOML"),
    ("rig lacks a key", rig("unit = 1\n", ""), USE_RIG, 2, "axis.view_theta.unit: is missing"),
    ("rig has an odd key", rig("[holder]", "[holder]\nsize = 3"), USE_RIG, 2, "holder.size"),
    ("rig has a word for a number", rig("2000.0", '"many"'), USE_RIG, 2, "counts_per_deg"),
    ("rig scale is zero", rig("2000.0", "0.0"), USE_RIG, 2, "counts_per_deg 0.0 is out of range"),
    ("rig cannot reach", rig("max_deg = 91.0", "max_deg = 1.0"), USE_RIG, 2, "view_theta"),
    (
        "rig has a box at the sample",
        rig("keep_out = []", "keep_out = [{ min_mm = [0, 0, 0], max_mm = [9, 9, 9] }]"),
        USE_RIG,
        2,
        "arm.keep_out.0: the box reaches within 100 mm of the sample's centre",
    ),
    ("grazing limit beyond", {}, ("plan", "--max-theta", "95"), 2, "max theta is 95 deg"),
    ("grazing limit no number", {}, ("plan", "--max-theta", "nan"), 2, "max theta is nan deg"),
    ("no plan", {}, USE_PLAN, 2, "plan.json: no such file"),
    ("plan is no JSON", {"plan.json": "{"}, USE_PLAN, 2, "is not JSON"),
    ("plan is a list", {"plan.json": "[]"}, USE_PLAN, 2, "is not a plan"),
    ("plan of another schema", {"plan.json": '{"schema": "x/9"}'}, USE_PLAN, 2, "x/9"),
    ("plan is a picture", {"plan.json": b"\x89PNG\xff"}, USE_PLAN, 2, "is not text"),
    ("unknown material", {}, ("capture", "--sim", "--material", "cheese"), 2, "wood-veneer"),
    ("no material file", {}, ("capture", "--sim", "--material", "a.npz"), 2, "no such file"),
    ("material is no npz", {"a.npz": "x"}, ("capture", "--sim", "--material", "a.npz"), 2, "a.npz"),
    ("unknown imperfections", {}, (*IMPERFECT, "some"), 2, "use none, mild, all, or the path of"),
    ("no file of imperfections", {}, (*IMPERFECT, "a.toml"), 2, "a.toml: no such file"),
    (
        "imperfections have an odd key",
        {"a.toml": "camera_prnn = 1"},
        (*IMPERFECT, "a.toml"),
        2,
        "a.toml: camera_prnn: is not a known key",
    ),
    (
        "an imperfection is too large",
        {"a.toml": "camera_full_well = 0.5"},
        (*IMPERFECT, "a.toml"),
        2,
        "a.toml: camera_full_well: 0.5 is out of range, 0 to 0.08 is allowed",
    ),
    ("texels without --btf", {}, ("reduce", "--texels", "8"), 2, "options of --btf"),
    ("samples' options with --btf", {}, ("reduce", "--btf", "--csv", "x.csv"), 2, "--csv is an"),
    ("imperfections of a real rig", {}, ("capture", "--imperfections", "mild"), 2, "--sim"),
    ("no real rig yet", {}, ("capture",), 2, "--sim"),
    ("nothing to resume", {}, ("capture", "--sim", "--resume"), 2, "session"),
    ("folder in use", {"session/x": "x"}, ("capture", "--sim"), 2, "never overwritten"),
    ("no session", {}, ("reconstruct", "session/"), 2, "no such folder"),
    ("folder is no session", {"session/x": ""}, ("reconstruct", "session/"), 2, "not a session"),
    ("reduce no session", {"session/x": ""}, ("reduce", "session/"), 2, "not a session"),
    ("table lacks a column", {"table.csv": "r,g,b\n1,2,3\n"}, FROM_TABLE, 2, "light_theta_deg"),
    ("table has a word", {"table.csv": TABLE + ROW.replace("30", "x")}, FROM_TABLE, 2, "line 2"),
    ("table holds NaN", {"table.csv": TABLE + ROW.replace("0.1", "nan")}, FROM_TABLE, 2, "line 2"),
    ("semicolons", {"table.csv": TABLE.replace(",", ";")}, FROM_TABLE, 2, "by semicolons"),
    (
        "transmission",
        {"table.csv": TABLE + ROW.replace("20", "120")},
        FROM_TABLE,
        2,
        "transmission",
    ),
    ("empty table", {"table.csv": ""}, FROM_TABLE, 2, "table.csv"),
    ("too few samples", {"table.csv": TABLE + ROW}, FROM_TABLE, 2, "there is 1 sample;"),
    *(
        (
            f"values of no unit, {estimator}",
            {"table.csv": TABLE + 12 * "10,0,20,30,1e-301,2e-301,3e-301\n"},
            (*FROM_TABLE, "--estimator", estimator),
            2,
            "median is 2e-301 1/sr, darker than anything",
        )
        for estimator in ("nn", "prior", "analytic", "paper")
    ),
    (
        "underscores in a number",
        {"table.csv": TABLE + ROW.replace("20", "2_0")},
        FROM_TABLE,
        2,
        "'2_0' is not a number",
    ),
    (
        "underscores in a direction",
        {"set.csv": "theta_deg,phi_deg\n1_0,0\n"},
        ("plan", "--candidates", "set.csv"),
        2,
        "line 2: '1_0,0' are no two angles",
    ),
    (
        "too few to compare",
        {"table.csv": TABLE + ROW},
        (*FROM_TABLE, "--compare"),
        2,
        "there is 1 sample; a comparison",
    ),
]


@pytest.mark.parametrize(
    ("files", "command", "code", "says"), [c[1:] for c in CASES], ids=[c[0] for c in CASES]
)
def test_one_clear_line(gonio, tmp_path, files, command, code, says):
    for name, content in files.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    result = gonio(*command)
    assert result.returncode == code, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    lines = [line for line in result.stderr.splitlines() if not re.match(r"(Usage|Try|$)", line)]
    assert len(lines) == 1, result.stderr
    assert says in lines[0]
    assert not (tmp_path / "session/plans").exists()


def edited(path, **changes):
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"shots": []}, "shots"),
        ({"rig_sha256": "0" * 64}, "sha256: does not match"),
        ({"sha256": None}, "sha256: is missing"),
        ({"colour": "red"}, "colour: is not a known key"),
    ],
)
def test_an_edited_plan_is_refused(gonio, tmp_path, changes, says):
    assert gonio(*PLAN).returncode == 0
    edited(tmp_path / "plan.json", **changes)
    result = gonio(*USE_PLAN)
    assert result.returncode == 2
    assert says in result.stderr


def test_a_session_keeps_its_plan_rig_material_and_seed(gonio, tmp_path):
    assert gonio(*PLAN).returncode == 0
    assert gonio("capture", "--sim").returncode == 0
    assert gonio("plan", "--density", "3").returncode == 0
    (tmp_path / "rig.toml").write_text(RIG.replace("distance_m = 2.0", "distance_m = 2.1"))
    for other in (
        ("--plan", "plan.json"), ("--rig", "rig.toml"), ("--material", "satin"), ("--seed", "5")
    ):  # fmt: skip
        result = gonio("capture", "--sim", "--resume", *other)
        assert result.returncode == 4, other
        assert "was begun with" in result.stderr
    assert gonio("capture", "--sim").returncode == 2


def test_a_damaged_frame_is_named(gonio, tmp_path):
    assert gonio(*PLAN).returncode == 0
    assert gonio("capture", "--sim").returncode == 0
    for frame in (tmp_path / "session/raw").iterdir():
        frame.write_bytes(frame.read_bytes()[:1000])
    result = gonio("reconstruct", "session/")
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
