"""What a state means: numbers, indifferent zones, regimes."""
