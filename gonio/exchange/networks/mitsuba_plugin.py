"""A plugin of Mitsuba 3 that evaluates the network and draws samples of it."""

from __future__ import annotations

import base64
import re
from importlib import resources
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from gonio.exchange.isotropy import ISOTROPIC_BELOW
from gonio.exchange.networks.activations import activation_of
from gonio.exchange.networks.formats import network_format
from gonio.exchange.networks.inputs import inputs_of
from gonio.exchange.networks.portable import without_marks
from gonio.exchange.networks.printing import ARITHMETIC, Language

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.exchange.format import Source
    from gonio.exchange.networks.portable import Portable

PYTHON = Language(
    operations=ARITHMETIC
    | {
        "sqrt": "m.sqrt({0})",
        "exp": "m.exp({0})",
        "log": "m.log({0})",
        "absolute": "m.abs({0})",
        "sin": "m.sin({0})",
        "cos": "m.cos({0})",
        "tanh": "m.tanh({0})",
        "erf": "_erf(m, {0})",
        "atan2": "m.atan2({0}, {1})",
        "maximum": "_larger(m, {0}, {1})",
        "minimum": "_smaller(m, {0}, {1})",
        "where_less": "m.select({0} < {1}, {2}, {3})",
    },
    declaration="{name} = {text}",
)

_TEMPLATE = "mitsuba_plugin.txt"
_LOGARITHMIC, _PLAIN = "m.exp(_smaller(m, o, 50.0)) - 0.01", "o"


def text_of(network: Portable, module: str, anisotropic: bool) -> str:
    """Return the plugin.

    Parameters
    ----------
    network
        What it evaluates.
    module
        How it is imported: the name of its file without the suffix.
    anisotropic
        Whether the table that samples are drawn from has azimuths; without, it is a twelfth.
    """
    inputs, results = PYTHON.lines(inputs_of(network.encoding))
    activation, (result,) = PYTHON.lines([activation_of(network.activation)])
    weights = np.concatenate([layer.ravel() for layer in network.layers]).astype("<f4")
    values = {
        "DESCRIPTION": network.description,
        "MODULE": without_marks(module),
        "PLUGIN": network.symbol,
        "SIZES": repr(list(network.sizes)),
        "SCALE": repr(list(network.scale)),
        "ANISOTROPIC": repr(anisotropic),
        "WEIGHTS": "\n".join(wrap(base64.b64encode(weights.tobytes()).decode(), 96)),
        "ACTIVATION": _body([*activation, f"return {result}"]),
        "INPUTS": _body([*inputs, f"return [{', '.join(results)}]"]),
        "VALUE": _LOGARITHMIC if network.logarithmic else _PLAIN,
    }
    template = resources.files(__package__).joinpath(_TEMPLATE).read_text("utf-8")
    return re.sub("@([A-Z_]+)@", lambda found: values[found[1]], template)


def _body(lines: list[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)


def _content(network: Portable, source: Source, path: Path) -> bytes:
    return text_of(network, path.stem, source.anisotropy > ISOTROPIC_BELOW).encode()


FORMAT = network_format(
    name="mitsuba",
    suffix=".py",
    title="plugin of Mitsuba 3 that evaluates and samples the network",
    content=_content,
)
