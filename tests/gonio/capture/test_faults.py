"""Every kind of fault: how it is seen, what is done about it, and what is lost."""

import re
from pathlib import Path

import pytest

from planner.make import make_plan
from sim.faults import KINDS, Fault

EXPOSURES = (0.002, 0.02, 0.2, 2.0)
SHOTS = 9
CALIBRATION = 32
DOCS = Path(__file__).parents[3] / "docs/topics/faults.md"

NO_REPLY = r"unit \d: no reply within 0\.5 s"
NO_ANSWER = r"lamps: no answer within 0\.[45]\d* s|lamps: what comes over the line is no answer"
SPOILED = rf"{NO_ANSWER}|bad checksum|unknown command"
NOT_SEEN = None

# what the journal says first, what was done, and how many exposures were taken once more
SEEN = {
    "bus time-out": (NO_REPLY, "asked again", 0),
    "bus CRC error": (NO_REPLY, "asked again", 0),
    "bus bytes dropped": (NO_REPLY, "asked again", 0),
    "bus bytes doubled": (NO_REPLY, "asked again", 0),
    "bus bytes delayed": (NO_REPLY, "asked again", 0),
    "bus wrong transaction": (NO_REPLY, "asked again", 0),
    "bus exception reply": (r"unit \d, .* exception 6; it is busy", "asked again", 0),
    "stale registers": (NOT_SEEN, "", 0),
    "encoder glitch": (r"_theta: a reading of -?\d+\.\d\d deg where", "read again", 0),
    "line time-out": (NO_ANSWER, "asked again", 0),
    "line bytes garbled": (SPOILED, "asked again", 0),
    "line bytes dropped": (SPOILED, "asked again", 0),
    "line bytes doubled": (SPOILED, "asked again", 0),
    "line answer doubled": (NOT_SEEN, "", 0),
    "line bytes delayed": (NO_ANSWER, "asked again", 0),
    "serial port unplugged": ("lamps: the serial port is gone", "waits up to 60 s", 0),
    "lost steps": (r"_phi|_theta: did not arrive within", "tried again", 0),
    "stall": (r": is no longer enabled \(error 0x8611, following error\)", "tried again", 0),
    "following error": (r": is no longer enabled \(error 0x8611", "tried again", 0),
    "limit hit": (r": stopped on its way \((posi|nega)tive limit switch", "tried again", 0),
    "watchdog expiry": (r"\(error 0x7500, communication lost", "tried again", 0),
    "power cut": ("is no longer enabled", "tried again", 0),
    "interlock": (r"went out in frame \d+ \(400, interlock open\)", "tried again", 1),
    "lamp open": (r"lamp \d+ went out in frame \d+ \(301, open circuit\)", "tried again", 1),
    "lamp over-temperature": (r"went out in frame \d+ \(300, over-temp", "tried again", 1),
    "flux drift": (NOT_SEEN, "", 0),
    "camera busy": (NOT_SEEN, "", 0),
    "frame missing": (r"frame_\d+\.dng: did not come within 10 s", "tried again", 1),
    "frame late": (NOT_SEEN, "", 0),
    "frame truncated": (r"\.dng: (is not a raw file|has \d+ bytes of)", "tried again", 1),
    "frame bit-flipped": (
        r"\.dng: (has other pixels|is not a raw file|has \d+ bytes)",
        "tried again",
        1,
    ),
}
STOPS = {"disk full"}


def plan_of(rig):
    return make_plan(rig, views=3, lights=3)


# requests and moves of homing and calibration come before these
AT = {
    "request": 420,
    "read": 420,
    "reading of an angle": 60,
    "move": 9,
    "exposure": 40,
    "frame": 40,
}


def one(kind):
    return Fault(kind=kind, at=(AT[KINDS[kind].per],))


@pytest.mark.parametrize("kind", SEEN)
@pytest.mark.parametrize("seed", [0, 1])
def test_a_capture_survives(stage, kind, seed):
    says, did, retaken = SEEN[kind]
    here = stage(plan_of, seed=seed)
    here.faults = (one(kind),)
    here.run()
    assert here.struck == {kind: 1}
    expected = [(shot, exposure_s) for shot in range(SHOTS) for exposure_s in EXPOSURES]
    assert sorted(here.shots()) == expected
    assert here.exposed == CALIBRATION + len(expected) + retaken
    if says is NOT_SEEN:
        assert here.noted() == []
    else:
        assert re.search(says, here.noted()[0][0]), here.noted()
        assert here.noted()[0][1] == did


def test_every_kind_has_its_test_and_its_row():
    assert {*SEEN} | STOPS == {*KINDS}
    rows = re.findall(r"^\| ([^|]+) \|", DOCS.read_text(), re.MULTILINE)
    assert {*KINDS} <= {*rows}
