"""Where training is stiff or extreme: what happens, measured."""
