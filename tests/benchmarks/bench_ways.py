"""How long it takes to check moves for what the arms sweep, and to find ways round."""

import time

import numpy as np

from gonio.clearance import not_free
from gonio.directions import paper_angles_deg
from gonio.paths import blocked, free_way
from gonio.rig import Rig, default_rig

MOVES = 100_000
BOX = {"min_mm": (500, 500, 200), "max_mm": (700, 800, 900)}


def free_poses(rig, count):
    """Return poses of the paper's pairs, drawn, shape (count, 4)."""
    angles = np.stack(paper_angles_deg(), axis=1)
    drawn = angles[np.random.default_rng(0).integers(len(angles), size=(3 * count, 2))]
    poses = drawn.reshape(-1, 4)
    return poses[~np.any([*not_free(poses, rig).values()], axis=0)][:count]


def test_ways():
    data = default_rig().model_dump()
    data["arm"] |= {"min_separation_deg": 12.0, "keep_out": [BOX]}
    rig = Rig.model_validate(data)
    starts, goals = np.split(free_poses(rig, 2 * MOVES), 2)
    began = time.process_time()
    hit = blocked(starts, goals, rig)
    checked_s = time.process_time() - began
    some = np.flatnonzero(hit)[:500]
    began = time.process_time()
    ways = [free_way(starts[move], goals[move], rig) for move in some]
    way_s = (time.process_time() - began) / len(some)
    straight = [free_way(starts[move], goals[move], default_rig()).seconds for move in some]
    longer = [way.seconds - least for way, least in zip(ways, straight, strict=True)]
    print(  # noqa: T201
        f"\n{MOVES} moves in {checked_s:.2f} s of processor time, {hit.mean():.0%} blocked; a way "
        f"round in {1000 * way_s:.1f} ms, {np.mean(longer):.1f} s longer than straight on, at most "
        f"{np.max(longer):.1f} s"
    )
    assert checked_s < 10
