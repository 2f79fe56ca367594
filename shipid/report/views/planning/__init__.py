"""Planned trials as a page."""
