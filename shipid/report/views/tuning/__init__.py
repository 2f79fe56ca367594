"""A design, its judgement, or two of them, as a page."""
