"""What a sensor's pixels do to the electrons that light makes: one pure function a file."""
