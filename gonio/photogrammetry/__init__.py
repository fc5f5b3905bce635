"""Geometry from pictures of the holder's board, and pictures put on the sample's plane."""

from __future__ import annotations
