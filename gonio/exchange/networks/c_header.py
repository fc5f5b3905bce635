"""A C header with the network inside."""

from __future__ import annotations

from hashlib import sha256
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

C = Language(
    operations=ARITHMETIC
    | {
        "sqrt": "sqrtf({0})",
        "exp": "expf({0})",
        "log": "logf({0})",
        "absolute": "fabsf({0})",
        "sin": "sinf({0})",
        "cos": "cosf({0})",
        "tanh": "tanhf({0})",
        "erf": "erff({0})",
        "atan2": "atan2f({0}, {1})",
        "maximum": "fmaxf({0}, {1})",
        "minimum": "fminf({0}, {1})",
        "where_less": "({0} < {1} ? {2} : {3})",
    },
    declaration="const float {name} = {text};",
    suffix="f",
)

_TEXT = """\
/* {description}
 * Written by gonio; C99 or C++, of which it needs the mathematics library only (-lm). */
#ifndef {guard}
#define {guard}

#include <math.h>

{body}
#endif
"""
_BODY = """\
{weights}

static inline float {symbol}_activation(float x) {{
{activation}
}}

/* BRDF in 1/sr, without the cosine, for unit vectors away from the surface: z is its normal, x the
 * direction of the sample's marked edge. Zero for a direction at or below the horizon. */
static inline void {symbol}(const float light[3], const float view[3], float rgb[3]) {{
    const float lx = light[0], ly = light[1], lz = light[2];
    const float vx = view[0], vy = view[1], vz = view[2];
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (!(lz > 0.0f && vz > 0.0f)) return;
{evaluation}
{values}
}}
"""


def text_of(network: Portable) -> str:
    """Return the header."""
    body = _body(network)
    # of the content: of two networks of one name the second is an error, not passed over
    digest = sha256(body.encode()).hexdigest()[:8]
    guard = f"{network.symbol}_{digest}_h".upper()
    return _TEXT.format(description=network.description, guard=guard, body=body)


def _body(network: Portable) -> str:
    values = [f"rgb[{index}] = {each};" for index, each in enumerate(value_texts(network, C))]
    return _BODY.format(
        symbol=network.symbol,
        weights="\n".join(
            f"static const float {name}[{count}] = {{\n    {numbers}}};"
            for name, count, numbers in weight_texts(network, C)
        ),
        activation=indented(activation_lines(network, C)),
        evaluation=indented(evaluation_lines(network, C)),
        values=indented(values),
    )


FORMAT = network_format(
    name="c",
    suffix=".h",
    title="C header with the network inside: gonio_NAME(light, view, rgb)",
    content=lambda network, source, path: text_of(network).encode(),
)
