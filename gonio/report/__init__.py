"""What was measured and what came of it, as one HTML page."""
