"""The full set of 6561 shots, hours of a rig, rehearsed on the twin: how long, and the same?"""

import os
import resource
import time

from gonio.files import sha256_file

LIMIT_S = 180.0


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_6561_shots_in_under_three_minutes_the_same_to_the_bit(gonio, tmp_path):
    plan = gonio("plan", "--density", "all", "--no-page", timeout=600)
    assert plan.returncode == 0, plan.stderr
    hashes = set()
    for name in ("one", "again"):
        began_s, began_cpu_s = time.perf_counter(), cpu_s()
        said = gonio("capture", "--sim", "--rehearse", "-o", name, timeout=1200)
        assert said.returncode == 0, said.stderr
        wall_s, used_s = time.perf_counter() - began_s, cpu_s() - began_cpu_s
        hashes.add(sha256_file(tmp_path / name / "journal.sqlite"))
        print(f"\n{said.stdout}wall {wall_s:.0f} s, processor {used_s:.0f} s")  # noqa: T201
        # on a machine that others use, the processor's time says more
        assert min(wall_s, used_s) < LIMIT_S
    print(f"load {os.getloadavg()[0]:.1f}, journals {hashes}")  # noqa: T201
    assert len(hashes) == 1
