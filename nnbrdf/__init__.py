"""From samples to a material: encodings, network, training, analytic models, error metrics."""
