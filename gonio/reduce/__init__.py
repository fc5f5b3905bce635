"""From raw frames to BRDF samples."""
