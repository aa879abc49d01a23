"""States that are uniform along one axis: their profiles, upright and drifting, and their growth rates."""
