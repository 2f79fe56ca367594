"""What the bridge knows and works out, without a clock and without a network."""
