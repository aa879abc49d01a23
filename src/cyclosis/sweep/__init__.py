"""Sweeps: ensembles over a grid of parameters, in blocks that are stored one by one."""
