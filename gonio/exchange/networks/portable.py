"""What of a model another program needs: one network, and what its outputs mean."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.exchange.networks.activations import ACTIVATIONS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material
    from nnbrdf.network import Networks

CHANNELS = 3


@dataclass(frozen=True)
class Portable:
    """One network as plain numbers.

    Attributes
    ----------
    name
        Of the material.
    encoding
        What the inputs are, a name of `gonio.exchange.networks.inputs.ENCODINGS`.
    layers
        Single precision, shape (outputs, inputs + 1) each, the last column the bias; three outputs.
    activation
        Of the hidden layers.
    logarithmic
        Whether an output o means scale x (exp(o) - 0.01), else it means scale x o; either is cut
        at zero.
    scale
        Of each channel, in 1/sr.
    color_space
        What the channels are.
    """

    name: str
    encoding: str
    layers: tuple[NDArray[np.float32], ...]
    activation: str
    logarithmic: bool
    scale: tuple[float, float, float]
    color_space: str

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of inputs, then of each layer's outputs."""
        return (self.layers[0].shape[1] - 1, *(len(layer) for layer in self.layers))

    @property
    def weights(self) -> int:
        """How many weights and biases."""
        return sum(layer.size for layer in self.layers)

    @property
    def symbol(self) -> str:
        """What programs call it: a prefix of all its names, so that two fit into one program."""
        return symbol_of(self.name)

    @property
    def description(self) -> str:
        """What it is, in one line without characters that end a comment in any language."""
        sizes = "-".join(map(str, self.sizes))
        kind = f"network {sizes} ({self.activation}, {self.encoding} inputs)"
        return f"{without_marks(self.name)}: {kind}, {without_marks(self.color_space)}"


def without_marks(text: str) -> str:
    """Return a text from a file as it may stand in the comments of any language."""
    return "".join(each if each.isalnum() or each in " -." else "_" for each in text)


def symbol_of(name: str) -> str:
    """Return what programs call a material, such as gonio_leather."""
    # GLSL keeps names with two underscores for itself
    plain = re.sub(r"[\W_]+", "_", name.lower(), flags=re.ASCII).strip("_")
    return f"gonio_{plain or 'material'}"


def portable_of(model: Material, name: str) -> Portable:
    """Return the network of a model: the delivered one, or the one that was taught.

    Raises
    ------
    gonio.errors.BadInputError
        When the material is no network, has weights that are not finite, or an activation
        that mixes the outputs of a layer.
    """
    # the help of gonio export lists the formats, and needs no model for that
    from nnbrdf.model import NNBRDF
    from nnbrdf.taught import TaughtBRDF

    if isinstance(model, TaughtBRDF):
        card, network, logarithmic = model.card, model.value, True
        scale = np.broadcast_to(card.scale * np.asarray(card.tint), CHANNELS)
    elif isinstance(model, NNBRDF):
        network, logarithmic = model.networks.member(model.card.delivered), False
        scale = np.full(CHANNELS, model.card.white)
    else:
        raise BadInputError(
            f"{name} is no network, which this format holds; make one with "
            "gonio reconstruct (--estimator nn or paper), or export it as a table"
        )
    if network.activation not in ACTIVATIONS:
        raise BadInputError(
            f"a network with activation {network.activation}, which mixes the outputs of a layer, "
            f"has no export; use one of {', '.join(ACTIVATIONS)}"
        )
    if not all(np.isfinite(layer).all() for layer in (*network.layers, scale)):
        raise BadInputError(f"{name} has weights that are not finite; reconstruct it again")
    red, green, blue = scale.tolist()
    return Portable(
        name=name,
        encoding=model.card.encoding,
        layers=_three_outputs(network),
        activation=network.activation,
        logarithmic=logarithmic,
        scale=(red, green, blue),
        color_space=model.card.color_space,
    )


def _three_outputs(network: Networks) -> tuple[NDArray[np.float32], ...]:
    *hidden, last = (layer[0].astype(np.float32) for layer in network.layers)
    return (*hidden, np.broadcast_to(last, (CHANNELS, last.shape[1])))
