"""The logarithm that the prior lives in."""

OFFSET = 0.01
"""Added to value / white before the logarithm, as in the metric male."""
