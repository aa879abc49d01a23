"""Theory of the kinetic model: waves about uniform states, travelling states, their spectra and branches."""
