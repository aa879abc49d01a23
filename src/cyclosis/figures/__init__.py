"""Figures and movies of cells, sweeps and theory."""
