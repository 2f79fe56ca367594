"""How components become one model: joined by name, augmented, and checked for units."""
