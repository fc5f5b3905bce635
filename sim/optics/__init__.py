"""What a lens does to an image: one pure function a file, on images (height, width, 3)."""
