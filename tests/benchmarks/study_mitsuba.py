"""The plugin's density against its samples, by Mitsuba's own chi-square test.

make mitsuba; where the system's LLVM is older than 17, DRJIT_LIBLLVM_PATH names a newer one.
"""

import importlib.util
import tempfile
from pathlib import Path

import mitsuba as mi
from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

from gonio.directions import from_degrees
from gonio.exchange.networks.mitsuba_plugin import text_of
from gonio.exchange.networks.portable import portable_of, symbol_of
from tests.gonio.exchange.networks import taught

MODELS = {"isotropic": (taught(), False), "grained": (taught("anisotropic"), True)}


def main():
    mi.set_variant("llvm_ad_rgb")
    for name, (model, anisotropic) in MODELS.items():
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{name}.py"
            path.write_text(text_of(portable_of(model, name), name, anisotropic))
            spec = importlib.util.spec_from_file_location(name, path)
            spec.loader.exec_module(importlib.util.module_from_spec(spec))
        for theta_deg in (0.0, 60.0, 80.0):
            wi = from_degrees(theta_deg, 25.0).tolist()
            draw, density = BSDFAdapter(symbol_of(name), "", wi=wi)
            test = ChiSquareTest(SphericalDomain(), draw, density, sample_dim=3, ires=16)
            # run() writes its data into the folder that one is in when it rejects
            verdict = "accepted" if test.run() else "rejected"
            print(f"{name} from {theta_deg:.0f} deg: p {test.p_value:.3f}, {verdict}")  # noqa: T201


if __name__ == "__main__":
    main()
