"""Trial records: read, described, checked, measured, simulated and written."""
