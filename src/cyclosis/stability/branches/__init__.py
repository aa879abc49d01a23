"""Branches of steady states over one parameter: continuation, switching, and special points."""
