"""The inputs of networks as formulas: those of `nnbrdf.encoding` and `nnbrdf.halfway`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from gonio.exchange.networks.expression import (
    atan2,
    cos,
    input_named,
    log,
    maximum,
    sin,
    sqrt,
    where_less,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.exchange.networks.expression import Expression

    Inputs = Callable[["Vector", "Vector"], list[Expression]]

_QUARTER, _TURN = math.pi / 2, 2 * math.pi
# in single precision, mirrored directions miss the normal by 1e-7
_POLE = 1e-6


class Vector(NamedTuple):
    """Three coordinates."""

    x: Expression
    y: Expression
    z: Expression


LIGHT = Vector(*(input_named(f"l{axis}") for axis in "xyz"))
VIEW = Vector(*(input_named(f"v{axis}") for axis in "xyz"))


def inputs_of(encoding: str) -> list[Expression]:
    """Return the formulas of an encoding's inputs, of `LIGHT` and `VIEW`."""
    return ENCODINGS[encoding](LIGHT, VIEW)


def _xyz(light: Vector, view: Vector) -> list[Expression]:
    return [*view, *light]


def _spherical(light: Vector, view: Vector) -> list[Expression]:
    return [
        each
        for way in (view, light)
        for each in (atan2(_sine(way), way.z) / _QUARTER, _turns(way.x, way.y))
    ]


def _sincos(light: Vector, view: Vector) -> list[Expression]:
    return [*_sincos_of(view), *_sincos_of(light)]


def _sincos_of(way: Vector) -> list[Expression]:
    cosine, sine = _azimuth(way)
    return [_sine(way), way.z, sine, cosine]


def _paper_literal(light: Vector, view: Vector) -> list[Expression]:
    return [*_printed(view), *_printed(light)]


def _printed(way: Vector) -> list[Expression]:
    theta, phi = atan2(_sine(way), way.z) / math.pi, 2.0 * _turns(way.x, way.y)
    return [sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)]


def _rusinkiewicz(light: Vector, view: Vector) -> list[Expression]:
    half, _ = _half(light, view)
    difference = _difference(light, half)
    tilt, apart = _sine(half), _sine(difference)
    # on the pole the azimuth would be that of the rounding
    phi_h = where_less(tilt, _POLE, 0.0, _turns(half.x, half.y))
    phi_d = where_less(apart, _POLE, 0.0, _turns(difference.x, difference.y))
    theta_h, theta_d = atan2(tilt, half.z), atan2(apart, difference.z)
    return [theta_h / _QUARTER, phi_h, theta_d / _QUARTER, phi_d]


def _half_difference(light: Vector, view: Vector) -> list[Expression]:
    half, _ = _half(light, view)
    return [*half, *_difference(light, half)]


def _isotropic(light: Vector, view: Vector) -> list[Expression]:
    half, cos_difference = _half(light, view)
    squared = half.x * half.x + half.y * half.y
    sharp = 0.25 * log(squared + 0.01)
    return [sqrt(squared), *_cosines(light, view), cos_difference, sharp]


def _anisotropic(light: Vector, view: Vector) -> list[Expression]:
    half, cos_difference = _half(light, view)
    turned = light.x * view.y - light.y * view.x
    return [
        half.x,
        half.y,
        *_cosines(light, view),
        light.x * view.x - light.y * view.y,
        light.x * view.y + light.y * view.x,
        cos_difference,
        turned * turned,
    ]


def _isotropic_exchange(light: Vector, view: Vector) -> list[Expression]:
    return [*_isotropic(light, view), light.z - view.z]


def _anisotropic_exchange(light: Vector, view: Vector) -> list[Expression]:
    across = [a - b for a, b in zip(light, view, strict=True)]
    return [*_anisotropic(light, view), *across]


ENCODINGS: dict[str, Inputs] = {
    "xyz": _xyz,
    "spherical": _spherical,
    "sincos": _sincos,
    "rusinkiewicz": _rusinkiewicz,
    "half-difference": _half_difference,
    "paper-literal": _paper_literal,
    "isotropic": _isotropic,
    "isotropic-exchange": _isotropic_exchange,
    "anisotropic": _anisotropic,
    "anisotropic-exchange": _anisotropic_exchange,
}
"""By the names of `nnbrdf.encoding.ENCODINGS` and `nnbrdf.halfway.HALFWAY`."""


def _half(light: Vector, view: Vector) -> tuple[Vector, Expression]:
    """Return the half vector and its cosine to either direction; opposite ones have the normal."""
    x, y, z = (a + b for a, b in zip(light, view, strict=True))
    length = sqrt(x * x + y * y + z * z)
    scale = maximum(length, 1e-9)
    return (
        Vector(x / scale, y / scale, where_less(length, 1e-9, 1.0, z / scale)),
        length * 0.5,
    )


def _cosines(light: Vector, view: Vector) -> tuple[Expression, Expression]:
    cos_light, cos_view = maximum(light.z, 0.0), maximum(view.z, 0.0)
    return sqrt(cos_light * cos_view), cos_light + cos_view


def _difference(light: Vector, half: Vector) -> Vector:
    """Return the light as seen where the half vector is the normal (Rusinkiewicz 1998)."""
    cosine, sine = _azimuth(half)
    tilt = _sine(half)
    along = cosine * light.x + sine * light.y
    across = cosine * light.y - sine * light.x
    return Vector(half.z * along - tilt * light.z, across, half.z * light.z + tilt * along)


def _sine(way: Vector) -> Expression:
    return sqrt(way.x * way.x + way.y * way.y)


def _azimuth(way: Vector) -> tuple[Expression, Expression]:
    """Return cosine and sine of an azimuth, which is 0 at the pole."""
    radius = _sine(way)
    scale = maximum(radius, _POLE)
    return (
        where_less(radius, _POLE, 1.0, way.x / scale),
        where_less(radius, _POLE, 0.0, way.y / scale),
    )


def _turns(x: Expression, y: Expression) -> Expression:
    """Return an azimuth as part of a turn, in [0, 1)."""
    # atan2 of (0, 0) is not defined in every language
    radius = sqrt(x * x + y * y)
    angle = atan2(y, where_less(radius, 1e-12, 1.0, x))
    turns = where_less(angle, 0.0, angle + _TURN, angle) / _TURN
    return where_less(turns, 1.0 - 1e-12, turns, 0.0)
