"""The tracking experiment of Passenier (1989), section 6.4: its tracks and its score."""
