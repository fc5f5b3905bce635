"""GLSL functions with the network inside."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.exchange.networks.formats import network_format
from gonio.exchange.networks.printing import ARITHMETIC, Language
from gonio.exchange.networks.source_text import (
    activation_lines,
    evaluation_lines,
    indented,
    value_texts,
    weight_texts,
)

if TYPE_CHECKING:
    from gonio.exchange.networks.portable import Portable

GLSL = Language(
    operations=ARITHMETIC
    | {
        "sqrt": "sqrt({0})",
        "exp": "exp({0})",
        "log": "log({0})",
        "absolute": "abs({0})",
        "sin": "sin({0})",
        "cos": "cos({0})",
        # some drivers overflow for large arguments, where it is 1 anyhow
        "tanh": "tanh(clamp({0}, -15.0, 15.0))",
        "erf": "gonio_erf({0})",
        "atan2": "atan({0}, {1})",
        "maximum": "max({0}, {1})",
        "minimum": "min({0}, {1})",
        "where_less": "({0} < {1} ? {2} : {3})",
    },
    declaration="float {name} = {text};",
)

_TEXT = """\
// {description}
// Written by gonio, to be put into a shader; GLSL 3.30, GLSL ES 3.00 (highp) or newer.

{weights}

// Abramowitz and Stegun (1964), 7.1.26: at most 1.5e-7 off.
#ifndef GONIO_ERF
#define GONIO_ERF
float gonio_erf(float x) {{
    float t = 1.0 / (1.0 + 0.3275911 * abs(x));
    float p = 1.061405429 * t - 1.453152027;
    p = ((p * t + 1.421413741) * t - 0.284496736) * t + 0.254829592;
    return sign(x) * (1.0 - p * t * exp(-x * x));
}}
#endif

float {symbol}_activation(float x) {{
{activation}
}}

// BRDF in 1/sr, without the cosine, for unit vectors away from the surface: z is its normal, x the
// direction of the sample's marked edge. Zero for a direction at or below the horizon.
vec3 {symbol}(vec3 light, vec3 view) {{
    float lx = light.x, ly = light.y, lz = light.z;
    float vx = view.x, vy = view.y, vz = view.z;
    if (!(lz > 0.0 && vz > 0.0)) return vec3(0.0);
{evaluation}
    return vec3(
        {values});
}}
"""


def text_of(network: Portable) -> str:
    """Return the functions."""
    return _TEXT.format(
        description=network.description,
        symbol=network.symbol,
        weights="\n".join(
            f"const float {name}[{count}] = float[{count}](\n    {numbers});"
            for name, count, numbers in weight_texts(network, GLSL)
        ),
        activation=indented(activation_lines(network, GLSL)),
        evaluation=indented(evaluation_lines(network, GLSL)),
        values=",\n        ".join(value_texts(network, GLSL)),
    )


FORMAT = network_format(
    name="glsl",
    suffix=".glsl",
    title="GLSL function with the network inside: vec3 gonio_NAME(vec3 light, vec3 view)",
    content=lambda network, source, path: text_of(network).encode(),
)
