"""Importance sampling of any material: views drawn about as a material sends light there."""

from nnbrdf.sampling.sampler import Sampler

__all__ = ["Sampler"]
