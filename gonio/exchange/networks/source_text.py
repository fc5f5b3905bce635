"""A network as source text, the same lines for C and GLSL."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.exchange.networks.activations import activation_of
from gonio.exchange.networks.inputs import inputs_of

if TYPE_CHECKING:
    from gonio.exchange.networks.portable import Portable
    from gonio.exchange.networks.printing import Language

# beyond e^50 nothing is a reflectance, and e^89 overflows
_LARGEST = "50.0"


def activation_lines(network: Portable, language: Language) -> list[str]:
    """Return the lines of a function of x that returns the activation."""
    lines, (result,) = language.lines([activation_of(network.activation)])
    return [*lines, f"return {result};"]


def evaluation_lines(network: Portable, language: Language) -> list[str]:
    """Return the lines that make `y0`, the outputs, of lx to vz.

    Layer n has its weights in `<symbol>_w<n>`, those of one input together, the biases last: sums
    that run over the outputs, of which a compiler makes vectors.
    """
    lines, results = language.lines(inputs_of(network.encoding))
    lines.append(f"float y0[{len(results)}];")
    lines += [f"y0[{index}] = {result};" for index, result in enumerate(results)]
    last = len(network.layers) - 1
    for index, layer in enumerate(network.layers):
        outputs, inputs = layer.shape[0], layer.shape[1] - 1
        x, y, w = f"y{index}", f"y{index + 1}", f"{network.symbol}_w{index}"
        each = f"for (int j = 0; j < {outputs}; ++j)"
        lines += [
            f"float {y}[{outputs}];",
            f"{each} {y}[j] = {w}[{inputs * outputs} + j];",
            f"for (int i = 0; i < {inputs}; ++i)",
            f"    {each} {y}[j] += {w}[i * {outputs} + j] * {x}[i];",
        ]
        if index < last:
            lines.append(f"{each} {y}[j] = {network.symbol}_activation({y}[j]);")
    return lines


def value_texts(network: Portable, language: Language) -> list[str]:
    """Return the BRDF of each channel in 1/sr, of the last layer's outputs."""
    outputs = f"y{len(network.layers)}"
    operations, zero = language.operations, language.number(0.0)
    texts = []
    for channel, scale in enumerate(network.scale):
        value = f"{outputs}[{channel}]"
        if network.logarithmic:
            limited = operations["minimum"].format(value, f"{_LARGEST}{language.suffix}")
            value = f"{operations['exp'].format(limited)} - {language.number(0.01)}"
        positive = operations["maximum"].format(value, zero)
        texts.append(f"{language.number(scale)} * {positive}")
    return texts


def weight_texts(network: Portable, language: Language) -> list[tuple[str, int, str]]:
    """Return name, count and numbers of each layer's weights, those of one input together."""
    return [
        (f"{network.symbol}_w{index}", layer.size, language.numbers(layer.T.ravel()))
        for index, layer in enumerate(network.layers)
    ]


def indented(lines: list[str]) -> str:
    """Return lines as the body of a function."""
    return "\n".join(f"    {line}" for line in lines)
