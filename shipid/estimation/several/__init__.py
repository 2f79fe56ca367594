"""Filters that work together: in a row, with adaptive noise, with an estimated noise level."""
