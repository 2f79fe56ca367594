"""Tables of whatever kind of file: opened within bounds, found among others, their header and their numbers understood."""
