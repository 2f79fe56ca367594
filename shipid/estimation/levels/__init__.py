"""Noise levels of a filter from the record that it filters, and what the record says against it."""
