"""`gonio rig bench` on the twin, and `gonio plan` with what it found."""

import json

import pytest

from gonio.plan import Plan
from gonio.rig import AXES, default_rig_text, load_rig
from gonio.timing import Timing

SLOWER = default_rig_text().replace("velocity_deg_s = 20.0", "velocity_deg_s = 12.0")


@pytest.fixture(scope="module")
def benched(tmp_path_factory):
    """A folder with rig.toml and the rig-timing.json that was measured of it."""
    from gonio.api.twin import simulated_rig
    from gonio.bench import bench_rig

    folder = tmp_path_factory.mktemp("benched")
    (folder / "rig.toml").write_text(SLOWER)
    rig = load_rig(folder / "rig.toml")
    steps = []
    with simulated_rig(rig, 0) as (instrument, operator, scratch):
        bench = bench_rig(instrument, operator, rig, scratch, lambda *step: steps.append(step))
    bench.timing.save(folder / "rig-timing.json")
    assert steps == [(i + 1, len(steps)) for i in range(len(steps))]
    return folder


@pytest.fixture
def folder(benched, tmp_path):
    for name in ("rig.toml", "rig-timing.json"):
        (tmp_path / name).write_bytes((benched / name).read_bytes())
    return tmp_path


def test_the_twin_acts_as_its_rig_file_says(benched):
    timing, rig = Timing.load(benched / "rig-timing.json"), load_rig(benched / "rig.toml")
    assert timing.measured
    assert timing.rig_sha256 == rig.sha256
    for name in AXES:
        spec, axis = rig.axis[name], timing.axis[name]
        assert axis.velocity_deg_s == pytest.approx(spec.max_velocity_deg_s, rel=0.02)
        assert axis.acceleration_deg_s2 == pytest.approx(spec.max_acceleration_deg_s2, rel=0.05)
        assert axis.jerk_deg_s3 == 0.0
        assert 0.05 < axis.latency_s < 0.1
        assert axis.sd_s < 0.02
        # homing searches at half speed and comes back at a crawl
        assert axis.homing_velocity_deg_s == pytest.approx(spec.max_velocity_deg_s / 2, rel=0.01)
        assert 0.9 < axis.settle.mean_s < 1.1
    assert timing.ring_down_s == pytest.approx(0.17, rel=0.1)
    # half full in 0.2 s
    assert timing.white_level_s == pytest.approx(0.4, rel=0.02)
    assert timing.read_out.mean_s == pytest.approx(0.04, abs=0.02)


def test_the_command_writes_it_beside_the_rig_file_and_shows_it(gonio, tmp_path):
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab/rig.toml").write_text(SLOWER)
    result = gonio("rig", "bench", "--sim", "--rig", "lab/rig.toml")
    assert result.returncode == 0, result.stderr
    timing = Timing.load(tmp_path / "lab/rig-timing.json")
    assert timing.sha256 in result.stdout
    for word in (*AXES, "deg/s2", "residual", "trapezoid", "then until its file is there"):
        assert word in result.stdout
    assert "note:" not in result.stdout


def test_a_plan_finds_it_and_says_so(gonio, folder):
    timing = Timing.load(folder / "rig-timing.json")
    result = gonio("plan", "--density", "3", "--criterion", "farthest", "--rig", "rig.toml")
    assert result.returncode == 0, result.stderr
    assert timing.sha256[:12] in result.stdout
    plan = Plan.load(folder / "plan.json")
    assert plan.estimates.timing_sha256 == timing.sha256
    assert plan.estimates.total_lo_s < plan.estimates.total_s < plan.estimates.total_hi_s
    # now that the camera is known, shots take what they may need
    all_exposures = load_rig(folder / "rig.toml").camera.exposures_s
    assert all(set(shot.exposures_s) < set(all_exposures) for shot in plan.shots)


def test_all_exposures_where_nothing_was_measured_or_it_is_asked_for(gonio, folder):
    options = ("plan", "--density", "2", "--criterion", "farthest")
    all_exposures = load_rig(folder / "rig.toml").camera.exposures_s
    for more in (("--rig", "rig.toml", "--bracket", "ALL"), ()):
        assert gonio(*options, *more).returncode == 0
        plan = Plan.load(folder / "plan.json")
        assert all(shot.exposures_s == all_exposures for shot in plan.shots)


OTHERS = {
    # what becomes of the file, and what is said
    "of another rig": (lambda data: data, (), "is of the rig"),
    "damaged": (
        lambda data: data | {"ring_down_s": 5.0},
        ("--rig", "rig.toml"),
        "sha256: does not",
    ),
}


@pytest.mark.parametrize(("edit", "rig", "says"), OTHERS.values(), ids=OTHERS)
def test_one_that_does_not_fit_is_refused_when_named_and_ignored_when_found(
    gonio, folder, edit, rig, says
):
    path = folder / "rig-timing.json"
    path.write_text(json.dumps(edit(json.loads(path.read_text()))))
    options = ("plan", "--density", "2", "--criterion", "farthest", *rig)
    named = gonio(*options, "--timing", "rig-timing.json")
    assert (named.returncode, says in named.stderr) == (2, True)
    assert len(named.stderr.splitlines()) == 1
    assert not (folder / "plan.json").exists()
    found = gonio(*options)
    assert found.returncode == 0, found.stderr
    assert found.stdout.startswith("note: not used: rig-timing.json")
    assert Plan.load(folder / "plan.json").estimates.timing_sha256 is None


BAD = {
    "no rig here": (("rig", "bench"), None, "add --sim"),
    "boxes": (
        ("rig", "bench", "--sim", "--rig", "rig.toml"),
        ("keep_out = []", "keep_out = [{min_mm = [300, 300, 300], max_mm = [400, 400, 400]}]"),
        "arm.keep_out",
    ),
    "white out of reach": (
        ("rig", "bench", "--sim", "--rig", "rig.toml"),
        ("max_deg = 91.0", "max_deg = 40.0"),
        "beyond the axis' travel",
    ),
    "white not to be seen": (
        ("rig", "bench", "--sim", "--rig", "rig.toml"),
        ("[0.002, 0.02, 0.2, 2.0]", "[1e-6, 5.0]"),
        "too bright or too dark at every exposure",
    ),
    "no such timing": (("plan", "--timing", "gone.json"), None, "gone.json: no such file"),
}


@pytest.mark.parametrize(("command", "change", "says"), BAD.values(), ids=BAD)
def test_what_cannot_be_is_told_in_one_line(gonio, tmp_path, command, change, says):
    if change:
        assert change[0] in SLOWER
        (tmp_path / "rig.toml").write_text(SLOWER.replace(*change))
    result = gonio(*command)
    assert (result.returncode, says in result.stderr) == (2, True), result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(tmp_path.glob("*.json"))
