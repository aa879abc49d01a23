"""What a cell is: parameters, grid, flow, filaments, initial states."""
