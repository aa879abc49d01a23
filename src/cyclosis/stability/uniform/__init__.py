"""Uniform states, their orders, and growth rates about them in closed form."""
