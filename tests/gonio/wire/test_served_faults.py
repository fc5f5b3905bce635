"""Faults on real sockets, pseudo-terminals and files: a capture ends with all of its shots."""

import re

import pytest
import tomli_w

from gonio.faultlog import faults_of
from gonio.session import Session
from sim.faults import KINDS

BUS = [kind for kind in KINDS if KINDS[kind].place == "bus"]
LINE = [kind for kind in KINDS if KINDS[kind].place == "line"]
RIG = [kind for kind in KINDS if KINDS[kind].place in ("axis", "rig", "lamp", "camera")]
FRAMES = [kind for kind in KINDS if KINDS[kind].place == "folder"]

# from where on, and how far apart, of what kinds are counted per
WHEN = {
    "request": (150, 17),
    "read": (200, 20),
    "reading of an angle": (20, 7),
    "move": (3, 2),
    "exposure": (3, 4),
    "frame": (3, 4),
}
# what takes longer than a test should
LASTS_S = {"serial port unplugged": 1.0}


def faults(kinds, times):
    """Return a file's text: each kind strikes `times` times, one kind after the other."""
    found, used = [], {}
    for kind in kinds:
        first, apart = WHEN[KINDS[kind].per]
        turn = used[kind] = len([other for other in used if KINDS[other].per == KINDS[kind].per])
        at = [first + apart * (turn + number * 8) for number in range(times)]
        lasts = {"lasts_s": LASTS_S[kind]} if kind in LASTS_S else {}
        found.append({"kind": kind, "at": at} | lasts)
    return tomli_w.dumps({"fault": found})


CASES = {
    "bus over TCP": ([], BUS, 2),
    "bus over RTU": (["--rtu"], BUS, 2),
    "line": ([], LINE, 2),
    "rig": ([], RIG, 1),
    "frames": ([], FRAMES, 1),
}


@pytest.mark.parametrize(
    ("options", "kinds", "times"),
    [
        pytest.param(*case, id=name, marks=[pytest.mark.slow] * (name == "bus over RTU"))
        for name, case in CASES.items()
    ],
)
def test_a_capture_ends_with_all_its_shots(gonio, tmp_path, serve_twin, options, kinds, times):
    (tmp_path / "faults.toml").write_text(faults(kinds, times))
    twin = serve_twin("--faults", tmp_path / "faults.toml", *options)
    rig = tmp_path / "rig.toml"
    rig.write_text(twin.rig.read_text().replace("file_timeout_s = 10.0", "file_timeout_s = 3.0"))
    planned = gonio("plan", "--density", "2", "--criterion", "farthest", "--rig", rig, "--no-page")
    assert planned.returncode == 0, planned.stderr
    captured = gonio("capture", "--rig", rig)
    assert captured.returncode == 0, captured.stderr
    struck = re.findall(r"(\d+) x ([^,\n]+)", twin.end().partition("struck")[2])
    assert {kind: int(count) for count, kind in struck} == dict.fromkeys(kinds, times)
    with Session(tmp_path / "session").journal() as journal:
        frames = [record.key for record in journal.frames()]
        assert faults_of(journal)
    assert len(frames) == len({*frames}) == 24
