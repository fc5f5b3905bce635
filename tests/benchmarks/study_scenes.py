"""What a scene's plan saves, and what it costs: error in the scene against rig time.

    python tests/benchmarks/study_scenes.py [wall=table.npz car=table.npz garment=table.npz]

For each scene of docs/examples: the default plan, the scene's plan, and, where the material is
isotropic, the scene's plan that is told so. Each is planned, captured on the twin and
reconstructed by the three commands. Minutes are those of the twin's clock; eps8 and male are means
over the 81 x 81 pairs, weighted by what the scene asks for, and plain.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import click
import numpy as np

from gonio.materials import MeasuredTable
from gonio.plan import Plan
from gonio.session import Session
from planner.candidates import paper_candidates
from planner.scene.demand import Demand
from planner.scene.pairs import sample_pairs
from planner.scene.scene import load_scene

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
MATERIALS = {"wall": "matte-paint", "car": "glossy-plastic", "garment": "satin"}
ROW = "| {:8s} | {:22s} | {:22s} | {:>5s} | {:>7s} | {:>14s} | {:>14s} |"
FLOOR = 0.01


def main() -> None:
    given = dict(argument.split("=", 1) for argument in sys.argv[1:])
    head = ("scene", "material", "plan", "shots", "minutes", "in the scene", "over all pairs")
    click.echo(ROW.format(*head))
    for scene, default in MATERIALS.items():
        material = given.get(scene, default)
        options = ["--scene", str(EXAMPLES / f"{scene}.toml")]
        plans = [[], options, [*options, "--isotropic"]]
        for plan in plans:
            figures = measure(scene, material, plan)
            name = " ".join(each for each in plan if each.startswith("--")) or "default"
            click.echo(ROW.format(scene, Path(material).stem, name, *figures))


def measure(scene: str, material: str, options: list[str]) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        run(folder, "plan", *options)
        run(folder, "capture", "--sim", "--material", material)
        run(folder, "reconstruct", "session/")
        session = Session(Path(folder) / "session")
        truth = MeasuredTable.load(session.truth_path)
        with np.load(session.root / "model" / "grid.npz") as grid:
            estimate = grid["values"].astype(np.float64)
        shots = len(Plan.load(Path(folder) / "plan.json").shots)
        minutes = duration_s(session) / 60
    weights = demand_of(scene)
    return [
        str(shots),
        f"{minutes:.1f}",
        *(errors(estimate, truth, each) for each in (weights, np.full_like(weights, 1 / 6561))),
    ]


def run(folder: str, *arguments: str) -> None:
    subprocess.run(
        [sys.executable, "-m", "gonio", *arguments], cwd=folder, check=True, capture_output=True
    )


def duration_s(session: Session) -> float:
    with session.journal() as journal:
        times = [event.at_s for event in journal.events()]
    return max(times) - min(times)


def demand_of(scene: str) -> np.ndarray:
    candidates = paper_candidates()
    pairs = sample_pairs(load_scene(EXAMPLES / f"{scene}.toml"))
    return Demand.of(pairs, candidates, candidates).weights


def errors(estimate: np.ndarray, truth: MeasuredTable, weights: np.ndarray) -> str:
    """Return eps8 and male, the pairs weighted."""
    white, true = truth.white, truth.values
    eps8 = 255 * np.abs(np.clip(estimate / white, 0, 1) - np.clip(true / white, 0, 1))
    male = np.abs(np.log((estimate.clip(0) + FLOOR * white) / (true.clip(0) + FLOOR * white)))
    means = [float((weights * each.mean(axis=-1)).sum()) for each in (eps8, male)]
    return "{:.2f} / {:.4f}".format(*means)


if __name__ == "__main__":
    main()
