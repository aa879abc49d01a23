"""How a cell moves: time steppers and single runs."""
