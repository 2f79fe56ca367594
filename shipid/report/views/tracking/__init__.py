"""The report of tracks."""
