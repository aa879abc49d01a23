"""Steady states of a whole cell, in two dimensions, and their leading modes."""
