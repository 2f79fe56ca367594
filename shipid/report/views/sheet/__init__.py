"""The sheet of a trial day as a page."""
