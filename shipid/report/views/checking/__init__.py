"""Findings on trials as a page."""
