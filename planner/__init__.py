"""Choosing what to measure: candidate directions, subsets, routes; it makes Plans."""
