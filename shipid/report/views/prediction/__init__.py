"""A predicted track as a page."""
