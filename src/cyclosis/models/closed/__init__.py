"""The closed cell: the filament equation and its flow on a closed surface of revolution."""
