"""Routes: the geometry of legs on the earth."""
