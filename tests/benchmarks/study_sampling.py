"""What importance sampling is worth: variance of one-bounce light against sampling by the cosine.

make sampling, or make sampling MODELS="one/model two/model" for models of your own
"""

import sys
from time import perf_counter

import numpy as np

from gonio.directions import from_degrees
from nnbrdf.load import load_model
from nnbrdf.sampling import Sampler
from sim.materials import EMBEDDED

DRAWS, THETAS_DEG = 200_000, (0.0, 30.0, 60.0, 75.0, 85.0)


def by_cosine(u):
    radius, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1)


def main(folders):
    rng = np.random.default_rng(0)
    print("ratio of variances (largest weight over the mean), by the light's polar angle")  # noqa: T201
    print(f"{'':24}" + "".join(f"{theta:>16.0f} deg" for theta in THETAS_DEG))  # noqa: T201
    materials = {name: each.material for name, each in EMBEDDED.items()}
    if folders:
        materials = {folder[-24:]: load_model(folder) for folder in folders}
    for name, material in materials.items():
        start = perf_counter()
        sampler = Sampler.of(material)
        built = perf_counter() - start
        cells = [cell(material, sampler, theta, rng) for theta in THETAS_DEG]
        print(f"{name:24}" + "".join(f"{each:>20}" for each in cells) + f"  table {built:.2f} s")  # noqa: T201
    start = perf_counter()
    sampler.sample(from_degrees(30.0, 0.0), rng.random((DRAWS, 2)))
    print(f"{1e6 * (perf_counter() - start) / DRAWS:.2f} us a sample, its density included")  # noqa: T201


def cell(material, sampler, theta_deg, rng):
    light, u = from_degrees(theta_deg, 25.0), rng.random((DRAWS, 2))
    plain = np.pi * material.evaluate(light, by_cosine(u)).mean(axis=-1)
    view, pdf = sampler.sample(light, rng.random((DRAWS, 2)))
    drawn = pdf > 0
    weight = np.zeros(DRAWS)
    values = material.evaluate(light, view[drawn]).mean(axis=-1)
    weight[drawn] = values * view[drawn, 2] / pdf[drawn]
    return f"{plain.var() / weight.var():.3g} ({weight.max() / weight.mean():.1f})"


if __name__ == "__main__":
    main(sys.argv[1:])
