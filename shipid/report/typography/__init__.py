"""Numbers and symbols as they are printed."""
