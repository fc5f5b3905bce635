"""Mitsuba's pictures against our own: what its table, its light and its noise each make of them.

python -m tests.benchmarks.study_renderers satin brushed-metal session/ ...
"""

import sys
import tempfile
from pathlib import Path
from unittest.mock import patch

from gonio.api.opened import open_material
from gonio.exchange import read_material
from gonio.exchange.format import Source
from gonio.exchange.rgl import write
from gonio.render import PROBES, SHAPES, shade
from gonio.render.contrast import contrast, exposure
from gonio.render.traced import Traced

SIZE, LIGHTS, MANY = 128, 192, 3072
PROBE = PROBES["studio"]


def main():
    print("PSNR in dB: table | direct light | all light | noise")  # noqa: T201
    for source in sys.argv[1:]:
        material = open_material(source).material
        table = tabulated(material)
        traced = Traced.of({"it": material})
        for name, shape in SHAPES.items():
            own = shade({"it": material, "table": table}, shape, PROBE.lights(MANY), SIZE)
            with patch("gonio.render.traced._DEPTH", 2):
                direct = traced.shade(shape, PROBE, MANY, SIZE)["it"]
            whole = traced.shade(shape, PROBE, MANY, SIZE)["it"]
            noisy = traced.shade(shape, PROBE, LIGHTS, SIZE)["it"]
            factor = exposure([own["it"]])
            pairs = [(own["table"], own["it"]), (direct, own["it"]), (whole, own["it"])]
            told = [contrast(*pair, factor).psnr for pair in [*pairs, (noisy, whole)]]
            print(source, name, *told, sep=" | ", flush=True)  # noqa: T201


def tabulated(material):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "material.bsdf"
        write(Source(material, "material"), path, None)
        return read_material(path)


if __name__ == "__main__":
    main()
