"""Color: a chart found in a frame, the camera's matrix that it gives, and how far that is off."""
