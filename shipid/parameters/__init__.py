"""Parameter sets: what is known of a ship, each number with its unit and its source; finding a model or a ship by name."""
