"""The kinetic model: the distribution of filament angles, of which the polar model is a closure."""
