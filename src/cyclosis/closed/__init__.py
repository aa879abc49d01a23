"""Closed cells: shapes, and the harmonics of their surfaces in which diffusion and flow are diagonal."""
