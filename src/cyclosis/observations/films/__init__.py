"""Films of cells: reading them, and measuring what moves in them."""
