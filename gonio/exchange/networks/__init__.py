"""The network of an NN-BRDF inside other programs: as a graph, as source text, as a plugin."""
