"""A filtered record, or a recursion, as a page."""
