"""Models ranked by their predictions, as a page."""
