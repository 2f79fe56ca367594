"""The draft of a format file: what the columns of a log are by the names in use, and what is left to fill in."""
