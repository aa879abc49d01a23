"""What a physics must provide, so that one loop, one file format and one ensemble work for all."""
