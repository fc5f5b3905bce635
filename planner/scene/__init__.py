"""What a use of the material asks for: from a scene to the density of its pairs of directions."""
