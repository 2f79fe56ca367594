"""The ground floor: errors, files written whole or not at all, the cache folder."""
