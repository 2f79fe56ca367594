"""Which trial to sail next, from the exact information matrix."""
