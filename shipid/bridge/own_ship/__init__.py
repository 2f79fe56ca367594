"""The own ship: her sensors, and the filter of her model."""
